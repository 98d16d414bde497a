use std::fs;

use super::*;
use crate::mesh::OrientationPolicy;

fn bytes_of(positions: &[[f64; 3]], stl: bool) -> Vec<u8> {
    let mut text = String::from(if stl { "solid s\n" } else { "OFF\n4 2 0\n" });
    let line = |x: [f64; 3]| format!("{} {} {}\n", x[0], x[1], x[2]);
    if stl {
        for face in [[0, 1, 2], [0, 2, 3]] {
            text.push_str("facet normal 0 0 1\nouter loop\n");
            face.iter()
                .for_each(|&v: &usize| text.push_str(&format!("vertex {}", line(positions[v]))));
            text.push_str("endloop\nendfacet\n");
        }
    } else {
        positions.iter().for_each(|&x| text.push_str(&line(x)));
        text.push_str("3 0 1 2\n3 0 2 3\n");
    }
    text.into_bytes()
}

const SQUARE: [[f64; 3]; 4] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
];

fn obj() -> Vec<u8> {
    b"# square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0.5 0.5\nf 1/1 2/1 3/1 \\\n 4/1\n".to_vec()
}

fn ply(binary: bool) -> Vec<u8> {
    let format = if binary { "binary_big_endian" } else { "ascii" };
    let mut bytes = format!(
        "ply\nformat {format} 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
         element face 2\nproperty list uchar uint vertex_index\nend_header\n"
    )
    .into_bytes();
    if !binary {
        bytes.extend(b"0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n");
        return bytes;
    }
    bytes.extend(
        SQUARE
            .iter()
            .flatten()
            .flat_map(|&value| (value as f32).to_be_bytes()),
    );
    for face in [[0u32, 1, 2], [0, 2, 3]] {
        bytes.push(3);
        bytes.extend(face.iter().flat_map(|corner| corner.to_be_bytes()));
    }
    bytes
}

fn stl_binary() -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend(2u32.to_le_bytes());
    for face in [[0, 1, 2], [0, 2, 3]] {
        bytes.extend([0; 12]);
        for v in face {
            let position: [f64; 3] = SQUARE[v];
            bytes.extend(
                position
                    .iter()
                    .flat_map(|&value| (value as f32).to_le_bytes()),
            );
        }
        bytes.extend([0; 2]);
    }
    bytes
}

fn samples() -> Vec<(MeshFormat, Vec<u8>)> {
    vec![
        (MeshFormat::Obj, obj()),
        (MeshFormat::Ply, ply(false)),
        (MeshFormat::Ply, ply(true)),
        (MeshFormat::Stl, bytes_of(&SQUARE, true)),
        (MeshFormat::Stl, stl_binary()),
        (MeshFormat::Off, bytes_of(&SQUARE, false)),
    ]
}

#[test]
fn every_format_gives_the_same_surface() {
    for (format, bytes) in samples() {
        let surface = format
            .parse(&bytes)
            .unwrap()
            .into_surface(SurfaceOptions::default())
            .unwrap();
        assert_eq!(surface.positions, SQUARE.map(Vec3::from), "{format:?}");
        assert_eq!(surface.mesh.faces(), [[0, 1, 2], [0, 2, 3]], "{format:?}");
    }
}

#[test]
fn content_tells_the_format_before_the_extension_does() {
    for (format, bytes) in samples() {
        let found = MeshFormat::detect(&bytes, Path::new("mesh.obj"));
        assert_eq!(found, Some(format));
    }
    assert_eq!(
        MeshFormat::detect(b"v 0 0 0", Path::new("A.OBJ")),
        Some(MeshFormat::Obj)
    );
    assert_eq!(MeshFormat::detect(b"v 0 0 0", Path::new("a.txt")), None);
    assert_eq!(MeshFormat::detect(b"", Path::new("a")), None);
}

#[test]
fn errors_carry_file_line_and_fault() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sheet.obj");
    let read = |text: &str| {
        fs::write(&path, text).unwrap();
        read_mesh(&path).and_then(|mesh| mesh.into_surface(SurfaceOptions::default()))
    };
    let error = read("v 0 0 0\nv 1 0 z\n").unwrap_err().to_string();
    assert!(
        error.ends_with("sheet.obj: line 2: the z coordinate 'z' is not a finite number"),
        "{error}"
    );
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\n";
    let error = read(&format!("{square}f 1 4 3\n")).unwrap_err().to_string();
    assert!(
        error.contains("sheet.obj, line 5: faces [1, 2] both traverse edge [1, 3]"),
        "{error}"
    );
    let error = read(&format!("{square}f 1 3 4\nf 1 1 3\n"))
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("sheet.obj, line 7: face 3 uses vertex 1 more than once: [1, 1, 3]"),
        "{error}"
    );
    assert_eq!(
        read(&format!("{square}f 1 3 4\n"))
            .unwrap()
            .mesh
            .num_faces(),
        2
    );

    assert!(
        read(&format!("\u{feff}{square}")).is_ok(),
        "a byte order mark is passed over"
    );
    let error = read_mesh(&folder.path().join("none.obj"))
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("could not read") && error.contains("none.obj"),
        "{error}"
    );
    fs::write(folder.path().join("notes.txt"), "hello").unwrap();
    let error = read_mesh(&folder.path().join("notes.txt"))
        .unwrap_err()
        .to_string();
    assert!(error.contains("no mesh format known here"), "{error}");
}

#[test]
fn faults_are_told_in_the_numbers_of_the_file() {
    let problem = |format: MeshFormat, text: &str| {
        let mesh = format.parse(text.as_bytes()).unwrap();
        let error = mesh.into_surface(SurfaceOptions::default()).unwrap_err();
        error.to_string()
    };
    // The first vertex is in no face and dropped: the others keep their numbers in what is said of them.
    let points = "v 9 9 9\nv 0 0 0\nv 1 0 0\n";
    assert_eq!(
        problem(MeshFormat::Obj, &format!("{points}f 2 3 3\n")),
        "line 4: face 1 uses vertex 3 more than once: [2, 3, 3]; remove the face \
         (vertices and triangles are counted from 1)"
    );
    assert_eq!(
        problem(
            MeshFormat::Off,
            "OFF\n3 1 0\n9 9 9\n0 0 0\n1 0 0\n3 1 2 2\n"
        ),
        "line 6: face 0 uses vertex 2 more than once: [1, 2, 2]; remove the face \
         (vertices and triangles are counted from 0)"
    );
    let stl = "solid s\nfacet\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 0 0\nendfacet\n";
    let text = problem(MeshFormat::Stl, stl);
    assert!(
        text.contains("vertex 1 more than once") && text.ends_with("equal points as one)"),
        "{text}"
    );
}

/// Steele, Lea and Flood (2014).
fn random(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[test]
fn damaged_files_give_errors_or_meshes_but_never_panic() {
    let repair = SurfaceOptions {
        orientation: OrientationPolicy::Repair,
        ..Default::default()
    };
    let mut state = 2026;
    let (mut refused, mut accepted) = (0, 0);
    for (format, good) in samples() {
        for _ in 0..3000 {
            let mut bytes = good.clone();
            for _ in 0..=random(&mut state) % 3 {
                damage(&mut bytes, &mut state);
            }
            match format.parse(&bytes).map(|mesh| mesh.into_surface(repair)) {
                Ok(Ok(_)) => accepted += 1,
                _ => refused += 1,
            }
        }
    }
    // The damage is neither so small nor so large that the test is empty.
    assert!(
        refused > 1000 && accepted > 1000,
        "{refused} refused, {accepted} accepted"
    );
}

fn damage(bytes: &mut Vec<u8>, state: &mut u64) {
    if bytes.is_empty() {
        return;
    }
    let at = random(state) as usize % bytes.len();
    let length = (random(state) as usize % 12).min(bytes.len() - at);
    match random(state) % 5 {
        0 => bytes[at] = random(state) as u8,
        // A byte from elsewhere in the file: digits for digits, letters for letters.
        1 => bytes[at] = bytes[random(state) as usize % bytes.len()],
        2 => drop(bytes.drain(at..at + length)),
        3 => {
            let copy = bytes[at..at + length].to_vec();
            let to = random(state) as usize % bytes.len();
            bytes.splice(to..to, copy);
        }
        _ => bytes.truncate(at),
    }
}
