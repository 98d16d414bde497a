use super::*;

/// Two triangles on a unit square, diagonal 0–2.
fn square() -> TriMesh {
    TriMesh::new(4, vec![[0, 1, 2], [0, 2, 3]]).unwrap()
}

fn tetrahedron() -> TriMesh {
    TriMesh::new(4, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).unwrap()
}

fn message(num_vertices: usize, faces: &[[u32; 3]]) -> String {
    TriMesh::new(num_vertices, faces.to_vec())
        .unwrap_err()
        .to_string()
}

#[test]
fn square_has_the_edges_and_sides_of_the_convention() {
    let mesh = square();
    assert_eq!(mesh.edges(), [[0, 1], [0, 2], [0, 3], [1, 2], [2, 3]]);
    let (a, b) = (Some(FaceId(0)), Some(FaceId(1)));
    // Face 1 traverses the diagonal 0→2, face 0 traverses it 2→0.
    assert_eq!(
        mesh.edge_faces(),
        [[a, None], [b, a], [None, b], [a, None], [b, None]]
    );
    assert_eq!(
        mesh.face_edges(),
        [
            [EdgeId(3), EdgeId(1), EdgeId(0)],
            [EdgeId(4), EdgeId(2), EdgeId(1)]
        ]
    );
    assert_eq!(mesh.edge_sign(FaceId(0), 1), -1.0);
    assert_eq!(mesh.edge_sign(FaceId(1), 2), 1.0);
    assert_eq!(mesh.opposite_vertex(EdgeId(1), 0), Some(VertexId(3)));
    assert_eq!(mesh.opposite_vertex(EdgeId(1), 1), Some(VertexId(1)));
    assert_eq!(mesh.opposite_vertex(EdgeId(0), 1), None);
    assert_eq!(mesh.find_edge(VertexId(2), VertexId(0)), Some(EdgeId(1)));
    assert_eq!(mesh.find_edge(VertexId(1), VertexId(3)), None);
}

#[test]
fn edge_sign_agrees_with_the_side_of_the_face() {
    let mesh = tetrahedron();
    for (f, edges) in mesh.face_edges().iter().enumerate() {
        for (c, edge) in edges.iter().enumerate() {
            let face = FaceId(f as u32);
            let side = if mesh.edge_sign(face, c) > 0.0 { 0 } else { 1 };
            assert_eq!(mesh.edge_faces()[edge.0 as usize][side], Some(face));
            assert_eq!(
                mesh.opposite_vertex(*edge, side),
                Some(VertexId(mesh.faces()[f][c]))
            );
        }
    }
}

#[test]
fn vertices_know_their_faces_and_valence() {
    let mesh = square();
    assert_eq!(mesh.vertex_faces(VertexId(0)), [FaceId(0), FaceId(1)]);
    assert_eq!(mesh.vertex_faces(VertexId(3)), [FaceId(1)]);
    assert_eq!(mesh.valence(VertexId(0)), 3);
    assert_eq!(mesh.valence(VertexId(1)), 2);
    assert_eq!(tetrahedron().valence(VertexId(0)), 3);
    assert!(mesh.is_boundary_edge(EdgeId(0)) && !mesh.is_boundary_edge(EdgeId(1)));
}

#[test]
fn boundary_loops_follow_the_faces() {
    let ids = |loops: Vec<Vec<VertexId>>| -> Vec<Vec<u32>> {
        loops
            .iter()
            .map(|l| l.iter().map(|v| v.0).collect())
            .collect()
    };
    assert_eq!(ids(square().boundary_loops()), [[0, 1, 2, 3]]);
    assert!(tetrahedron().boundary_loops().is_empty());
    let two = TriMesh::new(6, vec![[5, 4, 3], [0, 1, 2]]).unwrap();
    assert_eq!(ids(two.boundary_loops()), [[0, 1, 2], [3, 5, 4]]);
}

#[test]
fn components_are_numbered_by_first_vertex() {
    let two = TriMesh::new(6, vec![[5, 3, 1], [0, 2, 4]]).unwrap();
    assert_eq!(two.components(), (2, vec![0, 1, 0, 1, 0, 1]));
    assert_eq!(tetrahedron().components().0, 1);
}

#[test]
fn euler_characteristic_tells_disc_from_sphere() {
    assert_eq!(square().euler_characteristic(), 1);
    assert_eq!(tetrahedron().euler_characteristic(), 2);
}

#[test]
fn faulty_faces_are_refused_by_name() {
    assert!(message(3, &[]).contains("no faces"));
    assert!(
        message(3, &[[0, 1, 2], [0, 1, 7]]).contains("face 1 uses vertex 7, but there are only 3")
    );
    assert!(message(3, &[[0, 1, 1]]).contains("face 0 uses vertex 1 more than once: [0, 1, 1]"));
    assert!(message(3, &[[2, 1, 2]]).contains("face 0 uses vertex 2 more"));
    assert!(
        message(3, &[[0, 1, 2], [1, 0, 2]])
            .contains("faces [0, 1] have the same vertices [0, 1, 2]")
    );
    assert!(
        message(5, &[[0, 1, 3]]).contains("2 vertices belong to no face (the first is vertex 2)")
    );
}

#[test]
fn edge_of_three_faces_is_refused_with_its_faces() {
    let text = message(5, &[[0, 1, 2], [1, 0, 3], [0, 1, 4]]);
    assert!(
        text.contains("edge [0, 1] belongs to 3 faces [0, 1, 2]"),
        "{text}"
    );
}

#[test]
fn neighbours_of_opposite_orientation_are_refused() {
    let text = message(4, &[[0, 1, 2], [0, 3, 2]]);
    assert!(
        text.contains("faces [0, 1] both traverse edge [0, 2]"),
        "{text}"
    );
}

#[test]
fn fans_that_touch_at_a_vertex_are_refused() {
    let text = message(5, &[[0, 1, 2], [0, 3, 4]]);
    assert!(
        text.contains("vertex 0 joins separate fans") && text.contains("own copy"),
        "{text}"
    );
}
