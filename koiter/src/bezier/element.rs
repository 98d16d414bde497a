//! One element: its rest state, and energy, forces and stiffness at a pose of its three nodes.
//!
//! With A_i the rest axes as they hang on node i, E the axes of the frame and X_i, y_i corners at rest and now in the
//! frame, the deformation of a corner is
//!
//! ```text
//! d_i = (y_i − X_i,  log(Eᵀ R_i A_i)),      energy = ½ dᵀ K d
//! ```
//!
//! Let n, m̂ be the forces and moments of K d and H_i the derivative of the logarithm. Turning the frame itself costs the
//! moment `M = Σ y_i × n_i + m_i`, `m_i = H_iᵀ m̂_i`, so the exact derivative of the energy is, with G_i the spin of the
//! frame ([`super::frame`]),
//!
//! ```text
//! f_i = E (n_i − G_iᵀ M),      τ_i = E m_i
//! ```
//!
//! M vanishes at first order; with it forces and moments balance at any deformation. A frame by the printed iteration has
//! no G: then `f = E K d` as printed (Eq. 30).
//!
//! The consistent tangent is `E Pᵀ Hᵀ K H P Eᵀ` with `P = I − Γ G`, Γ = (−y_j×, I) the rigid turns, and the stiffness of the
//! forces as they turn (element-independent corotational formulation: Felippa, Haugen 2005), less terms of second order in
//! the deformation:
//!
//! ```text
//! (u_i, u_k): −n_i× G_k + G_iᵀ n_k× + G_iᵀ B G_k,   B = sym Σ_j n_j× y_j×;      (θ_i, u_k): −½ m_i× G_k
//! ```
//!
//! P is the identity but for terms of the order of the strain, yet of a thin shell a strain of (t/L)² in the membrane is as
//! much as all of bending.

use nalgebra::{Matrix2, Matrix3, SMatrix, SVector, UnitQuaternion, Vector2};

use super::andes::membrane_stiffness;
use super::collapse::Collapse;
use super::control_points::{CentralPoint, rest_levers};
use super::discrete_kirchhoff::bending_stiffness;
use super::frame::{Frame, FrameRule, rotation_angle};
use super::rotation::{cross_matrix, log_derivative, rotation_vector};
use super::stiffness::{Attachment, FlatTriangle, Stiffness, centre_gradients, cubic_stiffness};
use super::{BezierError, Section, Tangent};
use crate::Vec3;

/// Numbers over the unknowns of an element: (force, moment) or (displacement, rotation) of each corner.
pub(super) type ElementVector = SVector<f64, 18>;

/// Which element.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Deserialize, serde::Serialize, schemars::JsonSchema),
    serde(rename_all = "kebab-case")
)]
#[non_exhaustive]
pub enum ElementKind {
    /// The cubic triangle with the central point by degree elevation and control points that follow the stretch:
    /// converges on meshes of three directions; on irregular ones it fails the patch test of bending.
    #[default]
    Bezier,
    /// As printed in 2012. Inconsistent: it reproduces neither constant strain nor constant curvature and converges to
    /// another, mostly stiffer shell. For comparison.
    BezierPaper,
    /// Discrete Kirchhoff bending and the optimal membrane triangle: converges on any mesh. The reference.
    DktAndes,
}

impl ElementKind {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Bezier, Self::BezierPaper, Self::DktAndes];

    /// The name users write.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bezier => "bezier",
            Self::BezierPaper => "bezier-paper",
            Self::DktAndes => "dkt-andes",
        }
    }

    /// The frame that belongs to it.
    pub fn frame_rule(self) -> FrameRule {
        match self {
            Self::BezierPaper => FrameRule::PRINTED,
            _ => FrameRule::Polar,
        }
    }

    /// Where the central control point of its surface is.
    pub(super) fn central_point(self) -> CentralPoint {
        match self {
            Self::BezierPaper => CentralPoint::Carried,
            _ => CentralPoint::Elevated,
        }
    }
}

/// The rest state of an element: what survives when it is cut or sewn to others.
#[derive(Clone, Debug, PartialEq)]
pub struct RestElement {
    /// Corners [m].
    pub corners: [Vec3; 3],
    /// Normals at the corners.
    pub normals: [Vec3; 3],
    /// Rotation from the rest state to how each corner hangs on its node: the identity unless it was sewn on.
    pub attached: [UnitQuaternion<f64>; 3],
    /// What it is made of.
    pub section: Section,
}

/// An element, ready to be evaluated.
#[derive(Clone, Debug)]
pub struct Element {
    triangle: FlatTriangle,
    stiffness: Stiffness,
    collapse: Collapse,
    rule: FrameRule,
    /// Rest axes as they hang on each node.
    axes: [Matrix3<f64>; 3],
    /// Levers as they hang on each node [m].
    levers: [[Vec3; 3]; 3],
    centre: [(Vector2<f64>, Matrix2<f64>); 3],
}

/// Energy and its derivatives, in world axes.
#[derive(Clone, Debug)]
pub struct ElementState {
    /// ½ dᵀ K d [J].
    pub energy: f64,
    /// Derivative of the energy: minus the forces on the nodes [N] and moments [N m].
    pub gradient: ElementVector,
}

/// An element in its frame at a pose.
struct Placed {
    frame: Frame,
    spin: Option<[Matrix3<f64>; 3]>,
    deformation: ElementVector,
    /// K d.
    forces: ElementVector,
    log_derivatives: [Matrix3<f64>; 3],
    /// What the barrier of its area adds to gradient and stiffness.
    resistance: Option<(ElementVector, Stiffness)>,
}

fn part(vector: &ElementVector, first: usize) -> Vec3 {
    vector.fixed_rows::<3>(first).into_owned()
}

impl Element {
    /// Prepares an element; `index` is its number in messages.
    ///
    /// # Errors
    /// No area; a normal that points to the back.
    pub fn new(
        rest: &RestElement,
        kind: ElementKind,
        rule: FrameRule,
        index: usize,
    ) -> Result<Self, BezierError> {
        let section = &rest.section;
        let [a, b, c] = rest.corners;
        let longest = (b - a).norm().max((c - a).norm());
        let frame = Frame::along_edge(&rest.corners, longest * longest)
            .ok_or(BezierError::NoArea { element: index })?;
        let behind = |n: &Vec3| !(n.dot(&frame.axes.column(2)) > 0.0);
        if let Some(corner) = rest.normals.iter().position(behind) {
            let element = index;
            return Err(BezierError::Inverted { element, corner });
        }
        let triangle = FlatTriangle::new(frame.corners);
        let levers = rest_levers(&rest.corners, &rest.normals, kind.central_point());
        let local = levers.map(|of| of.map(|s| frame.axes.transpose() * s));
        let stiffness = match kind {
            ElementKind::Bezier => {
                cubic_stiffness(&triangle, &local, Attachment::Stretched, section)
            }
            ElementKind::BezierPaper => {
                cubic_stiffness(&triangle, &local, Attachment::Rigid, section)
            }
            ElementKind::DktAndes => {
                membrane_stiffness(&triangle, section) + bending_stiffness(&triangle, section)
            }
        };
        Ok(Self {
            collapse: Collapse::new(&triangle, section),
            triangle,
            stiffness,
            rule,
            axes: rest
                .attached
                .map(|r| r.to_rotation_matrix().matrix() * frame.axes),
            levers: [0, 1, 2].map(|i| levers[i].map(|s| rest.attached[i] * s)),
            centre: centre_gradients(&triangle, &local),
        })
    }

    /// This element with another stiffness.
    #[cfg(test)]
    pub(super) fn with_stiffness(self, stiffness: Stiffness) -> Self {
        Self { stiffness, ..self }
    }

    /// Area at rest [m²].
    pub fn area(&self) -> f64 {
        self.triangle.area
    }

    /// Stiffness in the frame.
    pub fn stiffness(&self) -> &Stiffness {
        &self.stiffness
    }

    /// The flat triangle at rest.
    pub(super) fn triangle(&self) -> &FlatTriangle {
        &self.triangle
    }

    /// The levers of each corner in the frame at rest [m].
    pub(super) fn local_levers(&self) -> [[Vec3; 3]; 3] {
        [0, 1, 2].map(|i| self.levers[i].map(|s| self.axes[i].transpose() * s))
    }

    /// Displacements and rotations of the corners in the frame; `None` if the element has collapsed.
    pub(super) fn deformation(
        &self,
        x: &[Vec3; 3],
        turns: &[UnitQuaternion<f64>; 3],
    ) -> Option<ElementVector> {
        self.deform(x, turns).map(|(_, deformation)| deformation)
    }

    /// The levers of each corner as they hang on its node at rest [m].
    pub fn levers(&self) -> &[[Vec3; 3]; 3] {
        &self.levers
    }

    /// Energy and gradient; `None` if the element has collapsed.
    pub fn state(&self, x: &[Vec3; 3], turns: &[UnitQuaternion<f64>; 3]) -> Option<ElementState> {
        let placed = self.place(x, turns)?;
        Some(self.state_of(&placed))
    }

    /// The energy [J]; `None` if the element has collapsed.
    pub fn energy(&self, x: &[Vec3; 3], turns: &[UnitQuaternion<f64>; 3]) -> Option<f64> {
        let (frame, deformation) = self.deform(x, turns)?;
        let elastic = 0.5 * deformation.dot(&(self.stiffness * deformation));
        Some(elastic + self.collapse.value(&frame.corners))
    }

    /// Energy, gradient and second derivatives in world axes; `None` if the element has collapsed.
    pub fn derivatives(
        &self,
        x: &[Vec3; 3],
        turns: &[UnitQuaternion<f64>; 3],
        tangent: Tangent,
    ) -> Option<(ElementState, Stiffness)> {
        let placed = self.place(x, turns)?;
        let mut local = match (tangent, &placed.spin) {
            (Tangent::Consistent, Some(spin)) => self.consistent(&placed, spin),
            (Tangent::Share(share), Some(spin)) => {
                self.stiffness * (1.0 - share) + self.consistent(&placed, spin) * share
            }
            _ => self.stiffness,
        };
        if let Some((_, stiffness)) = &placed.resistance {
            local += stiffness;
        }
        let axes = &placed.frame.axes;
        for i in 0..6 {
            for j in 0..=i {
                let block = local.fixed_view::<3, 3>(3 * i, 3 * j).into_owned();
                let turned = axes * block * axes.transpose();
                local
                    .fixed_view_mut::<3, 3>(3 * i, 3 * j)
                    .copy_from(&turned);
                local
                    .fixed_view_mut::<3, 3>(3 * j, 3 * i)
                    .copy_from(&turned.transpose());
            }
        }
        Some((self.state_of(&placed), local))
    }

    fn consistent(&self, placed: &Placed, spin: &[Matrix3<f64>; 3]) -> Stiffness {
        let mut tangent = self.stiffness;
        for i in 0..3 {
            let h = placed.log_derivatives[i];
            let row = h.transpose() * tangent.fixed_rows::<3>(6 * i + 3);
            tangent.fixed_rows_mut::<3>(6 * i + 3).copy_from(&row);
            let column = tangent.fixed_columns::<3>(6 * i + 3) * h;
            tangent.fixed_columns_mut::<3>(6 * i + 3).copy_from(&column);
        }
        let y = placed.frame.corners.map(|y| y.push(0.0));
        let mut turns = SMatrix::<f64, 18, 3>::zeros();
        for j in 0..3 {
            turns
                .fixed_view_mut::<3, 3>(6 * j, 0)
                .copy_from(&-cross_matrix(&y[j]));
            turns
                .fixed_view_mut::<3, 3>(6 * j + 3, 0)
                .fill_with_identity();
        }
        let of_turns = tangent * turns;
        let among_turns = turns.transpose() * of_turns;
        for k in 0..3 {
            let taken = of_turns * spin[k];
            let mut columns = tangent.fixed_columns_mut::<3>(6 * k);
            columns -= taken;
            let mut rows = tangent.fixed_rows_mut::<3>(6 * k);
            rows -= taken.transpose();
        }
        let n = [0, 1, 2].map(|i| cross_matrix(&part(&placed.forces, 6 * i)));
        let b: Matrix3<f64> = (0..3).map(|j| n[j] * cross_matrix(&y[j])).sum();
        let b = 0.5 * (b + b.transpose());
        for i in 0..3 {
            let moment = placed.log_derivatives[i].transpose() * part(&placed.forces, 6 * i + 3);
            let moment = cross_matrix(&moment);
            for k in 0..3 {
                let block =
                    -n[i] * spin[k] + spin[i].transpose() * (n[k] + (b + among_turns) * spin[k]);
                let mut view = tangent.fixed_view_mut::<3, 3>(6 * i, 6 * k);
                view += block;
                let block = -0.5 * moment * spin[k];
                let mut view = tangent.fixed_view_mut::<3, 3>(6 * i + 3, 6 * k);
                view += block;
                let mut view = tangent.fixed_view_mut::<3, 3>(6 * k, 6 * i + 3);
                view += block.transpose();
            }
        }
        tangent
    }

    fn state_of(&self, placed: &Placed) -> ElementState {
        let elastic = 0.5 * placed.deformation.dot(&placed.forces);
        ElementState {
            energy: elastic + self.collapse.value(&placed.frame.corners),
            gradient: placed.gradient(),
        }
    }

    fn place(&self, x: &[Vec3; 3], turns: &[UnitQuaternion<f64>; 3]) -> Option<Placed> {
        let (frame, deformation) = self.deform(x, turns)?;
        Some(Placed {
            frame,
            spin: frame.spin(self.rule, &self.triangle),
            deformation,
            forces: self.stiffness * deformation,
            log_derivatives: [0, 1, 2].map(|i| log_derivative(&part(&deformation, 6 * i + 3))),
            resistance: self.collapse.derivatives(&frame.corners),
        })
    }

    /// The frame, and the deformation in it.
    fn deform(
        &self,
        x: &[Vec3; 3],
        turns: &[UnitQuaternion<f64>; 3],
    ) -> Option<(Frame, ElementVector)> {
        let rotations: [Matrix3<f64>; 3] =
            [0, 1, 2].map(|i| turns[i].to_rotation_matrix().matrix() * self.axes[i]);
        let edge = Frame::along_edge(x, self.triangle.area)?;
        let frame = match self.rule {
            FrameRule::Polar => edge.polar(&self.triangle),
            FrameRule::Edge => edge,
            FrameRule::Iterated {
                scale,
                iterations,
                tolerance,
            } => {
                let mut frame = edge;
                for _ in 0..iterations {
                    let angle = scale * self.printed_angle(&frame, &rotations);
                    frame = frame.turned(angle);
                    if angle.abs() < tolerance {
                        break;
                    }
                }
                frame
            }
        };
        let mut deformation = ElementVector::zeros();
        for i in 0..3 {
            let displacement = frame.corners[i] - self.triangle.corners[i];
            deformation
                .fixed_rows_mut::<2>(6 * i)
                .copy_from(&displacement);
            let turn = rotation_vector(&(frame.axes.transpose() * rotations[i]));
            deformation.fixed_rows_mut::<3>(6 * i + 3).copy_from(&turn);
        }
        Some((frame, deformation))
    }

    /// The angle by which the printed interpolation is turned at the centroid, with corners' rotations entering by the
    /// printed sign, p × θ.
    fn printed_angle(&self, frame: &Frame, rotations: &[Matrix3<f64>; 3]) -> f64 {
        let mut f = Matrix2::identity();
        for i in 0..3 {
            let (slope, lever) = self.centre[i];
            f += (frame.corners[i] - self.triangle.corners[i]) * slope.transpose();
            let turn = rotation_vector(&(frame.axes.transpose() * rotations[i])).z;
            f -= Matrix2::new(-lever[(1, 0)], -lever[(1, 1)], lever[(0, 0)], lever[(0, 1)]) * turn;
        }
        rotation_angle(&f)
    }
}

impl Placed {
    /// The gradient in the world.
    fn gradient(&self) -> ElementVector {
        let axes = &self.frame.axes;
        let mut gradient = ElementVector::zeros();
        let mut set = |first: usize, v: Vec3| {
            gradient.fixed_rows_mut::<3>(first).copy_from(&(axes * v));
        };
        match &self.spin {
            None => {
                for k in 0..6 {
                    set(3 * k, part(&self.forces, 3 * k));
                }
            }
            Some(spin) => {
                let n = [0, 1, 2].map(|i| part(&self.forces, 6 * i));
                let m = [0, 1, 2]
                    .map(|i| self.log_derivatives[i].transpose() * part(&self.forces, 6 * i + 3));
                let of_frame: Vec3 = (0..3)
                    .map(|i| self.frame.corners[i].push(0.0).cross(&n[i]) + m[i])
                    .sum();
                for i in 0..3 {
                    set(6 * i, n[i] - spin[i].transpose() * of_frame);
                    set(6 * i + 3, m[i]);
                }
            }
        }
        if let Some((resistance, _)) = &self.resistance {
            for k in 0..6 {
                let added = axes * part(resistance, 3 * k);
                let mut rows = gradient.fixed_rows_mut::<3>(3 * k);
                rows += added;
            }
        }
        gradient
    }
}

#[cfg(test)]
mod tests;
