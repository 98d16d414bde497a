use super::*;

const HEADER: &str = "comment metres\nobj_info x\nelement vertex 4\nproperty double x\nproperty float y\n\
    property uchar red\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\n\
    property float strain\nelement edge 1\nproperty list short short path\nend_header\n";

fn text_file() -> String {
    format!(
        "ply\nformat ascii 1.0\n{HEADER}0.1 0 255 0\n1 0 255 0\n1 1 255 0.5\n0 1 255 0\n4 0 1 2 3 0.25\n2 7 8\n"
    )
}

fn binary_file(endian: Endian) -> Vec<u8> {
    let name = if endian == Endian::Big {
        "big"
    } else {
        "little"
    };
    let mut bytes = format!("ply\r\nformat binary_{name}_endian 1.0\n{HEADER}").into_bytes();
    let mut put = |value: &[u8]| {
        let mut value = value.to_vec();
        if endian == Endian::Big {
            value.reverse();
        }
        bytes.extend(value);
    };
    for [x, y, z] in [
        [0.1, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.5],
        [0.0, 1.0, 0.0],
    ] {
        put(&f64::to_le_bytes(x));
        put(&(y as f32).to_le_bytes());
        put(&[255]);
        put(&(z as f32).to_le_bytes());
    }
    put(&[4]);
    for corner in 0..4i32 {
        put(&corner.to_le_bytes());
    }
    put(&0.25f32.to_le_bytes());
    for value in [2i16, 7, 8] {
        put(&value.to_le_bytes());
    }
    bytes
}

#[test]
fn text_and_both_byte_orders_give_the_same_mesh() {
    let files = [
        text_file().into_bytes(),
        binary_file(Endian::Little),
        binary_file(Endian::Big),
    ];
    for file in &files {
        let mesh = parse_ply(file).unwrap();
        assert_eq!(
            mesh.positions,
            [
                [0.1, 0.0, 0.0],
                [1.0, 0.0, 0.0],
                [1.0, 1.0, 0.5],
                [0.0, 1.0, 0.0]
            ]
        );
        assert_eq!(mesh.faces, [[0, 1, 2], [0, 2, 3]]);
    }
    assert_eq!(parse_ply(&files[0]).unwrap().face_lines, [20, 20]);
}

#[test]
fn faults_are_named_with_their_place() {
    let changed = |from: &str, to: &str| {
        parse_ply(text_file().replacen(from, to, 1).as_bytes())
            .unwrap_err()
            .to_string()
    };
    assert!(changed("ply", "plu").contains("line 1: a PLY file starts with"));
    assert!(
        changed("ascii 1.0", "ascii 2.0")
            .contains("line 2: 'format ascii 2.0' is not a line of a PLY 1.0")
    );
    assert!(changed("ascii", "binary").contains("line 2: the format is none of"));
    assert!(changed("format ascii 1.0\n", "").contains("no 'format' line"));
    assert!(changed("end_header", "end").contains("line 15: 'end' is not a line"));
    assert!(
        changed("element vertex 4\n", "").contains("line 5: a property comes before any element")
    );
    assert!(changed("vertex 4", "vertex -4").contains("the count of the element"));
    assert!(changed("double x", "quad x").contains("line 6: 'quad' is not a PLY type"));
    assert!(changed("property double x", "property double").contains("line 6: a property is"));
    assert!(changed("double x", "double u").contains("'vertex' has no property 'x'"));
    assert!(changed("vertex_indices", "corners").contains("no list 'vertex_indices'"));
    assert!(changed("element face 1", "element polygon 1").contains("no element 'face'"));
    assert!(changed("vertex 4", "vertex 400").contains("announces 400 of element 'vertex'"));
    assert!(changed("vertex 4", "vertex 5").contains("not a whole number"));
    assert!(
        changed("0.1 0 255", "nan 0 255").contains("line 16: the x coordinate of vertex 0 is NaN")
    );
    assert!(changed("0.1 0 255", "0.1 o 255").contains("line 16: 'o' is not a number"));
    assert!(changed("4 0 1 2 3", "4 0 1 2 4").contains("line 20: the face uses vertex 4"));
    assert!(changed("4 0 1 2 3", "4 0 1 2 -1").contains("line 20: the vertex index -1"));
    assert!(changed("4 0 1 2 3", "2 0 1").contains("line 20: the face has 2 corners"));
    assert!(changed("2 7 8\n", "2 7\n").contains("the file ends here"));
    assert!(
        parse_ply(b"ply\nformat ascii 1.0\n")
            .unwrap_err()
            .to_string()
            .contains("does not end")
    );
}

#[test]
fn faults_in_binary_files_are_named_with_their_byte() {
    let good = binary_file(Endian::Little);
    let error = parse_ply(&good[..good.len() - 1]).unwrap_err();
    // Where the last two-byte value should start.
    assert_eq!(error.location, super::super::Location::Byte(good.len() - 2));
    assert!(error.problem.contains("cut off"));
}

#[test]
fn counts_beyond_the_file_cost_neither_memory_nor_time() {
    for header in [
        "element vertex 18446744073709551615\nproperty float x\nproperty float y\nproperty float z",
        "element thing 18446744073709551615",
        "element thing 18446744073709551615\nproperty list uchar float x",
    ] {
        for format in ["ascii", "binary_little_endian"] {
            let text = format!("ply\nformat {format} 1.0\n{header}\nend_header\n0 0 0\n");
            assert!(
                parse_ply(text.as_bytes())
                    .unwrap_err()
                    .problem
                    .contains("announces 18446744073709551615")
            );
        }
    }
    let list = "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty list uint char a\nproperty char x\n\
        property char y\nproperty char z\nend_header\n\u{7f}\u{7f}\u{7f}\u{7f}aaa";
    assert!(
        parse_ply(list.as_bytes())
            .unwrap_err()
            .problem
            .contains("cut off")
    );
}
