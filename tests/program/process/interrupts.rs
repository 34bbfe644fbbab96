//! Signals: the first asks to stop and keeps what there is, the second ends the program.

use crate::common::{folder, json, write};
use crate::process::{end_of, files, finish, program, signal, words};
use serde_json::Value;
use std::process::{Child, Command, Output, Stdio};

/// Work of many seconds: words of twelve fields of the thesis's general system.
const ENDLESS: [&str; 4] = ["rank", "proofs/moll2002/general.proof", "--order", "12"];

/// Starts a run, and lets it work for a while: a twentieth of a second of the processor.
fn started(command: &mut Command) -> Child {
    started_for(command, 5)
}

/// The same for so many hundredths of a second of the processor.
fn started_for(command: &mut Command, ticks: u64) -> Child {
    let child =
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it runs");
    while used(child.id()).is_some_and(|used| used < ticks) {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    child
}

/// The hundredths of a second that a process has used of the processor, as long as it runs.
fn used(id: u32) -> Option<u64> {
    let line = std::fs::read_to_string(format!("/proc/{id}/stat")).ok()?;
    let rest = line.rsplit_once(')')?.1;
    let words: Vec<&str> = rest.split_whitespace().collect();
    let ended = *words.first()? == "Z";
    words.get(11)?.parse().ok().filter(|_| !ended)
}

fn interrupted(command: &mut Command, name: &str) -> Output {
    let child = started(command);
    signal(name, &child.id().to_string());
    end_of(child)
}

/// The signals that end a program; a hangup that is ignored here, as under `nohup`, is ignored by what is started here too.
fn signals() -> Vec<&'static str> {
    let status = std::fs::read_to_string("/proc/self/status").expect("a process has a status");
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:")).expect("a mask").trim();
    let hangup_is_ignored = u64::from_str_radix(ignored, 16).expect("a mask in hexadecimal") & 1 == 1;
    ["INT", "TERM", "HUP"].into_iter().filter(|name| *name != "HUP" || !hangup_is_ignored).collect()
}

/// Each of these takes many seconds at the least.
#[test]
fn every_signal_is_heeded_in_the_middle_of_anything() {
    let folder = folder();
    let slow = write(&folder, "slow.proof", slow());
    let slow = slow.to_str().unwrap();
    let all: [&[&str]; 3] =
        [&ENDLESS, &["certify", "proofs/moll2002/general.proof", "--order", "12"], &["prove", slow]];
    for run in all {
        for name in signals() {
            let output = interrupted(&mut program(&[run, &["--json"]].concat()), name);
            assert_eq!(output.status.code(), Some(3), "{run:?} {name}: {}", words(&output));
            assert_eq!(json(&output)["interrupted"], true, "{run:?} {name}: {}", words(&output));
            assert!(String::from_utf8_lossy(&output.stderr).contains("stopping"), "{}", words(&output));
        }
    }
    assert_eq!(files(folder.path()), ["slow.proof"]);
}

/// A signal takes nothing back: what was found to be wrong before it came stays wrong, and the status says so.
#[test]
fn what_is_wrong_stays_wrong_when_the_rest_is_cut_off() {
    let folder = folder();
    let text = slow().replace("claim at_once: 1 + 1 = 2", "claim at_once: 1 + 1 = 3");
    let file = write(&folder, "wrong.proof", text);
    let run = ["prove", file.to_str().unwrap(), "--json"];
    // a claim that is decided at once is decided within some seconds of the processor, on the slowest machine
    let output = (4..12).map(|doublings| 1 << doublings).find_map(|ticks| {
        let child = started_for(&mut program(&run), ticks);
        signal("INT", &child.id().to_string());
        let output = end_of(child);
        let decided = json(&output)["claims"].as_array().is_some_and(|claims| !claims.is_empty());
        decided.then_some(output)
    });
    let output = output.expect("the first claim is decided");
    assert_eq!(output.status.code(), Some(1), "{}", words(&output));
    let found = json(&output);
    assert_eq!((&found["interrupted"], &found["ok"]), (&true.into(), &false.into()), "{}", words(&output));
    assert_eq!(found["claims"][0]["verdict"], "refuted", "{}", words(&output));
}

/// What was not looked at any more is not checked, which is no fault of it.
#[test]
fn a_recheck_that_is_cut_off_finds_no_fault() {
    let folder = folder();
    let file = folder.path().join("verdicts.json");
    let name = file.to_str().unwrap();
    let all = finish(&mut program(&["prove", "proofs/martinelli2005", "-q", "--verdicts", name]));
    assert_eq!(all.status.code(), Some(0), "{}", words(&all));
    // many times over, so that it takes seconds
    let mut verdicts: Value = serde_json::from_str(&std::fs::read_to_string(&file).unwrap()).unwrap();
    let once = verdicts["verdicts"].as_array().unwrap().clone();
    let all = once.len() * 40;
    verdicts["verdicts"] = once.into_iter().cycle().take(all).collect();
    write(&folder, "verdicts.json", verdicts.to_string());
    // it has to be read before anything of it is checked
    let output = (5..14).map(|doublings| 1 << doublings).find_map(|ticks| {
        let child = started_for(&mut program(&["recheck", name, "--json"]), ticks);
        signal("INT", &child.id().to_string());
        let output = end_of(child);
        json(&output)["verdicts"].is_array().then_some(output)
    });
    let output = output.expect("something is checked");
    let found = json(&output);
    assert_eq!(output.status.code(), Some(3), "{}", output.status);
    assert_eq!((&found["interrupted"], &found["ok"]), (&true.into(), &false.into()));
    assert_eq!(found["not_confirmed"], 0);
    let counts = ["confirmed", "half_confirmed", "consistent", "not_checked"]
        .map(|word| found[word].as_u64().expect("a count"));
    assert!(counts[3] > 40 && counts.iter().sum::<u64>() == all as u64, "{counts:?}");
}

/// Of many random bodies those that were looked at are told, as a run over so many tells them: one takes longer than an interrupt leaves.
#[test]
fn bodies_that_were_looked_at_are_kept() {
    let run = |bodies: u64| {
        let bodies = bodies.to_string();
        let mut command =
            program(&["poses", "--bodies", &bodies, "--family", "splines", "--margins", "0.15", "--json"]);
        // one after the other
        command.env("RAYON_NUM_THREADS", "1");
        command
    };
    let output = (5..14).map(|doublings| 1 << doublings).find_map(|ticks| {
        let child = started_for(&mut run(100_000), ticks);
        signal("INT", &child.id().to_string());
        let output = end_of(child);
        json(&output)["families"].is_array().then_some(output)
    });
    let output = output.expect("a body is looked at");
    let found = json(&output);
    assert_eq!((output.status.code(), &found["interrupted"]), (Some(3), &true.into()), "{}", words(&output));
    let bodies = found["families"][0]["bodies"].as_u64().expect("how many");
    assert!((1..100_000).contains(&bodies), "{bodies}");
    assert_eq!(found["families"], json(&finish(&mut run(bodies)))["families"]);
}

/// A study of bodies between slow palms tells those that it has come to, as a run over so many does: with many samples one takes longer than an interrupt leaves.
#[test]
fn a_slow_study_keeps_its_bodies() {
    let folder = folder();
    let run = |bodies: u64| {
        let scene = format!(
            "title = \"many\"\nmotion = \"quasistatic\"\nduration = 10\nsamples = 60\n[body]\nshape = {{ kind = \"ellipse\", semi_axes = [1.1, 1.0] }}\n\
             mass = 1.0\n[palms]\nplan = {{ margin = 0.3, rounds = 1 }}\n[study]\nbodies = {bodies}\nfamilies = [\"harmonics\"]\nsamples = [60]\norders = [6]\n"
        );
        let path = write(&folder, &format!("{bodies}.toml"), scene);
        program(&["observe", path.to_str().unwrap(), "--studies", "--no-times", "--json"])
    };
    let output = (5..16).map(|doublings| 1 << doublings).find_map(|ticks| {
        let child = started_for(&mut run(10_000), ticks);
        signal("INT", &child.id().to_string());
        let output = end_of(child);
        (json(&output)["study"][0]["bodies"].as_u64() > Some(0)).then_some(output)
    });
    let output = output.expect("a body is looked at");
    let mut found = json(&output);
    assert_eq!((output.status.code(), &found["interrupted"]), (Some(3), &true.into()), "{}", words(&output));
    let row = &mut found["study"][0];
    let bodies = row["bodies"].as_u64().expect("how many");
    assert_eq!(row["asked"].take(), 10_000);
    // bodies that jumped may have been drawn since the last one that did not
    let jumped = row["jumped"].take().as_u64();
    let mut whole = json(&finish(&mut run(bodies)))["study"][0].take();
    assert_eq!(whole["asked"].take(), bodies);
    assert!(whole["jumped"].take().as_u64() <= jumped);
    assert_eq!(*row, whole);
}

/// What holds at almost all states is known long before states are looked at, and which unknowns have infinitely many values long
/// before the others' are counted: neither is lost.
#[test]
fn what_is_known_before_the_end_is_kept() {
    let folder = folder();
    let file = write(&folder, "cyclic.proof", cyclic(7));
    let values = ["rank", file.to_str().unwrap(), "--global", "--work", "1000000000000000"];
    let kept = |run: &[&str], is_there: &dyn Fn(&Value) -> bool| {
        let output = (4..14).map(|doublings| 1 << doublings).find_map(|ticks| {
            let child = started_for(&mut program(&[run, &["--json"]].concat()), ticks);
            signal("INT", &child.id().to_string());
            let output = end_of(child);
            assert_eq!(output.status.code(), Some(3), "{}", words(&output));
            assert_eq!(json(&output)["interrupted"], true, "{}", words(&output));
            is_there(&json(&output)).then_some(output)
        });
        json(&output.expect("something is known before the end"))
    };
    let found = kept(&values, &|found| found["unknowns"].is_array());
    for unknown in found["unknowns"].as_array().unwrap() {
        let is_one_of_two = ["c", "s"].contains(&unknown["name"].as_str().unwrap());
        let told = [&unknown["values"], &unknown["verdict"], &unknown["at_most"]];
        match is_one_of_two {
            true => assert_eq!(told, [&"infinity".into(), &"proved".into(), &Value::Null]),
            false => assert_ne!(unknown["values"], "infinity"),
        }
    }
    let found = kept(&ENDLESS, &|found| found["branches"].is_array());
    let whole = json(&finish(&mut program(&[ENDLESS[0], ENDLESS[1], "--samples", "0", "--json"])));
    for key in ["generic", "unknowns", "unobservable_dimension"] {
        assert_eq!(found["branches"][0][key], whole[key]);
    }
    let drops = ["rank", "proofs/moll2002/circular_palms_rank.proof", "--singular-set"];
    let found = kept(&drops, &|found| found["rank"].is_number());
    assert_eq!((&found["exact"], &found["rank"]), (&false.into(), &10.into()));
    let moved = ["rank", "proofs/moll2002/general.proof", "--accessible", "--samples", "100000000"];
    let found = kept(&moved, &|found| found["branches"][0].is_object());
    let strong = &found["branches"][0]["strong_accessibility"];
    let dimension = found["dimension"].as_u64().unwrap();
    let (least, most) = (strong["at_least"].as_u64().unwrap(), strong["at_most"].as_u64().unwrap());
    assert!((1..=dimension).contains(&least) && (least..=dimension).contains(&most), "{found}");
    let brackets = found["branches"][0]["brackets"].as_array().unwrap();
    assert!(!brackets.is_empty() && brackets.len() as u64 <= dimension, "{found}");
}

/// Outputs whose values are met by very many states, beside a product of which nothing else is seen.
fn cyclic(n: usize) -> String {
    let names: Vec<String> = (0..n).map(|k| format!("x{k}")).collect();
    let product = |from: usize, degree: usize| {
        (from..from + degree).map(|k| names[k % n].as_str()).collect::<Vec<_>>().join("*")
    };
    let sum = |degree: usize| (0..n).map(|from| product(from, degree)).collect::<Vec<_>>().join(" + ");
    let outputs: Vec<String> = (1..n).map(sum).chain([product(0, n)]).collect();
    format!(
        "system \"cyclic\"\nparam {}, c, s unknown\nstate z\ndrift f\n  z' = 0\noutput z, c*s, {}\n",
        names.join(", "),
        outputs.join(", ")
    )
}

/// Claims for which nobody waits, half a minute in all, and before them one that is decided at once.
fn slow() -> String {
    let claim = |number: usize| {
        let entry = |i: usize, j: usize| format!("({}*x + y)^{}", 12 * i + j + 1, 1 + (i * j + number) % 7);
        let matrix = |entry: &dyn Fn(usize, usize) -> String| {
            let row = |i: usize| (0..12).map(|j| entry(i, j)).collect::<Vec<_>>().join(", ");
            (0..12).map(row).collect::<Vec<_>>().join("; ")
        };
        let (one, turned) = (matrix(&entry), matrix(&|i, j| entry(j, i)));
        format!("claim slow{number}: det([{one}]) = det([{turned}])\n")
    };
    let claims: String = (0..100).map(claim).collect();
    format!("system \"slow\"\nparam x, y\nclaim at_once: 1 + 1 = 2\n{claims}")
}

#[test]
fn the_second_signal_ends_it_at_once() {
    let child = started(&mut program(&ENDLESS));
    let id = child.id().to_string();
    signal("INT", &id);
    signal("TERM", &id);
    let output = end_of(child);
    let code = output.status.code();
    assert!(matches!(code, Some(130 | 143)), "{}", words(&output));
    assert!(output.stdout.is_empty(), "{}", words(&output));
}

/// The state of a search is kept whatever the signal, and taken up again.
#[test]
fn the_state_of_a_search_is_kept() {
    let folder = folder();
    let state = folder.path().join("search.state");
    let file = ["certify", "proofs/moll2002/fixed_palms.proof", "--state", state.to_str().unwrap(), "--json"];
    let first = finish(&mut program(&[&file[..], &["--boxes", "500"]].concat()));
    let mut boxes = json(&first)["boxes"].as_u64().unwrap_or_else(|| panic!("{}", words(&first)));
    for name in signals() {
        // while a search is prepared there is nothing to keep: it is given more time until it has found something
        let kept = (5..15).map(|doublings| 1 << doublings).find_map(|ticks| {
            let run = [&file[..], &["--budget", "3600"]].concat();
            let child = started_for(&mut program(&run), ticks);
            signal(name, &child.id().to_string());
            let output = end_of(child);
            // on a quick machine the search may be over before the signal comes
            let finished = json(&output)["interrupted"] == false;
            let status = if finished { 0 } else { 3 };
            assert_eq!(output.status.code(), Some(status), "{name}: {}", words(&output));
            assert_eq!(files(folder.path()), ["search.state"], "{name}");
            json(&output)["boxes"].as_u64().filter(|now| finished || *now > boxes)
        });
        let kept = kept.unwrap_or_else(|| panic!("{name}: nothing is kept"));
        let again = finish(&mut program(&[&file[..], &["--boxes", "1"]].concat()));
        boxes = json(&again)["boxes"].as_u64().unwrap_or_else(|| panic!("{}", words(&again)));
        assert!(boxes >= kept, "{name}: {boxes} boxes after {kept}");
    }
}

/// Who starts it with 'nohup' wants it to outlive the terminal.
#[test]
fn a_hangup_that_is_ignored_stays_ignored() {
    let line = "trap '' HUP; exec \"$0\" \"$@\"";
    let run = ["certify", "proofs/moll2002/fixed_palms.proof", "--boxes", "20000", "--json"];
    let output = interrupted(&mut crate::process::in_shell(line, &run), "HUP");
    assert_eq!(output.status.code(), Some(0), "{}", words(&output));
    assert_eq!(json(&output)["interrupted"], false);
}

/// Without a signal nothing is interrupted.
#[test]
fn a_whole_run_says_so() {
    let output = finish(&mut program(&["prove", "proofs/moll2002/fixed_palms.proof", "--json"]));
    assert_eq!(json(&output)["interrupted"], false, "{}", words(&output));
}
