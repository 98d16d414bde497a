//! The words of an expression.

use super::ExpressionError;

/// A word and its column, in characters from 1.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Token {
    pub(super) kind: TokenKind,
    pub(super) column: usize,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum TokenKind {
    Number(f64),
    Name(String),
    /// One of `+ - * / ^ ( ) , ; =`.
    Sign(char),
    End,
}

/// All words of a text, the last of which is [`TokenKind::End`].
pub(super) fn tokens(text: &str) -> Result<Vec<Token>, ExpressionError> {
    let characters: Vec<char> = text.chars().collect();
    let mut tokens = Vec::new();
    let mut at = 0;
    while at < characters.len() {
        let (character, column) = (characters[at], at + 1);
        let kind = if character.is_whitespace() {
            at += 1;
            continue;
        } else if character.is_ascii_digit() || character == '.' {
            let length = number_length(&characters[at..]);
            let written: String = characters[at..at + length].iter().collect();
            at += length;
            let value = written.parse().ok().filter(|value: &f64| value.is_finite());
            let Some(value) = value else {
                return Err(ExpressionError::new(
                    format!("'{written}' is no number"),
                    column,
                ));
            };
            TokenKind::Number(value)
        } else if character.is_alphabetic() || character == '_' {
            let is_of_name = |c: &&char| c.is_alphanumeric() || **c == '_';
            let length = characters[at..].iter().take_while(is_of_name).count();
            let name = characters[at..at + length].iter().collect();
            at += length;
            TokenKind::Name(name)
        } else if "+-*/^(),;=".contains(character) {
            at += 1;
            TokenKind::Sign(character)
        } else {
            let help = match character {
                '<' | '>' | '?' | '&' | '|' => {
                    "there are no conditions: use min, max, abs or smoothstep"
                }
                '[' | ']' | '{' | '}' => "use round parentheses",
                _ => "an expression has numbers, names, + - * / ^ ( ) , and ; between definitions",
            };
            return Err(
                ExpressionError::new(format!("unexpected '{character}'"), column).with_help(help),
            );
        };
        tokens.push(Token { kind, column });
    }
    tokens.push(Token {
        kind: TokenKind::End,
        column: characters.len() + 1,
    });
    Ok(tokens)
}

/// Digits, a point, digits, and an exponent if it has digits.
fn number_length(characters: &[char]) -> usize {
    let digits = |from: usize| {
        let rest = characters.get(from..).unwrap_or_default();
        rest.iter().take_while(|c| c.is_ascii_digit()).count()
    };
    let mut length = digits(0);
    if characters.get(length) == Some(&'.') {
        length += 1 + digits(length + 1);
    }
    if matches!(characters.get(length), Some('e' | 'E')) {
        let sign = usize::from(matches!(characters.get(length + 1), Some('+' | '-')));
        let exponent = digits(length + 1 + sign);
        if exponent > 0 {
            length += 1 + sign + exponent;
        }
    }
    length
}
