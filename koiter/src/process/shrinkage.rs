//! Shrinkage of a shell whose two layers want other lengths than at first: rest forms that go with them.
//!
//! ```text
//! ā = s² ā₀        b̄ = (L₊² − L₋²)/(2 h) ā₀ + s² b̄₀        s = (L₊ + L₋)/2
//! ```
//!
//! L₊, L₋ lengths of the top and the bottom layer over those at first, h thickness [m], ā₀, b̄₀ rest forms at first; b̄ is
//! positive where normals fan out. Of a shell that is flat at first these are exact: the metric at a height z is
//! `a + 2 z b + z² c` with the third form c; `a = s²`, `b = s² κ`, `c = s² κ²` make it `(s (1 + z κ))²`, which is L₊² and L₋² at
//! z = ± h/2. Of one that is curved at first, terms of the order h b̄₀ (L₊ − L₋) are left out. No surface need have these forms. A
//! strip whose top shrinks to υ bends to a curvature of `2 (1 − υ) / ((1 + υ) h)` in the middle, which is `(1 − υ) / (υ h)` at
//! the top.
//!
//! The membrane keeps its rest frames and takes the change as a rest strain, `ε̄ = (s² − 1)/2`: so masses and areas stay those
//! of the material. A face that has shrunk is as stiff an area of the *initial* shell as before, which is s² times as stiff an
//! area of its own: what has lost mass is softer. Of hinges the angle is that of two triangles on a sphere, curvature times the
//! distance of their circumcentres.

use super::RestState;
use crate::mesh::TriMesh;
use crate::rest::RestFrame;

/// What a shell's energies compare with rest values.
#[derive(Clone, Debug, PartialEq)]
pub enum Bent {
    /// Nothing: it does not curl.
    Nothing,
    /// Second fundamental forms of faces, so many a face, with those at first.
    Forms(Vec<f64>, usize),
    /// Angles of the inner edges.
    Hinges,
}

/// What the membranes of a shell compare with rest strains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stretched {
    /// Green strains of faces.
    Strains,
    /// Strains of all edges, then of the areas of all faces.
    LengthsAndAreas,
}

/// Moves the rest forms of a shell with the lengths of its layers.
#[derive(Clone, Debug)]
pub struct Shrinkage {
    mesh: TriMesh,
    thickness: Vec<f64>,
    bent: Bent,
    stretched: Stretched,
    /// Of every inner edge the distances of the circumcentres of its faces from it [m].
    arms: Vec<[f64; 2]>,
}

/// s².
fn squared([bottom, top]: &[f64; 2]) -> f64 {
    (0.5 * (top + bottom)).powi(2)
}

impl Shrinkage {
    /// Of a shell with rest `frames` and a `thickness` a face [m].
    pub fn new(
        mesh: &TriMesh,
        frames: &[RestFrame],
        thickness: Vec<f64>,
        bent: Bent,
        stretched: Stretched,
    ) -> Self {
        let arm = |face: usize, edge: usize| {
            let corner = mesh.face_edges()[face]
                .iter()
                .position(|e| e.0 as usize == edge);
            let c = corner.expect("an edge is one of its face's");
            let squares = frames[face].edge_lengths().map(|length| length * length);
            let [own, b, d] = [0, 1, 2].map(|k| squares[(c + k) % 3]);
            // ℓ/2 cot of the angle opposite the edge.
            own.sqrt() * (b + d - own) / (8.0 * frames[face].area)
        };
        let inner = mesh.edge_faces().iter().enumerate();
        let arms = inner.filter_map(|(edge, faces)| match faces {
            [Some(a), Some(b)] => Some([*a, *b].map(|face| arm(face.0 as usize, edge))),
            _ => None,
        });
        Self {
            arms: arms.collect(),
            mesh: mesh.clone(),
            thickness,
            bent,
            stretched,
        }
    }

    /// Moves rest values from those of the length factors `[bottom, top]` by face before to those now.
    pub fn advance(&self, rest: &mut RestState, before: &[[f64; 2]], now: &[[f64; 2]]) {
        self.stretch(&mut rest.strain, before, now);
        match &self.bent {
            Bent::Nothing => {}
            Bent::Forms(first, samples) => {
                for (place, value) in rest.curvature.iter_mut().enumerate() {
                    let (face, component) = (place / (3 * samples), place % 3);
                    let form = |factors: &[f64; 2]| {
                        let across = if component < 2 {
                            self.curling(face, factors)
                        } else {
                            0.0
                        };
                        across + squared(factors) * first[place]
                    };
                    *value += form(&now[face]) - form(&before[face]);
                }
            }
            Bent::Hinges => {
                let inner = self
                    .mesh
                    .edge_faces()
                    .iter()
                    .filter_map(|faces| match faces {
                        [Some(a), Some(b)] => Some([a.0 as usize, b.0 as usize]),
                        _ => None,
                    });
                for ((value, faces), arms) in rest.curvature.iter_mut().zip(inner).zip(&self.arms) {
                    let turned = |factors: &[[f64; 2]]| -> f64 {
                        let sides = faces.iter().zip(arms);
                        sides
                            .map(|(&face, arm)| arm * self.turning(face, &factors[face]))
                            .sum()
                    };
                    *value += turned(now) - turned(before);
                }
            }
        }
    }

    /// (L₊² − L₋²)/(2 h) [1/m].
    fn curling(&self, face: usize, [bottom, top]: &[f64; 2]) -> f64 {
        (top * top - bottom * bottom) / (2.0 * self.thickness[face])
    }

    /// Angle by rest length [rad/m]: curvature times s.
    fn turning(&self, face: usize, factors: &[f64; 2]) -> f64 {
        self.curling(face, factors) / squared(factors).sqrt()
    }

    fn stretch(&self, strain: &mut [f64], before: &[[f64; 2]], now: &[[f64; 2]]) {
        let change = |face: usize| squared(&now[face]) - squared(&before[face]);
        match self.stretched {
            Stretched::Strains => {
                for (face, strain) in strain.chunks_exact_mut(3).enumerate() {
                    strain[0] += 0.5 * change(face);
                    strain[1] += 0.5 * change(face);
                }
            }
            Stretched::LengthsAndAreas => {
                let (edges, faces) = strain.split_at_mut(self.mesh.num_edges());
                for (strain, sides) in edges.iter_mut().zip(self.mesh.edge_faces()) {
                    let sides = sides.iter().flatten().map(|face| face.0 as usize);
                    let length = |factors: &[[f64; 2]]| -> f64 {
                        let all = sides.clone().map(|face| squared(&factors[face]).sqrt());
                        all.sum::<f64>() / sides.clone().count() as f64
                    };
                    *strain += length(now) - length(before);
                }
                for (face, strain) in faces.iter_mut().enumerate() {
                    *strain += change(face);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::generate::{GridDiagonals, grid, icosphere};
    use crate::rest::rest_frames;

    #[test]
    fn forms_follow_the_mean_and_the_difference_of_the_layers_and_go_back() {
        let sheet = grid(1.0, 1.0, 2, 1, GridDiagonals::Uniform).unwrap();
        let frames = rest_frames(&sheet).unwrap();
        let first: Vec<f64> = (0..12).map(f64::from).collect();
        let bent = Bent::Forms(first.clone(), 1);
        let shrinkage =
            Shrinkage::new(&sheet.mesh, &frames, vec![0.1; 4], bent, Stretched::Strains);
        let mut rest = RestState {
            curvature: first.clone(),
            strain: vec![0.0; 12],
            ..RestState::default()
        };
        let (whole, burnt) = (vec![[1.0; 2]; 4], vec![[1.0, 0.8]; 4]);
        shrinkage.advance(&mut rest, &whole, &burnt);
        // 0.9² = 0.81, (0.64 − 1)/0.2 = −1.8.
        let expected = [-1.8, -1.8 + 0.81, 2.0 * 0.81];
        for (value, expected) in rest.curvature.iter().zip(expected) {
            assert!((value - expected).abs() < 1e-14, "{value} {expected}");
        }
        let strain = [-0.095, -0.095, 0.0];
        assert!((0..3).all(|k| (rest.strain[k] - strain[k]).abs() < 1e-15));
        shrinkage.advance(&mut rest, &burnt, &whole);
        for (value, first) in rest.curvature.iter().zip(&first) {
            assert!((value - first).abs() < 1e-13);
        }
    }

    #[test]
    fn hinges_turn_as_on_a_sphere_that_goes_through_their_vertices() {
        // Angles of an icosphere are those of its curvature, by what `arms` says of its flat triangles: to second order.
        let errors = [3, 4].map(|level| {
            let ball = icosphere(1.0, level).unwrap();
            let frames = rest_frames(&ball).unwrap();
            let shrinkage = Shrinkage::new(
                &ball.mesh,
                &frames,
                vec![0.01; frames.len()],
                Bent::Hinges,
                Stretched::LengthsAndAreas,
            );
            let mut worst = 0.0f64;
            for (edge, arms) in shrinkage.arms.iter().enumerate() {
                let [a, b] = ball.mesh.edge_faces()[edge].map(|face| {
                    let [x, y, z] = ball.corners(face.unwrap().0 as usize);
                    (y - x).cross(&(z - x)).normalize()
                });
                worst = worst.max((a.dot(&b).acos() / (arms[0] + arms[1]) - 1.0).abs());
            }
            worst
        });
        assert!(
            errors[1] < 1e-3 && errors[1] < 0.3 * errors[0],
            "{errors:?}"
        );
    }

    #[test]
    fn lengths_and_areas_shrink_alike() {
        let sheet = grid(1.0, 1.0, 1, 1, GridDiagonals::Uniform).unwrap();
        let frames = rest_frames(&sheet).unwrap();
        let thickness = vec![0.1; 2];
        let kind = Stretched::LengthsAndAreas;
        let shrinkage = Shrinkage::new(&sheet.mesh, &frames, thickness, Bent::Nothing, kind);
        let mut rest = RestState {
            strain: vec![0.0; 7],
            ..RestState::default()
        };
        shrinkage.advance(&mut rest, &[[1.0; 2]; 2], &[[0.9; 2]; 2]);
        assert!(
            rest.strain[..5]
                .iter()
                .all(|strain| (strain + 0.1).abs() < 1e-15)
        );
        assert!(
            rest.strain[5..]
                .iter()
                .all(|strain| (strain + 0.19).abs() < 1e-15)
        );
    }
}
