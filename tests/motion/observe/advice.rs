//! Motions of the palms that touch as much of a body as a search finds.

use crate::common::{folder, json, palmistry, write};
use crate::observe::{experiment, text, with};
use std::f64::consts::{FRAC_PI_2, TAU};

/// A short search, so that it does not take long.
fn search<'a>(scene: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&["advise", scene, "--trials", "40", "--angle1", "0.3,0.9", "--angle2", "1.2,1.8", "--rate", "2"], more]
        .concat()
}

/// What is printed goes into the scene, and the body then moves as was told: held as long, within the limits, with as many normals touched. Normals are counted here by a tenth of
/// a degree, from the motion itself.
#[test]
fn what_is_advised_is_what_happens() {
    let folder = folder();
    let scene = write(&folder, "scene.toml", text("same_rate"));
    let scene = scene.to_str().unwrap();
    let output = palmistry(&search(scene, &["--json"]));
    let found = json(&output);
    let (best, own) = (&found["best"], &found["own"]);
    assert_eq!(output.status.code(), Some(i32::from(best["held"] == false)), "{found}");
    let coverage = best["coverage"].as_f64().unwrap();
    assert!(coverage > own["coverage"].as_f64().unwrap(), "{found}");
    let printed = palmistry(&search(scene, &[]));
    let printed = String::from_utf8(printed.stdout).unwrap();
    let block = printed.split_once("prescribed = [").unwrap().1;
    let pasted = with(
        &text("same_rate"),
        "prescribed = [{ start = 0.4, rate = 0.4 }, { start = 1.8 }]",
        &format!("prescribed = [{block}"),
    );
    let experiment = experiment(&pasted);
    let motion = |name: &str| experiment.truth(name).unwrap();
    let (phi0, phi1, phi2) = (motion("phi0"), motion("phi1"), motion("phi2"));
    let lasted = experiment.signals.times().last().unwrap() / 1.4;
    assert!((lasted - best["lasted"].as_f64().unwrap()).abs() < 0.01, "{lasted} {found}");
    const PARTS: usize = 3600;
    let mut touched = vec![false; PARTS];
    let mut touch = |from: f64, to: f64| {
        for k in 0..=40 {
            let angle = from + (to - from) * f64::from(k) / 40.0;
            touched[(angle.rem_euclid(TAU) / TAU * PARTS as f64) as usize % PARTS] = true;
        }
    };
    for i in 0..phi0.len() - 1 {
        assert!((0.3..=0.9).contains(&phi1[i]) && (1.2..=1.8).contains(&phi2[i]), "{} {}", phi1[i], phi2[i]);
        // palm 1 is below the body, palm 2 beyond it
        touch(phi1[i] - FRAC_PI_2 - phi0[i], phi1[i + 1] - FRAC_PI_2 - phi0[i + 1]);
        let second = |i: usize| phi1[i] + phi2[i] + FRAC_PI_2 - phi0[i];
        touch(second(i), second(i + 1));
    }
    let counted = touched.iter().filter(|touched| **touched).count() as f64 / PARTS as f64;
    assert!((counted - coverage).abs() < 0.01, "{counted} {coverage}");
}

/// The same seed gives the same answer with one thread and with three, and another seed another one.
#[test]
fn advice_is_that_of_its_seed() {
    let folder = folder();
    let scene = write(&folder, "scene.toml", text("same_rate"));
    let scene = scene.to_str().unwrap();
    let run = |threads: &str, seed: &str| {
        let arguments = search(scene, &["--json", "--seed", seed]);
        let output = std::process::Command::new(env!("CARGO_BIN_EXE_palmistry"))
            .args(arguments)
            .env("RAYON_NUM_THREADS", threads)
            .output()
            .unwrap();
        String::from_utf8(output.stdout).unwrap()
    };
    let one = run("1", "4");
    assert_eq!(one, run("3", "4"));
    assert_ne!(one, run("2", "5"));
}

#[test]
fn limits_that_are_none_are_refused() {
    let scene = "proofs/moll2002/scenes/general.toml";
    for (arguments, word) in [
        (["--angle1", "0.9,0.3"], "--angle1: '0.9,0.3' is no range of angles"),
        (["--angle2", "1"], "--angle2: '1' is no range of angles"),
        (["--rate", "0"], "--rate: palms that turn at no more than 0 rad/s do not move"),
    ] {
        let output = palmistry(&[&["advise", scene, "--json"], &arguments[..]].concat());
        assert_eq!(output.status.code(), Some(2));
        assert_eq!(json(&output)["error"]["message"], word);
    }
    let output = palmistry(&["advise", "examples/systems/motor.toml", "--json"]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(json(&output)["error"]["message"], "the scene has no body");
}
