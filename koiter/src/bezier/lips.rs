//! The lips of a cut, and what is done with them: they are pulled apart, closed again, or widened with a patch.

use std::f64::consts::PI;

use nalgebra::{Matrix3, Rotation3, UnitQuaternion};

use super::change::Change;
use super::surface_path::{PathNode, SurfacePath};
use super::{BezierError, BezierShell, DeadLoad, Pose, ShellOptions};
use crate::Vec3;
use crate::mesh::{Surface, SurfaceOptions};

/// The lips of a cut, along its path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lips {
    /// Pairs of vertices that were one: left and right of the path.
    pub pairs: Vec<[u32; 2]>,
    /// The vertices at which the path begins and ends, where these are inside the surface.
    pub ends: [Option<u32>; 2],
}

/// A patch in the shape of a lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Width in the middle [m].
    pub width: f64,
    /// Elements from lip to lip.
    pub across: usize,
    /// What it is made of.
    pub options: ShellOptions,
}

/// A patch, ready to be sewn in.
#[derive(Clone, Debug)]
pub struct Patch {
    /// Its elements.
    pub shell: BezierShell,
    /// Where its nodes are and how they are turned from the rest shape.
    pub pose: Pose,
    /// The pairs of vertices to be sewn; those of the patch are counted from behind the vertices of the shell that was cut.
    pub pairs: Vec<[u32; 2]>,
}

impl Lips {
    /// Those of a cut along a path.
    pub fn new(cut: &Change, path: &SurfacePath) -> Self {
        let end = |node: Option<&PathNode>| match node {
            Some(PathNode::Vertex(v)) if cut.seam.iter().all(|pair| !pair.contains(v)) => Some(*v),
            _ => None,
        };
        Self {
            pairs: cut.seam.clone(),
            ends: [end(path.nodes.first()), end(path.nodes.last())],
        }
    }

    /// The lips on a shell that was changed further: `present` is where each old vertex went.
    pub fn carried(&self, present: &[u32]) -> Self {
        let now = |v: u32| present[v as usize];
        Self {
            pairs: self.pairs.iter().map(|pair| pair.map(now)).collect(),
            ends: self.ends.map(|end| end.map(now)),
        }
    }

    /// Forces on the lips as they are at a pose: on every vertex `sideways` away from the other lip and `outwards` along the
    /// normal of the shell [N].
    pub fn opening(
        &self,
        shell: &BezierShell,
        pose: &Pose,
        sideways: f64,
        outwards: f64,
    ) -> DeadLoad {
        let normals = super::vertex_normals_at(shell, pose);
        let mut load = DeadLoad::none(pose.len());
        for (k, pair) in self.pairs.iter().enumerate() {
            let along = self.direction(k, pose);
            for (v, sign) in pair.iter().zip([1.0, -1.0]) {
                let normal = normals[*v as usize];
                let left = normal.cross(&along).normalize();
                load.add_force(*v as usize, left * (sign * sideways) + normal * outwards);
            }
        }
        load
    }

    /// The middle between the two vertices of a pair [m].
    fn middle(&self, pair: usize, pose: &Pose) -> Vec3 {
        let [a, b] = self.pairs[pair].map(|v| pose.positions[v as usize]);
        0.5 * (a + b)
    }

    /// The direction of the path at a pair.
    fn direction(&self, pair: usize, pose: &Pose) -> Vec3 {
        let end = |end: Option<u32>| end.map(|v| pose.positions[v as usize]);
        let last = self.pairs.len() - 1;
        let before = match pair {
            0 => end(self.ends[0]).unwrap_or_else(|| self.middle(0, pose)),
            _ => self.middle(pair - 1, pose),
        };
        let after = match pair {
            _ if pair == last => end(self.ends[1]).unwrap_or_else(|| self.middle(last, pose)),
            _ => self.middle(pair + 1, pose),
        };
        after - before
    }

    /// A patch that is flat at rest, between the lips as they are at a pose. It is wide as the cut is open, everywhere by the same
    /// factor. Its rows of vertices go from lip to lip: straight where the lips are farther apart than it is wide, else along
    /// arcs of its width that bulge outwards; so sewing it in moves no lip.
    ///
    /// # Errors
    /// A cut that ends at the boundary, or whose lips lie on each other; see [`BezierShell::new`].
    pub fn patch(
        &self,
        shell: &BezierShell,
        pose: &Pose,
        lens: &Lens,
    ) -> Result<Patch, BezierError> {
        let (Some(start), Some(end)) = (self.ends[0], self.ends[1]) else {
            return Err(BezierError::OpenEnd);
        };
        let at = |v: u32| pose.positions[v as usize];
        let normals = super::vertex_normals_at(shell, pose);
        let way = at(end) - at(start);
        let sum: Vec3 = self
            .pairs
            .iter()
            .flatten()
            .map(|v| normals[*v as usize])
            .sum();
        let along = way.normalize();
        let normal = (sum - along * along.dot(&sum)).normalize();
        // Axes of the flat lens: to the right, along, and outwards.
        let axes = Matrix3::from_columns(&[along.cross(&normal), along, normal]);
        let (rows, first) = (self.pairs.len(), pose.len() as u32);
        let gaps = self
            .pairs
            .iter()
            .map(|[left, right]| (at(*right) - at(*left)).norm());
        let gaps: Vec<f64> = gaps.collect();
        let widest = gaps.iter().copied().fold(0.0, f64::max);
        if gaps.iter().any(|gap| *gap < LEAST_GAP * way.norm()) {
            return Err(BezierError::ClosedLips);
        }
        let mut rest = vec![at(start)];
        let mut placed = Pose::at(vec![at(start)]);
        let mut pairs = vec![[start, first]];
        for (row, [left, right]) in self.pairs.iter().enumerate() {
            let width = lens.width * gaps[row] / widest;
            let foot = at(start) + along * along.dot(&(self.middle(row, pose) - at(start)));
            let outwards = normals[*left as usize] + normals[*right as usize];
            let arc = Arc::new([at(*left), at(*right)], &outwards, width);
            let begin = first + rest.len() as u32;
            for column in 0..=lens.across {
                let fraction = column as f64 / lens.across as f64;
                rest.push(foot + axes.column(0) * (width * (fraction - 0.5)));
                let (position, here) = arc.at(fraction);
                placed.positions.push(position);
                let turn = Rotation3::from_matrix_unchecked(here * axes.transpose());
                placed
                    .rotations
                    .push(UnitQuaternion::from_rotation_matrix(&turn));
            }
            pairs.extend([[*left, begin], [*right, begin + lens.across as u32]]);
        }
        pairs.push([end, first + rest.len() as u32]);
        rest.push(at(end));
        placed.positions.push(at(end));
        // The tips are turned like the middles of the rows beside them.
        let middle = 1 + lens.across / 2;
        placed.rotations[0] = placed.rotations[middle];
        let last = placed.rotations[placed.rotations.len() - middle];
        placed.rotations.push(last);
        let faces = lens_faces(rows, lens.across);
        let surface = Surface::new(rest, faces, SurfaceOptions::default())?;
        let normals = vec![normal; surface.positions.len()];
        Ok(Patch {
            shell: BezierShell::new(&surface, &normals, lens.options)?,
            pose: placed,
            pairs,
        })
    }
}

/// Lips that are nearer to each other than this share of the length of their cut lie on each other.
const LEAST_GAP: f64 = 1e-4;

/// An arc of a given length between two points.
struct Arc {
    middle: Vec3,
    /// Axes at its middle: along the chord, and outwards.
    chord: Vec3,
    outwards: Vec3,
    /// Half the angle it turns by [rad].
    half_angle: f64,
    /// From its middle to its end along the chord [m].
    half_chord: f64,
}

/// An arc does not turn further than this to either side: beyond, it would be rolled up.
const LARGEST_HALF_ANGLE: f64 = 0.8 * PI;

impl Arc {
    fn new([from, to]: [Vec3; 2], outwards: &Vec3, length: f64) -> Self {
        let chord = (to - from).normalize();
        let half_chord = 0.5 * (to - from).norm();
        // sin φ / φ falls from 1: halving finds where it is chord over length.
        let (mut low, mut high) = (0.0, LARGEST_HALF_ANGLE);
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            match f64::sin(middle) * length > 2.0 * half_chord * middle {
                true => low = middle,
                false => high = middle,
            }
        }
        Self {
            middle: 0.5 * (from + to),
            outwards: (outwards - chord * chord.dot(outwards)).normalize(),
            half_angle: low,
            chord,
            half_chord,
        }
    }

    /// The point at a fraction of its length [m], and the axes there: along the arc, to the left of it seen from outwards, and
    /// outwards.
    fn at(&self, fraction: f64) -> (Vec3, Matrix3<f64>) {
        let angle = (2.0 * fraction - 1.0) * self.half_angle;
        let (sin, cos) = angle.sin_cos();
        let (along, up) = match self.half_angle > 1e-6 {
            true => {
                let radius = self.half_chord / self.half_angle.sin();
                (radius * sin, radius * (cos - self.half_angle.cos()))
            }
            false => (self.half_chord * (2.0 * fraction - 1.0), 0.0),
        };
        let tangent = self.chord * cos - self.outwards * sin;
        let normal = self.outwards * cos + self.chord * sin;
        let axes = Matrix3::from_columns(&[tangent, normal.cross(&tangent), normal]);
        let position = self.middle + self.chord * along + self.outwards * up;
        (position, axes)
    }
}

/// Triangles of rows of vertices from left to right between two tips, the first vertex and the last.
fn lens_faces(rows: usize, across: usize) -> Vec<[u32; 3]> {
    let vertex = |row: usize, column: usize| (1 + row * (across + 1) + column) as u32;
    let last = vertex(rows - 1, across) + 1;
    let mut faces = Vec::new();
    for column in 0..across {
        faces.push([0, vertex(0, column + 1), vertex(0, column)]);
        faces.push([last, vertex(rows - 1, column), vertex(rows - 1, column + 1)]);
        for row in 0..rows - 1 {
            let [a, b] = [vertex(row, column), vertex(row, column + 1)];
            let [c, d] = [vertex(row + 1, column + 1), vertex(row + 1, column)];
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    faces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arc_has_its_length_and_ends() {
        let ends = [Vec3::new(0.1, 0.0, 0.0), Vec3::new(0.1, 0.3, 0.0)];
        for length in [0.2, 0.31, 0.45] {
            let arc = Arc::new(ends, &Vec3::new(0.2, 0.1, 1.0), length);
            let points: Vec<Vec3> = (0..=1000).map(|k| arc.at(k as f64 / 1000.0).0).collect();
            let measured: f64 = points.windows(2).map(|p| (p[1] - p[0]).norm()).sum();
            // Chords of a thousandth of a turn or less.
            assert!(
                (measured - f64::max(length, 0.3)).abs() < 1e-6,
                "{measured}"
            );
            assert!((points[0] - ends[0]).norm() < 1e-12);
            assert!((points[1000] - ends[1]).norm() < 1e-12);
            let (_, axes) = arc.at(0.25);
            assert!((axes.determinant() - 1.0).abs() < 1e-12);
            let tangent = (points[251] - points[249]).normalize();
            assert!((axes.column(0) - tangent).norm() < 1e-5);
        }
    }
}
