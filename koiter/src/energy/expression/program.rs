//! An expression as instructions for a stack.

use super::functions::Function;
use crate::geometry::Real;

/// Numbers that wait on the stack at most; one more is a mistake in the text.
pub(super) const MAX_STACK: usize = 16;

/// Names that an expression defines at most.
pub(super) const MAX_DEFINITIONS: usize = 8;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Instruction {
    Number(f64),
    /// A quantity of the element, by its place in the list of names.
    Quantity(u8),
    /// Time (0) or a parameter (from 1).
    Setting(u8),
    /// What was defined.
    Recall(u8),
    /// Takes the last number for a definition.
    Define(u8),
    Negate,
    Add,
    Subtract,
    Multiply,
    Divide,
    /// To a power that is a number.
    PowerOf(f64),
    /// To a power that is a setting.
    PowerOfSetting(u8),
    Power,
    /// Of the last one, two or three numbers.
    Apply(Function, u8),
}

/// A parsed expression; see [`super::Names::parse`].
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    pub(super) instructions: Vec<Instruction>,
    /// Which quantities appear.
    pub(super) used: Vec<bool>,
    pub(super) uses_time: bool,
}

impl Program {
    /// Which of the quantities appear, in the order of their names.
    pub fn used(&self) -> &[bool] {
        &self.used
    }

    /// Whether `time` appears.
    pub fn uses_time(&self) -> bool {
        self.uses_time
    }

    /// The value for these quantities, in the order of their names, and settings.
    pub(super) fn evaluate<R: Real>(&self, quantities: &[R], settings: &[f64]) -> R {
        let zero = R::from(0.0);
        let mut stack = [zero; MAX_STACK];
        let mut definitions = [zero; MAX_DEFINITIONS];
        // The number on top is kept apart; the parser has counted the rest.
        let (mut top, mut below) = (zero, 0);
        for instruction in &self.instructions {
            let pushed = match *instruction {
                Instruction::Number(value) => R::from(value),
                Instruction::Quantity(index) => quantities[index as usize],
                Instruction::Setting(index) => R::from(settings[index as usize]),
                Instruction::Recall(index) => definitions[index as usize],
                Instruction::Define(index) => {
                    definitions[index as usize] = top;
                    // Definitions stand between sums: nothing else is on the stack.
                    below = 0;
                    continue;
                }
                Instruction::Negate => {
                    top = -top;
                    continue;
                }
                Instruction::PowerOf(exponent) => {
                    top = power(top, exponent);
                    continue;
                }
                Instruction::PowerOfSetting(index) => {
                    top = power(top, settings[index as usize]);
                    continue;
                }
                Instruction::Apply(function, count) => {
                    let others = count as usize - 1;
                    below -= others;
                    top = match others {
                        0 => function.of([top, zero, zero]),
                        1 => function.of([stack[below], top, zero]),
                        _ => function.of([stack[below], stack[below + 1], top]),
                    };
                    continue;
                }
                Instruction::Add
                | Instruction::Subtract
                | Instruction::Multiply
                | Instruction::Divide
                | Instruction::Power => {
                    below -= 1;
                    top = pair(*instruction, stack[below], top);
                    continue;
                }
            };
            stack[below] = top;
            below += 1;
            top = pushed;
        }
        top
    }
}

fn pair<R: Real>(instruction: Instruction, a: R, b: R) -> R {
    match instruction {
        Instruction::Add => a + b,
        Instruction::Subtract => a - b,
        Instruction::Multiply => a * b,
        Instruction::Divide => a / b,
        // Defined for negative bases too where the exponent is whole.
        _ if b.is_constant() => power(a, b.value()),
        _ => (a.ln() * b).exp(),
    }
}

fn power<R: Real>(base: R, exponent: f64) -> R {
    match exponent == 2.0 {
        true => base * base,
        false => base.powf(exponent),
    }
}
