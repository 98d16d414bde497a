//! What is said of every fault of a mesh.

use std::collections::BTreeSet;

use super::MeshError;
use crate::Vec3;
use crate::mesh::{Surface, SurfaceOptions, TriMesh, UnreferencedPolicy, repair};

/// Every variant; the compiler asks for those that are missing here, the test for those without a message.
macro_rules! variants {
    ($($variant:ident),*) => {
        const VARIANTS: &[&str] = &[$(stringify!($variant)),*];

        fn name(error: &MeshError) -> &'static str {
            match error {
                $(MeshError::$variant { .. } => stringify!($variant)),*
            }
        }
    };
}

variants!(
    Empty,
    TooLarge,
    IndexOutOfRange,
    RepeatedIndex,
    DuplicateFace,
    NonManifoldEdge,
    InconsistentOrientation,
    NotOrientable,
    NonManifoldVertex,
    Unreferenced,
    NotFinite,
    DegenerateFace,
    PositionCount
);

fn of_faces(num_vertices: usize, faces: &[[u32; 3]]) -> MeshError {
    TriMesh::new(num_vertices, faces.to_vec()).unwrap_err()
}

fn of_points(points: &[[f64; 3]]) -> MeshError {
    let positions = points.iter().map(|&x| Vec3::from(x)).collect();
    let options = SurfaceOptions {
        unreferenced: UnreferencedPolicy::Refuse,
        ..SurfaceOptions::default()
    };
    Surface::new(positions, vec![[0, 1, 2]], options).unwrap_err()
}

/// A Möbius strip of five triangles about as many vertices: each shares an edge with the next.
fn moebius() -> MeshError {
    let faces = (0..5).map(|i| [i, (i + 1) % 5, (i + 2) % 5]).collect();
    repair::orient_consistently(faces).unwrap_err()
}

#[test]
fn every_fault_names_the_element_and_what_to_do() {
    let origin = [0.0; 3];
    let x = [1.0, 0.0, 0.0];
    let y = [0.0, 1.0, 0.0];
    let count = MeshError::TooLarge {
        what: "faces",
        count: 5_000_000_000,
        limit: 4_294_967_295,
    };
    let one = TriMesh::new(3, vec![[0, 1, 2]]).unwrap();
    let cases = [
        (
            of_faces(0, &[]),
            "the mesh has no faces; give at least one triangle",
        ),
        (
            count,
            "the mesh has 5000000000 faces, more than the 4294967295 that 32-bit indices allow; split it",
        ),
        (
            of_faces(3, &[[0, 1, 5]]),
            "face 0 uses vertex 5, but there are only 3 vertices (numbered from 0); correct",
        ),
        (
            of_faces(3, &[[0, 1, 1]]),
            "face 0 uses vertex 1 more than once: [0, 1, 1]; remove the face",
        ),
        (
            of_faces(3, &[[0, 1, 2], [1, 2, 0]]),
            "faces [0, 1] have the same vertices [0, 1, 2]; remove one",
        ),
        (
            of_faces(5, &[[0, 1, 2], [1, 0, 3], [0, 1, 4]]),
            "edge [0, 1] belongs to 3 faces [0, 1, 2]; a shell has at most two",
        ),
        (
            of_faces(4, &[[0, 1, 2], [0, 1, 3]]),
            "faces [0, 1] both traverse edge [0, 1] in the same direction; reverse one",
        ),
        (
            moebius(),
            "the surface is one-sided: no orientation agrees across edge",
        ),
        (
            of_faces(5, &[[0, 1, 2], [0, 3, 4]]),
            "vertex 0 joins separate fans of faces (faces 0 and 1 meet only at this point)",
        ),
        (
            of_points(&[origin, x, y, [3.0; 3]]),
            "1 vertices belong to no face (the first is vertex 3); remove them",
        ),
        (
            of_points(&[origin, x, [f64::NAN, 0.0, 0.0]]),
            "vertex 2 has a coordinate that is not a finite number: [NaN, 0.0, 0.0]",
        ),
        (
            of_points(&[origin, x, [2.0, 0.0, 0.0]]),
            "face 0 [0, 1, 2] is degenerate: its height is 0.0e0 of its longest edge (2.000e0 m)",
        ),
        (
            Surface::from_mesh(one, vec![Vec3::zeros(); 2]).unwrap_err(),
            "there are 2 positions for 3 vertices; give one position a vertex",
        ),
    ];
    let mut seen = BTreeSet::new();
    for (error, words) in &cases {
        assert!(
            error.to_string().contains(words),
            "'{words}' is not in: {error}"
        );
        seen.insert(name(error));
    }
    assert_eq!(seen, VARIANTS.iter().copied().collect());
}
