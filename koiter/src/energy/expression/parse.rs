//! From text to a [`Program`], by recursive descent.

use super::error::ExpressionError;
use super::functions::FUNCTIONS;
use super::program::{Instruction, MAX_DEFINITIONS, MAX_STACK, Program};
use super::tokens::{Token, TokenKind, tokens};

/// Bytes of a text at most.
pub const MAX_TEXT: usize = 4096;

/// Instructions of a program at most.
pub const MAX_INSTRUCTIONS: usize = 256;

/// Parentheses, signs and powers within one another at most: each takes a few frames of the parser's own stack.
pub const MAX_NESTING: usize = 32;

/// Parameters at most.
pub const MAX_PARAMETERS: usize = 64;

/// What may be named beside functions, `time` and `pi`.
#[derive(Clone, Copy, Debug)]
pub struct Names<'a> {
    /// Quantities of an element.
    pub quantities: &'a [&'a str],
    /// Parameters.
    pub parameters: &'a [String],
}

impl Names<'_> {
    /// Reads an expression.
    ///
    /// # Errors
    /// The first mistake, with its column.
    pub fn parse(&self, text: &str) -> Result<Program, ExpressionError> {
        if text.len() > MAX_TEXT {
            let message = format!("the expression is longer than {MAX_TEXT} bytes");
            return Err(ExpressionError::new(message, 1));
        }
        if self.parameters.len() > MAX_PARAMETERS {
            let message = format!("there are more than {MAX_PARAMETERS} parameters");
            return Err(ExpressionError::new(message, 1));
        }
        let mut parser = Parser {
            names: self,
            tokens: tokens(text)?,
            next: 0,
            nesting: 0,
            waiting: 0,
            definitions: Vec::new(),
            program: Program {
                instructions: Vec::new(),
                used: vec![false; self.quantities.len()],
                uses_time: false,
            },
        };
        parser.text()?;
        Ok(parser.program)
    }

    /// Why a parameter or a definition cannot have this name.
    ///
    /// # Errors
    /// In words.
    pub fn check_new(&self, name: &str) -> Result<(), String> {
        let mut characters = name.chars();
        let begins = (characters.next()).is_some_and(|c| c.is_alphabetic() || c == '_');
        let what = if !begins || !characters.all(|c| c.is_alphanumeric() || c == '_') {
            "is no name: use letters, digits and '_', and begin with a letter"
        } else if self.quantities.contains(&name) {
            "is the name of a quantity"
        } else if FUNCTIONS.iter().any(|known| known.name == name) {
            "is the name of a function"
        } else if ["time", "pi"].contains(&name) {
            "has a meaning already"
        } else {
            return Ok(());
        };
        Err(format!("'{name}' {what}"))
    }
}

struct Parser<'a> {
    names: &'a Names<'a>,
    tokens: Vec<Token>,
    next: usize,
    nesting: usize,
    /// Numbers on the stack.
    waiting: usize,
    definitions: Vec<String>,
    program: Program,
}

type Parsed = Result<(), ExpressionError>;

impl Parser<'_> {
    fn peek(&self) -> &Token {
        // The last token is the end, which is never passed.
        &self.tokens[self.next]
    }

    fn column(&self) -> usize {
        self.peek().column
    }

    /// Takes a sign, if it is the next one.
    fn take(&mut self, sign: char) -> bool {
        let found = self.peek().kind == TokenKind::Sign(sign);
        self.next += usize::from(found);
        found
    }

    fn unexpected(&self, wanted: &str) -> ExpressionError {
        let found = match &self.peek().kind {
            TokenKind::Number(value) => format!("'{value}'"),
            TokenKind::Name(name) => format!("'{name}'"),
            TokenKind::Sign(sign) => format!("'{sign}'"),
            TokenKind::End => "the end".into(),
        };
        ExpressionError::new(format!("expected {wanted}, found {found}"), self.column())
    }

    fn emit(&mut self, instruction: Instruction, taken: usize, column: usize) -> Parsed {
        self.waiting = self.waiting - taken + 1;
        self.program.instructions.push(instruction);
        let message = if self.waiting > MAX_STACK {
            format!("more than {MAX_STACK} numbers wait for one another")
        } else if self.program.instructions.len() > MAX_INSTRUCTIONS {
            format!("the expression has more than {MAX_INSTRUCTIONS} numbers, names and operations")
        } else {
            return Ok(());
        };
        Err(ExpressionError::new(message, column)
            .with_help("name parts of it: part = …; then use the name"))
    }

    fn text(&mut self) -> Parsed {
        loop {
            let token = self.peek().clone();
            let is_definition = matches!(&token.kind, TokenKind::Name(_))
                && self.tokens[self.next + 1].kind == TokenKind::Sign('=');
            let TokenKind::Name(name) = token.kind else {
                break;
            };
            if !is_definition {
                break;
            }
            self.next += 2;
            self.define(name, token.column)?;
        }
        self.sum()?;
        match self.peek().kind {
            TokenKind::End => Ok(()),
            TokenKind::Sign('=') => Err(self
                .unexpected("an operation or the end")
                .with_help("a definition is one name, '=', a sum and ';', before the result")),
            _ => Err(self.unexpected("an operation or the end")),
        }
    }

    fn define(&mut self, name: String, column: usize) -> Parsed {
        let refuse = |message: String| Err(ExpressionError::new(message, column));
        if let Err(message) = self.names.check_new(&name) {
            return refuse(message);
        }
        if self.names.parameters.contains(&name) || self.definitions.contains(&name) {
            return refuse(format!("'{name}' has a meaning already"));
        }
        if self.definitions.len() == MAX_DEFINITIONS {
            return refuse(format!("there are more than {MAX_DEFINITIONS} definitions"));
        }
        self.sum()?;
        if !self.take(';') {
            return Err(self.unexpected("an operation, or ';' after a definition"));
        }
        let index = self.definitions.len() as u8;
        (self.program.instructions).push(Instruction::Define(index));
        self.waiting = 0;
        self.definitions.push(name);
        Ok(())
    }

    fn sum(&mut self) -> Parsed {
        self.product()?;
        loop {
            let column = self.column();
            if self.take('+') {
                self.product()?;
                self.emit(Instruction::Add, 2, column)?;
            } else if self.take('-') {
                self.product()?;
                self.emit(Instruction::Subtract, 2, column)?;
            } else {
                return Ok(());
            }
        }
    }

    fn product(&mut self) -> Parsed {
        self.signed()?;
        loop {
            let column = self.column();
            if self.take('*') {
                if self.peek().kind == TokenKind::Sign('*') {
                    let error = self.unexpected("a factor");
                    return Err(error.with_help("powers are written with '^'"));
                }
                self.signed()?;
                self.emit(Instruction::Multiply, 2, column)?;
            } else if self.take('/') {
                self.signed()?;
                self.emit(Instruction::Divide, 2, column)?;
            } else {
                return Ok(());
            }
        }
    }

    /// Every way to nest passes here.
    fn signed(&mut self) -> Parsed {
        self.nesting += 1;
        if self.nesting > MAX_NESTING {
            let message =
                format!("more than {MAX_NESTING} levels of parentheses, signs and powers");
            return Err(ExpressionError::new(message, self.column()));
        }
        let column = self.column();
        if self.take('-') {
            self.signed()?;
            match self.program.instructions.last_mut() {
                Some(Instruction::Number(value)) => *value = -*value,
                _ => self.emit(Instruction::Negate, 1, column)?,
            }
        } else if self.take('+') {
            self.signed()?;
        } else {
            self.power()?;
        }
        self.nesting -= 1;
        Ok(())
    }

    fn power(&mut self) -> Parsed {
        self.atom()?;
        let column = self.column();
        if !self.take('^') {
            return Ok(());
        }
        let before = self.program.instructions.len();
        self.signed()?;
        let constant = match self.program.instructions[before..] {
            [Instruction::Number(exponent)] => Instruction::PowerOf(exponent),
            [Instruction::Setting(index)] => Instruction::PowerOfSetting(index),
            _ => return self.emit(Instruction::Power, 2, column),
        };
        self.program.instructions.pop();
        self.waiting -= 1;
        self.emit(constant, 1, column)
    }

    fn atom(&mut self) -> Parsed {
        let token = self.peek().clone();
        match token.kind {
            TokenKind::Number(value) => {
                self.next += 1;
                self.emit(Instruction::Number(value), 0, token.column)
            }
            TokenKind::Name(name) => {
                self.next += 1;
                match self.take('(') {
                    true => self.call(&name, token.column),
                    false => self.name(&name, token.column),
                }
            }
            TokenKind::Sign('(') => {
                self.next += 1;
                self.sum()?;
                self.close(token.column)
            }
            _ => Err(self.unexpected("a number, a name or '('")),
        }
    }

    fn close(&mut self, opened: usize) -> Parsed {
        match self.take(')') {
            true => Ok(()),
            false => Err(self
                .unexpected("an operation or ')'")
                .with_help(format!("the parenthesis of column {opened} is open"))),
        }
    }

    fn call(&mut self, name: &str, column: usize) -> Parsed {
        let Some(info) = FUNCTIONS.iter().find(|known| known.name == name) else {
            let elsewhere = NAMES_ELSEWHERE.iter().find(|(other, _)| *other == name);
            if let Some((_, ours)) = elsewhere {
                let error = ExpressionError::new(format!("there is no function '{name}'"), column);
                return Err(error.with_help(format!("write {ours}")));
            }
            let known = FUNCTIONS.map(|known| known.name);
            return Err(unknown("function", name, column, &known));
        };
        let mut count = 0;
        if self.peek().kind != TokenKind::Sign(')') {
            loop {
                self.sum()?;
                count += 1;
                if !self.take(',') {
                    break;
                }
            }
        }
        self.close(column + name.chars().count())?;
        if count != info.arguments {
            let message = format!("{name} takes {} arguments, not {count}", info.arguments);
            return Err(ExpressionError::new(message, column).with_help(info.meaning));
        }
        let instruction = Instruction::Apply(info.function, count as u8);
        self.emit(instruction, count, column)
    }

    fn name(&mut self, name: &str, column: usize) -> Parsed {
        let in_texts = |list: &[String]| list.iter().position(|known| known == name);
        let mut quantities = self.names.quantities.iter();
        let instruction = if let Some(index) = quantities.position(|known| *known == name) {
            self.program.used[index] = true;
            Instruction::Quantity(index as u8)
        } else if let Some(index) = in_texts(self.names.parameters) {
            Instruction::Setting(index as u8 + 1)
        } else if let Some(index) = in_texts(&self.definitions) {
            Instruction::Recall(index as u8)
        } else if name == "time" {
            self.program.uses_time = true;
            Instruction::Setting(0)
        } else if name == "pi" {
            Instruction::Number(std::f64::consts::PI)
        } else {
            let mut known = self.names.quantities.to_vec();
            known.extend(self.names.parameters.iter().map(String::as_str));
            known.extend(self.definitions.iter().map(String::as_str));
            known.extend(["time", "pi"]);
            return Err(unknown("quantity", name, column, &known));
        };
        self.emit(instruction, 0, column)
    }
}

/// What other languages call what is there too.
const NAMES_ELSEWHERE: [(&str, &str); 8] = [
    ("ln", "log(x), the natural logarithm"),
    ("log10", "log(x) / log(10)"),
    ("pow", "x^y"),
    ("fabs", "abs(x)"),
    ("fmin", "min(x, y)"),
    ("fmax", "max(x, y)"),
    ("cbrt", "x^(1/3)"),
    ("clamp", "max(low, min(x, high))"),
];

fn unknown(what: &str, name: &str, column: usize, known: &[&str]) -> ExpressionError {
    let message = format!("there is no {what} '{name}'");
    let mut error =
        ExpressionError::new(message, column).with_help(format!("there are {}", known.join(", ")));
    error.unknown_name = Some(name.to_owned());
    error
}
