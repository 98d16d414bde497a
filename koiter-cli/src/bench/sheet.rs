//! The sheet on which assembly and linear solves are timed: irregular triangles, rippled and noisy, of cotton.

use std::sync::Arc;

use koiter::Vec3;
use koiter::assembly::{
    Assembled, DofLayout, Energy, HessianBuilder, Pattern, PatternBuilder, PsdProjection,
    SymmetricMatrix,
};
use koiter::energy::Membrane;
use koiter::energy::bending::{MidEdgeBending, Tangent, bending_stencils};
use koiter::material::{Homogeneous, StVenantKirchhoff};
use koiter::mesh::Surface;
use koiter::mesh::generate::irregular;
use koiter::rest::rest_frames;
use nalgebra::Vector3;

use crate::failure::Failure;

/// Cotton, 1 mm thick, on 1 m².
pub(super) const YOUNGS_MODULUS: f64 = 1e6;
pub(super) const POISSONS_RATIO: f64 = 0.3;
pub(super) const THICKNESS: f64 = 1e-3;
const DENSITY: f64 = 500.0;
const TIME_STEP: f64 = 0.02;

/// A membrane with BAC bending, and where its matrix goes.
pub(super) struct Sheet {
    pub(super) num_faces: usize,
    pub(super) energies: [Box<dyn Energy>; 2],
    pub(super) q: Vec<f64>,
    pub(super) layout: DofLayout,
    pub(super) matrix: SymmetricMatrix,
    inertia: Vec<f64>,
}

/// The mean area of an irregular mesh, as a fraction of its largest.
const MEAN_AREA: f64 = 0.65;

/// A flat sheet of about `faces` triangles.
pub(super) fn flat_sheet(faces: usize) -> Result<Surface, Failure> {
    irregular(1.0, 1.0, 1.0 / (MEAN_AREA * faces as f64), 1)
        .map_err(|error| Failure::input(error.to_string()))
}

/// The positions of a sheet, rippled and noisy.
pub(super) fn posed_positions(sheet: &Surface) -> Vec<Vec3> {
    let spacing = sheet.mean_edge_length();
    (sheet.positions.iter().enumerate())
        .map(|(v, x)| posed(v, x, spacing))
        .collect()
}

impl Sheet {
    /// A sheet of about `faces` triangles.
    pub(super) fn new(faces: usize) -> Result<Self, Failure> {
        let surface = flat_sheet(faces)?;
        let mesh = &surface.mesh;
        let mut layout = DofLayout::new();
        let first_vertex = layout.push_nodes(mesh.num_vertices(), 3, true);
        let first_edge = layout.push_nodes(mesh.num_edges(), 1, true);
        let frames = rest_frames(&surface).map_err(|error| Failure::input(error.to_string()))?;
        let material = StVenantKirchhoff::new(YOUNGS_MODULUS, POISSONS_RATIO);
        let section = Homogeneous::uniform(material, THICKNESS, mesh.num_faces());
        let mut inertia = vec![0.0; layout.num_dofs()];
        for (face, frame) in mesh.faces().iter().zip(&frames) {
            for &v in face {
                let mass = DENSITY * THICKNESS * frame.area / 3.0;
                for dof in 3 * v as usize..3 * v as usize + 3 {
                    inertia[dof] += mass / (TIME_STEP * TIME_STEP);
                }
            }
        }
        let membrane = Membrane::new(mesh, first_vertex, frames.clone(), section.clone());
        let flat = vec![Vector3::zeros(); mesh.num_faces()];
        let stencils = bending_stencils(mesh, first_vertex, first_edge);
        let bending = MidEdgeBending::<Tangent, _>::new(stencils, frames, flat, section);
        let mut energies: [Box<dyn Energy>; 2] = [
            Box::new(Assembled::new(membrane, &layout)),
            Box::new(Assembled::new(bending, &layout)),
        ];
        let mut q = vec![0.0; layout.num_dofs()];
        for (v, x) in posed_positions(&surface).iter().enumerate() {
            q[3 * v..3 * v + 3].copy_from_slice(x.as_slice());
        }
        let mut builder = PatternBuilder::default();
        for energy in &energies {
            energy.add_to_pattern(&q, &mut builder);
        }
        let pattern = Arc::new(Pattern::new(&layout, &builder.finish()));
        for energy in &mut energies {
            energy.bind(&pattern);
        }
        Ok(Self {
            num_faces: mesh.num_faces(),
            energies,
            q,
            layout,
            matrix: SymmetricMatrix::zeros(pattern),
            inertia,
        })
    }

    /// Energies, gradient and projected Hessian into the assembled matrix; returns the gradient.
    pub(super) fn assemble(&mut self) -> Vec<f64> {
        let mut gradient = vec![0.0; self.q.len()];
        let mut coupling = vec![0.0; self.q.len()];
        self.matrix.values.fill(0.0);
        let mut hessian = HessianBuilder {
            matrix: &mut self.matrix,
            layout: &self.layout,
            prescribed_step: &[],
            coupling: &mut coupling,
        };
        for energy in &self.energies {
            energy.add_derivatives(&self.q, PsdProjection::Clamp, &mut gradient, &mut hessian);
        }
        gradient
    }

    /// The matrix of an implicit step.
    pub(super) fn step_matrix(&mut self) -> &SymmetricMatrix {
        self.assemble();
        let pattern = Arc::clone(&self.matrix.pattern);
        for (&position, inertia) in pattern.diagonal_positions().iter().zip(&self.inertia) {
            self.matrix.values[position as usize] += inertia;
        }
        &self.matrix
    }
}

/// Ripples of 5 cm and noise of 5 % of an edge.
fn posed(vertex: usize, x: &Vec3, spacing: f64) -> Vec3 {
    let noise = |k: f64| 0.05 * spacing * ((vertex as f64 + 0.5) * k).sin();
    let ripple = 0.005 * (x.x * 40.0 * std::f64::consts::PI).sin() * (x.y * 9.0).cos();
    x + Vec3::new(noise(12.9898), noise(78.233), ripple + noise(37.719))
}
