//! Responses against closed forms.

use super::*;
use std::path::Path;

fn system(text: &str) -> System {
    System::parse("test.proof", text, Path::new("")).unwrap()
}

fn map<T: Clone>(pairs: &[(&str, T)]) -> BTreeMap<String, T> {
    pairs.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).collect()
}

/// `x' = a x + u` with `u = b t` has the solution `x = (x0 + b/a^2) e^(a t) - b/a^2 - b t/a`; `u'` is an output as well, and is `b`.
#[test]
fn a_line_is_driven_by_a_function_of_time() {
    let text = "system \"line\" state x param a = -2, b known u(t) drift f x' = a*x + u output x, x^2 + u'";
    let question = ResponseQuestion {
        start: map(&[("x", 1.5), ("b", 0.7)]),
        functions: map(&[("u", "b*t".to_owned())]),
        inputs: Vec::new(),
    };
    let times: Vec<f64> = (0..=20).map(|i| f64::from(i) / 10.0).collect();
    let found = response(&system(text), &question, &times).unwrap();
    let (a, b) = (-2.0, 0.7);
    for (i, t) in times.iter().enumerate() {
        let x = (1.5 + b / (a * a)) * (a * t).exp() - b / (a * a) - b * t / a;
        assert!((found.outputs[0].1[i] - x).abs() < 1e-11, "{t}");
        assert!((found.outputs[1].1[i] - x * x - b).abs() < 1e-10, "{t}");
        assert_eq!(found.inputs[0].1[i], b * t);
    }
    assert_eq!((found.states.len(), found.inputs[0].0.as_str()), (1, "u"));
    assert_eq!(found.constants, map(&[("a", a), ("b", b)]));
    assert_eq!(found.outputs[1].0, "x^2 + u'");
}

/// `x' = x^2` from one has no value from `t = 1` on.
#[test]
fn a_motion_that_ends_says_where() {
    let question = ResponseQuestion { start: map(&[("x", 1.0)]), ..ResponseQuestion::default() };
    let times: Vec<f64> = (0..=20).map(|i| f64::from(i) / 10.0).collect();
    let found =
        response(&system("system \"s\" state x drift f x' = x^2 output x"), &question, &times).unwrap();
    assert_eq!(found.times.len(), 10);
    assert!((found.ended.unwrap().time - 1.0).abs() < 1e-3);
    assert!((found.states[0].1[9] - 10.0).abs() < 1e-8);
}

#[test]
fn what_does_not_move_says_why() {
    let text = "system \"s\" state x, y param k unknown drift f x' = y*k y' = -x output x";
    let refused = |start: &[(&str, f64)], functions: &[(&str, &str)]| {
        let functions: Vec<(&str, String)> = functions.iter().map(|(a, b)| (*a, (*b).to_owned())).collect();
        let question = ResponseQuestion { start: map(start), functions: map(&functions), inputs: Vec::new() };
        response(&system(text), &question, &[0.0, 1.0]).unwrap_err().to_string()
    };
    let whole = [("x", 1.0), ("y", 0.0), ("k", 1.0)];
    assert_eq!(refused(&whole[..2], &[]), "nothing gives the initial condition of 'k'");
    assert_eq!(refused(&[("x", 1.0), ("height", 1.0)], &[]), "the system declares no 'height'");
    let moved = refused(&whole, &[("x", "t")]);
    assert_eq!(moved, "'x' moves by its own equation, and is no function of time");
}

/// An oscillator has no pole: for a sample in a year the message says that this is too far.
#[test]
fn a_sample_that_is_too_far_away_is_no_pole() {
    let oscillator = system("system \"o\" state x, v drift f x' = v v' = -x output x");
    let question = ResponseQuestion { start: map(&[("x", 0.5), ("v", 0.1)]), ..ResponseQuestion::default() };
    let lost = response(&oscillator, &question, &[0.0, 3.15e7]).unwrap_err().to_string();
    assert!(lost.contains("the equations were evaluated 3000 times"), "{lost}");
    assert!(lost.contains("the next sample is too far away, or a singularity is near"), "{lost}");
    // steps between two samples are counted, and not those of the whole motion
    let times: Vec<f64> = (0..400).map(f64::from).collect();
    assert!(response(&oscillator, &question, &times).unwrap().ended.is_none());
}
