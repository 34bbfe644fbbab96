//! Every scene that comes with the program, recorded by one process and read by another through a pipe and from a file.
//!
//! Oracle: the same scene simulated.

use crate::common::{folder, json, palmistry, without_times};
use crate::observe::observe;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// What only one knows that has moved the body itself.
const TRUTH: [&str; 6] = ["true", "error", "relative_error", "simulation", "contacts", "reconstruction"];

fn without_truth(value: &mut Value) {
    match value {
        Value::Object(map) => {
            map.retain(|key, _| !TRUTH.contains(&key.as_str()));
            map.values_mut().for_each(without_truth);
        }
        Value::Array(list) => list.iter_mut().for_each(without_truth),
        _ => {}
    }
}

/// The scenes of a folder of the project.
fn scenes(of: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(of);
    let all = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut all: Vec<PathBuf> = all.filter(|path| path.extension().is_some_and(|e| e == "toml")).collect();
    // systems side by side and known bodies take no stream, and say so (modes.rs, library.rs)
    let has = |path: &PathBuf, table: &str| std::fs::read_to_string(path).unwrap().contains(table);
    all.retain(|path| !has(path, "[[observer.modes]]") && !has(path, "[[observer.library]]"));
    all.sort();
    all
}

/// `palmistry observe SCENE --record - | palmistry observe SCENE --data - --json`: the lines, and the status of the second.
fn piped(scene: &Path) -> (Vec<Value>, Option<i32>) {
    let program = env!("CARGO_BIN_EXE_palmistry");
    let mut first = Command::new(program)
        .args(["observe", scene.to_str().unwrap(), "--record", "-"])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let second = Command::new(program)
        .args(["observe", scene.to_str().unwrap(), "--data", "-", "--json", "--no-times"])
        .stdin(first.stdout.take().unwrap())
        .output()
        .unwrap();
    assert_eq!(first.wait().unwrap().code(), Some(0), "{}", scene.display());
    let text = String::from_utf8(second.stdout).unwrap();
    let words = String::from_utf8_lossy(&second.stderr).into_owned();
    assert!(!words.contains("panicked"), "{words}");
    // a slow scene has one answer, over several lines
    let lines = serde_json::Deserializer::from_str(&text).into_iter::<Value>();
    (lines.map(|line| line.unwrap_or_else(|why| panic!("{why}: {text}"))).collect(), second.status.code())
}

/// A recording gives what was simulated, to the last digit: from a file all of it, through a pipe the first update of each method by windows, which knows as much.
fn a_recording_gives_the_same(scene: &Path) {
    let name = scene.display();
    let folder = folder();
    let file = folder.path().join("record.csv");
    let (first, mut simulated) = observe(scene, &["--record", file.to_str().unwrap()]);
    let (second, mut read) = observe(scene, &["--data", file.to_str().unwrap()]);
    assert_eq!(first.status.code(), second.status.code(), "{name}");
    for found in [&mut simulated, &mut read] {
        without_truth(found);
        without_times(found);
    }
    assert!(!simulated["observers"].as_array().unwrap().is_empty(), "{name}");
    assert_eq!(simulated["observers"], read["observers"], "{name}");
    let (lines, status) = piped(scene);
    let (end, windows) = lines.split_last().unwrap();
    assert_eq!((end["ended"].as_str(), windows.is_empty()), (Some("whole"), false), "{name}: {end}");
    assert!(matches!(status, Some(0 | 1)), "{name}: {status:?}");
    let all = simulated["observers"].as_array().unwrap();
    for (place, observer) in all.iter().enumerate() {
        let Some(update) = observer["updates"].as_array().and_then(|updates| updates.first()) else {
            continue;
        };
        let own = &windows[0]["observers"][place]["updates"][0];
        for (state, known) in update["states"].as_object().unwrap() {
            let number = |of: &Value, what: &str| of[what].as_f64();
            // the curves between samples are the same but for rounding
            let (told, known, bound) = (
                number(&own["states"][state], "recovered"),
                number(known, "recovered"),
                number(known, "bound"),
            );
            let (told, known) = (told.unwrap(), known.unwrap());
            let room = 1e-6 * bound.unwrap_or(known.abs()).max(1e-3 * known.abs());
            assert!((told - known).abs() <= room, "{name} {state}: {told} and {known}");
        }
    }
}

/// Those that are quick without optimisation.
#[test]
fn scenes_of_systems_are_read_from_a_pipe() {
    let scenes = scenes("examples/systems");
    assert_eq!(scenes.len(), 6);
    scenes.iter().for_each(|scene| a_recording_gives_the_same(scene));
}

/// The bodies between palms, those with a guess that is so much off the truth among them: of a recording it is off what the scene describes.
#[test]
fn scenes_of_palms_are_read_from_a_pipe() {
    let all = scenes("proofs/moll2002/scenes");
    // in space: tests/motion/space.rs
    let is_in_space = |path: &PathBuf| std::fs::read_to_string(path).unwrap().contains("\"spatial\"");
    let (space, all): (Vec<PathBuf>, Vec<PathBuf>) = all.into_iter().partition(is_in_space);
    assert_eq!(space.len(), 2);
    let is_slow = |path: &&PathBuf| std::fs::read_to_string(path).unwrap().contains("quasistatic");
    let (slow, quick): (Vec<&PathBuf>, Vec<&PathBuf>) = all.iter().partition(is_slow);
    assert_eq!((slow.len(), quick.len()), (4, 9));
    quick.into_iter().for_each(|scene| a_recording_gives_the_same(scene));
    for scene in slow {
        let simulated = json(&palmistry(&["observe", scene.to_str().unwrap(), "--json"]));
        let (found, status) = piped(scene);
        // rates of the palms are differentiated, and not told
        assert_eq!(found.len(), 1, "{}", scene.display());
        assert!(matches!(status, Some(0 | 1)), "{}: {status:?}", scene.display());
        assert_eq!(found[0]["explained"], simulated["explained"], "{}", scene.display());
    }
}

/// What slow motion has not is refused in words, and nothing is written.
#[test]
fn what_slow_motion_has_not_is_refused() {
    let scene =
        &scenes("proofs/moll2002/scenes").into_iter().find(|p| p.ends_with("slow_touchpad.toml")).unwrap();
    let folder = folder();
    let out = folder.path().join("parts");
    let out = out.to_str().unwrap();
    let cases: [(&[&str], &str); 7] = [
        (&["--shard", "1/2", "--part", out], "--shard is not for slow motion"),
        (&["--merge", out], "--merge is not for slow motion"),
        (&["--missing", out, "2"], "--missing is not for slow motion"),
        (&["--motion", "m.csv"], "--motion is not for slow motion"),
        (&["--studies"], "the scene has no study"),
        (&["--record", "-", "--json"], "--json asks for more"),
        (&["--record", "-", "--out", out], "--out asks for more"),
    ];
    for (asked, words) in cases {
        let output = palmistry(&[&["observe", scene.to_str().unwrap()], asked].concat());
        let told =
            String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout);
        let told = told.split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(output.status.code(), Some(2), "{asked:?}: {told}");
        assert!(told.contains(words), "{asked:?}: {told}");
        assert!(!Path::new(out).exists());
    }
}
