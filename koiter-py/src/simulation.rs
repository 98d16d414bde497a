//! Scenes that run.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

use koiter::integrate::StepReport;
use koiter::io::read;
use koiter::io::record::Recorder;
use koiter::io::result::FolderLock;
use koiter::mesh::SurfaceOptions;
use koiter::scene::{Probe, Scene, SceneFile, Warning};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{from_faces, from_points, to_faces, to_points};
use crate::error::{of_input, of_run, of_scene};
use crate::memory_meshes::MemoryMeshes;
use crate::report::Step;

/// Vertices and faces as NumPy has them.
type MeshArrays<'py> = (PyReadonlyArray2<'py, f64>, PyReadonlyArray2<'py, i64>);
type NewMesh<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<i64>>);

/// A running scene: made from the text of a scene file; `koiter.Scene` writes that text.
#[pyclass(subclass, module = "koiter")]
pub(crate) struct Simulation {
    inner: koiter::scene::Simulation,
    scene: Scene,
    /// The scene as it runs, overrides included.
    scene_text: String,
    /// Where a run is being written.
    recorder: Option<Recorder>,
}

/// The scene, and its text with the overrides.
fn build(
    text: &str,
    name: &str,
    overrides: &[String],
    meshes: &MemoryMeshes,
) -> PyResult<(Scene, String)> {
    let file = SceneFile::parse(name, text, overrides).map_err(|error| of_scene(&error))?;
    let scene = Scene::build(&file, meshes).map_err(|error| of_scene(&error))?;
    Ok((scene, file.document.to_toml()))
}

impl Simulation {
    fn shell(&self, name: &str) -> PyResult<usize> {
        let shells = &self.scene.model.shells;
        shells.iter().position(|s| s.name == name).ok_or_else(|| {
            let names: Vec<&str> = shells.iter().map(|s| s.name.as_str()).collect();
            of_input(format!(
                "there is no shell '{name}'; there are: {}",
                names.join(", ")
            ))
        })
    }
}

fn not_recording() -> PyErr {
    of_input("this simulation is not being written; begin_recording comes first")
}

fn warning_text(warning: &Warning) -> String {
    match &warning.help {
        Some(help) => format!("{} (at {}); {help}", warning.message, warning.path),
        None => format!("{} (at {})", warning.message, warning.path),
    }
}

#[pymethods]
impl Simulation {
    /// From the text of a scene; `meshes` has arrays by the names that stand for them, `folder` is where files are.
    #[new]
    #[pyo3(signature = (text, *, name="<scene>", overrides=Vec::new(), meshes=HashMap::new(), folder=PathBuf::new()))]
    fn new(
        py: Python<'_>,
        text: &str,
        name: &str,
        overrides: Vec<String>,
        meshes: HashMap<String, MeshArrays<'_>>,
        folder: PathBuf,
    ) -> PyResult<Self> {
        let arrays = (meshes.iter())
            .map(|(name, (vertices, faces))| {
                let mesh = (to_points(vertices, "vertices")?, to_faces(faces)?);
                Ok((name.clone(), mesh))
            })
            .collect::<PyResult<_>>()?;
        let meshes = MemoryMeshes { arrays, folder };
        py.detach(|| {
            let (scene, scene_text) = build(text, name, &overrides, &meshes)?;
            let inner = koiter::scene::Simulation::new(scene.model.clone()).map_err(of_input)?;
            Ok(Self {
                inner,
                scene,
                scene_text,
                recorder: None,
            })
        })
    }

    /// Takes a step of `dt` [s]; without it, of the scene's own length.
    #[pyo3(signature = (dt=None))]
    fn step(&mut self, py: Python<'_>, dt: Option<f64>) -> PyResult<Step> {
        let (next, timeline) = (self.inner.step_count() + 1, &self.scene.timeline);
        let length = dt.unwrap_or_else(|| timeline.dt(next));
        if !(length.is_finite() && length > 0.0) {
            return Err(of_input(format!(
                "dt must be larger than 0 s, but it is {length}"
            )));
        }
        let start = Instant::now();
        // Other threads of Python go on meanwhile; Ctrl-C is seen when the step is over.
        let report = py.detach(|| self.inner.step(length)).map_err(|error| {
            if let Some(recorder) = &mut self.recorder {
                recorder.note_error(&error);
            }
            of_run(error)
        })?;
        let report = StepReport {
            // A sum of steps rounds otherwise than the time that the scene means.
            time: dt.map_or_else(|| timeline.time(next), |_| report.time),
            ..report
        };
        let step = Step::new(report, start.elapsed());
        py.check_signals()?;
        Ok(step)
    }

    /// Whether there is nothing left to do before the last step: the end of a path of equilibria.
    #[getter]
    fn has_ended(&self) -> bool {
        self.inner.has_ended()
    }

    /// Begins to write a result folder, for a run of so many steps in all.
    fn begin_recording(&mut self, folder: PathBuf, num_steps: usize) -> PyResult<()> {
        if self.recorder.is_some() {
            return Err(of_input("this simulation is being written already"));
        }
        let (scene, text, simulation) = (&self.scene, &self.scene_text, &self.inner);
        let begun = FolderLock::create(&folder)
            .and_then(|lock| Recorder::create(lock, scene, text, simulation, num_steps));
        self.recorder = Some(begun.map_err(of_input)?);
        Ok(())
    }

    /// Writes a step that was just taken; the last with its frame and a checkpoint.
    fn record(&mut self, step: &Step, is_last: bool) -> PyResult<()> {
        let recorder = self.recorder.as_mut().ok_or_else(not_recording)?;
        (recorder.record(&self.inner, &step.report, is_last)).map_err(of_run)
    }

    /// Writes the summary and ends writing; `interrupted`: steps were left out.
    fn end_recording(&mut self, interrupted: bool) -> PyResult<()> {
        let mut recorder = self.recorder.take().ok_or_else(not_recording)?;
        if interrupted {
            recorder.stop(&self.inner).map_err(of_run)?;
        }
        recorder.write_summary(None).map_err(of_run)
    }

    /// Time [s].
    #[getter]
    fn time(&self) -> f64 {
        self.inner.time()
    }

    /// Steps taken.
    #[getter]
    fn step_count(&self) -> usize {
        self.inner.step_count()
    }

    /// Steps that the scene asks for.
    #[getter]
    fn num_steps(&self) -> usize {
        self.scene.timeline.num_steps()
    }

    /// The scene as it runs, overrides included, as a scene file.
    #[getter]
    fn scene_text(&self) -> &str {
        &self.scene_text
    }

    /// Names of the shells.
    #[getter]
    fn shells(&self) -> Vec<&str> {
        let shells = &self.scene.model.shells;
        shells.iter().map(|shell| shell.name.as_str()).collect()
    }

    /// What is implausible in the scene.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.scene.warnings.iter().map(warning_text).collect()
    }

    /// Positions of a shell's vertices [m], of shape (n, 3).
    fn positions<'py>(&self, py: Python<'py>, shell: &str) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let positions = self.inner.shell_positions(self.shell(shell)?);
        Ok(from_points(py, &positions))
    }

    /// Velocities of a shell's vertices [m/s], of shape (n, 3).
    fn velocities<'py>(&self, py: Python<'py>, shell: &str) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let velocities = self.inner.shell_velocities(self.shell(shell)?);
        Ok(from_points(py, &velocities))
    }

    /// Moves a shell's vertices [m]; refused where surfaces would touch.
    fn set_positions(&mut self, shell: &str, positions: PyReadonlyArray2<'_, f64>) -> PyResult<()> {
        let (shell, points) = (self.shell(shell)?, to_points(&positions, "positions")?);
        (self.inner.set_shell_positions(shell, &points)).map_err(of_input)
    }

    /// Sets the velocities of a shell's vertices [m/s].
    fn set_velocities(
        &mut self,
        shell: &str,
        velocities: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<()> {
        let (shell, values) = (self.shell(shell)?, to_points(&velocities, "velocities")?);
        (self.inner.set_shell_velocities(shell, &values)).map_err(of_input)
    }

    /// Faces of a shell by the numbers of its vertices, of shape (m, 3).
    fn faces<'py>(&self, py: Python<'py>, shell: &str) -> PyResult<Bound<'py, PyArray2<i64>>> {
        let faces = &self.inner.parts()[self.shell(shell)?].faces;
        Ok(from_faces(py, faces))
    }

    /// Everything that is shown: a list of (name, whether it is an obstacle, positions [m], faces).
    #[expect(clippy::type_complexity, reason = "it is unpacked in Python at once")]
    fn parts<'py>(
        &self,
        py: Python<'py>,
    ) -> Vec<(
        String,
        bool,
        Bound<'py, PyArray2<f64>>,
        Bound<'py, PyArray2<i64>>,
    )> {
        let positions = self.inner.display_positions();
        let mut rest = &positions[..];
        (self.inner.parts().iter())
            .map(|part| {
                let (own, others) = rest.split_at(part.num_vertices);
                rest = others;
                let (points, faces) = (from_points(py, own), from_faces(py, &part.faces));
                (part.name.clone(), part.is_obstacle, points, faces)
            })
            .collect()
    }

    /// Values on the faces of a shell by name: strain, bending_energy_density [J/m²], mean_curvature and rest_curvature
    /// [1/m].
    fn face_fields<'py>(&self, py: Python<'py>, shell: &str) -> PyResult<Bound<'py, PyDict>> {
        let shell = self.shell(shell)?;
        let parts = self.inner.parts();
        let first: usize = parts[..shell].iter().map(|part| part.faces.len()).sum();
        let own = first..first + parts[shell].faces.len();
        let fields = PyDict::new(py);
        for (name, values) in self.inner.face_fields() {
            fields.set_item(name, values[own.clone()].to_vec().into_pyarray(py))?;
        }
        Ok(fields)
    }

    /// Energies by name [J].
    #[getter]
    fn energies(&self) -> HashMap<String, f64> {
        self.inner.energies().into_iter().collect()
    }

    /// The values of the scene's probes by column.
    #[getter]
    fn probes(&self) -> HashMap<String, f64> {
        let of = |probe: &Probe| probe.columns().into_iter().zip(probe.measure(&self.inner));
        self.scene.probes.iter().flat_map(of).collect()
    }

    /// Gradient of the elastic energies by all unknowns: coordinates of vertices, shell by shell [N], then directors.
    fn gradient<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.inner.elastic_gradient().into_pyarray(py)
    }

    /// Hessian of the elastic energies, lower triangle by columns: (values, row indices, column starts).
    #[expect(clippy::type_complexity, reason = "it is unpacked in Python at once")]
    fn hessian_lower<'py>(
        &mut self,
        py: Python<'py>,
    ) -> PyResult<(
        Bound<'py, PyArray1<f64>>,
        Bound<'py, PyArray1<u32>>,
        Bound<'py, PyArray1<u32>>,
    )> {
        let hessian = (py.detach(|| self.inner.elastic_hessian())).map_err(of_run)?;
        let pattern = &hessian.pattern;
        Ok((
            PyArray1::from_slice(py, &hessian.values),
            PyArray1::from_slice(py, pattern.row_indices()),
            PyArray1::from_slice(py, pattern.column_starts()),
        ))
    }

    /// The frequencies [Hz] of the lowest vibrations about the present state; negative where it is not stable.
    #[pyo3(signature = (count=6))]
    fn frequencies(&mut self, py: Python<'_>, count: usize) -> PyResult<Vec<f64>> {
        let modes = py
            .detach(|| self.inner.vibration_modes(count))
            .map_err(of_run)?;
        let hertz = |squared: f64| squared.abs().sqrt().copysign(squared) / std::f64::consts::TAU;
        Ok(modes.iter().map(|mode| hertz(mode.omega_squared)).collect())
    }

    fn __repr__(&self) -> String {
        format!(
            "Simulation(shells=[{}], time={}, step_count={})",
            self.shells().join(", "),
            self.time(),
            self.step_count()
        )
    }
}

/// Vertices [m] and faces of a mesh file: OBJ, PLY, OFF or STL.
#[pyfunction]
pub(crate) fn read_mesh(py: Python<'_>, path: PathBuf) -> PyResult<NewMesh<'_>> {
    let surface = koiter::io::read_mesh(Path::new(&path))
        .and_then(|mesh: read::RawMesh| mesh.into_surface(SurfaceOptions::default()))
        .map_err(of_input)?;
    Ok((
        from_points(py, &surface.positions),
        from_faces(py, surface.mesh.faces()),
    ))
}

/// Vertices [m] and faces of the mesh of the only shell of a scene's text.
#[pyfunction]
pub(crate) fn generate_mesh<'py>(py: Python<'py>, text: &str) -> PyResult<NewMesh<'py>> {
    let meshes = MemoryMeshes {
        arrays: HashMap::new(),
        folder: PathBuf::new(),
    };
    let (scene, _) = build(text, "<mesh>", &[], &meshes)?;
    let surface = &scene.model.shells[0].surface;
    Ok((
        from_points(py, &surface.positions),
        from_faces(py, surface.mesh.faces()),
    ))
}
