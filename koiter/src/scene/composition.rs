//! What a shell is made of: from a law, numbers and prescribed forms to the section and the rest state of every face.

use std::sync::Arc;

use nalgebra::Vector3;

use super::composition_error::CompositionError;
use super::damping::DampingOptions;
use super::material_models::MaterialModel;
use super::membrane_models::MembraneModel;
use super::model::{BendingModel, Shell};
use crate::Vec3;
use crate::energy::bending::HingeSprings;
use crate::energy::{DiscreteStiffness, StretchLimit};
use crate::material::{
    ByFace, Homogeneous, Layer, Layered, Material, ModuliError, NeoHookean, Orthotropic,
    OrthotropicModuli, Section, StVenantKirchhoff, TensionField,
};
use crate::rest::{RestError, RestFrame};

/// What sets a shell apart from one isotropic St. Venant–Kirchhoff material of one thickness; the default is nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Composition {
    /// How stress follows from strain.
    pub law: MaterialLaw,
    /// The material's axis on every face, a vector in the space of the rest positions that is projected on the face;
    /// one for all faces, or one each. Empty: along x.
    pub axes: Vec<Vec3>,
    /// Values of single faces, in place of those of the shell.
    pub by_face: FaceValues,
    /// Prescribed rest state.
    pub rest: RestPrescription,
    /// A stretch of the midsurface that is never reached, whatever the law.
    pub stretch_limit: Option<StretchLimit>,
    /// How it resists stretching.
    pub membrane: MembraneModel,
    /// Of a membrane of springs: the stiffnesses that are not those of the material.
    pub springs: DiscreteStiffness,
    /// Of bending by hinges (DS(θ), DS(tan)): their weights, and their stiffness if it is not that of the material.
    pub hinges: HingeSprings,
    /// How it damps motion.
    pub damping: DampingOptions,
}

/// How stress follows from strain, with the constants that not all laws have.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum MaterialLaw {
    /// Isotropic, quadratic in the Green strain.
    #[default]
    StVenantKirchhoff,
    /// Isotropic rubber, which resists collapse.
    NeoHookean,
    /// Isotropic without compressive stress: it wrinkles.
    TensionField,
    /// Two moduli along the axes of the material; the shell's Young's modulus is that along the first.
    Orthotropic {
        /// Young's modulus along the second axis [Pa].
        across: f64,
        /// Shear modulus [Pa].
        shear: f64,
    },
    /// Layers, bottom first, with the shell's Poisson's ratio.
    Layered(Vec<Layer>),
}

/// Values of every face; where one is absent, that of the shell holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FaceValues {
    /// Thickness [m].
    pub thickness: Option<Vec<f64>>,
    /// Young's modulus [Pa].
    pub youngs_modulus: Option<Vec<f64>>,
    /// Poisson's ratio.
    pub poissons_ratio: Option<Vec<f64>>,
    /// Density [kg/m³].
    pub density: Option<Vec<f64>>,
    /// Young's modulus along the second axis of an orthotropic material [Pa].
    pub across: Option<Vec<f64>>,
    /// Shear modulus of an orthotropic material [Pa].
    pub shear: Option<Vec<f64>>,
}

impl FaceValues {
    fn named(&self) -> [(&'static str, &Option<Vec<f64>>); 6] {
        [
            ("thickness", &self.thickness),
            ("young", &self.youngs_modulus),
            ("poisson", &self.poissons_ratio),
            ("density", &self.density),
            ("young_across", &self.across),
            ("shear", &self.shear),
        ]
    }

    /// All values, list after list.
    pub(super) fn values(&self) -> impl Iterator<Item = f64> {
        (self.named().into_iter()).flat_map(|(_, list)| list.iter().flatten().copied())
    }
}

/// Rest forms that need not be those of a surface.
///
/// Forms have components `11, 12, 22` in the basis of the edges `x_j − x_i`, `x_k − x_i` of a face. b̄ is positive
/// where normals fan out: +1/R on a cylinder of radius R with outward normals. Masses follow the area of ā.
#[derive(Clone, Debug, PartialEq)]
pub struct RestPrescription {
    /// ā of every face [m²], in place of that of the rest positions.
    pub first: Option<Vec<[f64; 3]>>,
    /// b̄ of every face [m], added to that of the rest shape.
    pub second: Option<Vec<[f64; 3]>>,
    /// Factors on the rest lengths along the material's axis and across it.
    pub stretch: [f64; 2],
    /// Curvatures along the material's axis and across it [1/m], added to those of the rest shape.
    pub curvature: [f64; 2],
}

impl Default for RestPrescription {
    fn default() -> Self {
        Self {
            first: None,
            second: None,
            stretch: [1.0; 2],
            curvature: [0.0; 2],
        }
    }
}

/// What the energies of a shell are built from.
pub(super) struct Composed {
    pub(super) frames: Vec<RestFrame>,
    /// The prescribed part of b̄ in these frames, components `11, 22, 12` [1/m].
    pub(super) rest_forms: Vec<Vector3<f64>>,
    pub(super) section: Arc<dyn Section>,
}

impl Shell {
    /// Whether any rest form is prescribed.
    pub(super) fn has_prescribed_curvature(&self) -> bool {
        let rest = &self.composition.rest;
        let grown = matches!(&self.composition.law, MaterialLaw::Layered(layers)
            if layers.iter().any(|layer| layer.growth != [0.0; 2]));
        grown || rest.second.is_some() || rest.curvature != [0.0; 2]
    }

    /// Thickness of a face [m].
    pub fn face_thickness(&self, face: usize) -> f64 {
        value(&self.composition.by_face.thickness, self.thickness, face)
    }

    /// Mass density of a face [kg/m³].
    pub fn face_density(&self, face: usize) -> f64 {
        value(&self.composition.by_face.density, self.density, face)
    }

    /// Checks the composition against the mesh and works it out.
    ///
    /// # Errors
    /// See [`CompositionError`].
    pub(super) fn compose(&self) -> Result<Composed, CompositionError> {
        self.check_values()?;
        self.check_bending_model()?;
        self.check_membrane()?;
        let layered = match &self.composition.law {
            MaterialLaw::Layered(layers) => Some(
                Layered::new(layers, self.poissons_ratio)
                    .map_err(|error| CompositionError::Moduli { face: 0, error })?,
            ),
            _ => None,
        };
        let num_faces = self.surface.mesh.num_faces();
        let mut frames = Vec::with_capacity(num_faces);
        let mut rest_forms = Vec::with_capacity(num_faces);
        let mut axes = Vec::with_capacity(num_faces);
        for face in 0..num_faces {
            let (frame, form, axis) = self.rest_face(face, layered.as_ref())?;
            frames.push(frame);
            rest_forms.push(form);
            axes.push(axis);
        }
        let section = match layered {
            Some(layered) => Arc::new(layered),
            None => self.section(&axes)?,
        };
        Ok(Composed {
            frames,
            rest_forms,
            section,
        })
    }

    fn check_values(&self) -> Result<(), CompositionError> {
        let faces = self.surface.mesh.num_faces();
        let Composition {
            law,
            axes,
            by_face,
            rest,
            ..
        } = &self.composition;
        let count = |what, found: usize| match found == faces {
            true => Ok(()),
            false => Err(CompositionError::Count { what, found, faces }),
        };
        for (what, values) in by_face.named() {
            let Some(values) = values else { continue };
            if matches!(law, MaterialLaw::Layered(_)) && what != "density" {
                return Err(CompositionError::Layers { what });
            }
            count(what, values.len())?;
            let (sound, expected): (fn(f64) -> bool, _) = match what {
                "poisson" => (
                    |value| -1.0 < value && value <= 0.5,
                    "it must lie above -1 and at most at 0.5",
                ),
                _ => (
                    |value| value > 0.0 && value.is_finite(),
                    "it must be larger than 0",
                ),
            };
            // An orthotropic ratio may be larger; its bounds depend on the moduli.
            let is_bounded_later =
                matches!(law, MaterialLaw::Orthotropic { .. }) && what == "poisson";
            if let Some(face) = values.iter().position(|&v| !sound(v))
                && !is_bounded_later
            {
                let value = values[face];
                return Err(CompositionError::Value {
                    what,
                    face,
                    value,
                    expected,
                });
            }
        }
        if axes.len() > 1 {
            count("axis", axes.len())?;
        }
        for (what, forms) in [("first_form", &rest.first), ("second_form", &rest.second)] {
            let Some(forms) = forms else { continue };
            count(what, forms.len())?;
            if let Some(face) = (forms.iter()).position(|form| !form.iter().all(|x| x.is_finite()))
            {
                return Err(CompositionError::Value {
                    what,
                    face,
                    value: f64::NAN,
                    expected: "its components must be finite",
                });
            }
        }
        Ok(())
    }

    /// Models of hinges have neither axes nor forms.
    fn check_bending_model(&self) -> Result<(), CompositionError> {
        if has_second_form(self.bending) {
            return Ok(());
        }
        let what = if matches!(self.composition.law, MaterialLaw::Orthotropic { .. }) {
            "the axes of an orthotropic material"
        } else if self.has_prescribed_curvature() {
            "a prescribed rest curvature"
        } else {
            return Ok(());
        };
        let model = self.bending.info().name;
        Err(CompositionError::Hinges { model, what })
    }

    /// Springs have neither axes nor a side.
    fn check_membrane(&self) -> Result<(), CompositionError> {
        let model = self.composition.law.model();
        let is_one_sided = matches!(
            model,
            MaterialModel::Orthotropic | MaterialModel::TensionField
        );
        match self.composition.membrane {
            MembraneModel::DiscreteShells if is_one_sided => Err(CompositionError::Springs {
                material: model.info().name,
            }),
            _ => Ok(()),
        }
    }

    /// Frame, prescribed b̄ and the material's axis in the frame.
    fn rest_face(
        &self,
        face: usize,
        layered: Option<&Layered>,
    ) -> Result<(RestFrame, Vector3<f64>, [f64; 2]), CompositionError> {
        let rest = &self.composition.rest;
        let metric = CompositionError::Metric { face };
        let [i, j, k] = self.surface.mesh.faces()[face].map(|v| self.rest_positions[v as usize]);
        let (e1, e2) = (j - i, k - i);
        let of_mesh = [e1.norm_squared(), e1.dot(&e2), e2.norm_squared()];
        let given = rest.first.as_ref().map_or(of_mesh, |forms| forms[face]);
        let frame = RestFrame::from_first_form(given).ok_or(match rest.first {
            Some(_) => metric.clone(),
            None => RestError::DegenerateFace { face }.into(),
        })?;
        let (layer_stretch, layer_curvature) = layered.map_or(([1.0; 2], [0.0; 2]), |layered| {
            (layered.rest_stretch(), layered.rest_curvature())
        });
        let is_directed = rest.stretch != [1.0; 2]
            || rest.curvature != [0.0; 2]
            || layered.is_some()
            || matches!(self.composition.law, MaterialLaw::Orthotropic { .. });
        let second = rest.second.as_ref().map_or([0.0; 3], |forms| forms[face]);
        if !is_directed {
            return Ok((frame, frame.components(second), [1.0, 0.0]));
        }
        let axis = self.axis_in_edges(face, of_mesh, [e1, e2])?;
        let [c, s] = frame.direction(axis);
        // First what is prescribed, then the growth of layers; curvatures are per length of the final form.
        let along_axes = |[p, r]: [f64; 2]| {
            let tensor = Vector3::new(
                p * c * c + r * s * s,
                p * s * s + r * c * c,
                (p - r) * c * s,
            );
            frame.edge_form(tensor)
        };
        let stretch = [0, 1].map(|a| rest.stretch[a] * layer_stretch[a]);
        let grown = match stretch == [1.0; 2] {
            true => frame,
            false => {
                RestFrame::from_first_form(along_axes(stretch.map(|f| f * f))).ok_or(metric)?
            }
        };
        let curvature = [0, 1].map(|a| {
            rest.stretch[a].powi(2) * layer_curvature[a] + stretch[a].powi(2) * rest.curvature[a]
        });
        let added = along_axes(curvature);
        let second = [0, 1, 2].map(|a| second[a] + added[a]);
        Ok((grown, grown.components(second), grown.direction(axis)))
    }

    /// The material's axis in the frame of a face, a unit vector; where the axis stands across the face, the first edge.
    pub(super) fn material_axis(&self, face: usize, frame: &RestFrame) -> [f64; 2] {
        let [i, j, k] = self.surface.mesh.faces()[face].map(|v| self.rest_positions[v as usize]);
        let edges = [j - i, k - i];
        let [e1, e2] = edges;
        let of_mesh = [e1.norm_squared(), e1.dot(&e2), e2.norm_squared()];
        let axis = self.axis_in_edges(face, of_mesh, edges);
        axis.map_or([1.0, 0.0], |axis| frame.direction(axis))
    }

    /// The material's axis, projected on a rest face, in the basis of its edges.
    fn axis_in_edges(
        &self,
        face: usize,
        [e, f, g]: [f64; 3],
        edges: [Vec3; 2],
    ) -> Result<[f64; 2], CompositionError> {
        let axis = match &self.composition.axes[..] {
            [] => Vec3::x(),
            [one] => *one,
            many => many[face],
        };
        let [p, r] = edges.map(|edge| edge.dot(&axis));
        let det = e * g - f * f;
        let coefficients = [(g * p - f * r) / det, (e * r - f * p) / det];
        let projected = edges[0] * coefficients[0] + edges[1] * coefficients[1];
        // Within a twentieth of a degree of the normal, round-off and the mesh would choose the direction.
        match projected.norm() > 1e-3 * axis.norm() {
            true => Ok(coefficients),
            false => Err(CompositionError::Axis { face }),
        }
    }

    /// What a shell of one material through the thickness resists with; `axes` are in the frames.
    fn section(&self, axes: &[[f64; 2]]) -> Result<Arc<dyn Section>, CompositionError> {
        let by_face = &self.composition.by_face;
        let young = |face| value(&by_face.youngs_modulus, self.youngs_modulus, face);
        let poisson = |face| value(&by_face.poissons_ratio, self.poissons_ratio, face);
        match self.composition.law {
            MaterialLaw::NeoHookean => self.homogeneous(|f| NeoHookean::new(young(f), poisson(f))),
            MaterialLaw::TensionField => {
                self.homogeneous(|f| Ok(TensionField::new(young(f), poisson(f))))
            }
            MaterialLaw::Orthotropic { across, shear } => self.homogeneous(|f| {
                let moduli = OrthotropicModuli {
                    along: young(f),
                    across: value(&by_face.across, across, f),
                    poissons_ratio: poisson(f),
                    shear: value(&by_face.shear, shear, f),
                };
                Orthotropic::new(&moduli, axes[f])
            }),
            _ => self.homogeneous(|f| Ok(StVenantKirchhoff::new(young(f), poisson(f)))),
        }
    }

    fn homogeneous<M: Material + PartialEq + Copy + 'static>(
        &self,
        material: impl Fn(usize) -> Result<M, ModuliError>,
    ) -> Result<Arc<dyn Section>, CompositionError> {
        let num_faces = self.surface.mesh.num_faces();
        let materials = (0..num_faces)
            .map(|face| material(face).map_err(|error| CompositionError::Moduli { face, error }))
            .collect::<Result<Vec<M>, _>>()?;
        let thickness = (0..num_faces).map(|f| self.face_thickness(f)).collect();
        // One material is not kept as many: it stays in the cache.
        if let [first, others @ ..] = &materials[..]
            && others.iter().all(|other| other == first)
        {
            let material = *first;
            return Ok(Arc::new(Homogeneous {
                material,
                thickness,
            }));
        }
        Ok(Arc::new(Homogeneous {
            material: ByFace(materials),
            thickness,
        }))
    }
}

impl MaterialLaw {
    /// The law without its constants.
    pub fn model(&self) -> MaterialModel {
        match self {
            Self::StVenantKirchhoff => MaterialModel::StVenantKirchhoff,
            Self::NeoHookean => MaterialModel::NeoHookean,
            Self::TensionField => MaterialModel::TensionField,
            Self::Orthotropic { .. } => MaterialModel::Orthotropic,
            Self::Layered(_) => MaterialModel::Layered,
        }
    }
}

/// Whether a bending model asks the section what a second fundamental form costs (or bends not at all).
fn has_second_form(bending: BendingModel) -> bool {
    match bending {
        BendingModel::Bac
        | BendingModel::Dcs
        | BendingModel::Dso
        | BendingModel::Dkt
        | BendingModel::MeAverage
        | BendingModel::None => true,
        BendingModel::DsTheta
        | BendingModel::DsTan
        | BendingModel::ChEs
        | BendingModel::ChFs
        | BendingModel::QbCr
        | BendingModel::QbPl
        | BendingModel::QbInt
        | BendingModel::Ds2nd => false,
    }
}

fn value(by_face: &Option<Vec<f64>>, of_shell: f64, face: usize) -> f64 {
    by_face.as_ref().map_or(of_shell, |values| values[face])
}
