//! Values over time: keys, piecewise linear between them; rigid motions made of such values.

use crate::Vec3;
use nalgebra::{Rotation3, Unit};

pub use super::model::{Motion, Rotation, Schedule};

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
        assert!(
            !self.times.is_empty() && self.times.len() == self.values.len(),
            "a schedule has a value for each of at least one time"
        );
        let next = self.times.partition_point(|&time| time <= t);
        if next == 0 {
            return self.values[0];
        }
        if next == self.times.len() {
            return self.values[next - 1];
        }
        let (start, end) = (self.times[next - 1], self.times[next]);
        let (from, to) = (self.values[next - 1], self.values[next]);
        from + (to - from) * ((t - start) / (end - start))
    }
}

impl Motion {
    /// Whether nothing ever moves.
    pub fn is_still(&self) -> bool {
        self.translation.is_none() && self.rotation.is_none()
    }

    /// Where a point that is at `x` at time 0 is at time `t` [s].
    ///
    /// Relative to time 0 only in the sense that the schedules are: a schedule that does not begin at zero displaces
    /// the point from the start.
    pub fn apply(&self, x: Vec3, t: f64) -> Vec3 {
        let mut moved = x;
        if let Some(rotation) = &self.rotation {
            let axis = Unit::new_unchecked(rotation.axis);
            let turn = Rotation3::from_axis_angle(&axis, rotation.angle.at(t));
            moved = turn * (moved - rotation.pivot) + rotation.pivot;
        }
        if let Some(translation) = &self.translation {
            moved += translation.at(t);
        }
        moved
    }

    /// The positions at time `t` [s] of points given at time 0.
    pub fn positions_at(&self, start: &[Vec3], t: f64) -> Vec<Vec3> {
        start.iter().map(|&x| self.apply(x, t)).collect()
    }
}

#[cfg(feature = "serde")]
mod typed {
    use std::borrow::Cow;

    use schemars::{JsonSchema, Schema, SchemaGenerator};
    use serde::{Deserialize, Deserializer};

    use super::{Motion, Rotation, Schedule, Vec3};

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

    /// `motion` in a scene file.
    #[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields)]
    pub struct MotionSpec {
        /// Translation [m] over time.
        #[serde(default)]
        pub translate: Option<Schedule<[f64; 3]>>,
        /// Rotation over time.
        #[serde(default)]
        pub rotate: Option<TurnSpec>,
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
            Motion {
                translation,
                rotation,
            }
        }
    }
}

#[cfg(feature = "serde")]
pub use typed::{MotionSpec, TurnSpec};

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
        };
        let x = Vec3::new(2.0, 0.0, 0.0);
        assert_eq!(motion.apply(x, 0.0), x);
        assert!((motion.apply(x, 0.5) - Vec3::new(1.0, 1.0, 1.0)).norm() < 1e-15);
        assert!((motion.apply(x, 1.0) - Vec3::new(0.0, 0.0, 2.0)).norm() < 1e-15);
        assert!(Motion::default().is_still() && !motion.is_still());
    }
}
