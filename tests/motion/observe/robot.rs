//! The robot of section 6.2 as a scene: what is recovered of it, what is refused, and what its closure adds.

use super::*;

fn robot() -> String {
    text("robot")
}

/// From the middle of the sample box every window arrives at what the drive had, which knows no equation of the model: to 1e-10, which is what the curves between the samples leave.
#[test]
fn a_robot_is_recovered_from_what_its_gauges_read() {
    let experiment = experiment(&robot());
    let answer = &answers(&experiment)[0];
    assert_eq!((answer.track.updates.len(), experiment.names().len()), (6, 6));
    for update in &answer.track.updates {
        assert!(update.is_borne_out(), "{:?}", update.end);
        let truth = experiment.truth_at(update.from).unwrap();
        for ((name, found), truth) in experiment.names().iter().zip(&update.estimate).zip(&truth) {
            assert!((found - truth).abs() < 1e-10, "{} s, {name}: {found} for {truth}", update.from);
        }
    }
    // the constants are those of the scene
    assert_eq!(experiment.truth("one_over_m").unwrap()[0], 0.5);
    assert!((experiment.truth("rho2").unwrap()[0] - 0.49).abs() < 1e-15);
}

/// A wrong model is not taken: rods that are one percent longer than the model believes do not fit.
#[test]
fn a_robot_with_other_rods_does_not_fit() {
    let noisy = format!(
        "{}\n[sensor.f1]\nnoise = 1e-3\n[sensor.f2]\nnoise = 1e-3\n[sensor.f0]\nnoise = 1e-3\n",
        robot()
    );
    let short = with(&noisy, "samples = 601", "samples = 101").replace("duration = 6.0", "duration = 1.0");
    let fits = |text: &str| {
        let experiment = experiment(text);
        answers(&experiment)[0].track.updates[0].is_borne_out()
    };
    assert!(fits(&short));
    assert!(!fits(&with(&short, "guess = \"sample\"", "guess = \"sample\"\nknown = { l1 = 1.05 }")));
}

/// Ranks and singular values of another program (Python, central differences over 1e-6, each sample met by eight neighbours of all of the track): forces and angles tell all but the place, with
/// known rods and without; angles alone nothing. With the closure forces tell no more, angles alone the speed, and of unknown rods the lean: the ratio of speed and length is a second number, which none tells by itself.
#[test]
fn what_the_closure_adds() {
    let experiment = experiment(&with(&robot(), "samples = 601", "samples = 241"));
    let closure = experiment.closure.as_ref().unwrap();
    let ranks: Vec<_> =
        closure.settings.iter().map(|own| (own.unknowns.len(), own.without.rank, own.with.rank)).collect();
    assert_eq!(ranks, [(8, 6, 6), (12, 10, 10), (4, 0, 1), (6, 0, 2)]);
    let gained: Vec<_> = closure.settings.iter().map(|own| own.gained()).collect();
    assert_eq!(gained, [vec![], vec![], vec!["v1"], vec!["lean"]]);
    let left: Vec<_> = closure.settings.iter().map(|own| own.unobservable()).collect();
    assert_eq!(left[..2], [vec!["x", "y"], vec!["x", "y"]]);
    assert_eq!(left[2..], [vec!["phi0", "x", "y"], vec!["v1", "phi0", "x", "y", "base"]]);
    let [known, unknown, ..] = &closure.settings[..] else { panic!("four settings") };
    let python = [1506.32983, 331.654492, 33.5649256, 10.905974, 7.39353982, 0.977003451];
    for (found, expected) in known.without.singular_values.iter().zip(python) {
        assert!((found / expected - 1.0).abs() < 1e-5, "{found} for {expected}");
    }
    for (found, expected) in unknown.without.singular_values[..10].iter().zip([
        6848.32750,
        1418.17693,
        180.087086,
        69.3504860,
        29.6367849,
        10.9390399,
        6.84502668,
        1.15691815,
        0.741276469,
        0.692639996,
    ]) {
        assert!((found / expected - 1.0).abs() < 1e-5, "{found} for {expected}");
    }
    // the other program leaves out the ends of the track: some rows fewer of 160
    for (own, expected) in [(0, 1.03458502), (1, 0.802196401)] {
        let least = closure.settings[own].with.least().unwrap();
        assert!((least / expected - 1.0).abs() < 0.1 && least > expected, "{least} for {expected}");
    }
    let python = [3.03844907, 25.2937415];
    for (own, expected) in [(2, python[0]), (3, python[1])] {
        let largest = closure.settings[own].with.singular_values[0];
        assert!((1.0..1.1).contains(&(largest / expected)), "{largest} for {expected}");
    }
    // wheel 2 needs the way between the wheels: 2 m along the chord, a little more along the ground
    assert!((2.0..2.2).contains(&closure.from.unwrap()), "{:?}", closure.from);
    assert!((155..=170).contains(&closure.samples[0]) && closure.samples[1] == 241);
}

/// Where wheel 2 goes ahead nothing closes, and that is said: by the program, in text and in JSON.
#[test]
fn nothing_closes_where_wheel_2_goes_ahead() {
    let folder = crate::common::folder();
    let back = with(&robot(), "speed = 1.0", "speed = -1.0");
    let back = with(&back, "guess = \"sample\"", "guess_off = 0.05");
    let path = folder.path().join("back.toml");
    std::fs::write(&path, with(&back, "samples = 601", "samples = 121")).unwrap();
    let path = path.to_str().unwrap();
    let told = crate::common::words_of(&palmistry(&["observe", path]));
    assert!(told.contains("wheel 2 is never where wheel 1 has been, and nothing closes"), "{told}");
    let output = palmistry(&["observe", path, "--json"]);
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let closure = &found["closure"];
    assert_eq!((&closure["status"], &closure["samples"]), (&"computed".into(), &0.into()));
    assert!(closure["from"].is_null());
    for own in closure["settings"].as_array().unwrap() {
        assert_eq!(own["with"], own["without"]);
        assert!(own["gained"].as_array().unwrap().is_empty());
    }
    // what is recorded is read back, and has no closure: nothing is known of its ground
    let record = folder.path().join("run.csv");
    palmistry(&["observe", path, "--record", record.to_str().unwrap()]);
    let output = palmistry(&["observe", path, "--json", "--data", record.to_str().unwrap()]);
    let again: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(again["closure"].is_null());
    assert_eq!(
        again["observers"][0]["updates"][0]["states"]["ux"]["recovered"],
        found["observers"][0]["updates"][0]["states"]["ux"]["recovered"]
    );
}

/// What a scene may not say, with its place.
#[test]
fn robots_that_cannot_be_are_refused() {
    for (from, to, message) in [
        ("speed = 1.0", "speed = 0.0", "wheel 1 stands"),
        ("speed = 1.0", "speed = nan", "'speed' is NaN"),
        ("mass = 2.0", "mass = 0.0", "'mass' has to be positive"),
        ("[[1.0, -1.0], [-1.0, -1.0]]", "[[1.0, -1.0], [1.0, 1.0]]", "both wheels are above each other"),
        ("wavelength = 4.8", "wavelength = 0.48", "add up to"),
        ("speed = 1.0", "speed = 1e6", "more than this wave"),
        ("wavelength = 4.8", "wavelength = -4.8", "'wavelength' has to be positive"),
        ("[ground]\nwaves", "[grounds]\nwaves", "unknown key 'grounds'"),
        ("duration = 6.0", "", "without 'duration'"),
        ("[observer]", "[start]\nux = 1\n[observer]", "a robot and something else"),
    ] {
        let refused = Scene::parse("scene.toml", &with(&robot(), from, to)).unwrap_err().to_string();
        assert!(refused.contains(message), "{to}: {refused}");
    }
    let text = robot();
    let (head, tail) = text.split_once("[ground]").unwrap();
    let (_, tail) = tail.split_once("[observer]").unwrap();
    let refused = Scene::parse("scene.toml", &format!("{head}[observer]{tail}")).unwrap_err();
    assert!(refused.to_string().contains("without [ground]"));
    // a robot that flies at once
    let fast = with(&robot(), "speed = 1.0", "speed = 40.0");
    let scene = Scene::parse("scene.toml", &fast).unwrap();
    let refused = Experiment::new(scene, None).map(|found| found.motion).unwrap_err().to_string();
    assert!(refused.contains("would have to be pulled"), "{refused}");
}
