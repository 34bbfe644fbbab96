//! Questions and answers, without a browser.

use super::Lab;
use crate::common::{folder, json, palmistry, write};
use serde_json::{Value, json};
use std::io::Write;
use std::net::TcpStream;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

const TEXT: &str = "system \"A pendulum\"\nstate phi, omega\nparam k = 2\nangle phi\ndrift f\n  phi' = omega\n  omega' = -k*sin(phi)\noutput phi\n\
                    sample phi in [-3, 3] omega in [-2, 2]\nclaim good: L(f, f, phi) = -k*sin(phi)\nclaim bad: L(f, omega) = k*sin(phi)\nclaim seen: rank = 2\n";

/// A verdict without what depends on the moment and on the place.
fn verdict(claim: &Value) -> Value {
    let keys = ["id", "verdict", "expected", "ok", "statement", "engine", "error_bound", "witness"];
    keys.iter().map(|key| (key.to_string(), claim[key].clone())).collect::<serde_json::Map<_, _>>().into()
}

/// Of a system of somebody's own and of the thesis's general one: each verdict, the table of unknowns, the values, the sets. All of them are
/// those of the commands.
#[test]
fn answers_are_those_of_the_commands() {
    let (lab, folder) = (Lab::open(), folder());
    let own = write(&folder, "own.proof", TEXT);
    let general =
        std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/proofs/moll2002/general.proof"));
    let general = general.expect("it is there");
    let cases = [
        (TEXT, "own.proof", own.to_str().unwrap()),
        (&general, "papers:moll2002/general.proof", "proofs/moll2002/general.proof"),
    ];
    for (text, name, path) in cases {
        let draft = lab.last(&json!({ "ask": "draft", "text": text, "file": name }));
        assert_eq!(draft["problems"], json!([]), "{name}");
        let ids: Vec<&Value> = draft["claims"].as_array().unwrap().iter().map(|claim| &claim["id"]).collect();
        let mut lines =
            lab.ask("answer", &json!({ "ask": "claims", "text": text, "file": name, "only": ids }));
        assert_eq!(lines.pop().unwrap()["kind"], "done");
        let mut found: Vec<Value> = lines.iter().map(|line| verdict(&line["claim"])).collect();
        let whole = json(&palmistry(&["prove", path, "--json"]));
        let mut expected: Vec<Value> = whole["claims"].as_array().unwrap().iter().map(verdict).collect();
        let by_id = |claims: &mut Vec<Value>| claims.sort_by_key(|claim| claim["id"].to_string());
        by_id(&mut found);
        by_id(&mut expected);
        assert_eq!(found, expected, "{name}");
        let rank =
            lab.last(&json!({ "ask": "rank", "samples": 100, "text": text, "file": name }))["rank"].clone();
        let expected = json(&palmistry(&["rank", path, "--samples", "100", "--json"]));
        for key in ["unknowns", "generic", "rank_histogram", "certified", "fixed_at_the_files_values"] {
            assert_eq!(rank[key], expected[key], "{name}: {key}");
        }
    }
    let drops = lab.last(&json!({ "ask": "drops", "text": TEXT }));
    let expected = json(&palmistry(&["rank", own.to_str().unwrap(), "--singular-set", "--json"]));
    assert_eq!((&drops["drops"]["sets"], &drops["drops"]["exact"]), (&expected["sets"], &expected["exact"]));
    let rational = "system \"r\"\nstate x\nparam k unknown\ndrift f x' = -k^2*x\noutput x\n";
    let values = lab.last(&json!({ "ask": "values", "functions": true, "text": rational }));
    let path = write(&folder, "r.proof", rational);
    let expected = json(&palmistry(&["rank", path.to_str().unwrap(), "--functions", "--json"]));
    for key in ["unknowns", "identifiable_functions"] {
        assert_eq!(values["global"][key], expected[key], "{key}");
    }
}

/// What did not change is not decided again: keys change with the system and with the claim itself, and with nothing else.
#[test]
fn a_key_changes_with_what_a_verdict_depends_on() {
    let lab = Lab::open();
    let keys = |text: &str| -> Vec<(String, String)> {
        let draft = lab.last(&json!({ "ask": "draft", "text": text }));
        let claims = draft["claims"].as_array().unwrap().iter();
        claims
            .map(|claim| {
                (claim["id"].as_str().unwrap().to_owned(), claim["key"].as_str().unwrap().to_owned())
            })
            .collect()
    };
    let first = keys(TEXT);
    let changed = |text: String| -> Vec<String> {
        keys(&text).into_iter().filter(|pair| !first.contains(pair)).map(|(id, _)| id).collect()
    };
    let none: Vec<String> = Vec::new();
    assert_eq!(changed(TEXT.replace("output phi", "# a remark\n\noutput phi")), none);
    assert_eq!(changed(TEXT.replace("claim good", "\n\nclaim good")), none);
    assert_eq!(changed(TEXT.replace("= k*sin(phi)\n", "= -k*sin(phi)\n")), ["bad"]);
    assert_eq!(changed(TEXT.replace("param k = 2", "param k = 3")), ["good", "bad", "seen"]);
    assert_eq!(changed(TEXT.replace("-k*sin(phi)\noutput", "-k*cos(phi)\noutput")), ["good", "bad", "seen"]);
    // how many derivatives of a signal there are follows from all claims
    let driven = "system \"s\"\nknown u(t)\nstate x, v\nparam k unknown\ndrift f\n  x' = v\n  v' = -k*x + u\noutput x\nclaim p: rank = 3 everywhere\n";
    let more = format!("{driven}claim z: d(u'', u'') = [1]\n");
    assert_ne!(keys(driven)[0], keys(&more)[0]);
    // one that rests on another one depends on that, too
    let follows = format!("{TEXT}claim more restates good: L(f, f, phi) = -k*sin(phi)\n");
    let [one, other] = [follows.clone(), follows.replace("claim bad", "claim worse")].map(|text| keys(&text));
    assert_ne!(one.last(), other.last());
}

/// Two starts along the direction that one beacon does not tell: the same outputs, other states; by a rotation that is known in closed form.
#[test]
fn two_starts_with_the_same_outputs() {
    let lab = Lab::open();
    let text = std::fs::read_to_string(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/proofs/martinelli2005/one_beacon.proof"
    ))
    .unwrap();
    let (x, y, theta, angle) = (1.0, 0.5, 0.3, 0.8_f64);
    let found = lab.last(&json!({
        "ask": "motion", "text": text, "start": { "x": x, "y": y, "theta": theta }, "inputs": { "drive": "1", "turn": "sin(t)" },
        "duration": 4.0, "samples": 50, "along": [0, angle],
    }));
    let second = &found["second"]["start"];
    let near = |name: &str, value: f64| (second[name].as_f64().unwrap() - value).abs() < 1e-9;
    // the field is (-y, x, 1): everything turns about the beacon
    assert!(
        near("x", x * angle.cos() - y * angle.sin()) && near("y", x * angle.sin() + y * angle.cos()),
        "{second}"
    );
    assert!(near("theta", theta + angle), "{second}");
    assert!(found["second"]["difference"].as_f64().unwrap() < 1e-9);
    let state = |motion: &Value| motion["states"][0]["values"][20].as_f64().unwrap();
    assert!((state(&found) - state(&found["second"])).abs() > 0.1);
}

/// A recording that another run simulated: the rate and the constant are found, with a unit that is another and names that are.
#[test]
fn a_recording_that_is_dropped_is_estimated_from() {
    let lab = Lab::open();
    let rows: Vec<String> = (0..200)
        .map(|i| {
            let t = f64::from(i) * 0.02;
            // x'' = -4 x: in closed form
            format!("{},{}", t * 1000.0, 30.0 * (2.0 * t).cos())
        })
        .collect();
    let csv = format!("ms,deflection\n{}\n", rows.join("\n"));
    let text = "system \"A spring\"\nstate x, v\nparam k = 3   # over mass\ndrift f\n  x' = v\n  v' = -k*x\noutput x\nsample x in [-1, 1] v in [-1, 1]\n";
    let columns =
        json!({ "time": { "from": "ms", "unit": "ms" }, "x": { "from": "deflection", "unit": null } });
    let mut lines = lab.ask(
        "answer",
        &json!({
            "ask": "observe", "text": text, "estimate": ["x", "v", "k"], "window": 199,
            "from": { "record": { "csv": csv, "columns": columns } },
        }),
    );
    let (page, found) = (lines.pop().expect("a page"), lines.pop().expect("an answer"));
    assert_eq!(found["kind"], "done", "{found}");
    let states = &found["observed"]["observers"][0]["end"]["states"];
    assert!((states["k"]["recovered"].as_f64().unwrap() - 4.0).abs() < 1e-6, "{states}");
    let path = format!(
        "GET /page/{} HTTP/1.1\r\nhost: {}\r\nconnection: close\r\n\r\n",
        page["page"].as_str().unwrap(),
        lab.host
    );
    assert!(lab.raw(path.as_bytes()).expect("a page").body.contains("A spring"));
    // the same from a simulation, with an input field that nothing in the file drives
    let driven = text.replace("output x", "input push\n  x' = 0\n  v' = 1\noutput x");
    let found = lab.last(&json!({
        "ask": "observe", "text": driven, "estimate": ["v", "k"], "window": 100, "noise": 1e-4,
        "from": { "motion": { "start": { "x": 0.5, "v": 0.0, "k": 3.0 }, "inputs": { "push": "sin(t)" }, "duration": 5.0, "samples": 101 } },
    }));
    let k = &found["observed"]["observers"][0]["end"]["states"]["k"];
    assert!((k["recovered"].as_f64().unwrap() - 3.0).abs() < 5.0 * k["bound"].as_f64().unwrap(), "{found}");
}

/// The processes that answer for a lab, by the system's own list.
fn workers(lab: &Lab) -> usize {
    let found = Command::new("ps").args(["-o", "args=", "--ppid", &lab.child.id().to_string()]).output();
    String::from_utf8_lossy(&found.expect("there is a 'ps'").stdout)
        .lines()
        .filter(|line| line.contains("--answer"))
        .count()
}

fn until(what: &str, is_so: impl Fn() -> bool) {
    let begin = Instant::now();
    while !is_so() {
        assert!(begin.elapsed() < Duration::from_secs(30), "{what}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// A question that takes minutes is ended with its client, and with the lab.
#[test]
fn a_question_ends_with_its_client() {
    let lab = Lab::open();
    let long = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/proofs/benchmarks/pharm.proof"))
        .unwrap();
    let question = lab.request("answer", &json!({ "ask": "values", "text": long }).to_string());
    let send = || {
        let mut stream = TcpStream::connect(&lab.host).expect("it listens");
        stream.write_all(&question).expect("it reads");
        stream
    };
    let stream = send();
    until("a process answers", || workers(&lab) == 1);
    drop(stream);
    until("the process has ended", || workers(&lab) == 0);
    let _stream = send();
    until("a process answers", || workers(&lab) == 1);
    let id = lab.child.id();
    drop(lab);
    let left = Command::new("pgrep")
        .args(["-f", &format!("lab --answer.*{id}")])
        .output()
        .expect("there is a 'pgrep'");
    assert!(left.stdout.is_empty());
}

/// What a question has started ends with the lab, even where that is killed.
#[cfg(target_os = "linux")]
#[test]
fn nothing_outlives_a_lab_that_is_killed() {
    let mut lab = Lab::open();
    // a name by which the processes of this test are known among all
    let text = "system \"outliving\"\nstate x, v\nparam k = 3\ndrift f\n  x' = v\n  v' = -k*sin(x)\noutput x\nsample x in [-1, 1] v in [-1, 1]\n";
    let question = json!({
        "ask": "observe", "text": text, "estimate": ["v", "k"], "window": 100, "noise": 1e-3,
        "from": { "motion": { "start": { "x": 0.5, "v": 0.0, "k": 3.0 }, "inputs": {}, "duration": 1e5, "samples": 1_000_000 } },
    });
    let mut stream = TcpStream::connect(&lab.host).expect("it listens");
    stream.write_all(&lab.request("answer", &question.to_string())).expect("it reads");
    let descendants = |of: u32| -> Vec<u32> {
        let children = |of: u32| -> Vec<u32> {
            let found = Command::new("ps").args(["-o", "pid=", "--ppid", &of.to_string()]).output();
            String::from_utf8_lossy(&found.expect("there is a 'ps'").stdout)
                .split_whitespace()
                .filter_map(|id| id.parse().ok())
                .collect()
        };
        let first = children(of);
        let second: Vec<u32> = first.iter().flat_map(|id| children(*id)).collect();
        first.into_iter().chain(second).collect()
    };
    let id = lab.child.id();
    until("an observer works", || descendants(id).len() >= 2);
    let all = descendants(id);
    lab.child.kill().expect("it can be killed");
    lab.child.wait().expect("it ends");
    let is_there = |id: &u32| {
        let state = std::fs::read_to_string(format!("/proc/{id}/stat")).unwrap_or_default();
        state.rsplit(')').next().is_some_and(|rest| !rest.trim_start().starts_with('Z'))
            && state.contains("palmistry")
    };
    until("all have ended", || !all.iter().any(is_there));
}

/// What takes more memory than it may ends alone, and without an answer.
#[cfg(target_os = "linux")]
#[test]
fn a_question_has_no_more_memory_than_it_may() {
    let folder = folder();
    let long = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/proofs/benchmarks/pharm.proof"))
        .unwrap();
    let run = |memory: u64, question: &Value| {
        let mut child = Command::new(env!("CARGO_BIN_EXE_palmistry"))
            .args(["lab", "--answer", "--memory", &memory.to_string(), "--seconds", "300", "--work"])
            .arg(folder.path())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program runs");
        child.stdin.take().expect("a pipe").write_all(question.to_string().as_bytes()).expect("it reads");
        child.wait_with_output().expect("it ends")
    };
    let found = run(300 << 20, &json!({ "ask": "values", "text": long }));
    assert!(!found.status.success(), "{}", String::from_utf8_lossy(&found.stdout));
    assert!(!String::from_utf8_lossy(&found.stdout).contains("\"kind\":\"done\""));
    let found = run(300 << 20, &json!({ "ask": "draft", "text": TEXT }));
    assert!(found.status.success() && String::from_utf8_lossy(&found.stdout).contains("\"kind\":\"done\""));
}

/// Files of the folder are listed, read and saved; their imports are read, and nothing else.
#[test]
fn a_folder_is_served() {
    let folder = folder();
    let base = "system \"b\"\nstate x\nlet a = 2*x\n";
    write(&folder, "base.proof", base);
    let user = "system \"u\"\nuse b = \"base.proof\"\nstate x\nclaim 1: b.a = x + x\n";
    write(&folder, "user.proof", user);
    let lab = Lab::begin(&["--port", "0", folder.path().to_str().unwrap()]);
    assert_eq!(
        lab.ask("files", &json!({})),
        [json!({ "kind": "done", "files": ["base.proof", "user.proof"] })]
    );
    assert_eq!(lab.ask("read", &json!({ "file": "user.proof" })), [json!({ "kind": "done", "text": user })]);
    let claims = |text: &str| {
        lab.ask("answer", &json!({ "ask": "claims", "file": "user.proof", "text": text, "only": ["1"] }))
    };
    assert_eq!(claims(user)[0]["claim"]["verdict"], "proved");
    let before =
        lab.last(&json!({ "ask": "draft", "file": "user.proof", "text": user }))["claims"][0]["key"].clone();
    let saved = lab.ask(
        "save",
        &json!({ "file": "base.proof", "text": "system \"b\"\nstate x\nlet a = 3*x\n", "was": base }),
    );
    assert_eq!(saved, [json!({ "kind": "done" })]);
    // somebody else's words are not written over
    let again = lab.ask("save", &json!({ "file": "base.proof", "text": "gone", "was": base }));
    assert_eq!(again[0]["kind"], "error");
    // a verdict depends on what is imported
    let after =
        lab.last(&json!({ "ask": "draft", "file": "user.proof", "text": user }))["claims"][0]["key"].clone();
    assert_ne!(before, after);
    assert_eq!(claims(user)[0]["claim"]["verdict"], "refuted");
}
