//! Every picture of how well a state is observable, at five points each, by a route of its own: derivatives written down by hand, and the
//! covariance `(J^T U^-2 J)^-1` by elimination. Nothing here is shared with the program but the scales `U` and the priors that it tells,
//! and these are held against the sample box.

use crate::common::{folder, write};
use palmistry::System;
use palmistry::paper::{FileFindings, Paper, VerifyOptions, verify};
use palmistry::report::{rank_json, rank_text};
use palmistry::tradeoff::standard_deviations_at;
use palmistry::{RankQuestion, answer_rank};
use std::path::Path;

const BEACONS: &str = "system \"Two beacons\"\nstate x, y, theta\nparam b = 2\nangle theta\ninput drive\n  x' = cos(theta)\n  \
    y' = sin(theta)\n  theta' = 0\ninput turn\n  theta' = 1\n  others' = 0\nlet q1 = (x^2 + y^2)/2\nlet q2 = ((x - b)^2 + y^2)/2\n\
    output q1, q2\nsample x in [-3, 5] y in [-3, 3] theta in [-3, 3]\n";

/// All that `verify` finds of a system that is alone in its folder.
fn found(text: &str) -> FileFindings {
    let folder = folder();
    write(&folder, "a.proof", text);
    write(&folder, "paper.toml", "title = \"A\"\nauthors = [\"B\"]\nyear = 1999\n");
    let options = VerifyOptions { seed: 1, interrupt: &false.into(), progress: &|_, _, _| (), timed: false };
    let mut all = verify(&Paper::read(folder.path()).unwrap(), &options).unwrap();
    assert_eq!(
        all.files[0].left_out.len(),
        0,
        "{:?}",
        all.files[0].left_out.iter().map(|l| &l.why).collect::<Vec<_>>()
    );
    all.files.remove(0)
}

/// The inverse of a matrix by elimination with pivots.
fn inverse(matrix: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let n = matrix.len();
    let mut all: Vec<Vec<f64>> = (0..n)
        .map(|i| matrix[i].iter().copied().chain((0..n).map(|j| f64::from(u8::from(i == j)))).collect())
        .collect();
    for k in 0..n {
        let pivot = (k..n).max_by(|a, b| all[*a][k].abs().total_cmp(&all[*b][k].abs())).unwrap();
        all.swap(k, pivot);
        let head = all[k][k];
        all[k].iter_mut().for_each(|entry| *entry /= head);
        let row = all[k].clone();
        for other in (0..n).filter(|other| *other != k) {
            let factor = all[other][k];
            all[other].iter_mut().zip(&row).for_each(|(entry, part)| *entry -= factor * part);
        }
    }
    all.into_iter().map(|row| row[n..].to_vec()).collect()
}

/// The standard deviations over the prior ones: the roots of the diagonal of `(J^T U^-2 J)^-1`.
fn by_covariance(rows: &[Vec<f64>], noise: &[f64], priors: &[f64]) -> Vec<f64> {
    let n = priors.len();
    let entry =
        |i: usize, j: usize| rows.iter().zip(noise).map(|(row, unit)| row[i] * row[j] / unit.powi(2)).sum();
    let information: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect();
    inverse(&information)
        .iter()
        .enumerate()
        .zip(priors)
        .map(|((i, row), prior)| row[i].sqrt() / prior)
        .collect()
}

/// A number of a list by its name.
fn of(list: &[(String, f64)], name: &str) -> f64 {
    list.iter().find(|(known, _)| known == name).unwrap_or_else(|| panic!("{name} in {list:?}")).1
}

fn near(found: f64, expected: f64) {
    assert!((found / expected - 1.0).abs() < 1e-7, "{found:e}, by hand {expected:e}");
}

/// The differentials of `q1`, `q2` and of their rates along `drive`, by hand.
fn beacons(x: f64, y: f64, theta: f64) -> Vec<Vec<f64>> {
    let (c, s) = (theta.cos(), theta.sin());
    vec![vec![x, y, 0.0], vec![x - 2.0, y, 0.0], vec![c, s, y * c - x * s], vec![c, s, y * c - (x - 2.0) * s]]
}

/// README's map, and that of one state by name; and the numbers that the notebook draws of the same system are those of the map.
#[test]
fn the_map_of_two_beacons() {
    let map = "map \"m\": x in [-3, 5], y in [-3, 3] at {theta = 0.5} order 1";
    let file = found(&format!("{BEACONS}{map}\n{map} of theta\n"));
    let worst = &file.maps[0].maps[0].1;
    let theta = &file.maps[1].maps[0].1;
    assert_eq!((file.maps[0].view.of.as_deref(), file.maps[1].view.of.as_deref()), (None, Some("theta")));
    let priors: Vec<f64> = ["x", "y", "theta"].iter().map(|name| of(&worst.scales.priors, name)).collect();
    for (prior, width) in priors.iter().zip([8.0f64, 6.0, 6.0]) {
        near(*prior, width / 12.0f64.sqrt());
    }
    let noise: Vec<f64> =
        ["q1", "q2", "Ldrive q1", "Ldrive q2"].iter().map(|name| of(&worst.scales.noise, name)).collect();
    // the variance of q1 over the box, by moments: x = 1 + u with u in [-4, 4], y in [-3, 3]; two hundred draws
    let (u2, u4, y2, y4) = (16.0 / 3.0, 256.0 / 5.0, 3.0, 81.0 / 5.0);
    let q1: f64 = (4.0 * u2 + u4 - u2 * u2 + y4 - y2 * y2) / 4.0;
    assert!((noise[0] / q1.sqrt() - 1.0).abs() < 0.1, "{} and {}", noise[0], q1.sqrt());
    for cell in [0, 4_321, 6_060, 7_777, 9_599] {
        let x = -3.0 + 8.0 * ((cell % 120) as f64 + 0.5) / 120.0;
        let y = -3.0 + 6.0 * ((cell / 120) as f64 + 0.5) / 80.0;
        let expected = by_covariance(&beacons(x, y, 0.5), &noise, &priors);
        near(theta.deviations[cell].unwrap(), expected[2]);
        near(worst.deviations[cell].unwrap(), expected.iter().copied().fold(0.0, f64::max));
        let system = System::parse("a.proof", BEACONS, Path::new("")).unwrap();
        let (names, there) =
            standard_deviations_at(&system, Some(1), &[], &["x", "y", "theta"], &[&[x, y, 0.5]]).unwrap();
        assert_eq!(names, ["x", "y", "theta"]);
        let most = there[0].as_ref().unwrap().iter().copied().fold(0.0, f64::max);
        assert_eq!(Some(most), worst.deviations[cell]);
    }
    assert_eq!(worst.shown.iter().map(|(_, count)| count).sum::<usize>(), 9_600);
}

/// One row and one column: equilibrated it is one everywhere, at `S = 0` too, where nothing is observable. By hand: the noise over
/// the slope `S/500` over the prior.
#[test]
fn one_row_is_not_one_everywhere() {
    let file = found(
        "system \"s\"\nstate S\nparam R = 1\ndrift f\n  S' = R\noutput S^2/1000\nsample S in [0, 2]\n\
         map \"m\": S in [-3, 3], R in [0, 1] order 0\nline \"in\": S to 0\nline \"out\": S to infinity of S\n",
    );
    let map = &file.maps[0].maps[0].1;
    let (prior, noise) = (of(&map.scales.priors, "S"), of(&map.scales.noise, "S^2/1000"));
    near(prior, 1.0 / 3.0f64.sqrt());
    // the variance of S^2 over [0, 2] is 16/5 - 16/9
    assert!((noise * 1000.0 / (16.0f64 / 5.0 - 16.0 / 9.0).sqrt() - 1.0).abs() < 0.1, "{noise}");
    let by_hand = |s: f64| noise / (s.abs() / 500.0) / prior;
    for cell in [0, 59, 60, 5_000, 9_599] {
        near(map.deviations[cell].unwrap(), by_hand(-3.0 + 6.0 * ((cell % 120) as f64 + 0.5) / 120.0));
    }
    // orders do not matter to the rest: S' = R has no state in it
    let (into, out) = (&file.lines[0].slope, &file.lines[1].slope);
    for point in [0, 16, 32, 48, 64] {
        let distance = into.distance[point];
        near(into.values[point].as_ref().unwrap()[0] / into.values[0].as_ref().unwrap()[0], 1.0 / distance);
        near(
            out.values[point].as_ref().unwrap()[0] / out.values[0].as_ref().unwrap()[0],
            out.distance[point],
        );
    }
    assert!(into.values[64].as_ref().unwrap()[0] > 1e12 && out.values[64].as_ref().unwrap()[0] < 1e-12);
}

/// Not observable, beyond where the system exists, and large are three things.
#[test]
fn what_is_not_observable_is_neither_large_nor_a_pole() {
    let file = found(
        "system \"s\"\nstate x, k, d\ndrift f\n  x' = k - x\n  k' = 0\n  d' = 0\noutput x, d^3, log(x)\nsample x in [1, 2] k in [1, 2] d in [1, 2]\n\
         map \"all\": x in [-1, 1], d in [0, 1] at {k = 1} order 1\nmap \"k\": k in [1, 2], d in [0, 1] at {x = 1} order 0 of k\n\
         map \"of x\": k in [1, 2], d in [0, 1] at {x = 1} order 0 of x\nline \"flat\": d to 0 from {x = 1, k = 1} of d\n",
    );
    let [all, of_k, of_x] = [0, 1, 2].map(|place| &file.maps[place].maps[0].1);
    // the logarithm is real above zero, by half of the cells
    for cell in [0, 59, 60, 119, 9_570] {
        assert_eq!(all.deviations[cell].is_none(), cell % 120 < 60, "{cell}: {:?}", all.deviations[cell]);
    }
    assert!(all.deviations.iter().flatten().all(|value| value.is_finite()), "large is finite");
    assert!(all.deviations[60].unwrap() > 1e3);
    for cell in [0, 59, 60, 5_000, 9_599] {
        // no rate is measured, so that nothing tells k; the others do not suffer
        assert_eq!(of_k.deviations[cell], Some(f64::INFINITY));
        // at x = 1 the differentials of x and log(x) are one
        let [plain, log] = ["x", "log(x)"].map(|name| of(&of_x.scales.noise, name));
        let both = (1.0 / plain.powi(2) + 1.0 / log.powi(2)).sqrt();
        near(of_x.deviations[cell].unwrap(), 1.0 / both / of(&of_x.scales.priors, "x"));
    }
    let slope = &file.lines[0].slope;
    assert_eq!(slope.names, ["d"]);
    for point in [0, 16, 32, 48, 64] {
        let by_hand = of(&slope.scales.noise, "d^3")
            / (3.0 * slope.distance[point].powi(2))
            / of(&slope.scales.priors, "d");
        near(slope.values[point].as_ref().unwrap()[0], by_hand);
    }
}

/// A way into a set on which two rows fall together: the deviation grows as the distance shrinks, also where doubles cannot tell it from
/// infinite.
#[test]
fn a_line_into_a_singular_set_is_that_by_hand_to_its_end() {
    let file = found(
        "system \"s\"\nstate x, y\nparam e = 1\ndrift f\n  x' = 0\n  y' = 0\noutput x + y, x + (1 + e)*y\nsample x in [0, 1] y in [0, 1]\n\
         line \"together\": e to 0\n",
    );
    let slope = &file.lines[0].slope;
    let [first, second] = ["x + y", "x + (1 + e)*y"].map(|name| of(&slope.scales.noise, name));
    let prior = of(&slope.scales.priors, "y");
    // where doubles see nothing any more as well
    for point in [0, 10, 20, 30, 40, 50, 60, 64] {
        // y = (b - a)/e
        let by_hand = first.hypot(second) / slope.distance[point] / prior;
        let found = slope.values[point].as_ref().unwrap()[1];
        assert!((found / by_hand - 1.0).abs() < 1e-3, "{found:e} {by_hand:e}");
    }
}

/// A paper's own rows are measured each to first order; of what is left out of them nothing else is said.
#[test]
fn the_rows_of_a_paper_have_scales_of_their_own() {
    let file = found(
        "system \"s\"\nstate x, v\ndrift f\n  x' = v\n  v' = -x\noutput x\nsample x in [1, 3] v in [0, 4]\n\
         let rows = [x, 1; 0, 2]\nmap \"m\": x in [1, 2], v in [0, 1]\n",
    );
    let map = &file.maps[0].maps[0].1;
    let [px, pv] = [2.0 / 12.0f64.sqrt(), 4.0 / 12.0f64.sqrt()];
    let [one, two] = [of(&map.scales.noise, "row 1"), of(&map.scales.noise, "row 2")];
    near(two, 2.0 * pv);
    // the mean of x^2 over the box is 13/3
    assert!((one / (13.0 / 3.0 * px * px + pv * pv).sqrt() - 1.0).abs() < 0.05, "{one}");
    for cell in [0, 59, 60, 5_000, 9_599] {
        let x = 1.0 + ((cell % 120) as f64 + 0.5) / 120.0;
        let expected = by_covariance(&[vec![x, 1.0], vec![0.0, 2.0]], &[one, two], &[px, pv]);
        near(map.deviations[cell].unwrap(), expected[0].max(expected[1]));
    }
    assert_eq!(file.maps[0].maps.len(), 2);
}

/// The least observable state of a table, at the state of the sample box that is named: by the words and units that are told.
#[test]
fn the_least_observable_state_is_that_of_the_table() {
    let mut system = System::parse("a.proof", BEACONS, Path::new("")).unwrap();
    let answer =
        answer_rank(&mut system, &RankQuestion { samples: 300, order: Some(1), ..RankQuestion::default() })
            .unwrap();
    let found = rank_json(&answer);
    let table = &found["standard_deviations"];
    let least = &table["least_observable"];
    let at = |name: &str| least["at"][name]["value"].as_f64().unwrap();
    let all = beacons(at("x"), at("y"), at("theta"));
    let mut rows = Vec::new();
    let mut noise = Vec::new();
    for (word, row) in ["q1", "q2", "Ldrive q1", "Ldrive q2"].iter().zip(all) {
        if let Some(unit) = table["units_of_noise"][word].as_f64() {
            rows.push(row);
            noise.push(unit);
        }
    }
    let priors = [8.0, 6.0, 6.0].map(|width: f64| width / 12.0f64.sqrt());
    let expected = by_covariance(&rows, &noise, &priors);
    let most = expected.iter().copied().fold(0.0, f64::max);
    let place = ["x", "y", "theta"].iter().position(|name| least["state"] == *name).unwrap();
    near(least["deviation"].as_f64().unwrap(), most);
    near(expected[place], most);
    let worst =
        table["of"].as_array().unwrap().iter().map(|row| row["worst"].as_f64().unwrap()).fold(0.0, f64::max);
    near(worst, most);
    let text = rank_text(&answer, true);
    assert!(text.contains("least observable: ") && !text.contains("conditioned"), "{text}");
}

/// Only what is unknown can be observable well or poorly.
#[test]
fn a_picture_is_of_an_unknown() {
    for (line, message) in [
        ("map \"m\": x in [0, 1], k in [0, 1] of k", "'k' is known"),
        ("map \"m\": x in [0, 1], k in [0, 1] order 1 of z \"caption\"", "unknown state or parameter 'z'"),
        ("line \"l\": x to 0 of", "a state"),
    ] {
        let text = format!("system \"s\"\nstate x\nparam k = 1\ndrift f\n  x' = k\noutput x\n{line}\n");
        let error = System::parse("a.proof", &text, Path::new("")).expect_err(line);
        assert!(
            error.to_string().contains(message) || error.message.contains(message),
            "{line}: {}",
            error.message
        );
    }
}
