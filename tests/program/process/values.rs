//! Values at the edge of a domain, at zero, and by numbers that round.

use palmistry::claim::computed_value;
use palmistry::{System, ValueError, certified_value, system::Value};
use std::collections::HashMap;
use std::path::Path;

fn value(expression: &str) -> Result<palmistry::PointValue, ValueError> {
    at_digits(expression, 20)
}

fn at_digits(expression: &str, digits: usize) -> Result<palmistry::PointValue, ValueError> {
    let mut system = System::parse("a.proof", "system \"a\" state x", Path::new("")).unwrap();
    let Ok(Value::Scalar(id)) = system.evaluate_text(expression) else { panic!("{expression} is a number") };
    certified_value(&system.graph, id, &HashMap::new(), digits)
}

/// Certainly outside is told at once: the number of bits never comes into it.
#[test]
fn outside_a_domain_no_bits_are_wasted() {
    for expression in [
        "acos(1/atan(1/3))",
        "asin(-1/atan(1/3))",
        "sqrt(atan(1/3) - 1)",
        "log(atan(1/3) - 1)",
        "1 + sin(log(-exp(1)))",
        "acos(3)",
        "sqrt(sin(4))",
    ] {
        match value(expression) {
            Err(ValueError::Undefined(why)) => assert!(why.contains("lies outside its domain"), "{why}"),
            other => panic!("{expression}: {other:?}"),
        }
    }
}

/// At the edge itself nothing is certain, and the sentence says with how many bits it is not.
#[test]
fn at_an_edge_the_bits_are_bounded() {
    for (expression, words) in [
        ("acos(sin(1)^2 + cos(1)^2)", "edge of the domain"),
        ("sqrt(sin(1)^2 + cos(1)^2 - 1)", "edge of the domain"),
        ("log(sin(1)^2 + cos(1)^2 - 1)", "edge of the domain"),
        ("1/(sin(1)^2 + cos(1)^2 - 1)", "cannot be distinguished from zero"),
        ("sin(1)^2 + cos(1)^2 - 1", "neither be distinguished from zero nor be proved to be zero"),
        ("sin(pi)", "neither be distinguished from zero nor be proved to be zero"),
    ] {
        let why = at_digits(expression, 20).expect_err(expression).to_string();
        assert!(why.contains(words) && why.contains("4096 bits"), "{expression}: {why}");
    }
    // in the middle between two decimals: a half, that no exact arithmetic knows to be one
    let why = at_digits("100000 + sin(1)^2/2 + cos(1)^2/2", 6).expect_err("a half").to_string();
    assert!(why.contains("could not be fixed to more digits") && why.contains("4096 bits"), "{why}");
    // where more digits are asked for, their bits are tried
    let many = at_digits("sin(1)^2 + cos(1)^2 - 1", 3000).expect_err("zero").to_string();
    assert!(many.contains("21128 bits"), "{many}");
    // far below the first tries, and yet not zero: exp(-1000) is about 1e-435
    assert!(
        value("sin(1)^2 + cos(1)^2 - 1 + exp(-1000)")
            .unwrap()
            .decimal
            .starts_with("5.0759588975494567653e-435")
    );
}

/// The oracle is the certified value: what is computed to so many digits has these digits.
#[test]
fn a_computed_value_keeps_its_last_digit() {
    let mut compared = 0;
    for i in 1..400 {
        for expression in
            [format!("sin({i}/7)"), format!("exp({i}/90) - 1/{i}"), format!("{i}/7 + sqrt({i})/3")]
        {
            let mut system = System::parse("a.proof", "system \"a\" state x", Path::new("")).unwrap();
            let Ok(Value::Scalar(id)) = system.evaluate_text(&expression) else { panic!("{expression}") };
            for digits in [3, 14, 15] {
                let computed = computed_value(&system.graph, id, &HashMap::new(), digits).unwrap();
                let certified = certified_value(&system.graph, id, &HashMap::new(), digits).unwrap();
                assert_eq!(computed.decimal, certified.decimal, "{expression} to {digits} digits");
                compared += 1;
            }
        }
    }
    assert_eq!(compared, 399 * 9);
}
