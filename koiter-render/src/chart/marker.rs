//! Signs at the points of curves, so that curves can be told apart without colours.

/// A sign at a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marker {
    /// ●
    Circle,
    /// ■
    Square,
    /// ▲
    Triangle,
    /// ▼
    TriangleDown,
    /// ◆
    Diamond,
    /// ✚
    Plus,
    /// ✖
    Cross,
    /// ★
    Star,
    /// ○, large: what lies below is seen through it.
    Ring,
}

impl Marker {
    /// Whether the inside of the outline is left as it is.
    pub(super) fn is_hollow(self) -> bool {
        self == Self::Ring
    }

    /// The outline about a point, of radius `r` [pixels].
    pub(super) fn outline(self, [x, y]: [f64; 2], r: f64) -> Vec<[f64; 2]> {
        let polygon = |corners: usize, first: f64, r: f64| -> Vec<[f64; 2]> {
            let angle = |k: usize| first + std::f64::consts::TAU * k as f64 / corners as f64;
            (0..corners)
                .map(|k| [x + r * angle(k).cos(), y + r * angle(k).sin()])
                .collect()
        };
        let quarter = std::f64::consts::FRAC_PI_4;
        // Radii that give all signs about the same area.
        match self {
            Self::Circle => polygon(16, 0.0, r),
            Self::Square => polygon(4, quarter, 1.25 * r),
            Self::Diamond => polygon(4, 0.0, 1.35 * r),
            Self::Triangle => polygon(3, -2.0 * quarter, 1.4 * r),
            Self::TriangleDown => polygon(3, 2.0 * quarter, 1.4 * r),
            Self::Plus => bars([x, y], 1.35 * r, 0.0),
            Self::Cross => bars([x, y], 1.35 * r, quarter),
            Self::Star => (polygon(5, -2.0 * quarter, 1.6 * r).into_iter())
                .zip(polygon(
                    5,
                    -2.0 * quarter + 0.2 * std::f64::consts::PI,
                    0.65 * r,
                ))
                .flat_map(|(tip, notch)| [tip, notch])
                .collect(),
            Self::Ring => polygon(24, 0.0, 1.8 * r),
        }
    }
}

/// Two bars that cross, turned by `angle`.
fn bars([x, y]: [f64; 2], r: f64, angle: f64) -> Vec<[f64; 2]> {
    let half = 0.33 * r;
    let arm = [[r, -half], [r, half], [half, half]];
    let mut outline = Vec::with_capacity(12);
    for k in 0..4 {
        let (sin, cos) = (angle + std::f64::consts::FRAC_PI_2 * f64::from(k)).sin_cos();
        outline.extend(arm.map(|[a, b]| [x + cos * a - sin * b, y + sin * a + cos * b]));
    }
    outline
}
