use std::f64::consts::PI;

use super::*;
use crate::geometry::Jet;

const QUANTITIES: [&str; 3] = ["x", "y", "length"];

fn parse(text: &str) -> Result<Program, ExpressionError> {
    let parameters = ["k".to_owned(), "n".to_owned()];
    let names = Names {
        quantities: &QUANTITIES,
        parameters: &parameters,
    };
    names.parse(text)
}

/// At x = 0.7, y = 1.3, length = 2, time = 0.5, k = 3, n = 2.
fn value(text: &str) -> f64 {
    let program = parse(text).unwrap_or_else(|error| panic!("{text}: {error}"));
    program.evaluate(&[0.7, 1.3, 2.0], &[0.5, 3.0, 2.0])
}

fn mistake(text: &str) -> ExpressionError {
    parse(text).expect_err(text)
}

#[test]
fn operations_bind_as_on_paper() {
    let (x, y) = (0.7f64, 1.3f64);
    for (text, expected) in [
        ("1 + 2 * 3", 7.0),
        ("(1 + 2) * 3", 9.0),
        ("2 - 3 - 4", -5.0),
        ("12 / 2 / 3", 2.0),
        ("2^3^2", 512.0),
        ("-2^2", -4.0),
        ("(-2)^2", 4.0),
        ("2^-1", 0.5),
        ("2 * -3", -6.0),
        ("- - 3", 3.0),
        ("+x", x),
        ("x - -y", x + y),
        ("k * (x / y - 1)^2", 3.0 * (x / y - 1.0) * (x / y - 1.0)),
        ("x^n", x * x),
        ("x^y", x.powf(y)),
        ("length^(1/2)", 2f64.sqrt()),
        ("2 * pi * time", PI),
        (".5e1 + 1.e-1", 5.1),
        ("sqrt(y) + exp(x) - log(y)", y.sqrt() + x.exp() - y.ln()),
        ("sin(x) * cos(y) / tan(x)", x.sin() * y.cos() / x.tan()),
        ("asin(x) + acos(x) - atan(y)", PI / 2.0 - y.atan()),
        ("atan2(y, x)", y.atan2(x)),
        ("abs(x - y) + min(x, y) * max(x, y)", y - x + x * y),
        (
            "smoothstep(0, 1, 0.5) + smoothstep(1, 2, y)",
            0.5 + 0.3 * 0.3 * (3.0 - 0.6),
        ),
        ("smoothstep(1, 2, x) + smoothstep(1, 2, length + 1)", 1.0),
        ("u = x + 1; v = u * u; v - u", 1.7 * 1.7 - 1.7),
        ("u = x; 2 * u", 2.0 * x),
    ] {
        let found = value(text);
        assert!(
            (found - expected).abs() < 1e-14 * expected.abs().max(1.0),
            "{text}: {found}"
        );
    }
}

#[test]
fn derivatives_are_those_of_what_is_written() {
    let program = parse("u = x^2 * y; k * u - length / y").unwrap();
    let variables: Vec<Jet<3>> = [0.7, 1.3, 2.0]
        .into_iter()
        .enumerate()
        .map(|(i, value)| Jet::variable(value, i))
        .collect();
    let jet = program.evaluate(&variables, &[0.5, 3.0, 2.0]);
    let (x, y, l) = (0.7, 1.3, 2.0);
    let gradient = [6.0 * x * y, 3.0 * x * x + l / (y * y), -1.0 / y];
    for i in 0..3 {
        assert!((jet.gradient()[i] - gradient[i]).abs() < 1e-14);
    }
    assert!((jet.hessian(1, 1) + 2.0 * l / (y * y * y)).abs() < 1e-14);
    assert!((jet.hessian(1, 2) - 1.0 / (y * y)).abs() < 1e-14);
    assert_eq!(program.used(), [true, true, true]);
    assert!(!program.uses_time() && parse("time").unwrap().uses_time());
}

#[test]
fn mistakes_have_a_column_and_say_what_to_do() {
    for (text, column, words) in [
        ("", 1, "expected a number, a name or '(', found the end"),
        ("x +", 4, "found the end"),
        ("x + )", 5, "found ')'"),
        ("(x + 1", 7, "expected an operation or ')'"),
        ("x y", 3, "expected an operation or the end, found 'y'"),
        ("2 * lenght", 5, "there is no quantity 'lenght'"),
        ("squrt(x)", 1, "there is no function 'squrt'"),
        ("atan2(x)", 1, "atan2 takes 2 arguments, not 1"),
        ("sin()", 1, "sin takes 1 arguments, not 0"),
        ("min(x, y", 9, "expected an operation or ')'"),
        ("1.2.3", 4, "found '0.3'"),
        ("1e999", 1, "'1e999' is no number"),
        ("β + $", 5, "unexpected '$'"),
        ("x $ y", 3, "unexpected '$'"),
        ("x < y", 3, "unexpected '<'"),
        ("x = y; x", 1, "'x' is the name of a quantity"),
        ("k = y; x", 1, "'k' has a meaning already"),
        ("u = y x", 7, "or ';' after a definition"),
        ("u = y; u = x; u", 8, "'u' has a meaning already"),
        ("u + v = 3", 1, "there is no quantity 'u'"),
        ("x + y = 3", 7, "found '='"),
    ] {
        let error = mistake(text);
        assert!(error.to_string().contains(words), "{text}: {error}");
        assert_eq!(error.column, column, "{text}: {error}");
    }
    assert_eq!(
        mistake("2 * lenght").unknown_name.as_deref(),
        Some("lenght")
    );
    assert!(mistake("x < y").help.unwrap().contains("smoothstep"));
    assert!(mistake("ln(x)").help.unwrap().contains("log(x)"));
    assert!(mistake("pow(x, 2)").help.unwrap().contains("x^y"));
    assert!(mistake("x**2").help.unwrap().contains("'^'"));
}

#[test]
fn no_text_is_too_long_or_too_deep() {
    let deep = |count: usize| format!("{}x{}", "(".repeat(count), ")".repeat(count));
    assert!(parse(&deep(MAX_NESTING - 1)).is_ok());
    for text in [
        deep(MAX_NESTING),
        deep(2000),
        "-".repeat(2000) + "x",
        "2^".repeat(1000) + "x",
        "sin(".repeat(800),
        " ".repeat(MAX_TEXT) + "x",
        vec!["x"; MAX_INSTRUCTIONS].join("+"),
        // Powers to the right wait for one another.
        vec!["x"; 17].join("^"),
        (0..9).map(|i| format!("u{i} = x; ")).collect::<String>() + "x",
    ] {
        let error = mistake(&text);
        assert!(!error.message.is_empty(), "{error}");
    }
    // As long as is allowed, and evaluated without a stack beyond what was counted.
    let sum = vec!["x"; MAX_INSTRUCTIONS / 2].join("+");
    assert!((value(&sum) - 0.7 * (MAX_INSTRUCTIONS / 2) as f64).abs() < 1e-12);
    let waiting = (1..=16).map(|i| format!("({i} - ")).collect::<String>() + "x" + &")".repeat(16);
    assert!(mistake(&waiting).message.contains("wait for one another"));
}

#[test]
fn undefined_values_stay_undefined() {
    for text in [
        "log(0 - x)",
        "sqrt(x - y)",
        "min(x, log(-1))",
        "max(log(-1), x)",
        "(x - y)^0.5",
    ] {
        assert!(value(text).is_nan(), "{text}");
    }
    assert!(!value("1 / (x - x)").is_finite());
}
