//! Obstacles whose meshes deform: by a sequence of meshes, or by a file of positions over time.

use super::{Builder, Kind, check_same_triangles, mesh_error, move_to};
use crate::Vec3;
use crate::mesh::Surface;
use crate::scene::error::SceneError;
use crate::scene::model::Schedule;
use crate::scene::placement::{move_point, place_points};
use crate::scene::spec::{AnimationSpec, MeshSpec, ObstacleSpec};

impl Builder<'_> {
    /// Where the vertices of an obstacle that is the mesh `start` are over time, if it deforms.
    pub(super) fn deformation(
        &self,
        obstacle: &ObstacleSpec,
        start: &Surface,
    ) -> Result<Option<Schedule<Vec<Vec3>>>, SceneError> {
        match (&obstacle.animation, &obstacle.mesh) {
            (Some(animation), Some(mesh)) => self.animation(obstacle, mesh, animation).map(Some),
            _ if obstacle.deform.is_empty() => Ok(None),
            _ => self.sequence(obstacle, start).map(Some),
        }
    }

    fn sequence(
        &self,
        obstacle: &ObstacleSpec,
        start: &Surface,
    ) -> Result<Schedule<Vec<Vec3>>, SceneError> {
        let (mut times, mut values) = (vec![0.0], vec![start.positions.clone()]);
        for (number, deform) in obstacle.deform.iter().enumerate() {
            let path = format!("obstacle.{}.deform.{number}.mesh", obstacle.name);
            let mut surface = self.mesh(&path, &deform.mesh)?;
            let (path, name) = match &deform.mesh.file {
                Some(file) => (format!("{path}.file"), format!("'{file}'")),
                None => (path, "this".to_owned()),
            };
            check_same_triangles(&path, [&name, "obstacle's"], &surface, start)?;
            move_to(&mut surface, obstacle.rotate.as_ref(), obstacle.translate);
            times.push(deform.time);
            values.push(surface.positions);
        }
        Ok(Schedule { times, values })
    }

    fn animation(
        &self,
        obstacle: &ObstacleSpec,
        mesh: &MeshSpec,
        animation: &AnimationSpec,
    ) -> Result<Schedule<Vec<Vec3>>, SceneError> {
        let path = format!("obstacle.{}.animation", obstacle.name);
        let in_file = |message: String| {
            let message = format!("{}: {message}", animation.file);
            SceneError::new(Kind::Mesh, message).inside(&format!("{path}.file"))
        };
        let unreadable = |error| mesh_error(error, &format!("{path}.file"));
        let cache =
            (self.source.read_points(&animation.file)).map_err(|error| unreadable(error.into()))?;
        let times: Vec<f64> = match (animation.fps, cache.times) {
            (Some(fps), _) => (0..cache.frames.len()).map(|k| k as f64 / fps).collect(),
            (None, Some(times)) => times,
            (None, None) => {
                let message = "the file says no times, so 'fps' is needed: its frames a second";
                let error = SceneError::new(Kind::MissingKey, message);
                return Err(error.inside(&path).with_help("add fps = 24"));
            }
        };
        let times: Vec<f64> = times.iter().map(|time| animation.start + time).collect();
        let disordered = |pair: &[f64]| !(pair[0] < pair[1] && pair[1].is_finite());
        if let Some(frame) = times.windows(2).position(disordered) {
            let (before, after) = (times[frame], times[frame + 1]);
            return Err(in_file(format!(
                "times must increase, but frame {frame} at {before} s is followed by {after} s"
            )));
        }
        let mut values = place_points(mesh, self.source, cache.frames).map_err(unreadable)?;
        for (frame, points) in values.iter_mut().enumerate() {
            if let Some(vertex) = points.iter().position(|x| !x.iter().all(|v| v.is_finite())) {
                return Err(in_file(format!(
                    "vertex {vertex} of frame {frame} is not at finite numbers"
                )));
            }
            for x in points {
                *x = move_point(*x, obstacle.rotate.as_ref(), obstacle.translate);
            }
        }
        Ok(Schedule { times, values })
    }
}
