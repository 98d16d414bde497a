//! The functions of expressions.

use crate::geometry::Real;

/// A function of one, two or three numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Function {
    Sqrt,
    Exp,
    Log,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Atan2,
    Abs,
    Min,
    Max,
    SmoothStep,
}

/// What a function is called, and what it is.
#[derive(Clone, Copy, Debug)]
pub struct FunctionInfo {
    /// Name.
    pub name: &'static str,
    /// Number of arguments.
    pub arguments: usize,
    /// In a few words.
    pub meaning: &'static str,
    pub(super) function: Function,
}

const fn info(
    name: &'static str,
    arguments: usize,
    meaning: &'static str,
    function: Function,
) -> FunctionInfo {
    FunctionInfo {
        name,
        arguments,
        meaning,
        function,
    }
}

/// All functions.
pub const FUNCTIONS: [FunctionInfo; 14] = [
    info("sqrt", 1, "square root", Function::Sqrt),
    info("exp", 1, "exponential", Function::Exp),
    info("log", 1, "natural logarithm", Function::Log),
    info("sin", 1, "sine of an angle [rad]", Function::Sin),
    info("cos", 1, "cosine", Function::Cos),
    info("tan", 1, "tangent", Function::Tan),
    info("asin", 1, "angle of a sine [rad]", Function::Asin),
    info("acos", 1, "angle of a cosine", Function::Acos),
    info("atan", 1, "angle of a tangent", Function::Atan),
    info(
        "atan2",
        2,
        "angle of the point (second, first)",
        Function::Atan2,
    ),
    info("abs", 1, "absolute value", Function::Abs),
    info("min", 2, "the smaller", Function::Min),
    info("max", 2, "the larger", Function::Max),
    info(
        "smoothstep",
        3,
        "0 where the third is below the first, 1 above the second, t² (3 − 2 t) between",
        Function::SmoothStep,
    ),
];

impl Function {
    /// The value for these arguments, of which as many count as it has.
    pub(super) fn of<R: Real>(self, [a, b, c]: [R; 3]) -> R {
        match self {
            Self::Sqrt => a.sqrt(),
            Self::Exp => a.exp(),
            Self::Log => a.ln(),
            Self::Sin => a.sin(),
            Self::Cos => a.cos(),
            Self::Tan => a.tan(),
            Self::Asin => a.asin(),
            Self::Acos => a.acos(),
            Self::Atan => a.atan(),
            Self::Atan2 => a.atan2(b),
            Self::Abs => a.abs(),
            // Written so that NaN stays NaN.
            Self::Min if b.value() < a.value() || b.value().is_nan() => b,
            Self::Max if b.value() > a.value() || b.value().is_nan() => b,
            Self::Min | Self::Max => a,
            Self::SmoothStep => {
                let t = (c - a) / (b - a);
                match t.value() {
                    value if value <= 0.0 => R::from(0.0),
                    value if value >= 1.0 => R::from(1.0),
                    _ => t * t * (t * -2.0 + 3.0),
                }
            }
        }
    }
}
