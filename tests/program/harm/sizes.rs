//! Sizes that lie, and files that are nothing but long.

use super::refused;
use crate::common::{folder, palmistry, write};
use palmistry::import::{ImportQuestion, import};
use palmistry::system::System;
use std::path::Path;

/// A part of 4 GiB is no part, and that is found out without reading it.
#[test]
fn a_part_is_looked_at_before_it_is_read() {
    let folder = folder();
    let proof = write(&folder, "a.proof", "system \"a\"\nstate x\noutput x\nsample\n  x in [-1, 1]\n");
    let parts = folder.path().join("parts");
    std::fs::create_dir(&parts).unwrap();
    for begin in ["", "{\n  \"format\": \"palmistry rank part 1\",\n"] {
        let file = std::fs::File::create(parts.join("rank-1-of-1.json")).unwrap();
        std::io::Write::write_all(&mut &file, begin.as_bytes()).unwrap();
        file.set_len(4 << 30).unwrap();
        refused(&["rank", proof.to_str().unwrap(), "--merge", parts.to_str().unwrap()]);
    }
}

/// A compartment without dimensions may have a size in level 3: a concentration in it is an amount by that size. In level 2 it has none.
#[test]
fn a_point_of_level_3_keeps_its_size() {
    let model = |level: &str, size: &str| {
        format!(
            "<sbml xmlns=\"http://www.sbml.org/sbml/level{level}\" level=\"{level}\" version=\"1\"><model id=\"m\">\
             <listOfCompartments><compartment id=\"c\" spatialDimensions=\"0\" {size} constant=\"true\"/></listOfCompartments>\
             <listOfSpecies><species id=\"s\" compartment=\"c\" initialAmount=\"6\" hasOnlySubstanceUnits=\"false\" boundaryCondition=\"false\" constant=\"false\"/></listOfSpecies>\
             <listOfParameters><parameter id=\"k\" value=\"3\" constant=\"true\"/></listOfParameters>\
             <listOfReactions><reaction id=\"r\" reversible=\"false\" fast=\"false\"><listOfReactants><speciesReference species=\"s\" stoichiometry=\"1\" constant=\"true\"/></listOfReactants>\
             <kineticLaw><math xmlns=\"http://www.w3.org/1998/Math/MathML\"><apply><times/><ci>k</ci><ci>s</ci></apply></math></kineticLaw></reaction></listOfReactions></model></sbml>"
        )
    };
    let rate = |text: &str| {
        let imported = import("a.xml", text, &ImportQuestion::default()).unwrap();
        imported.text.lines().find(|line| line.trim_start().starts_with("s' ")).unwrap().trim().to_owned()
    };
    assert_eq!(rate(&model("3", "size=\"2\"")), "s' = -r/c");
    assert_eq!(rate(&model("3", "")), "s' = -r");
    assert_eq!(rate(&model("2", "")), "s' = -r");
}

/// A chain of errata is followed once, from whichever end; and what goes round in a circle is found wherever one comes into it.
#[test]
fn chains_of_references_are_followed_once() {
    let entry = |i: usize, from: Option<usize>| {
        let follows = from.map_or(String::new(), |from| format!(" follows e{from}"));
        format!("erratum e{i}{follows}: printed x = 2*x corrected x = x\n")
    };
    let head = "system \"a\"\nstate x\n".to_owned();
    let count = 6000;
    let forward = (0..count).fold(head.clone(), |text, i| text + &entry(i, (i + 1 < count).then_some(i + 1)));
    let backward = (0..count).fold(head.clone(), |text, i| text + &entry(i, i.checked_sub(1)));
    for text in [forward, backward] {
        assert_eq!(System::parse("a.proof", &text, Path::new("")).unwrap().claims.len(), count);
    }
    // a circle of five, one that leads into it, one that ends elsewhere
    let mut circle = (0..5).fold(head, |text, i| text + &entry(i, Some((i + 1) % 5)));
    circle += &entry(7, Some(2));
    circle += &entry(8, Some(9));
    circle += &entry(9, None);
    let found = System::examine_text("a.proof", &circle, Path::new(""), 100);
    let said: Vec<&str> = found.problems.iter().map(|problem| problem.message.as_str()).collect();
    assert_eq!(said, ["0", "1", "2", "3", "4", "7"].map(|i| format!("'e{i}' is said to come from itself")));
}

/// The text of a scene that comes with the program, with another duration, and what `observe` says of it.
fn with_duration(scene: &str, duration: &str) -> std::process::Output {
    let folder = folder();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("proofs/moll2002");
    let text = std::fs::read_to_string(root.join("scenes").join(scene)).unwrap();
    let text = text.replace("\"../", &format!("\"{}/", root.display()));
    let line = text.lines().find(|line| line.starts_with("duration = ")).unwrap();
    let path = write(&folder, "scene.toml", text.replace(line, &format!("duration = {duration}")));
    palmistry(&["observe", path.to_str().unwrap()])
}

/// A duration in a wrong unit: sliding back and forth for thirty years comes to an end, and it is told which.
#[test]
fn a_motion_of_thirty_years_ends() {
    let output = with_duration("friction.toml", "1e9");
    let words = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(words.contains("the motion ended early, "), "{words}");
    assert_eq!(output.status.code(), Some(2), "{words}");
}

/// Where rates overflow no decomposition waits for them to converge: the run ends, and nothing fits.
#[test]
fn a_slow_motion_of_no_time_ends() {
    for duration in ["1e-300", "1e300"] {
        let output = with_duration("slow_jump.toml", duration);
        let words =
            String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
        assert!(matches!(output.status.code(), Some(1 | 2)), "{duration}: {words}");
        assert!(!words.contains("panicked"), "{words}");
    }
}

/// Many sets are entered; and of more states than a dense matrix has room for everything is decided but ranks.
#[test]
fn many_sets_are_read_and_ranks_of_too_many_states_are_refused() {
    let head = "system \"a\"\nstate x\n".to_owned();
    let sets = (0..64_000).fold(head, |text, i| text + &format!("set \"{i}\": x = {i}\n"));
    assert_eq!(System::parse("a.proof", &sets, Path::new("")).unwrap().sets.len(), 64_000);
    let twice = format!("{sets}set \"7\": x = 1/2\n");
    let error = System::parse("a.proof", &twice, Path::new("")).unwrap_err();
    assert_eq!(
        (error.to_string(), error.line_and_column().0),
        ("there is a set \"7\" already".to_owned(), 64_003)
    );

    let text = |count: usize, claim: &str| {
        let names = (0..count).map(|i| format!("x{i}")).collect::<Vec<_>>().join(", ");
        format!(
            "system \"a\"\nstate {names}\ndrift f\n x0' = x1\n others' = 0\noutput x0\nclaim 1: {claim}\n"
        )
    };
    let parsed = |count, claim| System::parse("a.proof", &text(count, claim), Path::new(""));
    assert_eq!(parsed(10_000, "rank = 2").unwrap().claims.len(), 1);
    assert_eq!(parsed(10_001, "L(f, x0) = x1").unwrap().claims.len(), 1);
    let words = "ranks and estimates are of at most 10000 states and unknown parameters, and these are 10001";
    let error = parsed(10_001, "rank = 2").unwrap_err();
    assert_eq!(error.to_string(), format!("claim 1: {words}"));

    let folder = folder();
    let path = write(&folder, "many.proof", text(10_001, "L(f, x0) = x1"));
    let said = refused(&["rank", path.to_str().unwrap()]);
    assert!(said.contains("ranks and estimates are of at most"), "{said}");
}
