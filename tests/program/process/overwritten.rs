//! What a command reads it does not write over, under whatever name it is asked to: it says so before anything is done.

use crate::common::{folder, json, write};
use crate::process::{SMALL, files, finish, program, words};

/// A recording of `SMALL` at rest, and a scene that names it.
const RUN: &str = "time,x\n0,0\n0.1,0\n0.2,0\n0.3,0\n0.4,0\n0.5,0\n0.6,0\n0.7,0\n0.8,0\n0.9,0\n";
const SCENE: &str = "title = \"a\"\nmodel = \"small.proof\"\n[data]\nrecord = \"run.csv\"\n[observer]\n\
                     estimate = [\"x\", \"y\"]\nguess = { x = 0.0, y = 0.0 }\n";

#[test]
fn what_is_read_is_not_written_over() {
    let folder = folder();
    let place = |name: &str| folder.path().join(name).display().to_string();
    let small = write(&folder, "small.proof", SMALL).display().to_string();
    let user = write(
        &folder,
        "user.proof",
        "system \"user\" use s = \"small.proof\" state x output x\n\
                                             claim 1: s.rows = s.rows\n",
    );
    let user = user.display().to_string();
    let run = write(&folder, "run.csv", RUN).display().to_string();
    let other = write(&folder, "other.csv", RUN).display().to_string();
    let scene = write(&folder, "scene.toml", SCENE).display().to_string();
    std::os::unix::fs::symlink(&run, place("soft.csv")).unwrap();
    std::fs::hard_link(&run, place("hard.csv")).unwrap();
    std::fs::create_dir(place("deep")).unwrap();
    let round = place("deep/../run.csv");
    let (soft, hard) = (place("soft.csv"), place("hard.csv"));
    let model = write(&folder, "m.jl", "").display().to_string();
    // a problem of PEtab is written as three files, whatever the end of the name
    let problem =
        write(&folder, "p.yaml", "parameter_file: p.tsv\nproblems:\n- measurement_files: [other.csv]\n");
    let (problem, stem) = (problem.display().to_string(), place("other"));
    let before = files(folder.path());
    for line in [
        &["observe", &scene, "--track", &run] as &[&str],
        &["observe", &scene, "--record", &run],
        &["observe", &scene, "--record", &round],
        &["observe", &scene, "--track", &soft],
        &["observe", &scene, "--track", &hard],
        // a recording in place of the scene's, and that of the scene, which is not read then
        &["observe", &scene, "--data", &other, "--track", &other],
        &["observe", &scene, "--data", &other, "--record", &run],
        &["plan", &scene, "--out", &small],
        &["plan", &scene, "--out", &scene],
        &["prove", &small, "--junit", &small],
        &["prove", &user, "--verdicts", &small],
        &["prove", folder.path().to_str().unwrap(), "--verdicts", &small],
        &["rank", &small, "--verdicts", &small],
        &["rank", &small, "--reparametrise", &small],
        &["rank", &user, "--reparametrise", &small],
        &["reduce", &small, "--out", &small],
        &["certify", &small, "--boxes", "10", "--state", &small],
        &["certify", &small, "--boxes", "10", "--verdicts", &small],
        &["import", &model, "--out", &model],
        &["import", &problem, "--out", &stem],
    ] {
        let output = finish(&mut program(&[line, &["--json"]].concat()));
        assert_eq!(output.status.code(), Some(2), "{line:?}: {}", words(&output));
        let error = &json(&output)["error"];
        assert_eq!(error["code"], "E001", "{line:?}: {error}");
        assert!(error["message"].as_str().unwrap().contains("would overwrite"), "{line:?}: {error}");
    }
    assert_eq!(files(folder.path()), before);
    for (name, text) in [("run.csv", RUN), ("other.csv", RUN), ("small.proof", SMALL), ("scene.toml", SCENE)]
    {
        assert_eq!(std::fs::read_to_string(place(name)).unwrap(), text, "{name}");
    }
}

/// Results may be written again, and a search goes on in the file in which it stands.
#[test]
fn what_was_written_before_is_written_again() {
    let folder = folder();
    let place = |name: &str| folder.path().join(name).display().to_string();
    let small = write(&folder, "small.proof", SMALL).display().to_string();
    let (claims, state) = (place("claims.json"), place("open.txt"));
    for line in [
        &["prove", &small, "--verdicts", &claims] as &[&str],
        &["certify", &small, "--boxes", "10", "--state", &state],
    ] {
        for _ in 0..2 {
            let output = finish(&mut program(line));
            assert_eq!(output.status.code(), Some(0), "{line:?}: {}", words(&output));
        }
    }
    // a search's state is no place for its verdicts
    let output =
        finish(&mut program(&["certify", &small, "--boxes", "10", "--state", &state, "--verdicts", &state]));
    assert_eq!(output.status.code(), Some(2), "{}", words(&output));
}
