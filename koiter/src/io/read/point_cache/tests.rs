use super::*;

fn pc2(num_points: u32, num_frames: u32, values: &[f32]) -> Vec<u8> {
    let mut bytes = PC2_MAGIC.to_vec();
    bytes.extend(num_points.to_le_bytes());
    bytes.extend(0_f32.to_le_bytes());
    bytes.extend(1_f32.to_le_bytes());
    bytes.extend(num_frames.to_le_bytes());
    bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    bytes
}

fn problem(bytes: &[u8]) -> String {
    parse_point_cache(bytes).unwrap_err().to_string()
}

#[test]
fn frames_of_a_pc2_file_come_in_order() {
    let values: Vec<f32> = (0..12).map(|x| x as f32).collect();
    let cache = parse_point_cache(&pc2(2, 2, &values)).unwrap();
    assert_eq!(cache.times, None);
    assert_eq!(cache.frames.len(), 2);
    assert_eq!(cache.frames[1][0], Vec3::new(6.0, 7.0, 8.0));
}

#[test]
fn files_that_contradict_themselves_are_refused() {
    let values = [0.0; 6];
    assert!(problem(&pc2(2, 2, &values)).contains("2 frames of 2 points"));
    assert!(problem(&pc2(u32::MAX, u32::MAX, &values)).contains("24 bytes that follow"));
    assert!(problem(&pc2(0, 7, &[])).contains("no positions"));
    assert!(
        problem(&pc2(2, 1, &[0.0, f32::NAN, 0.0, 0.0, 0.0, 0.0])).contains("vertex 0 of frame 0")
    );
    assert!(problem(&PC2_MAGIC[..]).contains("within its header"));
    assert!(problem(b"solid").contains("neither a PC2"));
    assert!(problem(b"PK\x03\x04 and nothing else").contains("damaged or cut off"));
}

/// An NPY file of a shape as text.
fn npy(kind: &str, shape: &str, values: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(values);
    bytes
}

#[test]
fn arrays_have_their_shape_and_either_byte_order() {
    let array = parse_npy(&npy(">f4", "(2,)", &[0x3f, 0x80, 0, 0, 0xc0, 0, 0, 0])).unwrap();
    assert_eq!((array.shape, array.values), (vec![2], vec![1.0, -2.0]));
    let array = parse_npy(&npy("<f8", "()", &1.5_f64.to_le_bytes())).unwrap();
    assert_eq!((array.shape, array.values), (vec![], vec![1.5]));
    for (kind, shape, said) in [
        ("<i8", "(1,)", "numbers are '<i8'"),
        ("<f8", "(2,)", "does not fit its 8 bytes"),
        ("<f8", "(18446744073709551615, 2)", "does not fit"),
        ("<f8", "(-1,)", "cannot be read"),
    ] {
        let error = parse_npy(&npy(kind, shape, &[0; 8])).unwrap_err();
        assert!(error.contains(said), "{error}");
    }
}
