//! A bent patch, and every energy on it.

use koiter::Vec3;
use koiter::assembly::{Assembled, Dof, DofLayout};
use koiter::energy::bending::{
    AngleProfile, CorotationalEdge, CorotationalFace, DiscreteShells, FaceBending, LaplacianMesh,
    MidEdgeAverage, MidEdgeBending, QuadraticHinge, QuadraticVertex, bending_stencils,
};
use koiter::energy::{Membrane, StrainLimit, StretchLimit};
use koiter::material::{Homogeneous, StVenantKirchhoff};
use koiter::mesh::{Surface, TriMesh};
use koiter::rest::{RestFrame, rest_frames};
use nalgebra::Vector3;

pub(super) const THICKNESS: f64 = 0.3;

pub(super) struct Setup {
    pub(super) rest: Surface,
    pub(super) layout: DofLayout,
    pub(super) edges: Dof,
    pub(super) frames: Vec<RestFrame>,
    pub(super) q: Vec<f64>,
    pub(super) at_rest: Vec<f64>,
}

/// A bent patch: an inner vertex of valence 3 (its face stencils hold a vertex twice), one of valence 5, a boundary.
pub(super) fn setup_with(positions: Vec<Vec3>, faces: Vec<[u32; 3]>) -> Setup {
    let rest =
        Surface::from_mesh(TriMesh::new(positions.len(), faces).unwrap(), positions).unwrap();
    let mut layout = DofLayout::new();
    layout.push_nodes(rest.mesh.num_vertices(), 3, true);
    let edges = layout.push_nodes(rest.mesh.num_edges(), 1, true);
    let mut at_rest: Vec<f64> = rest
        .positions
        .iter()
        .flat_map(|x| [x.x, x.y, x.z])
        .collect();
    let num_positions = at_rest.len();
    at_rest.resize(layout.num_dofs(), 0.0);
    let amplitude = |i: usize| if i < num_positions { 0.08 } else { 0.2 };
    let q = at_rest
        .iter()
        .enumerate()
        .map(|(i, x)| x + amplitude(i) * ((i * 7 + 1) as f64 * 1.3).sin())
        .collect();
    let frames = rest_frames(&rest).unwrap();
    Setup {
        rest,
        layout,
        edges,
        frames,
        q,
        at_rest,
    }
}

pub(super) fn patch(height: f64) -> Setup {
    let points = [
        [0.0, 0.0, 0.1],
        [1.0, -0.1, 0.0],
        [0.45, 0.9, 0.05],
        [0.5, 0.3, 0.25],
        [-0.6, 0.8, -0.1],
        [0.5, -0.8, -0.15],
        [1.4, 0.8, -0.2],
    ];
    let faces = vec![
        [0, 1, 3],
        [1, 2, 3],
        [2, 0, 3],
        [0, 2, 4],
        [1, 0, 5],
        [2, 1, 6],
    ];
    setup_with(
        points
            .iter()
            .map(|p| Vec3::new(p[0], p[1], height * p[2]))
            .collect(),
        faces,
    )
}

pub(super) fn section(s: &Setup) -> Homogeneous<StVenantKirchhoff> {
    Homogeneous::uniform(StVenantKirchhoff::new(2.0, 0.3), THICKNESS, s.frames.len())
}

pub(super) fn membrane(s: &Setup) -> Membrane<Homogeneous<StVenantKirchhoff>> {
    Membrane::new(&s.rest.mesh, Dof(0), s.frames.clone(), section(s))
}

/// Wide enough for the stretches of the tested state, some of which lie below the barrier.
pub(super) fn strain_limit(s: &Setup) -> StrainLimit {
    let limit = StretchLimit {
        stretch: 2.0,
        begin: 1.0,
        stiffness: 1.3,
    };
    let volumes: Vec<f64> = s.frames.iter().map(|f| THICKNESS * f.area).collect();
    StrainLimit::new(&s.rest.mesh, Dof(0), s.frames.clone(), limit, &volumes)
}

/// A rigidity that differs from face to face.
pub(super) fn rigidity(s: &Setup) -> Vec<f64> {
    (0..s.frames.len()).map(|f| 0.7 + 0.1 * f as f64).collect()
}

pub(super) fn hinge<P: AngleProfile>(s: &Setup, curved: bool) -> DiscreteShells<P> {
    DiscreteShells::new(&s.rest, Dof(0), &s.frames, curved, &rigidity(s))
}

pub(super) fn corotational_edge(s: &Setup, curved: bool) -> CorotationalEdge {
    CorotationalEdge::new(&s.rest, Dof(0), &s.frames, curved, &rigidity(s))
}

pub(super) fn corotational_face(s: &Setup, curved: bool) -> FaceBending<CorotationalFace> {
    let stencils = bending_stencils(&s.rest.mesh, Dof(0), s.edges);
    FaceBending::<CorotationalFace>::new(&s.rest, stencils, &s.frames, curved, &rigidity(s))
}

pub(super) type Average = FaceBending<MidEdgeAverage<Homogeneous<StVenantKirchhoff>>>;

pub(super) fn mid_edge_average(s: &Setup, curved: bool) -> Average {
    let stencils = bending_stencils(&s.rest.mesh, Dof(0), s.edges);
    let zero = vec![Vector3::zeros(); s.rest.mesh.num_faces()];
    let mut bending = Average::new(stencils, s.frames.clone(), zero, section(s));
    if curved {
        let gathered = Assembled::new(mid_edge_average(s, false), &s.layout);
        let form = |f| bending.second_form(f, &gathered.gather(f, &s.at_rest));
        let forms = (0..s.rest.mesh.num_faces()).map(form).collect();
        bending.set_rest_forms(forms);
    }
    bending
}

pub(super) fn quadratic_hinge(s: &Setup) -> QuadraticHinge {
    QuadraticHinge::new(&s.rest, Dof(0), &s.frames, &rigidity(s))
}

pub(super) fn quadratic_vertex(s: &Setup, laplacian: LaplacianMesh) -> QuadraticVertex {
    let rigidity = rigidity(s);
    QuadraticVertex::new(&s.rest, Dof(0), &s.layout, &s.frames, &rigidity, laplacian)
}

pub(super) fn mid_edge<P: AngleProfile>(
    s: &Setup,
    curved: bool,
) -> MidEdgeBending<P, Homogeneous<StVenantKirchhoff>> {
    let stencils = bending_stencils(&s.rest.mesh, Dof(0), s.edges);
    let zero = vec![Vector3::zeros(); s.rest.mesh.num_faces()];
    let mut bending = MidEdgeBending::<P, _>::new(stencils, s.frames.clone(), zero, section(s));
    if curved {
        let gathered = Assembled::new(mid_edge::<P>(s, false), &s.layout);
        let form = |f| bending.second_form(f, &gathered.gather(f, &s.at_rest));
        let forms = (0..s.rest.mesh.num_faces()).map(form).collect();
        bending.set_rest_forms(forms);
    }
    bending
}
