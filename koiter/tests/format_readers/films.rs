//! Films: VTKHDF read by VTK and h5py, USDA by Pixar's library, NPZ by NumPy; and STL by VTK.

use std::path::Path;

use koiter::io::result::{Frame, ResultReader};
use koiter::io::write::{
    MeshWithFields, WriteError, write_npz, write_pc2, write_stl, write_usda, write_vtkhdf,
};
use koiter::io::{read_mesh, read_points};
use serde_json::{Map, Value, json};

use crate::python::{bits, read_with};
use crate::sample::write_result;

type Write = fn(&Path, &ResultReader, &[usize]) -> Result<(), WriteError>;

fn single(values: &[f32]) -> Value {
    bits(values.iter().map(|&value| f64::from(value)))
}

/// What a reader must find of a frame.
fn expected(
    result: &ResultReader,
    frame: &Frame,
    is_double: bool,
    field_name: fn(&str) -> String,
) -> Value {
    let coordinate = |value: f64| match is_double {
        true => value,
        false => f64::from(value as f32),
    };
    let positions: Value = (frame.positions.iter())
        .map(|x| bits(x.iter().map(|&value| coordinate(value))))
        .collect();
    let mut fields = Map::new();
    for (prefix, list) in [
        ("vertex", &frame.vertex_fields),
        ("face", &frame.face_fields),
    ] {
        for field in list {
            let name = format!("{prefix} {}", field_name(&field.name));
            fields.insert(name, single(&field.values));
        }
    }
    json!({ "positions": positions, "faces": result.faces_in(frame), "fields": fields })
}

fn as_word(name: &str) -> String {
    name.replace(|c: char| !c.is_ascii_alphanumeric(), "_")
}

fn check(extension: &str, write: Write, is_double: bool, field_name: fn(&str) -> String) {
    let folder = tempfile::tempdir().unwrap();
    write_result(&folder.path().join("run"));
    let result = ResultReader::open(&folder.path().join("run")).unwrap();
    let file = folder.path().join(format!("run.{extension}"));
    for frames in [vec![0, 1, 2], vec![1]] {
        write(&file, &result, &frames).unwrap();
        let Some(mut found) = read_with("film_reader.py", &file) else {
            return;
        };
        assert_eq!(found["up"], "z");
        assert_eq!(found["metres"], 1.0);
        assert_eq!(found["parts"], json!(["torus", "sheet"]));
        let read: Vec<Frame> = frames.iter().map(|&k| result.frame(k).unwrap()).collect();
        if let Some(times) = found["times"].as_array() {
            for (time, frame) in times.iter().zip(&read) {
                // USD counts in codes of 1/24 s, which rounds.
                let time = f64::from_bits(time.as_u64().unwrap());
                assert!((time - frame.time).abs() < 1e-15, "{time}");
            }
        }
        assert_eq!(found["frames"].as_array().unwrap().len(), frames.len());
        for (found, frame) in found["frames"]
            .as_array_mut()
            .unwrap()
            .iter_mut()
            .zip(&read)
        {
            // Of VTK's files only; that of VTU has its own test.
            found["fields"].as_object_mut().unwrap().remove("face part");
            let expected = expected(&result, frame, is_double, field_name);
            for key in ["positions", "faces", "fields"] {
                // Told without the numbers, which are thousands.
                assert!(found[key] == expected[key], "{extension}: {key}");
            }
        }
    }
}

#[test]
fn vtk_and_h5py_read_vtkhdf_bit_for_bit() {
    check("vtkhdf", write_vtkhdf, true, |name| name.replace('/', "_"));
}

#[test]
fn pixars_library_reads_usda_to_single_precision() {
    check("usda", write_usda, false, as_word);
}

#[test]
fn numpy_reads_npz_bit_for_bit_and_so_do_we() {
    check("npz", write_npz, true, as_word);
    let folder = tempfile::tempdir().unwrap();
    write_result(&folder.path().join("run"));
    let result = ResultReader::open(&folder.path().join("run")).unwrap();
    let file = folder.path().join("run.npz");
    write_npz(&file, &result, &[0, 2]).unwrap();
    let cache = read_points(&file).unwrap();
    let frames = [0, 2].map(|index| result.frame(index).unwrap());
    assert_eq!(
        cache.times,
        Some(frames.iter().map(|frame| frame.time).collect())
    );
    assert_eq!(cache.frames, frames.map(|frame| frame.positions));
}

#[test]
fn a_point_cache_comes_back_with_its_mesh() {
    let folder = tempfile::tempdir().unwrap();
    write_result(&folder.path().join("run"));
    let result = ResultReader::open(&folder.path().join("run")).unwrap();
    let file = folder.path().join("run.pc2");
    let mesh = write_pc2(&file, &result, &[0, 1, 2]).unwrap();
    let (mesh, cache) = (read_mesh(&mesh).unwrap(), read_points(&file).unwrap());
    assert_eq!(mesh.faces, result.faces());
    assert_eq!((cache.times, cache.frames.len()), (None, 3));
    for (index, frame) in cache.frames.iter().enumerate() {
        for (found, x) in frame.iter().zip(&result.frame(index).unwrap().positions) {
            assert_eq!(*found, x.map(|value| f64::from(value as f32)));
        }
    }
}

#[test]
fn vtk_reads_the_triangles_of_stl() {
    let folder = tempfile::tempdir().unwrap();
    write_result(&folder.path().join("run"));
    let result = ResultReader::open(&folder.path().join("run")).unwrap();
    let frame = result.frame(2).unwrap();
    let file = folder.path().join("run.stl");
    write_stl(&file, &MeshWithFields::of_frame(&result, &frame)).unwrap();
    let Some(found) = read_with("film_reader.py", &file) else {
        return;
    };
    let corners: Value = (result.faces().iter().flatten())
        .map(|&vertex| {
            let x = frame.positions[vertex as usize];
            bits(x.iter().map(|&value| f64::from(value as f32)))
        })
        .collect();
    assert!(found["corners"] == corners);
}
