//! Recordings in which not each row measures all: sensors with rates of their own, and a robot's log.
//!
//! Oracles: the same recording without the rows in which nothing was measured; least squares on the solution of the equations, by hand; the truth.

use crate::common::{folder, write};
use crate::observe::observe;
use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::Value;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

const SPRING: &str =
    "system \"A spring\" state x, v drift f x' = v v' = -4*x output x, v sample x in [-2, 2] v in [-2, 2]";

/// How far apart samples are, in s.
const STEP: f64 = 0.05;

/// A cell of a row; none where nothing was measured.
type Cells = Vec<Option<f64>>;

fn normal(random: &mut ChaCha8Rng) -> f64 {
    let radius = (-2.0 * (1.0 - random.random::<f64>()).ln()).sqrt();
    radius * (std::f64::consts::TAU * random.random::<f64>()).cos()
}

/// What position and velocity are made of at a sample, by the first of each: `[cos 2t, sin 2t / 2]` and its derivative.
fn by_hand(row: usize) -> [[f64; 2]; 2] {
    let (sin, cos) = (2.0 * STEP * row as f64).sin_cos();
    [[cos, sin / 2.0], [-2.0 * sin, cos]]
}

/// Samples of the spring that begins at 1 and -0.5 with errors of 0.02 and 0.05, each cell measured where it is told to be.
fn spring(seed: u64, rows: usize, is_measured: impl Fn(usize, usize) -> bool) -> Vec<Cells> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut cell = |row: usize, output: usize| {
        let [a, b] = by_hand(row)[output];
        let value = a - 0.5 * b + [0.02, 0.05][output] * normal(&mut random);
        is_measured(row, output).then_some(value)
    };
    (0..rows).map(|row| vec![cell(row, 0), cell(row, 1)]).collect()
}

fn csv(names: &str, rows: &[(f64, &Cells)]) -> String {
    let mut text = format!("time,{names}\n");
    for (time, cells) in rows {
        let cells: Vec<String> =
            cells.iter().map(|cell| cell.map_or_else(String::new, |value| format!("{value:?}"))).collect();
        let _ = writeln!(text, "{time:?},{}", cells.join(","));
    }
    text
}

fn timed(rows: &[Cells]) -> Vec<(f64, &Cells)> {
    rows.iter().enumerate().map(|(row, cells)| (STEP * row as f64, cells)).collect()
}

/// A scene of the spring's recording.
fn scene(folder: &TempDir, data: &str, methods: &str, more: &str) -> PathBuf {
    write(folder, "spring.proof", SPRING);
    write(folder, "data.csv", data);
    let text = format!(
        "title = \"A spring\"\nmodel = \"spring.proof\"\n[data]\nrecord = \"data.csv\"\nspike = inf\n{more}\n[observer]\nmethods = [{methods}]\n\
         estimate = [\"x\", \"v\"]\nguess = {{ x = 0.9, v = -0.4 }}\nwhole = true\nsteps = 50\nkalman = {{ process_noise = 0 }}\nunscented = {{ process_noise = 0 }}\n"
    );
    write(folder, "scene.toml", text)
}

const NOISE: &str = "[sensor.x]\nnoise = 0.02\n[sensor.v]\nnoise = 0.05";

fn number(found: &Value, place: &str) -> f64 {
    found.pointer(place).and_then(Value::as_f64).unwrap_or_else(|| panic!("{place}: {found}"))
}

/// What an observer of a scene has found first, by windows, or at the end: values, and their deviations.
fn found(found: &Value, observer: usize, place: &str) -> [[f64; 2]; 2] {
    ["x", "v"].map(|name| {
        ["recovered", "bound"]
            .map(|what| number(found, &format!("/observers/{observer}/{place}/states/{name}/{what}")))
    })
}

/// Position and velocity measured at rates of their own, with errors of their own: estimate, deviations and test of fit are those of the normal equations.
#[test]
fn sensors_with_their_own_rates_are_least_squares_by_hand() {
    let rows = spring(1, 90, |row, output| row % [3, 7][output] == 1);
    let folder = folder();
    let scene = scene(&folder, &csv("x,v", &timed(&rows)), "\"trust-region\", \"multiple-shooting\"", NOISE);
    let (output, json) = observe(&scene, &[]);
    assert_eq!(output.status.code(), Some(0), "{json}");
    let (mut normal, mut right, mut square, mut count) = (DMatrix::zeros(2, 2), DVector::zeros(2), 0.0, 0);
    for (row, cells) in rows.iter().enumerate() {
        for (output, value) in cells.iter().enumerate().filter_map(|(output, cell)| Some((output, (*cell)?)))
        {
            let sigma = [0.02, 0.05][output];
            let slope = DVector::from_column_slice(&by_hand(row)[output]) / sigma;
            normal += &slope * slope.transpose();
            right += slope * (value / sigma);
            (square, count) = (square + (value / sigma).powi(2), count + 1);
        }
    }
    let covariance = normal.clone().try_inverse().unwrap();
    let expected = &covariance * &right;
    let chi_square = square - right.dot(&expected);
    for observer in 0..2 {
        for (place, [value, deviation]) in found(&json, observer, "updates/0").into_iter().enumerate() {
            assert!((value - expected[place]).abs() < 1e-6, "{value} {}", expected[place]);
            assert!((deviation / covariance[(place, place)].sqrt() - 1.0).abs() < 1e-5, "{deviation}");
        }
        let fit = format!("/observers/{observer}/updates/0/fit");
        assert_eq!(number(&json, &format!("{fit}/degrees_of_freedom")), f64::from(count - 2));
        assert!((number(&json, &format!("{fit}/chi_square")) / chi_square - 1.0).abs() < 1e-5);
    }
    assert_eq!(json["sparse"][0]["measured"], 30);
    assert_eq!(
        json["sparse"][1],
        serde_json::json!({ "column": "v", "measured": 13, "interpolated": false })
    );
}

/// Rows in which nothing was measured change nothing: of windows, and of filters where no noise drives the equations, which are linear here. A filter has the estimate of least squares
/// at the end, but for what it believed before.
#[test]
fn rows_in_which_nothing_was_measured_change_nothing() {
    let rows = spring(2, 120, |row, _| row % 3 == 0);
    let methods = "\"newton\", \"trust-region\", \"multiple-shooting\", \"kalman\", \"unscented\"";
    let run = |data: &str| {
        let folder = folder();
        let (output, json) = observe(&scene(&folder, data, methods, NOISE), &["--no-times"]);
        assert_eq!(output.status.code(), Some(0), "{json}");
        json
    };
    // it ends with a row in which something was measured, as the other does
    let all = timed(&rows[..118]);
    let some: Vec<(f64, &Cells)> = all.iter().copied().filter(|(_, cells)| cells[0].is_some()).collect();
    let [sparse, dropped] = [csv("x,v", &all), csv("x,v", &some)].map(|data| run(&data));
    for observer in 0..5 {
        for place in ["updates/0", "end"].into_iter().skip(usize::from(observer > 2)) {
            let pairs = found(&sparse, observer, place).into_iter().zip(found(&dropped, observer, place));
            for ([a, own], [b, other]) in pairs {
                assert!(
                    (a - b).abs() < 1e-7 * own.max(1e-3) / 1e-3 && (own / other - 1.0).abs() < 1e-6,
                    "{observer} {place}: {a} {b}, {own} {other}"
                );
            }
        }
        let innovations =
            |json: &Value| json["observers"][observer]["innovations"]["degrees_of_freedom"].clone();
        assert_eq!(innovations(&sparse), innovations(&dropped));
    }
    assert!(dropped.get("sparse").is_none());
}

/// Of right recordings with cells missing at random the test of fit calls no more wrong than it says (one in a thousand each), and one that drifts is found out in each.
#[test]
fn the_test_of_fit_is_as_sharp_as_it_says() {
    let (mut least, mut small) = (1.0f64, 0);
    for seed in 0..60 {
        for drifts in [false, true] {
            let mut random = ChaCha8Rng::seed_from_u64(1000 + seed);
            let gaps: Vec<bool> = (0..200).map(|_| random.random_bool(0.4)).collect();
            let mut rows = spring(seed, 100, |row, output| gaps[2 * row + output]);
            if drifts {
                let late =
                    rows.iter_mut().enumerate().filter_map(|(row, cells)| Some((row, cells[0].as_mut()?)));
                late.for_each(|(row, value)| *value += 1e-3 * row as f64);
            }
            let folder = folder();
            let (_, json) =
                observe(&scene(&folder, &csv("x,v", &timed(&rows)), "\"trust-region\"", NOISE), &[]);
            let probability = number(&json, "/observers/0/updates/0/fit/probability");
            if drifts {
                assert!(probability < 1e-3, "{seed}: {probability}");
            } else {
                least = least.min(probability);
                small += usize::from(probability < 0.1);
            }
        }
    }
    // six are expected below a tenth
    assert!(least > 1e-4 && (1..=14).contains(&small), "{least} {small}");
}

/// What a table holds under some names, row by row.
fn table<const N: usize>(path: &Path, names: [&str; N]) -> Vec<[f64; N]> {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = lines.next().unwrap();
    let places = names.map(|name| header.iter().position(|own| *own == name).unwrap());
    lines.map(|cells| places.map(|place| cells[place].parse().unwrap())).collect()
}

/// A smoother of linear equations is the least squares of all states together: one matrix of all samples, with what was believed before, how the state goes from each to the next, and
/// what was measured, each weighed by its covariance. With a noise that drives the equations and without, and where much was not measured.
#[test]
fn a_smoother_is_least_squares_of_all_samples_together() {
    const ROWS: usize = 50;
    for (drive, every) in [(0.0, 1), (0.3, 1), (0.3, 4)] {
        let rows = spring(7, ROWS, |row, output| (row + output) % every == 0);
        let folder = folder();
        let scene = scene(&folder, &csv("x,v", &timed(&rows)), "\"smoother\", \"kalman\"", NOISE);
        let text = std::fs::read_to_string(&scene).unwrap();
        let text = text
            .replace("kalman = { process_noise = 0 }", &format!("kalman = {{ process_noise = {drive:?} }}"));
        let scene = write(&folder, "scene.toml", text.replace("whole = true\n", ""));
        let track = folder.path().join("track.csv");
        let (output, json) = observe(&scene, &["--track", track.to_str().unwrap()]);
        assert!(output.status.code().is_some_and(|code| code < 2), "{json}");
        let (sin, cos) = (2.0 * STEP).sin_cos();
        let flow = DMatrix::from_row_slice(2, 2, &[cos, sin / 2.0, -2.0 * sin, cos]);
        // relations, each `slopes * states = value` with a deviation; sizes are those of the guess
        let (guess, mut relations) = ([0.9, -0.4], Vec::new());
        let mut relate = |slopes: &[(usize, f64)], value: f64, deviation: f64| {
            let mut row = DVector::zeros(2 * ROWS);
            slopes.iter().for_each(|(place, slope)| row[*place] += slope / deviation);
            relations.push((row, value / deviation));
        };
        for (i, believed) in guess.iter().enumerate() {
            relate(&[(i, 1.0)], *believed, 0.5 * believed.abs());
        }
        for (row, cells) in rows.iter().enumerate() {
            for i in 0..2 {
                let to = 2 * row;
                if let Some(value) = cells[i] {
                    relate(&[(to + i, 1.0)], value, [0.02, 0.05][i]);
                }
                let Some(from) = to.checked_sub(2) else { continue };
                // without noise the equations hold to far below what is compared
                let deviation = (drive * guess[i].abs() * STEP.sqrt()).max(1e-8);
                relate(&[(to + i, 1.0), (from, -flow[(i, 0)]), (from + 1, -flow[(i, 1)])], 0.0, deviation);
            }
        }
        let slopes = DMatrix::from_fn(relations.len(), 2 * ROWS, |i, j| relations[i].0[j]);
        let values = DVector::from_fn(relations.len(), |i, _| relations[i].1);
        let qr = slopes.qr();
        let inverse = qr.r().try_inverse().unwrap();
        let expected = &inverse * qr.q().tr_mul(&values);
        let told: Vec<[f64; 5]> = table(&track, ["time", "x", "x_bound", "v", "v_bound"]);
        assert_eq!(told.len(), ROWS);
        for (row, own) in told.iter().enumerate() {
            for i in 0..2 {
                let ([value, deviation], bound) =
                    ([own[1 + 2 * i], own[2 + 2 * i]], inverse.row(2 * row + i).norm());
                let off = (value - expected[2 * row + i]).abs();
                assert!(off < 1e-5 * bound.max(1e-3), "{drive} {row} {i}: {value} {}", expected[2 * row + i]);
                assert!((deviation / bound - 1.0).abs() < 1e-5, "{drive} {row} {i}: {deviation} {bound}");
            }
        }
        for (place, row) in [("begin", 0), ("end", ROWS - 1)] {
            let states = format!("/observers/0/{place}/states");
            assert!((number(&json, &format!("{states}/v/recovered")) - told[row][3]).abs() < 1e-12);
        }
        // a filter knows as much at the end, and less before
        assert_eq!(json["observers"][0]["end"], json["observers"][1]["end"]);
        assert!(json["observers"][1].get("begin").is_none());
    }
}

/// Windows that know nothing of each other meet in a sample that both have read, or that neither has: where they are apart by no more than their deviations, what they share taken off, no seam is called
/// wrong, and probabilities are as even as they have to be.
#[test]
fn windows_meet_in_samples_that_were_not_measured() {
    let (mut small, mut all, mut least) = (0u32, 0u32, 1.0f64);
    for seed in 0..40 {
        let mut random = ChaCha8Rng::seed_from_u64(2000 + seed);
        let gaps: Vec<bool> = (0..242).map(|_| random.random_bool(0.3)).collect();
        let rows = spring(seed, 121, |row, output| gaps[2 * row + output]);
        let folder = folder();
        let path = scene(&folder, &csv("x,v", &timed(&rows)), "\"trust-region\"", NOISE);
        let text =
            std::fs::read_to_string(&path).unwrap().replace("whole = true", "window = 20\ninherit = false");
        let (_, json) = observe(&write(&folder, "scene.toml", text), &[]);
        for update in json["observers"][0]["updates"].as_array().unwrap() {
            let Some(probability) = update["seam"]["probability"].as_f64() else { continue };
            least = least.min(probability);
            small += u32::from(probability < 0.1);
            all += 1;
        }
    }
    // a tenth is expected below a tenth: four deviations of that
    let [expected, deviation] = [0.1 * f64::from(all), (0.09 * f64::from(all)).sqrt()];
    assert!(all >= 150 && (f64::from(small) - expected).abs() < 4.0 * deviation, "{small} of {all}");
    assert!(least > 1e-4, "{least}");
}

const PUSHED: &str = "system \"A mass that is pushed\" state x, v param u drift f x' = v v' = u output x sample x in [-2, 2] v in [-2, 2] u in [-1, 1]";

/// What drives the model goes between its samples as it is told: a force that is held, measured each fourth row from the second on. The mass is where the integral by hand has it, and
/// rows before the force is known are left out.
#[test]
fn what_drives_the_model_is_held_or_goes_straight() {
    for (interpolation, is_held) in [("hold", true), ("linear", false)] {
        let force = |place: usize| [0.5, -1.0, 0.25, 2.0, -0.75][place % 5];
        // the force over time since it is known, of places that are 0.2 s apart
        let forced = |time: f64| {
            let (place, part) = ((time / 0.2 + 1e-9).floor() as usize, time / 0.2 % 1.0);
            if is_held { force(place) } else { force(place) + part * (force(place + 1) - force(place)) }
        };
        // position and velocity by small steps of the midpoint rule, exact for what is piecewise linear but for the cubes of the steps
        let (mut x, mut v, mut rows) = (0.3, -0.2, Vec::new());
        for row in 0..81 {
            let is_forced = row > 0 && (row - 1) % 4 == 0;
            let place = (row.max(1) - 1) / 4;
            rows.push(vec![Some(x), is_forced.then(|| force(place))]);
            if row > 0 {
                for i in 0..2000 {
                    let (step, since) = (STEP / 2000.0, STEP * (row - 1) as f64);
                    let push = forced(since + (f64::from(i) + 0.5) * step);
                    x += step * v + step * step / 2.0 * push;
                    v += step * push;
                }
            }
        }
        let folder = folder();
        write(&folder, "pushed.proof", PUSHED);
        write(&folder, "data.csv", csv("x,u", &timed(&rows)));
        let text = format!(
            "title = \"A mass\"\nmodel = \"pushed.proof\"\n[data]\nrecord = \"data.csv\"\nspike = inf\ninterpolation = \"{interpolation}\"\n[observer]\n\
             methods = [\"trust-region\", \"multiple-shooting\"]\nestimate = [\"x\", \"v\"]\nguess = {{ x = 0, v = 0.1 }}\nwhole = true\nsteps = 50\n"
        );
        let (output, json) = observe(&write(&folder, "scene.toml", text), &[]);
        assert_eq!(output.status.code(), Some(0), "{json}");
        for observer in 0..2 {
            for (name, truth) in [("x", 0.3), ("v", -0.2)] {
                let own = number(&json, &format!("/observers/{observer}/updates/0/states/{name}/recovered"));
                assert!((own - truth).abs() < 1e-7, "{interpolation}: {name} {own}");
            }
            assert!(number(&json, &format!("/observers/{observer}/updates/0/residual")) < 1e-7);
        }
        assert_eq!(json["rows_left_out"], serde_json::json!({ "start": 1, "end": 3 }));
        assert_eq!(
            json["sparse"][0],
            serde_json::json!({ "column": "u", "measured": 20, "interpolated": true })
        );
    }
}

/// A force that is measured with an error each fifth row, and held: all rows in between err with it, and estimates are off by no more than their deviations say, nor are right recordings
/// called wrong.
#[test]
fn errors_of_filled_cells_hang_together() {
    const ROWS: usize = 121;
    let (mut squares, mut count) = (0.0, 0u32);
    for seed in 0..30 {
        let mut random = ChaCha8Rng::seed_from_u64(3000 + seed);
        let (mut x, mut v, mut push, mut rows) = (0.3, -0.2, 0.0, Vec::new());
        for row in 0..ROWS {
            let is_forced = row % 5 == 0;
            if is_forced {
                push = (0.7 * row as f64).sin();
            }
            let read = is_forced.then(|| push + 0.3 * normal(&mut random));
            rows.push(vec![Some(x + 1e-3 * normal(&mut random)), read]);
            x += STEP * v + STEP * STEP / 2.0 * push;
            v += STEP * push;
        }
        let folder = folder();
        write(&folder, "pushed.proof", PUSHED);
        write(&folder, "data.csv", csv("x,u", &timed(&rows)));
        let text = "title = \"A mass\"\nmodel = \"pushed.proof\"\n[data]\nrecord = \"data.csv\"\nspike = inf\ninterpolation = \"hold\"\n[sensor.x]\nnoise = 1e-3\n\
                    [sensor.u]\nnoise = 0.3\n[observer]\nmethods = [\"trust-region\"]\nestimate = [\"x\", \"v\"]\nguess = { x = 0.2, v = -0.1 }\nwhole = true\nsteps = 50\n";
        let (_, json) = observe(&write(&folder, "scene.toml", text), &[]);
        assert!(number(&json, "/observers/0/updates/0/fit/probability") > 1e-3, "{seed}");
        for ([value, deviation], truth) in found(&json, 0, "updates/0").into_iter().zip([0.3, -0.2]) {
            squares += ((value - truth) / deviation).powi(2);
            count += 1;
        }
    }
    let root = (squares / f64::from(count)).sqrt();
    assert!((0.5..1.3).contains(&root), "{root}");
}

/// Where nothing is: a window in which nothing was measured tells nothing and is not said to fit; one value alone; modes; what a column that is not whole cannot have; a recording
/// whose start is read off derivatives.
#[test]
fn where_nothing_was_measured_nothing_is_told() {
    let run = |rows: &[Cells], method: &str, changes: &[[&str; 2]]| {
        let folder = folder();
        let path = scene(&folder, &csv("x,v", &timed(rows)), &format!("\"{method}\""), NOISE);
        let text = std::fs::read_to_string(&path).unwrap();
        let text = changes.iter().fold(text, |text, [from, to]| {
            assert_eq!(text.matches(from).count(), 1, "{from}");
            text.replace(from, to)
        });
        observe(&write(&folder, "scene.toml", text), &["--no-times"])
    };
    let message = |(output, json): (std::process::Output, Value)| {
        assert_eq!(output.status.code(), Some(2), "{json}");
        json["error"]["message"].as_str().unwrap().to_owned()
    };
    let first = spring(5, 81, |row, _| row < 20);
    for method in ["newton", "trust-region", "multiple-shooting", "kalman", "unscented", "smoother"] {
        let (output, json) = run(&first, method, &[["whole = true", "window = 20"]]);
        assert!(output.status.code().is_some_and(|code| code < 2), "{method}: {json}");
        let alone = run(&first, method, &[["whole = true", "window = 20\ninherit = false"]]).1;
        let updates = alone["observers"][0]["updates"].as_array().unwrap();
        for update in updates.iter().filter(|update| update["from"].as_f64().unwrap() > 19.5 * STEP) {
            assert!(update["fit"]["fits"] != true && update["held"] == true, "{method}: {update}");
        }
        assert_eq!(updates.is_empty(), ["kalman", "unscented", "smoother"].contains(&method));
    }
    // one column of which nothing is; one value for each unknown, which leave no degree of freedom to test
    let one = spring(5, 40, |row, output| row == 7 && output == 0);
    assert!(message(run(&one, "trust-region", &[])).contains("nothing was measured of the column 'v'"));
    let two = spring(5, 40, |row, output| row == [7, 9][output]);
    let (_, json) = run(&two, "trust-region", &[]);
    assert_ne!(json["observers"][0]["updates"][0]["fit"]["fits"], true, "{json}");
    // systems side by side are told apart in windows that are cut out of the same columns
    let rows = spring(6, 81, |row, output| (row + output) % 2 == 0);
    let mode = "steps = 50\n[[observer.modes]]\nname = \"the same\"\nmodel = \"spring.proof\"\nestimate = [\"x\", \"v\"]\nguess = \"sample\"\n";
    let settings = "kalman = { process_noise = 0 }\nunscented = { process_noise = 0 }\n";
    let (output, json) = run(
        &rows,
        "trust-region",
        &[["whole = true", "window = 40"], [settings, ""], ["steps = 50\n", mode]],
    );
    assert!(output.status.code().is_some_and(|code| code < 2), "{json}");
    // starts by derivatives need curves: there is none, and others arrive
    let (output, json) =
        run(&rows, "multiple-shooting", &[["steps = 50", "steps = 50\nshooting = { derivatives = true }"]]);
    assert_eq!(output.status.code(), Some(0), "{json}");
    let known = [["steps = 50", "steps = 50\nknown = { \"x.delay\" = 0.01 }"]];
    assert!(message(run(&rows, "trust-region", &known)).contains("its delay cannot be undone"));
    let held = [
        ["spike = inf", "spike = inf\ninterpolation = \"hold\""],
        ["estimate = [\"x\", \"v\"]", "estimate = [\"x\", \"v\", \"x.delay\"]"],
        ["v = -0.4 }", "v = -0.4, \"x.delay\" = 0.01 }"],
    ];
    assert!(message(run(&rows, "trust-region", &held)).contains("where columns are held"));
}

/// Dates are seconds since the first of them, from a file and through a pipe; a unit of them is refused.
#[test]
fn dates_are_seconds() {
    let rows = spring(4, 61, |row, output| output == 0 || row % 2 == 0);
    let plain = csv("x,v", &timed(&rows));
    // 0.05 s apart, over midnight
    let date = |row: usize| {
        let after = 50 * row;
        match after < 1000 {
            true => format!("2024-02-28T23:59:59.{after:03}Z"),
            false => format!("2024-02-29T01:00:{:02}.{:03}+01:00", (after - 1000) / 1000, after % 1000),
        }
    };
    let dated: String = plain
        .lines()
        .enumerate()
        .map(|(place, line)| match place {
            0 => format!("{line}\n"),
            row => format!("{},{}\n", date(row - 1), line.split_once(',').unwrap().1),
        })
        .collect();
    let folder = folder();
    let read = |data: &str, more: &str| {
        observe(&scene(&folder, data, "\"trust-region\"", &format!("{NOISE}{more}")), &["--no-times"])
    };
    let (_, one) = read(&plain, "");
    let (output, other) = read(&dated, "");
    assert_eq!(output.status.code(), Some(0), "{other}");
    assert_eq!(other["time_origin"], "2024-02-28T23:59:59.000Z");
    for (a, b) in found(&one, 0, "updates/0")
        .into_iter()
        .flatten()
        .zip(found(&other, 0, "updates/0").into_iter().flatten())
    {
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
    let (output, refused) = read(&dated, "\n[columns]\ntime = { from = \"time\", unit = \"ms\" }");
    assert_eq!(output.status.code(), Some(2));
    assert!(refused["error"]["message"].as_str().unwrap().contains("dates"), "{refused}");
    // a stream has windows, and no 'whole'
    let path = scene(&folder, &dated, "\"trust-region\"", NOISE);
    let text = std::fs::read_to_string(&path)
        .unwrap()
        .replace("whole = true", "window = 60")
        .replace("data.csv", "-");
    let path = write(&folder, "stream.toml", text);
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_palmistry"))
        .args(["observe", path.to_str().unwrap(), "--json", "--no-times"])
        .stdin(std::process::Stdio::piped())
        .stdout(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    std::io::Write::write_all(&mut child.stdin.take().unwrap(), dated.as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    let line = String::from_utf8(output.stdout).unwrap();
    let window: Value = serde_json::from_str(line.lines().next().unwrap()).unwrap();
    assert_eq!(window["time_origin"], "2024-02-28T23:59:59.000Z", "{window}");
    // what was not measured is not compared in a stream either
    for ([a, _], [b, _]) in found(&one, 0, "updates/0").into_iter().zip(found(&window, 0, "updates/0")) {
        assert!((a - b).abs() < 1e-6, "{a} {b}");
    }
}

/// What is no gap of a sensor is what it was: a row that was cut off, a word, a column of nothing; a method that needs all.
#[test]
fn what_is_damaged_is_not_taken_for_unmeasured() {
    let rows = spring(3, 60, |row, output| output == 0 || row % 2 == 0);
    let good = csv("x,v", &timed(&rows));
    let refused = |data: &str, methods: &str| {
        let folder = folder();
        let (output, json) = observe(&scene(&folder, data, methods, NOISE), &[]);
        (output.status.code(), format!("{}", json["error"]["message"]), json)
    };
    let line = good.lines().nth(7).unwrap();
    let cut = good.replace(line, line.split(',').next().unwrap());
    let (status, message, _) = refused(&cut, "\"kalman\"");
    assert!(
        status == Some(2) && message.contains("line 8") && message.contains("nothing there"),
        "{message}"
    );
    let word = good.replace(line, &format!("{}n/a", &line[..line.rfind(',').unwrap() + 1]));
    let (status, message, _) = refused(&word, "\"kalman\"");
    assert!(status == Some(2) && message.contains("is no number"), "{message}");
    let nothing = spring(3, 60, |_, output| output == 0);
    let (status, message, _) = refused(&csv("x,v", &timed(&nothing)), "\"kalman\"");
    assert!(status == Some(2) && message.contains("nothing was measured of the column 'v'"), "{message}");
    let (_, _, json) = refused(&good, "\"high-gain\"");
    assert!(json.to_string().contains("v was not measured in some"), "{json}");
}

/// A robot's log: ranges to four modules in turn with heavy tails, wheel speeds in each row; nothing is known of the pose. An independent least squares with a robust loss is 0.062 m off the truth (rms) and
/// finds the wheels twice as far apart as the file says, right and left exchanged. What is left is no independent noise, and that is said.
#[test]
fn a_robot_s_log_tells_where_it_was() {
    let folder = folder();
    let home = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/recordings/uwb_labyrinth");
    let track = folder.path().join("track.csv");
    let (output, json) = observe(&home.join("robot.toml"), &["--track", track.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(1), "{json}");
    let state =
        |name: &str, what: &str| number(&json, &format!("/observers/0/updates/0/states/{name}/{what}"));
    assert!((1.0 / state("w", "recovered") + 0.159).abs() < 0.003, "{}", state("w", "recovered"));
    assert!((0.05..0.16).contains(&state("c", "recovered")));
    assert!(number(&json, "/observers/0/updates/0/fit/probability") < 1e-3);
    let names = ["time", "x", "y"];
    let (track, truth) = (table(&track, names), table(&home.join("truth.csv"), names));
    let square = |[own, other]: [&[f64; 3]; 2]| {
        assert!((own[0] - other[0]).abs() < 1e-6);
        (own[1] - other[1]).powi(2) + (own[2] - other[2]).powi(2)
    };
    assert_eq!(track.len(), truth.len());
    let mean = track.iter().zip(&truth).map(|(a, b)| square([a, b])).sum::<f64>() / track.len() as f64;
    assert!(mean.sqrt() < 0.065, "{}", mean.sqrt());
    assert_eq!(json["sparse"].as_array().map(Vec::len), Some(4));
}
