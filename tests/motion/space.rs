//! Chapter 5 through measurements alone: a body in space on three palms, its state, inertia, mass and shape with nothing known.
//!
//! Oracle: the body that was simulated by Newton's and Euler's laws, and what is known of an ellipsoid by hand.

use crate::common::{folder, json, palmistry, without_times, write};
use palmistry::experiment::space::{
    SpaceExperiment, SpaceMeasurements, SpaceScene, SpaceUpdate, SpaceVerdict, relative_error,
};
use palmistry::shape::sphere::OuterBound;
use std::f64::consts::PI;
use std::path::Path;

const SHIPPED: &str = "proofs/moll2002/scenes/figure_5_3.toml";

const HOLLOW: &str = "proofs/moll2002/scenes/figure_5_3_hollow.toml";

const BODY: &str = "shape = { kind = \"ellipsoid\", semi_axes = [2.5, 2, 1] }\nmass = 1.3\norientation = [0.2, -0.3, 0.4]\nbalanced = true\nrate = [0, 0.3, 0.3]";
const PALMS: &str =
    "azimuth = [0, 2.1, 4.2]\ninertia = [0.5, 0.5, 0.5]\nhinge = [[0.1, 0, 0], [0, 0, 0.05], [0, 0, 0]]";
const MOVED: &str = "prescribed = [{ start = 1.0, swings = [{ amplitude = 0.05, frequency = 0.6 }] }, { start = 1.05 }, { start = 1.1, rate = 0.02 }]";

fn text(samples: usize, body: &str, palms: &str, rest: &str) -> String {
    format!(
        "title = \"A body in space\"\nmotion = \"spatial\"\nduration = 1.76\nsamples = {samples}\n[body]\n{body}\n[palms]\n{palms}\n{rest}"
    )
}

fn scene(text: &str) -> SpaceScene {
    SpaceScene::parse("space.toml", text).unwrap_or_else(|why| panic!("{:?}", miette::Report::new(why)))
}

fn experiment(text: &str) -> SpaceExperiment {
    SpaceExperiment::new(scene(text), None).unwrap_or_else(|why| panic!("{:?}", miette::Report::new(why)))
}

/// That a window of figure 5.3's ellipsoid has the state, the three moments and every pose.
fn arrives(experiment: &SpaceExperiment, update: &SpaceUpdate) {
    assert_eq!(update.verdict, SpaceVerdict::Fits);
    let state = update.state.as_ref().unwrap();
    let error = relative_error(&state.entries(), &experiment.true_entries(update).unwrap());
    assert!(error < 1e-7, "{error:e}");
    let mut moments = state.inertia_over_mass.try_symmetric_eigen(f64::EPSILON, 1000).unwrap().eigenvalues;
    moments.as_mut_slice().sort_by(f64::total_cmp);
    for (found, by_hand) in moments.iter().zip([1.0, 7.25 / 5.0, 10.25 / 5.0]) {
        assert!((found - by_hand).abs() < 1e-7, "{moments}");
    }
    for error in experiment.errors(update) {
        assert!(error.centre < 1e-7 && error.turn < 1e-7 && error.radius < 1e-7, "{error:?}");
    }
}

/// The scene of figure 5.3: the state, the three moments of an ellipsoid, every pose, what was touched, and bounds about the volume of an ellipsoid.
#[test]
fn the_scene_of_figure_5_3_is_observed_with_nothing_known() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let experiment =
        SpaceExperiment::new(SpaceScene::read(&root.join(SHIPPED)).unwrap().unwrap(), None).unwrap();
    let answers = experiment.run(&|| false, &|| ());
    let [update] = answers.updates.as_slice() else { panic!("{}", answers.updates.len()) };
    arrives(&experiment, update);
    let shape = answers.shape.as_ref().unwrap();
    assert_eq!(shape.touches.len(), 531);
    let truth = |normal: &_| experiment.true_support(normal).unwrap().0;
    let [touched, everywhere] = shape.errors(&truth).unwrap();
    assert!(touched < 1e-3 && touched <= everywhere, "{touched:e} {everywhere:e}");
    let volume = 20.0 / 3.0 * PI;
    assert!(shape.hull.as_ref().unwrap().volume.high() < volume);
    match shape.outer.as_ref().unwrap() {
        OuterBound::Bounded(region) => assert!(region.volume.low() > volume),
        OuterBound::Unbounded { direction } => {
            assert!(shape.touches.iter().all(|touch| touch.normal.dot(direction) < 1e-9));
        }
    }
}

/// The same on hollow palms: each contact is inside of its palm's ball, so that what one run leaves unbounded by tangent planes is bounded by balls.
#[test]
fn hollow_palms_bound_what_they_touch() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let shipped = root.join(HOLLOW);
    let experiment = SpaceExperiment::new(SpaceScene::read(&shipped).unwrap().unwrap(), None).unwrap();
    let answers = experiment.run(&|| false, &|| ());
    let update = &answers.updates[0];
    arrives(&experiment, update);
    let shape = answers.shape.as_ref().unwrap();
    let volume = 20.0 / 3.0 * PI;
    assert!(matches!(shape.outer.as_ref().unwrap(), OuterBound::Unbounded { .. }));
    let balls = shape.hollow.as_ref().unwrap().as_ref().unwrap().volume;
    assert!(volume < balls.low() && balls.high() < 300.0, "{balls}");
    assert!(shape.balls.is_none());
}

/// Readings of spherical palms go through a file bit by bit; one that is beyond its sphere is no contact.
#[test]
fn spheres_are_recorded() {
    let bent = format!("{PALMS}\ncurvature = [-0.1, 0.2, 0]\ntouch_point = [[0, 2], [0.1, 1.8], [0, 0]]");
    let experiment = experiment(&text(89, BODY, &format!("{bent}\n{MOVED}"), "[sensor]\nnoise = 1e-4\n"));
    let folder = folder();
    let file = folder.path().join("run.csv");
    experiment.measurements.record().unwrap().write(&file).unwrap();
    assert_eq!(SpaceMeasurements::recorded(&experiment.scene, &file).unwrap(), experiment.measurements);
    // the forces that torques and levers tell are those of the simulation, but for the noise of levers
    let truth = &experiment.truth.as_ref().unwrap().trajectory.moments;
    let solid = experiment.solid();
    for (palms, moment) in solid.palms.iter().zip(truth) {
        for (i, (palm, told)) in palms.iter().zip(&moment.palms).enumerate() {
            let force = palm.torque / solid.surfaces[i].lever(palm.place);
            assert!((force - told.force).abs() < 1e-3 * told.force.abs(), "{force} {}", told.force);
        }
    }
    let scene = format!(
        "title = \"recorded\"\nmotion = \"spatial\"\n[palms]\n{}\n[data]\nrecord = \"run.csv\"\n",
        bent.replace("-0.1, 0.2", "-0.1, 2.0")
    );
    let scene = SpaceScene::parse(folder.path().join("scene.toml").to_str().unwrap(), &scene).unwrap();
    let why = format!("{:?}", miette::Report::new(SpaceExperiment::new(scene, None).unwrap_err()));
    assert!(why.contains("the contact with palm 2 is beyond the sphere at 0 s"), "{why}");
}

/// A recording holds what was read bit by bit, so that the answer is the same; without the palms' rates these are those of a polynomial.
#[test]
fn a_recording_gives_the_same() {
    let experiment = experiment(&text(89, BODY, &format!("{PALMS}\n{MOVED}"), "[sensor]\nnoise = 1e-4\n"));
    let folder = folder();
    let file = folder.path().join("run.csv");
    experiment.measurements.record().unwrap().write(&file).unwrap();
    let again = SpaceMeasurements::recorded(&experiment.scene, &file).unwrap();
    assert_eq!(again, experiment.measurements);
    // of another program, with names of its own and without rates
    let table = std::fs::read_to_string(&file).unwrap();
    let keep = |line: &str| -> String {
        let cells: Vec<&str> = line.split(',').collect();
        let kept = cells.iter().enumerate().filter(|(i, _)| *i == 0 || ![2, 3].contains(&((i - 1) % 6 + 1)));
        kept.map(|(_, cell)| *cell).collect::<Vec<_>>().join(",")
    };
    let mut lines: Vec<String> = table.lines().map(keep).collect();
    assert_eq!(lines[0], "time,phi1,p1,q1,torque1,phi2,p2,q2,torque2,phi3,p3,q3,torque3");
    lines[0] = lines[0].replace("p1,", "along,");
    let other = write(&folder, "other.csv", lines.join("\n"));
    let recorded = format!(
        "title = \"recorded\"\nmotion = \"spatial\"\n[palms]\n{PALMS}\n[data]\nrecord = \"other.csv\"\ncolumns = {{ p1 = \"along\" }}\n"
    );
    let recorded = SpaceScene::parse(folder.path().join("scene.toml").to_str().unwrap(), &recorded).unwrap();
    assert_eq!(recorded.record.as_deref(), Some(other.as_path()));
    let told = SpaceExperiment::new(recorded, None).unwrap();
    assert!(told.truth.is_none());
    for (own, told) in experiment.measurements.palms.iter().zip(&told.measurements.palms) {
        for (own, told) in own.iter().zip(told) {
            assert_eq!((own.angle, own.place, own.torque), (told.angle, told.place, told.torque));
            assert!((own.rate - told.rate).abs() < 1e-8, "{} {}", own.rate, told.rate);
            assert!((own.acceleration - told.acceleration).abs() < 1e-4, "{own:?} {told:?}");
        }
    }
}

/// By the command: what is simulated and what is recorded have one answer, page and all, and the status says that it fits.
#[test]
fn the_command_tells_state_shape_and_bounds() {
    let folder = folder();
    let moved = text(
        177,
        BODY,
        &format!("{PALMS}\n{MOVED}"),
        "[observer]\ndegree = 8\nleast_radius = 0.4\ngreatest_radius = 6.25\n",
    );
    // in half of that time the body turns little, and the search does not arrive
    let moved = moved.replace("duration = 1.76", "duration = 3.6");
    let file = write(&folder, "space.toml", &moved);
    let (file, page) = (file.to_str().unwrap(), folder.path().join("page"));
    let record = folder.path().join("run.csv");
    let (record, out) = (record.to_str().unwrap(), page.to_str().unwrap());
    let first = palmistry(&["observe", file, "--record", record, "--out", out, "--json", "--no-times"]);
    let second = palmistry(&["observe", file, "--data", record, "--json", "--no-times"]);
    assert_eq!((first.status.code(), second.status.code()), (Some(0), Some(0)));
    let (mut simulated, mut read) = (json(&first), json(&second));
    assert_eq!(simulated["updates"][0]["verdict"], "converged, fits");
    assert!((simulated["updates"][0]["states"]["m"]["recovered"].as_f64().unwrap() - 1.3).abs() < 1e-6);
    assert!(simulated["updates"][0]["error"]["turn"].as_f64().unwrap() < 1e-6);
    assert_eq!(simulated["shape"]["bounds"].as_array().unwrap().len(), 4);
    for found in [&mut simulated, &mut read] {
        without_times(found);
        found["simulation"].take();
        found["shape"]["error"].take();
        let update = &mut found["updates"][0];
        update["error"].take();
        for (_, state) in update["states"].as_object_mut().unwrap() {
            state["true"].take();
            state["error"].take();
        }
    }
    assert_eq!(simulated, read);
    let html = std::fs::read_to_string(page.join("index.html")).unwrap();
    // a picture that turns with the colours of its two surfaces, and two with errors, nothing from elsewhere
    assert_eq!(html.matches("<svg").count(), 5);
    assert!(html.contains("pointermove") && html.contains("hull of the contacts"));
    assert!(!html.contains("://"));
    surfaces_are_written(&page, &simulated["shape"]["bounds"]);
}

/// The volume within polygons, by Gauss's theorem over triangles, of both formats; the bounds' is told by exact arithmetic, the body's is known.
fn surfaces_are_written(page: &Path, bounds: &serde_json::Value) {
    type Polygons = Vec<Vec<usize>>;
    let numbers = |line: &str| -> Vec<f64> { line.split(' ').filter_map(|word| word.parse().ok()).collect() };
    let places = |line: &str, less: usize| {
        numbers(line).iter().map(|place| *place as usize - less).collect::<Vec<_>>()
    };
    let ply = |name: &str| -> (Vec<Vec<f64>>, Polygons) {
        let text = std::fs::read_to_string(page.join(name).with_extension("ply")).unwrap();
        let (head, body) = text.split_once("end_header\n").unwrap();
        let count = |what: &str| -> usize {
            let line = head.lines().find_map(|line| line.strip_prefix(&format!("element {what} ")));
            line.unwrap().parse().unwrap()
        };
        let lines: Vec<&str> = body.lines().collect();
        let (corners, faces) = lines.split_at(count("vertex"));
        assert_eq!(faces.len(), count("face"));
        let face = |line: &&str| places(line, 0).into_iter().skip(1).collect();
        (corners.iter().map(|line| numbers(line)).collect(), faces.iter().map(face).collect())
    };
    let obj = |name: &str| -> (Vec<Vec<f64>>, Polygons) {
        let text = std::fs::read_to_string(page.join(name).with_extension("obj")).unwrap();
        let of =
            |kind: &str| text.lines().filter(move |line| line.starts_with(kind)).map(str::to_owned).collect();
        let [corners, faces]: [Vec<String>; 2] = ["v ", "f "].map(of);
        (
            corners.iter().map(|line| numbers(line)).collect(),
            faces.iter().map(|line| places(line, 1)).collect(),
        )
    };
    let volume = |name: &str| -> f64 {
        let (corners, faces) = ply(name);
        assert_eq!((&corners, &faces), (&obj(name).0, &obj(name).1));
        let det = |a: &[f64], b: &[f64], c: &[f64]| {
            a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
                + a[2] * (b[0] * c[1] - b[1] * c[0])
        };
        let fan = |face: &Vec<usize>| -> f64 {
            let corner = |i: usize| corners[face[i]].as_slice();
            (2..face.len()).map(|i| det(corner(0), corner(i - 1), corner(i))).sum()
        };
        faces.iter().map(fan).sum::<f64>() / 6.0
    };
    let told = |place: usize| bounds[place]["volume"].as_f64();
    assert!((volume("hull") - told(0).unwrap()).abs() < 1e-9);
    match told(2) {
        Some(planes) => assert!((volume("half_spaces") - planes).abs() < 1e-9 * planes),
        None => assert!(!page.join("half_spaces.ply").exists()),
    }
    // of 96 directions round and 48 up a smooth body loses a thousandth or two
    let ellipsoid = 20.0 / 3.0 * PI;
    assert!(volume("body") < ellipsoid && volume("body") > 0.995 * ellipsoid);
    assert!(volume("shape") > 0.0 && volume("balls") > volume("hull"));
}

/// Windows begin with the last sample of the one before, and no sample is left out.
#[test]
fn windows_cover_the_record() {
    let rest = |window: usize| format!("[observer]\nwindow = {window}\n");
    for (window, count) in [(24, 3), (40, 2), (66, 2), (67, 1), (89, 1)] {
        let experiment = experiment(&text(89, BODY, &format!("{PALMS}\n{MOVED}"), &rest(window)));
        // what is left for the last one is 24 samples or more
        assert_eq!(experiment.count(), count, "{window}");
    }
}

/// A body that lies still tells no inertia and no mass: blind, and nothing is made up.
#[test]
fn a_body_that_lies_still_is_not_seen() {
    let still = text(
        60,
        &BODY.replace("[0, 0.3, 0.3]", "[0, 0, 0]"),
        &format!("{PALMS}\nprescribed = [{{ start = 1.0 }}, {{ start = 1.05 }}, {{ start = 1.1 }}]"),
        "",
    );
    let experiment = experiment(&still);
    let answers = experiment.run(&|| false, &|| ());
    assert_eq!(answers.updates[0].verdict, SpaceVerdict::Unobservable);
    assert!(answers.updates[0].state.is_none() && answers.shape.is_none());
    let folder = folder();
    let file = write(&folder, "still.toml", still);
    let run = palmistry(&["observe", file.to_str().unwrap()]);
    assert_eq!(run.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&run.stdout).contains(": not observable"));
}

/// What is wrong with a scene is said at its place.
#[test]
fn mistakes_are_marked() {
    let whole =
        text(89, BODY, &format!("{PALMS}\n{MOVED}"), "[sensor]\nnoise = 0\n[observer]\nwindow = 60\n");
    experiment(&whole);
    let mistakes = [
        ("kind = \"ellipsoid\"", "kind = \"elipsoid\"", "perhaps you meant 'ellipsoid'"),
        ("semi_axes = [2.5, 2, 1]", "mean = 2", "'mean' is no key of a shape of the kind 'ellipsoid'"),
        (", semi_axes = [2.5, 2, 1]", "", "has to have 'semi_axes'"),
        ("[2.5, 2, 1]", "[2.5, -2, 1]", "a semi-axis is -2"),
        (
            "\"ellipsoid\", semi_axes = [2.5, 2, 1]",
            "\"harmonics\", mean = 1, terms = [{ powers = [0, 0, 2], coefficient = 2 }]",
            "strictly convex",
        ),
        (
            "\"ellipsoid\", semi_axes = [2.5, 2, 1]",
            "\"blend\", parts = [{ times = 1, shape = { kind = \"ball\" } }]",
            "the kind 'ball' is not known",
        ),
        ("mass = 1.3", "mass = -1.3", "the body's mass is -1.3"),
        ("mass = 1.3", "mass = 1.3\ncolour = 3", "unknown key 'colour'"),
        ("mass = 1.3", "mass = 1.3\ninertia_over_mass = [1, 1, 3, 0, 0, 0]", "that of no body"),
        ("[0, 0.3, 0.3]", "[0, 30, 0.3]", "would have to pull"),
        ("samples = 89", "samples = 12", "there would be 12 samples"),
        ("duration = 1.76", "duration = 0", "has to be positive"),
        ("duration = 1.76\n", "", "what is simulated is not all said"),
        ("samples = 89", "samples = 89\nrate = 50", "'samples' or 'rate'"),
        ("window = 60", "window = 8", "determines no state"),
        ("window = 60", "window = 100", "longer than the record"),
        ("window = 60", "least_radius = 3\ngreatest_radius = 2", "and the greatest 2"),
        ("noise = 0", "noise = -1", "must not be negative"),
        ("prescribed =", "torques =", "unknown key 'start'"),
        ("[sensor]", "[data]\nrecord = \"run.csv\"\n[sensor]", "both simulated and recorded"),
        ("azimuth = [0, 2.1, 4.2]", "azimuth = [0, 0, 0]", "no pose of balance"),
        ("inertia = [0.5", "curvature = [0, -1, 0]\ninertia = [0.5", "palm 2 is hollow with a radius of 1 m"),
        ("inertia = [0.5", "curvature = [0, inf, 0]\ninertia = [0.5", "a curvature is inf"),
        ("inertia = [0.5", "touch_point = [[0, 0], [0, 2], [0, 0]]\ninertia = [0.5", "palm 2 is flat"),
        (
            "inertia = [0.5",
            "curvature = [1, 1, 1]\ntouch_point = [[0, 40], [0, 40], [0, 40]]\ninertia = [0.5",
            "no pose of balance",
        ),
        ("motion = \"spatial\"", "motion = \"spatial\"\ngravity = [0, 0, 0]", "nothing holds a body"),
    ];
    for (from, to, expected) in mistakes {
        let text = whole.replacen(from, to, 1);
        assert_ne!(text, whole, "{from}");
        let why = SpaceScene::parse("space.toml", &text).and_then(|scene| SpaceExperiment::new(scene, None));
        let why = format!("{:?}", miette::Report::new(why.err().unwrap_or_else(|| panic!("{to}"))));
        let why = why.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ");
        assert!(why.contains(expected), "{to}: {why}");
    }
}

/// What bodies in space have not is refused in words, and nothing is written.
#[test]
fn what_bodies_in_space_have_not_is_refused() {
    let folder = folder();
    let out = folder.path().join("parts");
    let out = out.to_str().unwrap();
    let cases: [(&[&str], &str); 7] = [
        (&["--shard", "1/2", "--part", out], "--shard is not for bodies in space"),
        (&["--merge", out], "--merge is not for bodies in space"),
        (&["--motion", "m.csv"], "--motion is not for bodies in space"),
        (&["--outline", "o.csv"], "--outline is not for bodies in space"),
        (&["--track", "t.csv"], "--track is not for bodies in space"),
        (&["--studies"], "--studies is not for bodies in space"),
        (&["--record", "-", "--json"], "--json asks for more"),
    ];
    for (asked, words) in cases {
        let output = palmistry(&[&["observe", SHIPPED], asked].concat());
        let told =
            String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout);
        let told = told.split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(output.status.code(), Some(2), "{asked:?}: {told}");
        assert!(told.contains(words), "{asked:?}: {told}");
        assert!(!Path::new(out).exists());
    }
}
