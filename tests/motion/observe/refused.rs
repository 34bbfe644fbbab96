//! Scenes that cannot be used: a clear error at its place, and no panic.

use crate::common::{folder, write};
use crate::observe::{observe, refusal, text, with};

/// A change to `same_rate`: from, to, what the error says, what it advises, and the line it names, by its beginning.
type Mistake = (&'static str, &'static str, &'static str, &'static str, &'static str);

const MISTAKES: [Mistake; 17] = [
    ("mass = 1.0", "mas = 1.0", "unknown key 'mas'", "perhaps you meant 'mass'", "mas = "),
    ("mass = 1.0", "mass = -1.0", "'mass' has to be positive, and is -1", "in kg", "mass = "),
    ("mass = 1.0", "mass = nan", "'mass' has to be positive, and is NaN", "in kg", "mass = "),
    ("\"r1\", \"r2\", \"omega0\"", "\"r1\", \"r3\"", "'r3' is no state of the system", "'r1'", "estimate = "),
    (
        "\"r1\", \"r2\", \"omega0\"",
        "\"r1\", \"tau1\"",
        "'tau1' is no state",
        "estimates states",
        "estimate = ",
    ),
    ("\"r1\", \"r2\", \"omega0\"", "", "nothing to estimate", "name the states", "estimate = "),
    ("g1 = \"tau1\"", "g7 = \"tau1\"", "no field 'g7'", "", "inputs = "),
    ("g1 = \"tau1\"", "g1 = \"tau7\"", "declares no 'tau7'", "", "inputs = "),
    ("[0.03, -0.04]", "[0.6, -0.04]", "the body is not strictly convex", "centre of mass inside", "shape = "),
    (
        "start = 0.4, rate = 0.4",
        "start = 2.4, rate = 0.4",
        "palm 1 would have to pull",
        "pushed by both",
        "[palms]",
    ),
    ("start = 1.8", "start = 3.5", "do not form a V", "between 0 and pi", "prescribed = "),
    ("steps = 20", "steps = 20\nclamp = [\"rho\"]", "'rho' is not in 'estimate'", "", "clamp = "),
    (
        "samples = 401",
        "samples = 40100000000",
        "'samples' cannot be 40100000000",
        "2 to 1000000",
        "samples = ",
    ),
    ("samples = 401", "rate = 1e15", "at 1000000000000000 Hz", "samples", "rate = 1e15"),
    ("samples = 401", "samples = -1", "a whole number that is not negative", "", "samples = "),
    ("window = 80", "window = 402", "'window' cannot be 402", "from 2 to 401", "window = "),
    ("general.proof", "generel.proof", "there is no file", "general.proof", "model = "),
];

#[test]
fn mistakes_in_a_scene_are_shown_at_their_place() {
    let folder = folder();
    for (from, to, says, advises, place) in MISTAKES {
        let changed = with(&text("same_rate"), from, to);
        let scene = write(&folder, "scene.toml", &changed);
        let (output, found) = observe(&scene, &[]);
        let (message, help) = refusal(&output, &found);
        assert!(message.contains(says), "{to}: {message}");
        assert!(help.contains(advises) && !help.is_empty(), "{to}: {help}");
        let line = found["error"]["line"].as_u64().unwrap() as usize;
        let named = changed.lines().nth(line - 1).unwrap();
        assert!(named.starts_with(place), "{to}: line {line} is {named}");
        assert_eq!(found["error"]["file"].as_str(), scene.to_str(), "{to}");
    }
}

/// A model with a constant that neither bodies nor columns nor the file itself give.
#[test]
fn what_no_one_tells_is_named() {
    let folder = folder();
    let model = "system \"one palm\" state r1, s1 param drag drift f r1' = -drag*s1 s1' = r1 output s1";
    write(&folder, "drag.proof", model);
    let inner = text("same_rate");
    let begin = inner.find("model = ").unwrap();
    let end = begin + inner[begin..].find('\n').unwrap();
    let changed = with(&inner, &inner[begin..end], "model = \"drag.proof\"");
    let changed = with(&changed, "inputs = { g1 = \"tau1\", g2 = \"tau2\" }\n", "");
    let changed = with(&changed, "\"r1\", \"r2\", \"omega0\"", "\"r1\"");
    let scene = write(&folder, "scene.toml", &changed);
    let (output, found) = observe(&scene, &[]);
    let (message, _) = refusal(&output, &found);
    assert!(message.contains("nothing determines 'drag'") && message.contains("known"), "{message}");
    // told, it is a model, if a wrong one
    let told = with(&changed, "window = 80", "window = 80\nknown = { drag = 0.5 }");
    let (output, found) = observe(&write(&folder, "scene.toml", told), &[]);
    assert!(output.status.code().is_some_and(|code| code < 2), "{found}");
}

#[test]
fn files_that_are_no_scene_are_refused() {
    let folder = folder();
    for (name, bytes) in [
        ("empty.toml", b"".as_slice()),
        ("binary.toml", b"title = \"\xff\""),
        ("broken.toml", b"title = \"never closed"),
        ("other.toml", b"[package]\nname = \"other\"\n"),
    ] {
        let scene = write(&folder, name, bytes);
        let (output, found) = observe(&scene, &[]);
        assert_eq!(output.status.code(), Some(2), "{name}: {found}");
        assert!(!found["error"]["message"].as_str().unwrap().is_empty());
    }
    let (output, found) = observe(&folder.path().join("none.toml"), &[]);
    assert_eq!(output.status.code(), Some(2), "{found}");
    let (output, found) = observe(folder.path(), &[]);
    assert_eq!(output.status.code(), Some(2), "{found}");
}
