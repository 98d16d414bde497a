//! From the expressions of a model to energies of their shells.

use std::sync::Arc;

use super::assemble::BuildError;
use super::elastic::rest_surface;
use super::model::{Model, Schedule, Shell};
use crate::Vec3;
use crate::assembly::{Assembled, Differentiated, Dof, DofLayout, Energy, LocalEnergy};
use crate::energy::edge_rest_lengths;
use crate::energy::expression::{
    EdgeElement, Edges, ElementKind, Elements, ExpressionError, FaceElement, Faces, HingeElement,
    Hinges, Names, Parameter, Potential, PotentialDamping, Program, RateEnergy, RatePotential,
    Settings, VertexElement, Vertices, WholeDamping, WholePotential,
};
use crate::geometry::{Wing, hinge_angle};
use crate::integrate::{Damper, ShellPart};
use crate::mesh::{EdgeId, VertexId};

/// An energy, or a force by a dissipation function, as a text.
#[derive(Clone, Debug)]
pub struct TextEnergy {
    /// Name, unique in the scene and none of the built-in ones.
    pub name: String,
    /// Index of the shell.
    pub shell: usize,
    /// Over what it is summed.
    pub on: ElementKind,
    /// What its value is.
    pub value: TextValue,
    /// See [`crate::energy::expression`].
    pub text: String,
    /// Parameters by name.
    pub parameters: Vec<(String, Schedule<f64>)>,
    /// Only elements whose vertices are all among these (of hinges: the ends of their edge); `None`: all.
    pub vertices: Option<Vec<VertexId>>,
}

/// What the value of an expression is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TextValue {
    /// A dissipation function [W], whose force is minus its derivative by velocity; else an energy [J].
    pub is_dissipation: bool,
    /// By rest area or rest length; else of an element.
    pub is_density: bool,
}

impl TextEnergy {
    /// The program, by which it can be seen whether it reads.
    ///
    /// # Errors
    /// A mistake in the text.
    pub fn parse(&self) -> Result<Program, ExpressionError> {
        let quantities = match self.value.is_dissipation {
            true => self.on.rate_names(),
            false => self.on.names().to_vec(),
        };
        let parameters: Vec<String> =
            (self.parameters.iter().map(|(name, _)| name.clone())).collect();
        let names = Names {
            quantities: &quantities,
            parameters: &parameters,
        };
        names.parse(&self.text)
    }

    fn settings(&self) -> Settings {
        let parameters = self.parameters.iter().map(|(_, schedule)| {
            let schedule = schedule.clone();
            Arc::new(move |time| schedule.at(time)) as Parameter
        });
        Settings::new(parameters.collect())
    }
}

/// What the expressions of a model become.
#[derive(Default)]
pub(super) struct Expressions {
    pub(super) potentials: Vec<Box<dyn Energy>>,
    pub(super) rates: Vec<Box<dyn RateEnergy>>,
    /// Damping of the potentials by stiffness.
    pub(super) dampers: Vec<Damper>,
}

/// The energies of all expressions of a model, which must be defined at `q`.
pub(super) fn expressions(
    model: &Model,
    parts: &[ShellPart],
    masses: &[f64],
    layout: &DofLayout,
    q: &[f64],
) -> Result<Expressions, BuildError> {
    let mut made = Expressions::default();
    for energy in &model.energies {
        let program = energy.parse().map_err(|error| BuildError::Expression {
            energy: energy.name.clone(),
            error,
        })?;
        let source = Source {
            energy,
            program,
            layout,
            q,
            damping: model.shells[energy.shell].composition.damping.stiffness,
        };
        let (shell, part) = (&model.shells[energy.shell], &parts[energy.shell]);
        let chosen = Chosen::new(energy, part);
        match energy.on {
            ElementKind::Vertex => {
                source.add(chosen.vertices(shell, part, masses), &mut made)?;
            }
            ElementKind::Edge => source.add(chosen.edges(shell, part), &mut made)?,
            ElementKind::Hinge => source.add(chosen.hinges(shell, part), &mut made)?,
            ElementKind::Face => source.add(chosen.faces(shell, part), &mut made)?,
            ElementKind::Shell => source.add_whole(shell, part, &mut made)?,
        }
    }
    Ok(made)
}

struct Source<'a> {
    energy: &'a TextEnergy,
    program: Program,
    layout: &'a DofLayout,
    q: &'a [f64],
    /// Of the shell, by stiffness [s].
    damping: f64,
}

impl Source<'_> {
    fn add<const N: usize, const K: usize, E: Elements<N, K> + 'static>(
        self,
        elements: E,
        made: &mut Expressions,
    ) -> Result<(), BuildError> {
        let TextEnergy { name, value, .. } = self.energy;
        if elements.count() == 0 {
            return Err(BuildError::NoElements {
                energy: name.clone(),
                elements: self.energy.on.plural(),
            });
        }
        let (settings, is_density) = (self.energy.settings(), value.is_density);
        let (program, layout) = (self.program.clone(), self.layout);
        if value.is_dissipation {
            let local = RatePotential::new(name.clone(), elements, program, settings, is_density);
            let mut energy = Assembled::new(local, layout);
            energy.begin(self.q, self.q, 1.0);
            self.check(&energy)?;
            energy.rest();
            made.rates.push(Box::new(energy));
        } else {
            let local = Potential::new(name.clone(), elements, program, settings, is_density);
            let energy = Assembled::new(Differentiated(local), layout);
            self.check(&energy)?;
            if self.damping > 0.0 {
                let damping = PotentialDamping::new(energy.local().0.clone());
                let damping = Box::new(Assembled::new(Differentiated(damping), layout));
                made.dampers.push(Damper::new(damping, self.damping, None));
            }
            made.potentials.push(Box::new(energy));
        }
        Ok(())
    }

    /// Refuses an energy that is not defined at the start, or has no derivatives there.
    fn check<const N: usize, const K: usize, L: LocalEnergy<N, K>>(
        &self,
        energy: &Assembled<L, N, K>,
    ) -> Result<(), BuildError> {
        let is_undefined = |stencil: &usize| {
            let local = (energy.local()).hessian(*stencil, &energy.gather(*stencil, self.q));
            let derivatives = local.gradient.iter().chain(local.hessian.iter());
            !local.value.is_finite() || derivatives.into_iter().any(|entry| !entry.is_finite())
        };
        match (0..energy.local().num_stencils()).find(is_undefined) {
            None => Ok(()),
            Some(stencil) => Err(self.undefined(energy.local().describe(stencil))),
        }
    }

    fn undefined(&self, element: String) -> BuildError {
        BuildError::UndefinedEnergy {
            energy: self.energy.name.clone(),
            element,
        }
    }

    fn add_whole(
        self,
        shell: &Shell,
        part: &ShellPart,
        made: &mut Expressions,
    ) -> Result<(), BuildError> {
        let name = self.energy.name.clone();
        let speaks_of_volume = self.program.used()[..2].contains(&true);
        if speaks_of_volume && !part.mesh.boundary_loops().is_empty() {
            return Err(BuildError::OpenShell {
                energy: name,
                shell: shell.name.clone(),
            });
        }
        let vertex = |v: u32| Dof(part.first_vertex.0 + 3 * v);
        let faces: Vec<[Dof; 3]> = part.mesh.faces().iter().map(|f| f.map(vertex)).collect();
        let rest = rest_surface(shell);
        let corners: Vec<[Vec3; 3]> = (0..faces.len()).map(|face| rest.corners(face)).collect();
        let (program, settings) = (self.program.clone(), self.energy.settings());
        let energy = WholePotential::new(name, &faces, self.layout, &corners, program, settings);
        if !energy.is_defined(self.q) {
            return Err(self.undefined("the whole shell".into()));
        }
        if self.damping > 0.0 {
            let damping = Box::new(WholeDamping::new(energy.clone()));
            made.dampers.push(Damper::new(damping, self.damping, None));
        }
        made.potentials.push(Box::new(energy));
        Ok(())
    }
}

/// Which vertices of a shell are meant.
struct Chosen(Vec<bool>);

impl Chosen {
    fn new(energy: &TextEnergy, part: &ShellPart) -> Self {
        let Some(vertices) = &energy.vertices else {
            return Self(vec![true; part.mesh.num_vertices()]);
        };
        let mut chosen = vec![false; part.mesh.num_vertices()];
        for VertexId(vertex) in vertices {
            chosen[*vertex as usize] = true;
        }
        Self(chosen)
    }

    fn all(&self, vertices: &[u32]) -> bool {
        vertices.iter().all(|&vertex| self.0[vertex as usize])
    }

    fn vertices(&self, shell: &Shell, part: &ShellPart, masses: &[f64]) -> Vertices {
        let mut areas = vec![0.0; part.mesh.num_vertices()];
        for (frame, face) in part.frames.iter().zip(part.mesh.faces()) {
            for &vertex in face {
                areas[vertex as usize] += frame.area / 3.0;
            }
        }
        let vertices = (0..areas.len() as u32).filter(|&vertex| self.all(&[vertex]));
        let element = |vertex: u32| {
            let dof = part.first_vertex.0 + 3 * vertex;
            VertexElement {
                dof: Dof(dof),
                vertex,
                rest: shell.rest_positions[vertex as usize],
                area: areas[vertex as usize],
                mass: masses[dof as usize],
            }
        };
        Vertices(vertices.map(element).collect())
    }

    fn edges(&self, shell: &Shell, part: &ShellPart) -> Edges {
        let lengths = edge_rest_lengths(&part.mesh, &part.frames);
        let edges = (0..lengths.len()).filter(|&edge| self.all(&part.mesh.edges()[edge]));
        Edges(
            edges
                .map(|edge| edge_element(shell, part, edge, lengths[edge]))
                .collect(),
        )
    }

    fn hinges(&self, shell: &Shell, part: &ShellPart) -> Hinges {
        let lengths = edge_rest_lengths(&part.mesh, &part.frames);
        let mut hinges = Vec::new();
        for (index, faces) in part.mesh.edge_faces().iter().enumerate() {
            let [Some(first), Some(second)] = *faces else {
                continue;
            };
            let ends = part.mesh.edges()[index];
            let apexes = [0, 1].map(|side| part.mesh.opposite_vertex(EdgeId(index as u32), side));
            let ([Some(a), Some(b)], true) = (apexes, self.all(&ends)) else {
                continue;
            };
            let length = lengths[index];
            let areas = [first, second].map(|face| part.frames[face.0 as usize].area);
            let vertex = |v: u32| Dof(part.first_vertex.0 + 3 * v);
            hinges.push(HingeElement {
                edge: edge_element(shell, part, index, length),
                apexes: [vertex(a.0), vertex(b.0)],
                angle: rest_angle(shell, [ends[0], ends[1], a.0, b.0]),
                height: (areas[0] + areas[1]) / (3.0 * length),
            });
        }
        Hinges(hinges)
    }

    fn faces(&self, shell: &Shell, part: &ShellPart) -> Faces {
        let mut elements = Vec::new();
        for (face, corners) in part.mesh.faces().iter().enumerate() {
            if !self.all(corners) {
                continue;
            }
            let frame = part.frames[face];
            let rest = corners.map(|v| shell.rest_positions[v as usize]);
            elements.push(FaceElement {
                corners: corners.map(|v| Dof(part.first_vertex.0 + 3 * v)),
                face: face as u32,
                rest: (rest[0] + rest[1] + rest[2]) / 3.0,
                frame,
                axis: shell.material_axis(face, &frame),
                thickness: shell.face_thickness(face),
            });
        }
        Faces(elements)
    }
}

fn edge_element(shell: &Shell, part: &ShellPart, edge: usize, length: f64) -> EdgeElement {
    let vertices = part.mesh.edges()[edge];
    let [u, v] = vertices.map(|v| shell.rest_positions[v as usize]);
    EdgeElement {
        ends: vertices.map(|v| Dof(part.first_vertex.0 + 3 * v)),
        vertices,
        rest: (u + v) * 0.5,
        length,
    }
}

/// The rest angle of a hinge: that of the rest shape, unless the shell is flat at rest.
fn rest_angle(shell: &Shell, vertices: [u32; 4]) -> f64 {
    if !shell.rest_curved {
        return 0.0;
    }
    let [a, b, c, d] = vertices.map(|v| shell.rest_positions[v as usize]);
    hinge_angle(&Wing::new(&a, &b, &c), &Wing::new(&b, &a, &d))
}
