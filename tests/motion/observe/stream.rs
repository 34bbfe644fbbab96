//! Readings that arrive: real processes, pipes and signals.
//!
//! Oracles: the same measurements from a file, and the operating system.

use crate::common::{folder, palmistry, write};
use crate::observe::observe;
use serde_json::Value;
use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

/// Nothing here takes a tenth of it.
const HUNG: Duration = Duration::from_secs(240);

const MODEL: &str = "system \"A spring of unknown stiffness\" state x : m, v : m/s, k : 1/s^2 drift f x' = v v' = -k*x k' = 0 output x \
                     sample x in [-2, 2] v in [-2, 2] k in [1, 5]";

const SCENE: &str = "title = \"A spring\"\nmodel = \"spring.proof\"\nduration = 8\nsamples = 401\nseed = 5\n[start]\nx = 0.7\nv = -0.9\nk = 2.3\n\
                     [sensor]\nnoise = 0.001\n[observer]\nmethods = [\"trust-region\", \"kalman\"]\nestimate = [\"x\", \"v\", \"k\"]\n\
                     guess_off = 0.05\nwindow = 80\nsteps = 30\n";

/// A scene of a spring in a folder, and the file of what is read of it.
fn spring(scene: &str) -> (tempfile::TempDir, PathBuf, String) {
    let folder = folder();
    write(&folder, "spring.proof", MODEL);
    let scene = write(&folder, "spring.toml", scene);
    let output = palmistry(&["observe", scene.to_str().unwrap(), "--record", "-"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let measurements = String::from_utf8(output.stdout).unwrap();
    // nothing but the measurements is printed
    assert_eq!(measurements.lines().count(), 402);
    assert!(measurements.lines().skip(1).all(|line| line.split(',').all(|cell| cell.parse::<f64>().is_ok())));
    (folder, scene, measurements)
}

/// The program that listens.
fn listening(scene: &Path) -> (Child, Receiver<Value>) {
    let mut child = Command::new(env!("CARGO_BIN_EXE_palmistry"))
        .args(["observe", scene.to_str().unwrap(), "--data", "-", "--json"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let (sender, lines) = channel();
    let out = BufReader::new(child.stdout.take().unwrap());
    std::thread::spawn(move || {
        for line in out.lines() {
            // whatever is printed, errors too
            let line = line.unwrap();
            let found = serde_json::from_str::<Value>(&line).unwrap_or_else(|why| panic!("{why}: {line}"));
            if sender.send(found).is_err() {
                break;
            }
        }
    });
    (child, lines)
}

/// What a run has come to: the lines that were left, the exit status, and the words.
fn end_of(mut child: Child, lines: &Receiver<Value>) -> (Vec<Value>, Option<i32>, String) {
    drop(child.stdin.take());
    let mut left = Vec::new();
    while let Ok(line) = lines.recv_timeout(HUNG) {
        left.push(line);
    }
    let status = child.wait().unwrap();
    let mut words = String::new();
    child.stderr.take().unwrap().read_to_string(&mut words).unwrap();
    assert!(!words.contains("panicked"), "{words}");
    (left, status.code(), words)
}

fn rows(measurements: &str, range: std::ops::Range<usize>) -> String {
    measurements.lines().skip(range.start).take(range.len()).map(|line| format!("{line}\n")).collect()
}

fn state(update: &Value, name: &str, what: &str) -> f64 {
    update["states"][name][what].as_f64().unwrap_or_else(|| panic!("{name} {what}: {update}"))
}

#[test]
fn what_is_piped_gives_what_a_file_gives() {
    let (folder, scene, measurements) = spring(SCENE);
    let line = "\"$0\" observe \"$1\" --record - | \"$0\" observe \"$1\" --data - --json";
    let output = Command::new("bash")
        .args(["-c", line, env!("CARGO_BIN_EXE_palmistry"), scene.to_str().unwrap()])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    let lines: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let (end, windows) = lines.split_last().unwrap();
    assert_eq!((end["ended"].as_str(), end["windows"].as_u64()), (Some("whole"), Some(5)), "{end}");
    assert_eq!(end["rows"].as_u64(), Some(401));
    let file = write(&folder, "spring.csv", measurements);
    let (output, whole) = observe(&scene, &["--data", file.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{whole}");
    let updates = whole["observers"][0]["updates"].as_array().unwrap();
    assert_eq!((updates.len(), windows.len()), (5, 5));
    for (i, (window, update)) in windows.iter().zip(updates).enumerate() {
        let own = &window["observers"][0]["updates"][0];
        assert_eq!(own["inherits"].as_bool(), (i > 0).then_some(true), "{own}");
        for name in ["x", "v", "k"] {
            // the curves between samples are the same but for rounding
            let bound = state(update, name, "bound");
            assert!((state(own, name, "recovered") - state(update, name, "recovered")).abs() < 1e-6 * bound);
            assert!((state(own, name, "bound") / bound - 1.0).abs() < 1e-6);
        }
    }
    for place in 0..2 {
        let (last, end) = (&windows[4]["observers"][place]["end"], &whole["observers"][place]["end"]);
        for name in ["x", "v", "k"] {
            assert!((state(last, name, "recovered") - state(end, name, "recovered")).abs() < 1e-9, "{place}");
        }
    }
    // a filter says how well it knows
    assert!(state(&windows[4]["observers"][1]["end"], "k", "bound") > 0.0);
}

/// A window is answered as soon as its rows are there with the few after it, while the writer still writes; and what was
/// asked to stop keeps what it had.
#[test]
fn answers_arrive_before_the_stream_ends_and_stay_when_it_is_stopped() {
    let (_folder, scene, measurements) = spring(SCENE);
    for name in ["INT", "TERM"] {
        let (mut child, lines) = listening(&scene);
        let mut input = child.stdin.take().unwrap();
        // cut in the middle of rows
        for piece in rows(&measurements, 0..110).as_bytes().chunks(999) {
            input.write_all(piece).unwrap();
            input.flush().unwrap();
        }
        let first = lines.recv_timeout(HUNG).expect("an answer while the stream goes on");
        assert_eq!((first["window"].as_u64(), first["samples"].as_u64()), (Some(1), Some(81)));
        let sent = Command::new("kill").args([&format!("-{name}"), &child.id().to_string()]).status();
        assert!(sent.unwrap().success());
        // the writer is still there
        let (left, status, words) = {
            let mut left = Vec::new();
            while let Ok(line) = lines.recv_timeout(HUNG) {
                left.push(line);
            }
            let status = child.wait().unwrap().code();
            let mut words = String::new();
            child.stderr.take().unwrap().read_to_string(&mut words).unwrap();
            (left, status, words)
        };
        drop(input);
        assert_eq!(status, Some(3), "{name}: {words}");
        assert!(words.contains("cut off: interrupted"), "{words}");
        let end = left.last().unwrap();
        assert_eq!((end["ended"].as_str(), end["interrupted"].as_bool()), (Some("interrupted"), Some(true)));
        assert!(end["windows"].as_u64().unwrap() >= 1);
    }
}

#[test]
fn a_faulty_row_ends_a_stream_or_is_skipped() {
    let (_folder, scene, measurements) = spring(SCENE);
    let row = measurements.lines().nth(200).unwrap();
    let broken = measurements.replacen(row, &format!("{},abc", row.split(',').next().unwrap()), 1);
    let (mut child, lines) = listening(&scene);
    child.stdin.take().unwrap().write_all(broken.as_bytes()).unwrap();
    let (left, status, words) = end_of(child, &lines);
    assert_eq!(status, Some(2), "{words}");
    let (end, windows) = left.split_last().unwrap();
    // two windows lie before it, and a part of the third
    assert_eq!(windows.len(), 3, "{end}");
    assert_eq!(windows[2]["samples"].as_u64(), Some(39));
    let message = end["error"]["message"].as_str().unwrap();
    for word in ["row 200", "line 201", "x", "abc"] {
        assert!(message.contains(word) && words.contains(word), "{word}: {message}, {words}");
    }
    let skip = format!("{SCENE}[data]\non_fault = \"skip\"\n");
    let (_folder, scene, _) = spring(&skip);
    let (mut child, lines) = listening(&scene);
    child.stdin.take().unwrap().write_all(broken.as_bytes()).unwrap();
    let (left, status, words) = end_of(child, &lines);
    assert_eq!(status, Some(0), "{words}");
    let end = left.last().unwrap();
    assert_eq!((end["ended"].as_str(), end["faulty_rows"].as_u64()), (Some("whole"), Some(1)), "{end}");
    let faults: Vec<&str> = left
        .iter()
        .filter_map(|line| line["faults"].as_array())
        .flatten()
        .filter_map(Value::as_str)
        .collect();
    assert!(faults.len() == 1 && faults[0].contains("line 201"), "{faults:?}");
}

#[test]
fn a_row_that_is_cut_off_is_none() {
    let (_folder, scene, measurements) = spring(SCENE);
    for cut in ["4.0,0.12", "4.0,", "4."] {
        let text = rows(&measurements, 0..201) + cut;
        let (mut child, lines) = listening(&scene);
        child.stdin.take().unwrap().write_all(text.as_bytes()).unwrap();
        let (left, status, words) = end_of(child, &lines);
        assert_eq!(status, Some(3), "{words}");
        let end = left.last().unwrap();
        assert!(end["ended"].as_str().unwrap().contains("line 202 has no end"), "{end}");
        assert_eq!((end["windows"].as_u64(), end["rows"].as_u64()), (Some(3), Some(200)));
        assert!(words.contains("line 202"), "{words}");
    }
}

#[test]
fn nobody_listens_any_more() {
    let (_folder, scene, measurements) = spring(SCENE);
    let line = "\"$0\" observe \"$1\" --data - --json | head -c 10 > /dev/null; exit ${PIPESTATUS[0]}";
    let mut child = Command::new("bash")
        .args(["-c", line, env!("CARGO_BIN_EXE_palmistry"), scene.to_str().unwrap()])
        .stdin(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut input = child.stdin.take().unwrap();
    let _ = input.write_all(measurements.as_bytes());
    let mut time = 8.0;
    for _ in 0..20_000 {
        time += 0.02;
        if input.write_all(format!("{time},0.1\n").as_bytes()).is_err() {
            // who writes on is told by the system
            break;
        }
    }
    drop(input);
    let output = child.wait_with_output().unwrap();
    let words = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{words}");
    assert!(words.contains("nobody reads"), "{words}");
}

/// Before anything is read, and where the command line is not understood: one line, and that an object.
#[test]
fn errors_of_a_stream_are_lines_too() {
    let (folder, scene, _) = spring(SCENE);
    let piped = SCENE.replace("duration = 8\nsamples = 401\n", "");
    let piped = piped.replace("[start]\nx = 0.7\nv = -0.9\nk = 2.3\n", "[data]\nrecord = \"-\"\n");
    let piped = piped.replace("guess_off = 0.05", "guess = { x = 0.7, v = -0.9, k = 2.3 }");
    let from_scene = write(&folder, "piped.toml", piped);
    let (scene, from_scene) = (scene.to_str().unwrap(), from_scene.to_str().unwrap());
    for arguments in [
        &["observe", "missing.toml", "--data", "-"][..],
        &["observe", scene, "--data", "-", "--no-such-word"],
        &["observe", scene, "--data=-", "--no-such-word"],
        &["observe", scene, "--data", "-", "--out", "x"],
        &["observe", from_scene],
        &["prove", "--watch", "--no-such-word"],
    ] {
        let output = palmistry(&[arguments, &["--json"]].concat());
        let text = String::from_utf8(output.stdout).unwrap();
        assert_eq!((output.status.code(), text.lines().count()), (Some(2), 1), "{arguments:?}: {text}");
        let object: Value = serde_json::from_str(&text).unwrap();
        assert!(object["error"].is_object(), "{arguments:?}: {text}");
    }
}

#[test]
fn what_a_stream_cannot_do_is_refused() {
    let (folder, scene, _) = spring(SCENE);
    for (arguments, word) in [
        (&["--data", "-", "--out", "x"][..], "--out"),
        (&["--data", "-", "--studies"], "--studies"),
        (&["--data", "-", "--track", "x.csv"], "--track"),
        (&["--record", "-", "--json"], "--json"),
        (&["--record", "-", "--out", "x"], "--out"),
    ] {
        let output = palmistry(&[&["observe", scene.to_str().unwrap()], arguments].concat());
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(String::from_utf8_lossy(&output.stderr).contains(word), "{arguments:?}");
    }
    let whole = write(&folder, "whole.toml", SCENE.replace("window", "whole = true\nwindow"));
    for (scene, text, word) in [
        (&scene, "", "no rows"),
        (&scene, "time,y\n0,1\n1,1\n2,1\n", "'x'"),
        (&scene, "time,x\n0,1\n", "one row"),
        (&scene, "time,x\n", "no rows"),
        (&whole, "time,x\n0,1\n", "no whole"),
    ] {
        let (mut child, lines) = listening(scene);
        let _ = child.stdin.take().unwrap().write_all(text.as_bytes());
        let (left, status, words) = end_of(child, &lines);
        assert!(matches!(left.as_slice(), [only] if only["error"].is_object()), "{left:?}");
        assert_eq!(status, Some(2), "{text:?}: {words}");
        assert!(words.contains(word), "{text:?}: {words}");
    }
}

/// A column that stands still in the first window is a constant of the model there, and what comes after may be otherwise: the answers go on with it.
#[test]
fn a_column_may_change_after_the_first_window() {
    let folder = folder();
    write(
        &folder,
        "cart.proof",
        "system \"A cart that is pushed\" state x : m, v : m/s known u(t) : m/s^2 drift f x' = v v' = u output x \
         sample x in [-2, 2] v in [-2, 2]",
    );
    let scene = "title = \"A cart\"\nmodel = \"cart.proof\"\nseed = 3\n[data]\nrecord = \"-\"\n[sensor]\nnoise = 0.001\n[observer]\n\
                 methods = [\"trust-region\", \"kalman\"]\nestimate = [\"x\", \"v\"]\nguess = { x = 0.1, v = 0.1 }\nwindow = 50\n";
    let scene = write(&folder, "cart.toml", scene);
    // pushed evenly from the hundredth step on: x by hand; measurements err by a wave below the noise
    let step = 0.01;
    let mut text = "time,x,u\n".to_owned();
    for i in 0..301 {
        let (t, late) = (step * f64::from(i), step * f64::from((i - 100).max(0)));
        let push = if i >= 100 { 0.8 } else { 0.0 };
        let x = 0.2 + 0.3 * t + 0.4 * late * late + 0.0008 * f64::from(i * i).sin();
        text += &format!("{t:?},{x:?},{push:?}\n");
    }
    let (mut child, lines) = listening(&scene);
    child.stdin.take().unwrap().write_all(text.as_bytes()).unwrap();
    let (left, _, words) = end_of(child, &lines);
    let (end, windows) = left.split_last().unwrap();
    assert_eq!((end["ended"].as_str(), windows.len()), (Some("whole"), 6), "{end} {words}");
    let remarks: Vec<String> =
        windows.iter().map(|window| window["observers"][0]["remarks"].to_string()).collect();
    let told: Vec<bool> = remarks.iter().map(|remarks| remarks.contains("'u' changes")).collect();
    assert_eq!(told.iter().filter(|told| **told).count(), 1, "{remarks:?}");
    // the speed at the end is 0.3 + 0.8 * 2
    let last = &windows[5]["observers"][0]["end"];
    assert!((state(last, "v", "recovered") - 1.9).abs() < 0.02, "{last}");
}

/// A window that cannot see is answered at once, and its rows are read again with those of the next: as of a file. By hand, four steps of 0.05 s tell the speed of 0.5 to 0.32 and eight to
/// 0.13, which is less than a third of it.
#[test]
fn blind_windows_grow() {
    let folder = folder();
    let model =
        "system \"A point\" state x, v drift f x' = v v' = 0 output x sample x in [-5, 5] v in [-5, 5]";
    write(&folder, "spring.proof", model);
    let scene = "title = \"A point\"\nmodel = \"spring.proof\"\nduration = 10\nsamples = 201\n[start]\nx = 1.0\nv = 0.5\n[sensor]\nnoise = 0.05\n\
                 [observer]\nmethods = [\"trust-region\", \"kalman\"]\nestimate = [\"x\", \"v\"]\nguess = { x = 0.3, v = 0.1 }\nwindow = 4\nsteps = 20\n";
    let scene = write(&folder, "point.toml", scene);
    let file = folder.path().join("x.csv");
    let (_, whole) = observe(&scene, &["--record", file.to_str().unwrap()]);
    let (mut child, lines) = listening(&scene);
    let measurements = std::fs::read_to_string(&file).unwrap();
    child.stdin.as_mut().unwrap().write_all(measurements.as_bytes()).unwrap();
    let (told, status, words) = end_of(child, &lines);
    assert_eq!(status, Some(0), "{words}");
    assert_eq!((told.len(), told[50]["rows"].as_u64()), (51, Some(201)));
    let updates = whole["observers"][0]["updates"].as_array().unwrap();
    assert_eq!(updates.len(), 50);
    for (window, update) in told.iter().zip(updates) {
        let own = &window["observers"][0]["updates"][0];
        for key in ["from", "to", "status", "inherits"] {
            assert_eq!(own[key], update[key], "{own}");
        }
        for name in ["x", "v"] {
            let off = state(own, name, "recovered") - state(update, name, "recovered");
            assert!(off.abs() < 1e-6 * state(update, name, "bound"), "{own}");
        }
    }
    let spans: Vec<[f64; 2]> =
        updates.iter().take(4).map(|u| ["from", "to"].map(|key| u[key].as_f64().unwrap())).collect();
    let near = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).abs() + (a[1] - b[1]).abs() < 1e-9;
    let expected = [[0.0, 0.2], [0.0, 0.4], [0.4, 0.6], [0.6, 0.8]];
    assert!(spans.iter().zip(expected).all(|(a, b)| near(*a, b)), "{spans:?}");
    // the filter goes on from where it was, and reads nothing twice
    let ends = told[..50].iter().map(|window| &window["observers"][1]["end"]["time"]);
    assert!(ends.clone().zip(1..).all(|(end, k)| (end.as_f64().unwrap() - 0.2 * f64::from(k)).abs() < 1e-9));
}

/// The innovations of a filter are those of the file, whatever the pieces; a step that the model does not know fails by them at the end.
#[test]
fn a_filter_alone_is_tested_at_the_end() {
    let (folder, scene, measurements) = spring(&SCENE.replace("\"trust-region\", \"kalman\"", "\"kalman\""));
    let header = measurements.lines().next().unwrap();
    let stepped = measurements.lines().skip(1).map(|row| {
        let cells: Vec<f64> = row.split(',').map(|cell| cell.parse().unwrap()).collect();
        format!("{:?},{:?}\n", cells[0], cells[1] + if cells[0] > 4.0 { 0.05 } else { 0.0 })
    });
    let stepped = format!("{header}\n{}", stepped.collect::<String>());
    for (text, fits) in [(&measurements, true), (&stepped, false)] {
        let file = write(&folder, "measurements.csv", text);
        let (output, whole) = observe(&scene, &["--data", file.to_str().unwrap()]);
        assert_eq!(output.status.code(), Some(i32::from(!fits)), "{whole}");
        let (mut child, lines) = listening(&scene);
        child.stdin.as_mut().unwrap().write_all(text.as_bytes()).unwrap();
        let (left, status, words) = end_of(child, &lines);
        assert_eq!(status, Some(i32::from(!fits)), "{words}");
        let own = &left.last().unwrap()["observers"][0]["innovations"];
        let other = &whole["observers"][0]["innovations"];
        println!("{own}\n{other}");
        assert_eq!(own["fits"], fits);
        let ratio = own["chi_square"].as_f64().unwrap() / other["chi_square"].as_f64().unwrap();
        assert!((ratio - 1.0).abs() < 0.05, "{own} {other}");
    }
}
