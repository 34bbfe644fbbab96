//! Columns of recordings that have other names and units than the model.
//!
//! Oracle: the same numbers in the model's own names and units, converted by hand.

use crate::common::{folder, palmistry, write};
use crate::observe::{observe, refusal};
use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Stdio};

const MODEL: &str = "system \"A pendulum on a rail\" state phi : angle, omega : 1/s, s : m angle phi param k = 4 : 1/s^2 known u(t) : m/s \
                     drift f phi' = omega omega' = -k*sin(phi) s' = u output phi, s + 2*s sample phi in [-1, 1] omega in [-2, 2] s in [-1, 1]";

const SCENE: &str = "title = \"A pendulum\"\nmodel = \"pendulum.proof\"\nduration = 4\nsamples = 81\n[start]\nphi = 0.8\nomega = 0.3\ns = 0.2\n\
                     [inputs]\nu = \"0.1*cos(t)\"\n[sensor]\nnoise = 1e-3\n[observer]\nmethods = [\"trust-region\"]\n\
                     estimate = [\"phi\", \"omega\", \"s\"]\nguess_off = 0.1\nwindow = 80\nsteps = 20\n";

const COLUMNS: &str = "[columns]\ntime = { from = \"t_ms\", unit = \"ms\" }\nphi = { from = \"angle\", unit = \"deg\" }\nu = { from = \"speed\", unit = \"mm/s\" }\n";

fn scenes() -> (tempfile::TempDir, PathBuf, PathBuf) {
    let folder = folder();
    write(&folder, "pendulum.proof", MODEL);
    let plain = write(&folder, "plain.toml", SCENE);
    let named = write(&folder, "named.toml", format!("{SCENE}{COLUMNS}"));
    (folder, plain, named)
}

#[test]
fn a_recording_in_other_units_gives_the_same_answer() {
    let (folder, plain, named) = scenes();
    let own = folder.path().join("own.csv");
    let (output, expected) = observe(&plain, &["--record", own.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{expected}");
    // by hand: milliseconds, degrees, millimetres a second, in another order and with a column of words
    let text = std::fs::read_to_string(&own).unwrap();
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    assert_eq!(header, ["time", "phi", "s + 2*s", "u"]);
    let mut other = "note,speed,angle,s + 2*s,t_ms\n".to_owned();
    for line in lines {
        let v: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        other += &format!("ok,{:?},{:?},{:?},{:?}\n", 1e3 * v[3], v[1].to_degrees(), v[2], 1e3 * v[0]);
    }
    let file = write(&folder, "other.csv", &other);
    let (output, found) = observe(&named, &["--data", file.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{found}");
    let state = |found: &serde_json::Value, name: &str| {
        found["observers"][0]["updates"][0]["states"][name]["recovered"].as_f64().unwrap()
    };
    for name in ["phi", "omega", "s"] {
        assert!((state(&found, name) - state(&expected, name)).abs() < 1e-9, "{name}");
    }
    // the same from a stream
    let mut child = Command::new(env!("CARGO_BIN_EXE_palmistry"))
        .args(["observe", named.to_str().unwrap(), "--data", "-", "--json"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(other.as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    let text = String::from_utf8(output.stdout).unwrap();
    let first: serde_json::Value = serde_json::from_str(text.lines().next().unwrap()).unwrap();
    for name in ["phi", "omega", "s"] {
        let own = first["observers"][0]["updates"][0]["states"][name]["recovered"].as_f64().unwrap();
        assert!((own - state(&expected, name)).abs() < 1e-9, "{name}");
    }
    // what such a scene records has its own names and units, and gives its own answer, from either kind of file
    for name in ["again.csv", "again.parquet"] {
        let file = folder.path().join(name);
        let (_, first) = observe(&named, &["--record", file.to_str().unwrap()]);
        let (_, second) = observe(&named, &["--data", file.to_str().unwrap()]);
        for name in ["phi", "omega", "s"] {
            assert_eq!(state(&first, name), state(&second, name), "{name}");
            assert!((state(&first, name) - state(&expected, name)).abs() < 1e-9, "{name}");
        }
    }
    let text = std::fs::read_to_string(folder.path().join("again.csv")).unwrap();
    assert!(text.starts_with("t_ms,angle,s + 2*s,speed\n"), "{text}");
    assert!(text.lines().last().unwrap().starts_with("4000.0,"), "{text}");
}

#[test]
fn faults_and_missing_columns_have_their_names_in_the_file() {
    let (folder, _, named) = scenes();
    let file = folder.path().join("x.csv");
    let output = palmistry(&["observe", named.to_str().unwrap(), "--record", file.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0));
    let text = std::fs::read_to_string(&file).unwrap();
    let lost = write(&folder, "lost.csv", text.replacen("angle", "angles", 1));
    let (output, found) = observe(&named, &["--data", lost.to_str().unwrap()]);
    let (message, help) = refusal(&output, &found);
    assert!(
        message.contains("no column 'angle'") && help.contains("'angles'") && help.contains("'phi'"),
        "{message}: {help}"
    );
    let row = text.lines().nth(5).unwrap();
    let cells: Vec<&str> = row.split(',').collect();
    let faulty = write(
        &folder,
        "faulty.csv",
        text.replacen(row, &format!("{},oops,{},{}", cells[0], cells[2], cells[3]), 1),
    );
    let (output, found) = observe(&named, &["--data", faulty.to_str().unwrap()]);
    let (message, _) = refusal(&output, &found);
    assert!(message.contains("line 6") && message.contains("angle") && message.contains("oops"), "{message}");
}

#[test]
fn mistakes_in_columns_are_pointed_at() {
    let (folder, ..) = scenes();
    for (columns, words) in [
        ("phi = { from = \"a\", unit = \"degre\" }", ["degre", "deg"]),
        ("s = { unit = \"deg\" }", ["in m", "number"]),
        ("time = { unit = \"mm\" }", ["in s", "in m"]),
        ("omegas = \"w\"", ["omegas", "omega"]),
        ("phi = { factor = 0 }", ["factor", "leave"]),
        ("phi = \"a\"\nu = \"a\"", ["twice", "leave"]),
        ("phi = { form = \"a\" }", ["form", "from"]),
        ("phi = \"\"", ["empty", "name"]),
    ] {
        let scene = write(&folder, "wrong.toml", format!("{SCENE}[columns]\n{columns}\n"));
        let (output, found) = observe(&scene, &[]);
        let (message, help) = refusal(&output, &found);
        let all = format!("{message} {help}");
        assert!(words.iter().all(|word| all.contains(word)), "{columns}: {all}");
    }
}
