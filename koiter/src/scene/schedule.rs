//! Values over time: keys, piecewise linear between them; motions made of such values.

use crate::Vec3;
use nalgebra::{Rotation3, Unit};

pub use super::model::{Motion, Rotation, Scaling, Schedule};

impl<T> Schedule<T> {
    /// The keys around the time `t` [s] and the fraction of the way from the first to the second.
    ///
    /// # Panics
    /// If there are no keys, or not as many values as times.
    fn keys_around(&self, t: f64) -> (usize, usize, f64) {
        assert!(
            !self.times.is_empty() && self.times.len() == self.values.len(),
            "a schedule has a value for each of at least one time"
        );
        let next = self.times.partition_point(|&time| time <= t);
        if next == 0 || next == self.times.len() {
            let last = next.saturating_sub(1);
            return (last, last, 0.0);
        }
        let (start, end) = (self.times[next - 1], self.times[next]);
        (next - 1, next, (t - start) / (end - start))
    }
}

impl<T> Schedule<T>
where
    T: Copy
        + std::ops::Add<Output = T>
        + std::ops::Sub<Output = T>
        + std::ops::Mul<f64, Output = T>,
{
    /// The value at time `t` [s].
    ///
    /// # Panics
    /// If there are no keys, or not as many values as times.
    pub fn at(&self, t: f64) -> T {
        let (before, after, fraction) = self.keys_around(t);
        let (from, to) = (self.values[before], self.values[after]);
        from + (to - from) * fraction
    }
}

impl Schedule<Vec<Vec3>> {
    /// All points at time `t` [s].
    ///
    /// # Panics
    /// If there are no keys, or not as many values as times.
    pub fn points_at(&self, t: f64) -> Vec<Vec3> {
        let (before, after, fraction) = self.keys_around(t);
        let points = self.values[before].iter().zip(&self.values[after]);
        points
            .map(|(from, to)| from + (to - from) * fraction)
            .collect()
    }
}

impl Scaling {
    /// S(t) v, or its inverse where `power` is −1.
    fn stretch(&self, v: Vec3, t: f64, power: i32) -> Vec3 {
        let factor = self.factor.at(t).powi(power);
        match self.along {
            None => v * factor,
            Some(along) => v + along * ((factor - 1.0) * along.dot(&v)),
        }
    }
}

impl Rotation {
    /// By how much it turns until time `t` [s].
    pub(super) fn turn(&self, t: f64) -> Rotation3<f64> {
        Rotation3::from_axis_angle(&Unit::new_unchecked(self.axis), self.angle.at(t))
    }
}

impl Motion {
    /// Whether nothing ever moves.
    pub fn is_still(&self) -> bool {
        self.translation.is_none() && self.rotation.is_none() && self.scaling.is_none()
    }

    /// Where a point that is at `x` at time 0 is at time `t` [s].
    ///
    /// Relative to time 0 only in the sense that the schedules are: a schedule that does not begin at zero displaces
    /// the point from the start.
    pub fn apply(&self, x: Vec3, t: f64) -> Vec3 {
        let mut moved = x;
        if let Some(scaling) = &self.scaling {
            moved = scaling.stretch(moved - scaling.pivot, t, 1) + scaling.pivot;
        }
        if let Some(rotation) = &self.rotation {
            moved = rotation.turn(t) * (moved - rotation.pivot) + rotation.pivot;
        }
        if let Some(translation) = &self.translation {
            moved += translation.at(t);
        }
        moved
    }

    /// The point that [`Self::apply`] moves to `x`.
    fn undo(&self, x: Vec3, t: f64) -> Vec3 {
        let mut moved = x;
        if let Some(translation) = &self.translation {
            moved -= translation.at(t);
        }
        if let Some(rotation) = &self.rotation {
            moved = rotation.turn(t).inverse() * (moved - rotation.pivot) + rotation.pivot;
        }
        if let Some(scaling) = &self.scaling {
            moved = scaling.stretch(moved - scaling.pivot, t, -1) + scaling.pivot;
        }
        moved
    }

    /// What happens to a direction across a surface that moves: perpendicular to what it was perpendicular to, not
    /// normalised. `power` is −1 for the motion backwards.
    fn apply_normal(&self, normal: Vec3, t: f64, power: i32) -> Vec3 {
        let stretch = |n| match &self.scaling {
            Some(scaling) => scaling.stretch(n, t, -power),
            None => n,
        };
        match (&self.rotation, power) {
            (None, _) => stretch(normal),
            (Some(rotation), 1) => rotation.turn(t) * stretch(normal),
            (Some(rotation), _) => stretch(rotation.turn(t).inverse() * normal),
        }
    }

    /// The positions at time `t` [s] of points given at time 0.
    pub fn positions_at(&self, start: &[Vec3], t: f64) -> Vec<Vec3> {
        start.iter().map(|&x| self.apply(x, t)).collect()
    }

    /// The part of the motion between two times [s]; all until `time` where `since` is `None`.
    pub fn between(&self, since: Option<f64>, time: f64) -> MotionPart<'_> {
        MotionPart {
            motion: self,
            since: since.filter(|_| !self.is_still()),
            time,
        }
    }
}

/// The part of a motion between two times.
#[derive(Clone, Copy, Debug)]
pub struct MotionPart<'a> {
    motion: &'a Motion,
    since: Option<f64>,
    time: f64,
}

impl MotionPart<'_> {
    /// Where a point is at the end that is at `x` at the beginning.
    pub fn point(&self, x: Vec3) -> Vec3 {
        let start = self.since.map_or(x, |since| self.motion.undo(x, since));
        self.motion.apply(start, self.time)
    }

    /// A unit vector across a surface that moves along.
    pub fn normal(&self, normal: Vec3) -> Vec3 {
        let back = |since| self.motion.apply_normal(normal, since, -1);
        let start = self.since.map_or(normal, back);
        self.motion.apply_normal(start, self.time, 1).normalize()
    }
}

#[cfg(feature = "serde")]
mod typed {
    use std::borrow::Cow;

    use schemars::{JsonSchema, Schema, SchemaGenerator};
    use serde::{Deserialize, Deserializer};

    use super::{Motion, Rotation, Scaling, Schedule, Vec3};

    /// Written as a list of pairs `[time, value]`.
    impl<'de, T: Deserialize<'de>> Deserialize<'de> for Schedule<T> {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            let pairs = Vec::<(f64, T)>::deserialize(deserializer)?;
            let (times, values) = pairs.into_iter().unzip();
            Ok(Self { times, values })
        }
    }

    impl<T: JsonSchema> JsonSchema for Schedule<T> {
        fn inline_schema() -> bool {
            true
        }

        fn schema_name() -> Cow<'static, str> {
            format!("Schedule_of_{}", T::schema_name()).into()
        }

        fn json_schema(generator: &mut SchemaGenerator) -> Schema {
            Vec::<(f64, T)>::json_schema(generator)
        }
    }

    /// `motion` in a scene file: scaled, then turned, then moved.
    #[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields)]
    pub struct MotionSpec {
        /// Translation [m] over time.
        #[serde(default)]
        pub translate: Option<Schedule<[f64; 3]>>,
        /// Rotation over time. Points of meshes move along chords between the ends of a step.
        #[serde(default)]
        pub rotate: Option<TurnSpec>,
        /// Scaling over time.
        #[serde(default)]
        pub scale: Option<ScaleSpec>,
    }

    /// `motion.scale` in a scene file.
    #[derive(Clone, Debug, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields)]
    pub struct ScaleSpec {
        /// Direction in which lengths change, of any length but 0; default: all directions.
        #[serde(default)]
        pub along: Option<[f64; 3]>,
        /// The point that stays [m].
        #[serde(default)]
        pub through: [f64; 3],
        /// Factor on lengths over time, larger than 0.
        pub factor: Schedule<f64>,
    }

    /// `motion.rotate` in a scene file.
    #[derive(Clone, Debug, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields)]
    pub struct TurnSpec {
        /// Direction of the axis, of any length but 0.
        pub axis: [f64; 3],
        /// A point of the axis [m].
        #[serde(default)]
        pub through: [f64; 3],
        /// Angle [°] over time, right-handed.
        pub degrees: Schedule<f64>,
    }

    impl MotionSpec {
        /// In vectors and radians.
        pub fn to_motion(&self) -> Motion {
            let translation = self.translate.as_ref().map(|schedule| Schedule {
                times: schedule.times.clone(),
                values: schedule
                    .values
                    .iter()
                    .map(|&value| Vec3::from(value))
                    .collect(),
            });
            let rotation = self.rotate.as_ref().map(|turn| Rotation {
                pivot: Vec3::from(turn.through),
                axis: Vec3::from(turn.axis).normalize(),
                angle: Schedule {
                    times: turn.degrees.times.clone(),
                    values: turn.degrees.values.iter().map(|d| d.to_radians()).collect(),
                },
            });
            let scaling = self.scale.as_ref().map(|scale| Scaling {
                pivot: Vec3::from(scale.through),
                along: scale.along.map(|along| Vec3::from(along).normalize()),
                factor: scale.factor.clone(),
            });
            Motion {
                scaling,
                rotation,
                translation,
            }
        }
    }
}

#[cfg(feature = "serde")]
pub use typed::{MotionSpec, ScaleSpec, TurnSpec};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_schedule_is_linear_between_keys_and_constant_outside() {
        let schedule = Schedule {
            times: vec![1.0, 2.0, 4.0],
            values: vec![0.0, 10.0, 0.0],
        };
        let expected = [
            (0.0, 0.0),
            (1.0, 0.0),
            (1.25, 2.5),
            (2.0, 10.0),
            (3.0, 5.0),
            (9.0, 0.0),
        ];
        for (t, value) in expected {
            assert_eq!(schedule.at(t), value, "t = {t}");
        }
    }

    #[test]
    fn a_motion_turns_about_its_pivot_then_translates() {
        let motion = Motion {
            translation: Some(Schedule {
                times: vec![0.0, 1.0],
                values: vec![Vec3::zeros(), Vec3::new(0.0, 0.0, 2.0)],
            }),
            rotation: Some(Rotation {
                pivot: Vec3::new(1.0, 0.0, 0.0),
                axis: Vec3::z(),
                angle: Schedule {
                    times: vec![0.0, 1.0],
                    values: vec![0.0, std::f64::consts::PI],
                },
            }),
            ..Motion::default()
        };
        let x = Vec3::new(2.0, 0.0, 0.0);
        assert_eq!(motion.apply(x, 0.0), x);
        assert!((motion.apply(x, 0.5) - Vec3::new(1.0, 1.0, 1.0)).norm() < 1e-15);
        assert!((motion.apply(x, 1.0) - Vec3::new(0.0, 0.0, 2.0)).norm() < 1e-15);
        assert!(Motion::default().is_still() && !motion.is_still());
    }
    /// Scaled along a slant, turned and moved, all at once.
    fn twisting() -> Motion {
        let over = |to: f64, from: f64| Schedule {
            times: vec![0.0, 1.0],
            values: vec![from, to],
        };
        Motion {
            scaling: Some(Scaling {
                pivot: Vec3::new(0.1, 0.2, 0.3),
                along: Some(Vec3::new(1.0, 2.0, 2.0) / 3.0),
                factor: over(0.25, 1.0),
            }),
            rotation: Some(Rotation {
                pivot: Vec3::new(1.0, 0.0, 0.0),
                axis: Vec3::z(),
                angle: over(2.0, 0.0),
            }),
            translation: Some(Schedule {
                times: vec![0.0, 1.0],
                values: vec![Vec3::zeros(), Vec3::new(0.0, 0.0, 2.0)],
            }),
        }
    }

    #[test]
    fn scaling_changes_lengths_along_its_direction_only() {
        let motion = Motion {
            rotation: None,
            translation: None,
            ..twisting()
        };
        let along = Vec3::new(1.0, 2.0, 2.0) / 3.0;
        let across = Vec3::new(2.0, -1.0, 0.0);
        let moved = |v: Vec3| motion.apply(v, 1.0) - motion.apply(Vec3::zeros(), 1.0);
        assert!((moved(along) - along * 0.25).norm() < 1e-15);
        assert!((moved(across) - across).norm() < 1e-15);
        let pivot = Vec3::new(0.1, 0.2, 0.3);
        assert!((motion.apply(pivot, 1.0) - pivot).norm() < 1e-15);
    }

    #[test]
    fn a_part_of_a_motion_takes_over_where_the_part_before_ended() {
        let motion = twisting();
        let x = Vec3::new(0.4, -0.7, 0.9);
        let halfway = motion.between(None, 0.5).point(x);
        let rest = motion.between(Some(0.5), 1.0);
        // Round-off of some ten operations on numbers around 1.
        assert!((rest.point(halfway) - motion.apply(x, 1.0)).norm() < 1e-14);
        let still = Motion::default();
        assert_eq!(still.between(Some(0.3), 0.8).point(x), x);
    }

    #[test]
    fn a_normal_stays_across_the_surface_that_moves_it() {
        let motion = twisting();
        let (u, v) = (Vec3::new(0.3, 0.1, -0.4), Vec3::new(-0.2, 0.5, 0.1));
        let part = motion.between(Some(0.2), 0.9);
        let moved = |d: Vec3| part.point(d) - part.point(Vec3::zeros());
        let normal = part.normal(u.cross(&v).normalize());
        let expected = moved(u).cross(&moved(v)).normalize();
        assert!((normal - expected).norm() < 1e-14);
    }
}
