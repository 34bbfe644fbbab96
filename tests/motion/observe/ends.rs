//! Where searches end: what cannot be seen, other basins, mirror images. The recordings come from a method of Runge and Kutta in this file.

use crate::common::{folder, palmistry, write};
use crate::observe::observe;
use serde_json::Value;
use std::fmt::Write;

/// Normal numbers by twelve even ones, from a generator of linear congruences.
struct Draws(u64);

impl Draws {
    fn even(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.even()).sum::<f64>() - 6.0
    }
}

/// A motion sampled at even times, by the classical method of Runge and Kutta with fifty steps a sample.
fn motion<const N: usize>(
    rates: impl Fn([f64; N], f64) -> [f64; N],
    mut state: [f64; N],
    step: f64,
    samples: usize,
) -> Vec<[f64; N]> {
    const STEPS: usize = 50;
    let h = step / STEPS as f64;
    let along = |a: [f64; N], b: [f64; N], by: f64| std::array::from_fn(|i| a[i] + by * b[i]);
    let mut all = vec![state];
    for i in 0..(samples - 1) * STEPS {
        let t = i as f64 * h;
        let a = rates(state, t);
        let b = rates(along(state, a, h / 2.0), t + h / 2.0);
        let c = rates(along(state, b, h / 2.0), t + h / 2.0);
        let d = rates(along(state, c, h), t + h);
        state = std::array::from_fn(|i| state[i] + h / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]));
        if (i + 1) % STEPS == 0 {
            all.push(state);
        }
    }
    all
}

fn table(header: &str, rows: impl Iterator<Item = Vec<f64>>) -> String {
    let mut text = format!("{header}\n");
    for row in rows {
        let cells: Vec<String> = row.iter().map(f64::to_string).collect();
        let _ = writeln!(text, "{}", cells.join(","));
    }
    text
}

/// The first update, and whether it is borne out.
fn first(found: &Value) -> (&Value, bool) {
    let update = &found["observers"][0]["updates"][0];
    (update, update["status"] == "converged")
}

/// How many of its bounds a state of an update is off.
fn off(update: &Value, name: &str, truth: f64) -> f64 {
    let state = &update["states"][name];
    let number = |key: &str| state[key].as_f64().unwrap_or(f64::NAN);
    (number("recovered") - truth).abs() / number("bound")
}

/// `x e^(-k t) + b`, from guesses of `b` that are small beside what is known of it: whether it can be seen is known where the search ends.
#[test]
fn what_cannot_be_seen_is_decided_where_a_search_ends() {
    let folder = folder();
    write(
        &folder,
        "decay.proof",
        "system \"Decay with an offset\" state x param k, b unknown drift f x' = -k*x output x + b \
         sample x in [1/2, 2] k in [1/2, 2] b in [-1, 1]",
    );
    let mut draws = Draws(5);
    let rows: Vec<Vec<f64>> = (0..61)
        .map(|i| f64::from(i) * 0.05)
        .map(|t| vec![t, 1.3 * (-0.9 * t).exp() + 0.3 + 2e-3 * draws.normal()])
        .collect();
    write(&folder, "run.csv", table("time,x + b", rows.into_iter()));
    for guess in [1e-3, 1e-6, 0.3] {
        let scene = format!(
            "title = \"Decay\"\nmodel = \"decay.proof\"\n[data]\nrecord = \"run.csv\"\n[sensor]\nnoise = 2e-3\n[observer]\n\
             methods = [\"trust-region\"]\nestimate = [\"x\", \"k\", \"b\"]\nguess = {{ x = 1, k = 1, b = {guess} }}\nwindow = 60\nsteps = 50\n"
        );
        let (output, found) = observe(&write(&folder, "scene.toml", scene), &[]);
        let (update, arrived) = first(&found);
        assert!(arrived && output.status.code() == Some(0), "{guess}: {found}");
        for (name, truth) in [("x", 1.3), ("k", 0.9), ("b", 0.3)] {
            assert!(off(update, name, truth) < 4.0, "{guess}: {name} in {update}");
        }
    }
    // what is not there to be seen is not seen, wherever the search begins: two offsets of which the sum is read
    write(
        &folder,
        "decay.proof",
        "system \"Decay with two offsets\" state x param k, b, c unknown drift f x' = -k*x output x + b + c \
         sample x in [1/2, 2] k in [1/2, 2] b in [-1, 1] c in [-1, 1]",
    );
    let run = std::fs::read_to_string(folder.path().join("run.csv")).unwrap();
    write(&folder, "run.csv", run.replace("x + b", "x + b + c"));
    let scene = "title = \"Decay\"\nmodel = \"decay.proof\"\n[data]\nrecord = \"run.csv\"\n[sensor]\nnoise = 2e-3\n[observer]\n\
                 methods = [\"trust-region\"]\nestimate = [\"x\", \"k\", \"b\", \"c\"]\nguess = { x = 1, k = 1, b = 0.1, c = 0.1 }\n\
                 window = 60\nsteps = 50\n";
    let scene = write(&folder, "scene.toml", scene);
    let (_, found) = observe(&scene, &[]);
    assert_eq!(first(&found).0["status"], "not observable", "{found}");
    // the guess that it keeps is not given what could be known of it as its own deviation
    assert_eq!(first(&found).0["held"], true);
    let output = palmistry(&["observe", scene.to_str().unwrap()]);
    let text = String::from_utf8(output.stdout).unwrap();
    let held: Vec<&str> = text.lines().filter(|line| line.contains("not estimated, at best ±")).collect();
    assert_eq!(held.len(), 4, "{text}");
    assert!(held.iter().any(|line| line.contains("x ") && line.contains("1.000000000")), "{text}");
}

/// Susceptible and infectious parts of a population with unknown rates, from guesses anywhere in the box: every one arrives.
#[test]
fn an_epidemic_is_found_from_anywhere_in_its_box() {
    let folder = folder();
    write(
        &folder,
        "sir.proof",
        "system \"An epidemic\" state s, i param beta, gamma unknown drift f s' = -beta*s*i i' = beta*s*i - gamma*i output i \
         sample s in [1/2, 1] i in [0, 1/10] beta in [1/10, 2] gamma in [1/20, 1]",
    );
    let truth = [0.97, 0.008, 0.55, 0.18];
    let [_, _, beta, gamma] = truth;
    let rates = |[s, i]: [f64; 2], _| [-beta * s * i, (beta * s - gamma) * i];
    let path = motion(rates, [truth[0], truth[1]], 1.0, 61);
    let mut draws = Draws(11);
    let rows = path.iter().enumerate().map(|(t, state)| vec![t as f64, state[1] + 1e-3 * draws.normal()]);
    write(&folder, "run.csv", table("time,i", rows.collect::<Vec<_>>().into_iter()));
    for method in ["trust-region", "multiple-shooting"] {
        let mut draws = Draws(23);
        for seed in 0..10 {
            let [s, i, b, g] = [(0.5, 1.0), (0.0, 0.1), (0.1, 2.0), (0.05, 1.0)]
                .map(|(low, high)| low + draws.even() * (high - low));
            let scene = format!(
                "title = \"An epidemic\"\nmodel = \"sir.proof\"\n[data]\nrecord = \"run.csv\"\n[sensor]\nnoise = 1e-3\n[observer]\n\
                 methods = [\"{method}\"]\nestimate = [\"s\", \"i\", \"beta\", \"gamma\"]\n\
                 guess = {{ s = {s}, i = {i}, beta = {b}, gamma = {g} }}\nwindow = 60\nsteps = 50\n"
            );
            let (_, found) = observe(&write(&folder, "scene.toml", scene), &[]);
            let (update, arrived) = first(&found);
            assert!(arrived, "{method} {seed}: {found}");
            for (name, truth) in ["s", "i", "beta", "gamma"].into_iter().zip(truth) {
                assert!(off(update, name, truth) < 4.5, "{method} {seed}: {name} in {update}");
            }
        }
    }
}

/// A wheel whose odometer's scale is unknown: driven backwards by a scale below zero, with the heading turned by half a turn, it passes the same places. By hand
/// there is no other image: a heading that is mirrored goes elsewhere.
#[test]
fn a_mirror_image_is_named_beside_the_estimate() {
    let folder = folder();
    write(
        &folder,
        "wheel.proof",
        "system \"A wheel\" state x, y, heading param scale unknown param v, w angle heading drift f x' = 0 y' = 0 heading' = 0 \
         input drive x' = scale*cos(heading) y' = scale*sin(heading) others' = 0 input steer heading' = 1 others' = 0 output x, y \
         sample x in [-2, 2] y in [-2, 2] heading in [-3, 3] scale in [-2, 2]",
    );
    let speed = |t: f64| 0.6 + 0.2 * (0.7 * t).sin();
    let turn = |t: f64| 0.5 * (0.4 * t).cos();
    let (scale, heading) = (1.2, 0.5);
    let rates =
        |[_, _, a]: [f64; 3], t: f64| [scale * speed(t) * a.cos(), scale * speed(t) * a.sin(), turn(t)];
    let path = motion(rates, [0.1, -0.2, heading], 0.1, 81);
    let mut draws = Draws(3);
    let rows: Vec<Vec<f64>> = (path.iter().enumerate())
        .map(|(i, state)| (0.1 * i as f64, state))
        .map(|(t, state)| {
            vec![t, state[0] + 1e-3 * draws.normal(), state[1] + 1e-3 * draws.normal(), speed(t), turn(t)]
        })
        .collect();
    write(&folder, "run.csv", table("time,x,y,v,w", rows.into_iter()));
    let scene = |more: &str| {
        format!(
            "title = \"A wheel\"\nmodel = \"wheel.proof\"\n[data]\nrecord = \"run.csv\"\n[sensor]\nnoise = 1e-3\n[observer]\n\
             methods = [\"trust-region\"]\nestimate = [\"x\", \"y\", \"heading\", \"scale\"]\ninputs = {{ drive = \"v\", steer = \"w\" }}\n\
             guess = {{ x = 0, y = 0, heading = 0.3, scale = 1 }}\nwindow = 80\nsteps = 50\n{more}"
        )
    };
    let (_, found) = observe(&write(&folder, "scene.toml", scene("")), &[]);
    let (update, arrived) = first(&found);
    assert!(arrived, "{found}");
    assert!(off(update, "scale", scale) < 4.0 && off(update, "heading", heading) < 4.0, "{update}");
    let images = images(&found);
    assert_eq!(images.len(), 1, "{found}");
    let value = |name: &str| value(&images[0], name);
    assert!((value("scale") + scale).abs() < 1e-2, "{images:?}");
    assert!(((value("heading") - heading).abs() - std::f64::consts::PI).abs() < 1e-2, "{images:?}");
    assert!(images[0].contains("scale > 0"), "{images:?}");
    // where that is said nothing else is left to say
    let (_, found) = observe(&write(&folder, "scene.toml", scene("bounds = { scale = [0.1, 3] }\n")), &[]);
    assert!(first(&found).1, "{found}");
    assert_eq!(self::images(&found), Vec::<String>::new());
}

/// Two compartments that are read as a sum: which of them is which nothing tells, and a bound between their rates does. One that is read by itself as well has no other name.
#[test]
fn an_image_that_exchanges_unknowns_is_named() {
    let folder = folder();
    let model = |more: &str| {
        format!(
            "system \"Two compartments\" state a, b param k, l unknown drift f a' = -k*a b' = -l*b output a + b{more} \
             sample a in [0, 4] b in [0, 4] k in [1/10, 3] l in [1/10, 3]"
        )
    };
    write(&folder, "sum.proof", model(""));
    write(&folder, "both.proof", model(", a"));
    let scene = |model: &str, more: &str| {
        format!(
            "title = \"A sum\"\nmodel = \"{model}.proof\"\nduration = 4\nsamples = 81\n[start]\na = 2\nb = 1\nk = 2\nl = 0.3\n[sensor]\nnoise = 1e-4\n\
             [observer]\nmethods = [\"trust-region\"]\nestimate = [\"a\", \"b\", \"k\", \"l\"]\nguess_off = 0.1\nwindow = 80\nsteps = 50\n{more}"
        )
    };
    let (_, found) = observe(&write(&folder, "sum.toml", scene("sum", "")), &[]);
    assert!(first(&found).1, "{found}");
    let named = images(&found);
    assert_eq!(named.len(), 1, "{found}");
    for (name, truth) in [("a", 1.0), ("b", 2.0), ("k", 0.3), ("l", 2.0)] {
        assert!((value(&named[0], name) - truth).abs() < 0.01, "{named:?}");
    }
    let between: f64 = named[0].split("k > ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!((between - 1.15).abs() < 0.01, "{named:?}");
    let bounds = "bounds = { k = [1, 3] }\n";
    for scene in [scene("sum", bounds), scene("both", "")] {
        let (_, found) = observe(&write(&folder, "other.toml", scene), &[]);
        assert!(first(&found).1, "{found}");
        assert_eq!(images(&found), Vec::<String>::new());
    }
}

/// Three compartments that are read as a sum have five other orders: four are named, and of the fifth it is said that there is one.
#[test]
fn images_that_are_not_named_are_counted() {
    let folder = folder();
    let model = "system \"Three compartments\" state a, b, c param k, l, m unknown drift f a' = -k*a b' = -l*b c' = -m*c output a + b + c \
                 sample a in [0, 4] b in [0, 4] c in [0, 4] k in [1/10, 9] l in [1/10, 9] m in [1/100, 3]";
    write(&folder, "sum.proof", model);
    let scene = "title = \"A sum\"\nmodel = \"sum.proof\"\nduration = 6\nsamples = 601\n[start]\na = 2\nb = 1\nc = 3\nk = 5\nl = 1\nm = 0.1\n[sensor]\nnoise = 1e-6\n\
                 [observer]\nmethods = [\"trust-region\"]\nestimate = [\"a\", \"b\", \"c\", \"k\", \"l\", \"m\"]\nguess_off = 0.02\nwindow = 600\nsteps = 50\n";
    let (_, found) = observe(&write(&folder, "sum.toml", scene), &[]);
    assert!(first(&found).1, "{found}");
    assert_eq!(images(&found).len(), 4, "{found}");
    let remarks = found["observers"][0]["remarks"].to_string();
    assert!(remarks.contains("and 1 more such images"), "{remarks}");
}

/// What is said of other states that explain the measurements.
fn images(found: &Value) -> Vec<String> {
    let remarks = found["observers"][0]["remarks"].as_array().unwrap();
    let words = remarks.iter().filter_map(Value::as_str).map(str::to_owned);
    words.filter(|remark| remark.contains("explains the same measurements")).collect()
}

/// A value in such a sentence.
fn value(image: &str, name: &str) -> f64 {
    let rest = image.split(&format!("{name} = ")).nth(1).unwrap();
    rest.split([',', ' ']).next().unwrap().parse().unwrap()
}

/// A pendulum that is struck once, read without a stated noise: the model without the blow explains no window that holds it. What such a window leaves is no noise, and is no reason to call it blind. A filter that
/// is asked alone fails with it.
#[test]
fn a_blow_is_no_blindness() {
    let folder = folder();
    write(
        &folder,
        "pendulum.proof",
        "system \"A pendulum\" state phi, om param k unknown angle phi drift f phi' = om om' = -k*sin(phi) output phi \
         sample phi in [1/10, 2] om in [-2, 2] k in [5, 15]",
    );
    let rates = |[phi, om]: [f64; 2], _| [om, -12.0 * phi.sin()];
    let before = motion(rates, [0.8, 0.0], 0.01, 101);
    let [phi, om] = before[100];
    let after = motion(rates, [phi, om + 2.5], 0.01, 101);
    let path = before.iter().chain(&after[1..]);
    let rows: Vec<Vec<f64>> = path.enumerate().map(|(i, state)| vec![0.01 * i as f64, state[0]]).collect();
    write(&folder, "run.csv", table("time,phi", rows.into_iter()));
    let observed = |method: &str| {
        let scene = format!(
            "title = \"A blow\"\nmodel = \"pendulum.proof\"\n[data]\nrecord = \"run.csv\"\n[observer]\nmethods = [\"{method}\"]\n\
             estimate = [\"om\", \"k\"]\nguess = {{ om = 0.3, k = 10 }}\nwindow = 40\nsteps = 60\n"
        );
        let (output, found) = observe(&write(&folder, "scene.toml", scene), &[]);
        (output.status.code(), found)
    };
    let (status, found) = observed("trust-region");
    let standings: Vec<&str> = found["observers"][0]["updates"]
        .as_array()
        .unwrap()
        .iter()
        .map(|update| update["status"].as_str().unwrap())
        .collect();
    assert_eq!(status, Some(1), "{standings:?}");
    assert!(standings[..2].iter().all(|standing| *standing == "converged"), "{standings:?}");
    let fails = standings.contains(&"converged, but does not fit");
    assert!(fails && !standings.contains(&"not observable"), "{standings:?}");
    assert_eq!(observed("kalman").0, Some(1));
}
