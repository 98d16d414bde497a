//! Koiter bending with mid-edge directors: DCS, DSO and BAC in one implementation.
//!
//! ```text
//! E = Ā W(κ),    κ = D⁻ᵀ II D⁻¹ − b̄,    II = [[q₀ + q₁, q₀], [q₀, q₀ + q₂]],    q_c = 2 a_c g(ζ_c)
//! ζ_c = θ_c / 2 + ε_c α_c
//! ```
//!
//! Ā rest area [m²], W energy of bending per unit area of the [`Section`] [J/m²], D rest edges ([`RestFrame`]), b̄ rest second
//! fundamental form in the same frame [1/m], a_c altitude over edge c [m], θ_c hinge angle, α_c edge angle, ε_c sign of
//! the edge in the face, g the profile: sin (DCS), identity (DSO), tan (BAC). Boundary edges have θ = 0 and a free α.
//! Reference: "Better Bending" (2026), Eqs. (30), (31), (34), (48); `2 a = 4 A / ℓ` there.
//!
//! The unknowns are the corners, the opposite vertices of the three neighbours, and the three edge angles. The Hessian
//! is `Jᵀ Q J + Σ σ_c ∇²q_c` with J = ∂q, Q the section's tangent and σ_c = ∂E/∂q_c; with the functionals of the two
//! wings of an edge (own: N T M Ψ K, neighbour's: primed)
//!
//! ```text
//! q'' / 2a = g (N² + M² − (M + K)²) + g' T (2 ε α − N') + g'' ζ'² + g' (Ψ (M + K/2) + N' T' + Ψ' (M' + K'/2))
//! ```
//!
//! where each term has a closed positive part ([`super::quadratic_form`]).

use std::marker::PhantomData;

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use super::bending_stencil::BendingStencil;
use super::held_mid_edge::{HeldEdge, HeldMidEdge};
use super::hinge::turning_angle;
use super::profile::AngleProfile;
use super::quadratic_form::{Functional, QuadraticForm, WIDTH, WingFunctionals, dot, scaled_sum};
use crate::Vec3;
use crate::assembly::{Assembled, Dof, DofLayout, Energy, LocalEnergy, LocalHessian, parallel_map};
use crate::geometry::over_numbers::{cross, norm, point, sub};
use crate::geometry::{Real, Wing, hinge_angle};
use crate::material::Section;
use crate::rest::RestFrame;

/// Place of the edge angle among the unknowns of a hinge.
const ANGLE: usize = 12;

/// One edge of a face with what its curvature needs.
struct Corner {
    wing: Wing,
    neighbor: Option<Wing>,
    profile: [f64; 3],
    sign: f64,
}

impl Corner {
    /// q_c.
    fn curvature(&self) -> f64 {
        2.0 * self.wing.height * self.profile[0]
    }

    /// ζ' and the functionals of both wings.
    fn tilt_change(&self, own: &Functional, other: Option<&Functional>) -> Functional {
        let mut out = [0.0; WIDTH];
        if let Some(other) = other {
            out = std::array::from_fn(|i| -0.5 * (own[i] + other[i]));
        }
        out[ANGLE] = self.sign;
        out
    }
}

/// Koiter bending energy of one shell with profile `P`.
pub struct MidEdgeBending<P, S> {
    stencils: Vec<BendingStencil>,
    frames: Vec<RestFrame>,
    rest_forms: Vec<Vector3<f64>>,
    section: S,
    /// Edges across which the neighbour has gone; empty: none.
    cuts: Vec<[bool; 3]>,
    profile: PhantomData<P>,
}

impl<P: AngleProfile, S: Section> MidEdgeBending<P, S> {
    /// `rest_forms` are b̄ in the frames of the faces, components `11, 22, 12` [1/m].
    pub fn new(
        stencils: Vec<BendingStencil>,
        frames: Vec<RestFrame>,
        rest_forms: Vec<Vector3<f64>>,
        section: S,
    ) -> Self {
        Self {
            stencils,
            frames,
            rest_forms,
            section,
            cuts: Vec::new(),
            profile: PhantomData,
        }
    }

    /// Replaces b̄ of every face.
    pub fn set_rest_forms(&mut self, rest_forms: Vec<Vector3<f64>>) {
        self.rest_forms = rest_forms;
    }

    /// The second fundamental form in the rest frame, components `11, 22, 12` [1/m].
    pub fn second_form(&self, stencil: usize, q: &SVector<f64, 21>) -> Vector3<f64> {
        let curvatures = self.corners(stencil, q).map(|c| c.curvature());
        self.form_matrix(stencil) * Vector3::from(curvatures)
    }

    /// The tilts of the three directors.
    pub fn tilts(&self, stencil: usize, q: &SVector<f64, 21>) -> [f64; 3] {
        std::array::from_fn(|c| self.tilt(stencil, c, q).0)
    }

    /// Sum over the two faces of an edge of Ā |∂d/∂ζ|² / 3: times ρ h³/12 the inertia of the edge angle (Eq. 52).
    pub fn director_inertia(&self, stencil: usize, q: &SVector<f64, 21>) -> [f64; 3] {
        self.tilts(stencil, q)
            .map(|tilt| self.frames[stencil].area / 3.0 * P::director_stretch_squared(tilt))
    }

    fn form_matrix(&self, stencil: usize) -> Matrix3<f64> {
        let rows = self.frames[stencil].second_form_matrix();
        Matrix3::from_fn(|i, j| rows[i][j])
    }

    fn tilt(&self, stencil: usize, c: usize, q: &SVector<f64, 21>) -> (f64, Wing, Option<Wing>) {
        let point = |i: usize| Vec3::new(q[3 * i], q[3 * i + 1], q[3 * i + 2]);
        let (a, b) = (point((c + 1) % 3), point((c + 2) % 3));
        let wing = Wing::new(&a, &b, &point(c));
        let is_cut = self.cuts.get(stencil).is_some_and(|edges| edges[c]);
        let stencil = &self.stencils[stencil];
        let across = stencil.across[c].filter(|_| !is_cut);
        let neighbor = across.map(|_| Wing::new(&b, &a, &point(3 + c)));
        let theta = neighbor
            .as_ref()
            .map_or(0.0, |other| hinge_angle(&wing, other));
        (0.5 * theta + stencil.signs[c] * q[18 + c], wing, neighbor)
    }

    fn corners(&self, stencil: usize, q: &SVector<f64, 21>) -> [Corner; 3] {
        std::array::from_fn(|c| {
            let (tilt, wing, neighbor) = self.tilt(stencil, c, q);
            Corner {
                wing,
                neighbor,
                profile: P::eval(tilt),
                sign: self.stencils[stencil].signs[c],
            }
        })
    }

    /// The angles of a face.
    pub(super) fn angles(&self, stencil: usize) -> [Dof; 3] {
        self.stencils[stencil].angles
    }

    /// Energy, ∂E/∂q and ∂²E/∂q² at the curvatures q.
    pub(super) fn response(
        &self,
        stencil: usize,
        curvatures: &Vector3<f64>,
    ) -> (f64, Vector3<f64>, Matrix3<f64>) {
        let form = self.form_matrix(stencil);
        let change = form * curvatures - self.rest_forms[stencil];
        let response = (self.section.bend(stencil, &change)).scaled(self.frames[stencil].area);
        let transposed = form.transpose();
        (
            response.density,
            transposed * response.stress,
            transposed * response.tangent * form,
        )
    }

    fn derivatives(&self, stencil: usize, q: &SVector<f64, 21>, kept: f64) -> LocalHessian<21> {
        let corners = self.corners(stencil, q);
        let (value, moments, tangent) = self.response(stencil, &curvatures_of(&corners));
        let mut hessian = SMatrix::<f64, 21, 21>::zeros();
        let mut jacobian = [[0.0; 21]; 3];
        for (c, corner) in corners.iter().enumerate() {
            let places = places(c);
            let (slope, form) = corner_form(corner, moments[c], kept);
            let used = if corner.neighbor.is_some() {
                0..ANGLE + 1
            } else {
                0..9
            };
            let scatter = |i: usize, j: usize, hessian: &mut SMatrix<f64, 21, 21>| {
                hessian[(places[i], places[j])] += form.rows[j][i];
            };
            for j in used.clone() {
                jacobian[c][places[j]] = slope[j];
                for i in used.clone() {
                    scatter(i, j, &mut hessian);
                }
            }
            if corner.neighbor.is_none() {
                jacobian[c][places[ANGLE]] = slope[ANGLE];
                scatter(ANGLE, ANGLE, &mut hessian);
                for i in used {
                    scatter(i, ANGLE, &mut hessian);
                    scatter(ANGLE, i, &mut hessian);
                }
            }
        }
        let mut gradient = SVector::<f64, 21>::zeros();
        for (c, row) in jacobian.iter().enumerate() {
            let image: [f64; 21] =
                std::array::from_fn(|i| (0..3).map(|d| tangent[(c, d)] * jacobian[d][i]).sum());
            for j in 0..21 {
                gradient[j] += moments[c] * row[j];
                let mut column = hessian.column_mut(j);
                for (entry, value) in column.iter_mut().zip(&image) {
                    *entry += value * row[j];
                }
            }
        }
        LocalHessian {
            value,
            gradient,
            hessian,
        }
    }

    /// E of one face over any numbers, whose section has the density `density(κ)` [J/m²]: the oracle of the tests.
    pub fn formula<R: Real>(
        &self,
        stencil: usize,
        q: &[R; 21],
        density: impl Fn([R; 3]) -> R,
    ) -> R {
        let face = &self.stencils[stencil];
        let curvature: [R; 3] = std::array::from_fn(|c| {
            let [a, b, apex, across] = [(c + 1) % 3, (c + 2) % 3, c, 3 + c].map(|i| point(q, i));
            let e = sub(&b, &a);
            let twice_area = norm(&cross(&e, &sub(&apex, &a)));
            let theta = match face.across[c] {
                Some(_) => turning_angle(&[a, b, apex, across]),
                None => R::from(0.0),
            };
            let tilt = theta * 0.5 + q[18 + c] * face.signs[c];
            twice_area / norm(&e) * P::formula(tilt) * 2.0
        });
        let rows = self.frames[stencil].second_form_matrix();
        let strain: [R; 3] = std::array::from_fn(|s| {
            curvature[0] * rows[s][0] + curvature[1] * rows[s][1] + curvature[2] * rows[s][2]
                - self.rest_forms[stencil][s]
        });
        density(strain) * self.frames[stencil].area
    }

    /// What the positions in `q` contribute to the curvatures of a face.
    pub(super) fn held_edges(&self, stencil: usize, mut q: SVector<f64, 21>) -> [HeldEdge; 3] {
        q.fixed_rows_mut::<3>(18).fill(0.0);
        std::array::from_fn(|c| {
            let (half_turn, wing, _) = self.tilt(stencil, c, &q);
            HeldEdge {
                twice_height: 2.0 * wing.height,
                half_turn,
                sign: self.stencils[stencil].signs[c],
            }
        })
    }
}

fn curvatures_of(corners: &[Corner; 3]) -> Vector3<f64> {
    Vector3::from_fn(|c, _| corners[c].curvature())
}

/// Where the unknowns of the hinge at corner `c` stand among those of the face.
fn places(c: usize) -> [usize; 13] {
    let nodes = [(c + 1) % 3, (c + 2) % 3, c, 3 + c];
    std::array::from_fn(|i| {
        if i == ANGLE {
            18 + c
        } else {
            3 * nodes[i / 3] + i % 3
        }
    })
}

/// ∂q_c and `moment` · ∂²q_c over the unknowns of the hinge.
fn corner_form(corner: &Corner, moment: f64, kept: f64) -> (Functional, QuadraticForm) {
    let [g, g1, g2] = corner.profile;
    let twice_height = 2.0 * corner.wing.height;
    let own = WingFunctionals::new(&corner.wing, [0, 1, 2]);
    let other = corner
        .neighbor
        .as_ref()
        .map(|wing| WingFunctionals::new(wing, [1, 0, 3]));
    let tilt_change = corner.tilt_change(&own.turning, other.as_ref().map(|w| &w.turning));
    let slope =
        std::array::from_fn(|i| twice_height * (g * own.stretching[i] + g1 * tilt_change[i]));
    let mut form = QuadraticForm::zero(kept);
    let k = moment * twice_height;
    own.add_altitude(k * g, &mut form);
    form.add_square(k * g2, &tilt_change);
    let mut partner = [0.0; WIDTH];
    partner[ANGLE] = 2.0 * corner.sign;
    if let Some(other) = &other {
        partner = scaled_sum(&partner, &other.turning, -1.0);
        if kept < 1.0 {
            // In a fold the neighbour's normal leaves that of the face, so N' and T are not orthogonal, as the closed
            // positive part of a product needs: split off the square of T.
            let along = dot(&partner, &own.stretching) / dot(&own.stretching, &own.stretching);
            form.add_square(k * g1 * along, &own.stretching);
            partner = scaled_sum(&partner, &own.stretching, -along);
        }
        form.add_product(
            k * g1,
            &own.tilting,
            &scaled_sum(&own.sliding, &own.swinging, 0.5),
        );
        other.add_angle(0.5 * k * g1, &mut form);
    }
    form.add_product(k * g1, &own.stretching, &partner);
    (slope, form)
}

impl<P: AngleProfile, S: Section> LocalEnergy<21, 9> for MidEdgeBending<P, S> {
    const NODE_SIZES: [usize; 9] = [3, 3, 3, 3, 3, 3, 1, 1, 1];
    const MEASURES: usize = 3;

    fn name(&self) -> &'static str {
        "bending"
    }

    fn num_stencils(&self) -> usize {
        self.stencils.len()
    }

    fn nodes(&self, stencil: usize) -> [Option<Dof>; 9] {
        let s = &self.stencils[stencil];
        let [a, b, c] = s.corners.map(Some);
        let [d, e, f] = s.across;
        let [g, h, i] = s.angles.map(Some);
        [a, b, c, d, e, f, g, h, i]
    }

    fn value(&self, stencil: usize, q: &SVector<f64, 21>) -> f64 {
        let corners = self.corners(stencil, q);
        self.response(stencil, &curvatures_of(&corners)).0
    }

    fn gradient(&self, stencil: usize, q: &SVector<f64, 21>) -> (f64, SVector<f64, 21>) {
        let corners = self.corners(stencil, q);
        let (value, moments, _) = self.response(stencil, &curvatures_of(&corners));
        let mut gradient = SVector::<f64, 21>::zeros();
        for (c, corner) in corners.iter().enumerate() {
            let [g, g1, _] = corner.profile;
            let scale = 2.0 * corner.wing.height * moments[c];
            let nodes = [(c + 1) % 3, (c + 2) % 3, c, 3 + c];
            let mut add = |node: usize, v: &Vec3, factor: f64| {
                let mut part = gradient.fixed_rows_mut::<3>(3 * node);
                part += v * factor;
            };
            for (i, v) in corner.wing.stretching().iter().enumerate() {
                add(nodes[i], v, scale * g);
            }
            if let Some(neighbor) = &corner.neighbor {
                for (i, v) in corner.wing.turning().iter().enumerate() {
                    add(nodes[i], v, -0.5 * scale * g1);
                }
                for (v, i) in neighbor.turning().iter().zip([1, 0, 3]) {
                    add(nodes[i], v, -0.5 * scale * g1);
                }
            }
            gradient[18 + c] += scale * g1 * corner.sign;
        }
        (value, gradient)
    }

    fn hessian(&self, stencil: usize, q: &SVector<f64, 21>) -> LocalHessian<21> {
        self.derivatives(stencil, q, 1.0)
    }

    fn projected_hessian(
        &self,
        stencil: usize,
        q: &SVector<f64, 21>,
        kept: f64,
    ) -> LocalHessian<21> {
        self.derivatives(stencil, q, kept)
    }

    fn is_admissible(&self, stencil: usize, q: &SVector<f64, 21>) -> bool {
        P::MAX_TILT.is_infinite()
            || self
                .tilts(stencil, q)
                .iter()
                .all(|tilt| tilt.abs() < P::MAX_TILT)
    }

    fn measure(&self, stencil: usize, q: &SVector<f64, 21>, measures: &mut [f64]) {
        measures.copy_from_slice(self.second_form(stencil, q).as_slice());
    }

    fn rest(&self, stencil: usize, measures: &mut [f64]) {
        measures.copy_from_slice(self.rest_forms[stencil].as_slice());
    }

    fn set_rest(&mut self, stencil: usize, measures: &[f64]) {
        self.rest_forms[stencil] = Vector3::from_column_slice(measures);
    }

    fn set_cut(&mut self, stencil: usize, edges: [bool; 3]) {
        self.cuts.resize(self.stencils.len(), [false; 3]);
        self.cuts[stencil] = edges;
    }

    fn describe(&self, stencil: usize) -> String {
        format!("face {stencil}")
    }

    fn at_held_positions<'a>(
        &'a self,
        unknowns: &(dyn Fn(usize) -> SVector<f64, 21> + Sync),
        layout: &DofLayout,
    ) -> Option<Box<dyn Energy + 'a>> {
        let edges = parallel_map(self.stencils.len(), |stencil| {
            self.held_edges(stencil, unknowns(stencil))
        });
        Some(Box::new(Assembled::new(
            HeldMidEdge::new(self, edges),
            layout,
        )))
    }
}
