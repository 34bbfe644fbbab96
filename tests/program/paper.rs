//! A paper is a folder: what stands in its files is looked at, drawn and decided, and nothing of it in the program.

use crate::common::{folder, json, palmistry, write};
use palmistry::System;
use palmistry::paper::{Findings, Paper, VerifyOptions, verify};
use palmistry::system::LineEnd;
use serde_json::{Value, json};
use std::path::Path;

/// A pendulum on a cart that is pushed, and the pendulum alone; by hand: where the cart rests the angle moves as that of a
/// pendulum of length 1.
const CART: &str = r#"
system "A pendulum on a cart"
state x, v, phi, omega
param g = 10
angle phi
drift f
  x'     = v
  v'     = 0
  phi'   = omega
  omega' = -g*sin(phi) - v*omega
output phi
sample
  x     in [1, 2]
  v     in [1, 2]
  phi   in [-1, 1]
  omega in [1, 2]
"#;
const PENDULUM: &str = r#"
system "A pendulum"
use cart = "cart.proof"
state phi, omega
angle phi
drift f
  phi'   = omega
  omega' = -g*sin(phi)
output phi
sample
  phi   in [-1, 1]
  omega in [1, 2]
reduction of cart: v = 0 "the cart rests"
set "at rest": omega = 0
singularity "hanging": sin(phi) = 0
map "plane": phi in [-1, 1], omega in [0, 2] at {g = 9} order 1 "nothing happens"
line "to rest": omega to 0
line "away": omega to infinity from {phi = 1/2}
line "to the balance": g to omega^2 + g = 7
claim 1: L(f, f, phi) = -g*sin(phi)
claim 2: (omega*g) at {omega = 2, g = 1.5} = 3.01 within 0.02 carrying 3 digits
"#;

fn found(folder: &Path) -> Findings {
    let options = VerifyOptions { seed: 1, interrupt: &false.into(), progress: &|_, _, _| (), timed: true };
    verify(&Paper::read(folder).unwrap(), &options).unwrap()
}

/// Everything that the files say is there, in the order of paper.toml, with what is known of each by hand.
#[test]
fn a_folder_is_taken_through_everything() {
    let folder = folder();
    write(&folder, "cart.proof", CART);
    write(&folder, "pendulum.proof", PENDULUM);
    write(
        &folder,
        "paper.toml",
        "title = \"Carts\"\nauthors = [\"A\", \"B\"]\nyear = 1999\nequations = 3\norder = [\"pendulum.proof\"]\n",
    );
    let found = found(folder.path());
    let paper = &found.paper;
    assert_eq!(
        (paper.authors_in_words().as_str(), paper.title.as_str(), paper.year),
        ("A and B, ", "Carts", Some(1999))
    );
    let names: Vec<&str> = found.files.iter().map(|file| file.system.name.as_str()).collect();
    assert_eq!(names, ["pendulum.proof", "cart.proof"]);
    let words: Vec<&str> =
        found.paper.numbering.equations(found.outcomes()).iter().map(|equation| equation.word()).collect();
    assert_eq!(words, ["proved", "proved", "no entry"]);

    let pendulum = &found.files[0];
    let left: Vec<String> =
        pendulum.left_out.iter().map(|left| format!("{}: {}", left.what, left.why)).collect();
    assert!(left.is_empty(), "{left:?}");
    let ranks: Vec<_> = pendulum.ranks.iter().map(|rank| (rank.name(), rank.as_expected())).collect();
    // where it hangs there is a rank, and the file says that there is none
    assert_eq!(ranks, [("the whole sample box", true), ("at rest", true), ("hanging", false)]);
    for rank in &pendulum.ranks {
        for branch in &rank.found.as_ref().unwrap().branches {
            assert_eq!(
                branch.full.rank_histogram.keys().copied().collect::<Vec<_>>(),
                [2],
                "{}",
                rank.name()
            );
        }
    }
    assert!(!pendulum.ok() && !found.ok());
    let map = &pendulum.maps[0];
    assert_eq!((map.view.title.as_str(), map.view.order, map.maps.len()), ("plane", Some(1), 1));
    let (x, y) = (&map.maps[0].1.x, &map.maps[0].1.y);
    assert_eq!((x.name.as_str(), x.low, x.high, y.high), ("phi", -1.0, 1.0, 2.0));
    assert_eq!(map.view.caption.as_deref(), Some("nothing happens"));
    let ends: Vec<bool> = pendulum.lines.iter().map(|line| line.view.end == LineEnd::Infinity).collect();
    assert_eq!(ends, [false, true, false]);
    // what a line is not told it has from the map before it
    assert_eq!(pendulum.lines[0].view.from[0].0, "g");
    assert_eq!(pendulum.lines[1].view.from[0].0, "phi");

    // conditions, fields, what is left out (x, v), outputs, differentials: v' = 0, phi', omega', x' = v = 0, v' = 0, phi,
    // d(L(f, phi))
    let reduction = &pendulum.reductions[0];
    assert!(
        reduction.proved(),
        "{:?}",
        reduction.claims.iter().map(|c| (&c.statement, c.ok)).collect::<Vec<_>>()
    );
    assert_eq!((reduction.claims.len(), &reduction.left_out[..]), (7, &["x".to_owned(), "v".to_owned()][..]));
    let saved = reduction.comparison.as_ref().unwrap();
    assert_eq!((saved.small_states, saved.large_states), (2, 4));
    // 2 times 1.5 is 3, and three digits do not explain one hundredth
    let printed = &pendulum.printed[0].values[0];
    assert_eq!((printed.printed.as_str(), printed.carried, printed.digits_that_agree), ("3.01", 3, 2));
    assert!(!printed.study.as_ref().unwrap().contains(printed.error));
    assert!(pendulum.derivatives.is_some() && pendulum.trade.is_some() && pendulum.certificate.is_some());
    // the other file names nothing to be looked at
    assert!(pendulum.stress.is_some());
    let cart = &found.files[1];
    assert!(
        cart.trade.is_none() && cart.stress.is_none() && cart.certificate.is_none() && cart.ranks.len() == 1
    );
}

/// A reduction that is none: the cart moves, and then the angle does not go as that of a pendulum.
#[test]
fn a_false_reduction_is_not_proved() {
    let folder = folder();
    write(&folder, "cart.proof", CART);
    let reduction = |text: &str| {
        write(&folder, "pendulum.proof", PENDULUM.replace("reduction of cart: v = 0", text));
        let findings = found(&folder.path().join("pendulum.proof"));
        let file = findings.files.into_iter().next().unwrap();
        (file.reductions, file.left_out)
    };
    let reduction_of = |output: &str| {
        write(&folder, "pendulum.proof", PENDULUM.replace("output phi", output));
        let findings = found(&folder.path().join("pendulum.proof"));
        let file = findings.files.into_iter().next().unwrap();
        (file.reductions, file.left_out)
    };
    // v stays 1, but omega' has a term more, and x moves
    let (found, _) = reduction("reduction of cart: v = 1");
    let wrong: Vec<&str> = found[0].claims.iter().filter(|c| !c.ok).map(|c| c.statement.as_str()).collect();
    assert_eq!(wrong.len(), 2, "{wrong:?}");
    assert!(wrong.iter().all(|statement| statement.contains("where v = 1")));
    // phi = 0 does not stay so
    let (found, _) = reduction("reduction of cart: v = 0, phi = 0");
    assert!(!found[0].proved());
    // one name, two outputs
    write(&folder, "cart.proof", CART.replace("output phi", "let seen = phi\noutput seen"));
    let (found, _) = reduction_of("let seen = phi + omega\noutput seen");
    let wrong: Vec<&str> = found[0].claims.iter().filter(|c| !c.ok).map(|c| c.statement.as_str()).collect();
    assert_eq!(
        wrong,
        [
            "seen = det([1]*cart.output) where v = 0",
            "d(L(f, seen), phi, omega) = d(L(cart.f, det([1]*cart.output)), phi, omega) where v = 0"
        ]
    );
    // something seen besides that is not known
    write(&folder, "cart.proof", CART.replace("output phi", "output phi, v + omega"));
    let (found, _) = reduction_of("output phi");
    let wrong: Vec<&str> = found[0].claims.iter().filter(|c| !c.ok).map(|c| c.statement.as_str()).collect();
    assert_eq!(wrong, ["d(det([0, 1]*cart.output), phi, omega) = [0, 0] where v = 0"]);
    write(&folder, "cart.proof", CART);
    // no state of the larger system
    write(&folder, "cart.proof", CART.replace("omega", "w"));
    let (found, left) = reduction("reduction of cart: v = 0");
    assert!(found.is_empty() && left[0].why.contains("'omega' is no state of cart"), "{left:?}");
}

/// A row a mistake: what stands in the file, what is said, and at which text.
#[test]
fn mistakes_are_marked_where_they_are() {
    for (line, message, marked) in [
        ("set \"a\": x = 0\nset \"a\": y = 0", "there is a set \"a\" already", "\"a\""),
        ("set \"\": x = 0", "a name between the quotation marks", "\""),
        ("set \"a\" x = 0", "':' behind the name", "x"),
        ("set \"a\": z = 0", "unknown name 'z'", "z"),
        ("set \"a\": x = 0 within 1", "met exactly", "1"),
        ("set \"a\": [x, y] = 0", "", "[x, y]"),
        ("pole \"a\": rank = 1", "", "rank"),
        ("map \"m\": x in [0, 1]", "two coordinates", "x"),
        ("map \"m\": x in [0, 1], y in [0, 1], k in [0, 1]", "two coordinates", "x"),
        ("map \"m\": x in [0, 1], x in [0, 2]", "the two coordinates are one", "x"),
        ("map \"m\": x in [1, 1], y in [0, 1]", "no width", "1, 1"),
        ("map \"m\": x in [0, y], y in [0, 1]", "expected a rational number", "y"),
        ("map \"m\": x in [0, 1], z in [0, 1]", "unknown state or parameter 'z'", "z"),
        ("map \"m\": x in [0, 1], y in [0, 1] at {z = 1}", "unknown state or parameter 'z'", "z"),
        ("map \"m\": x in [0, 1], y in [0, 1] order 13", "order of Lie derivatives", "13"),
        ("map \"m\": x in [0, 1], y in [0, 1] order 1/2", "order of Lie derivatives", "1/2"),
        ("line \"l\": z to 1", "unknown state or parameter 'z'", "z"),
        ("line \"l\": x 1", "'to'", "1"),
        ("line \"l\": x to 1 from {x = 1, x = 2}", "'x' is given twice", "x"),
        ("reduction of other: x = 0", "there is no imported system 'other'", "other"),
        ("claim 1: x = y carrying 10 digits", "a number in print", "x = y carrying 10 digits"),
        ("claim 1: 2*x = 4 carrying 0 digits", "a number of digits from 1 to 30", "0"),
        ("claim 1: 2*x < 4 carrying 9 digits", "a number in print", "2*x < 4 carrying 9 digits"),
    ] {
        let text = format!("system \"s\"\nstate x, y\nparam k\ndrift f\n others' = 0\noutput x\n{line}\n");
        let error = System::parse("test.proof", &text, Path::new("")).expect_err(line);
        assert!(error.message.contains(message), "{line}: {}", error.message);
        let (begin, length) = (error.span.offset(), error.span.len());
        let whole = &text[begin..begin + length.max(1)];
        assert!(marked.starts_with(whole) || whole.starts_with(marked), "{line}: marked '{whole}'");
    }
}

/// A pole is one also where the words that were needed exist on it: a divisor of a rate, that no output's derivative has met.
#[test]
fn a_pole_of_the_fields_is_a_pole() {
    let text = "system \"s\"\nstate x, y\ndrift f\n  x' = y\n  y' = 1/x\noutput x\nsample\n  x in [1, 2]\n  \
        y in [1, 2]\npole \"p\": x = 0\nset \"q\": x = 0, y = 1\nset \"r\": y = 0\nset \"none\": x = 0, x = 1\n";
    let folder = folder();
    let file = write(&folder, "s.proof", text);
    let found = found(&file);
    let ranks: Vec<_> =
        found.files[0].ranks.iter().map(|rank| (rank.name(), rank.is_pole(), rank.as_expected())).collect();
    let whole = ("the whole sample box", false, true);
    assert_eq!(
        ranks,
        [whole, ("p", true, true), ("q", true, false), ("r", false, true), ("none", false, false)]
    );
}

/// Where a force is written with an absolute value its derivative has a part on either side, and a set on the kink lies in none of them: there
/// is no rank, which is not as expected, and all that is written says why.
#[test]
fn a_set_without_a_rank_is_not_as_expected() {
    let text = "system \"A vehicle on a kink\"\nstate vy, r\nparam mu = 1/2 unknown\nlet slip = vy*5 + r*6\ndrift f\n  \
        vy' = -mu*slip/(1 + abs(slip)) - 20*r\n  r' = -mu*slip/(1 + abs(slip))\noutput r\nsample\n  vy in [-1, 1]\n  \
        r in [-1, 1]\n  mu in [1/5, 1]\nset \"straight driving\": vy = 0, r = 0\nset \"a turn\": vy = 0\n";
    let folder = folder();
    let file = write(&folder, "kink.proof", text);
    let out = folder.path().join("out");
    let verify = |more: &[&str]| {
        let paths = [file.to_str().unwrap(), "--no-times", "--out", out.to_str().unwrap()];
        palmistry(&[&["verify"][..], &paths[..], more].concat())
    };
    let output = verify(&["--json"]);
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
    let found = json(&output);
    let ranks = found["files"][0]["ranks"].as_array().unwrap();
    let expected: Vec<&Value> = ranks.iter().map(|rank| &rank["as_expected"]).collect();
    assert_eq!((&found["ok"], expected), (&json!(false), vec![&json!(true), &json!(false), &json!(true)]));
    let why = ranks[1]["not_decided"].as_str().unwrap();
    assert!(why.len() > 20, "{why}");
    let page = std::fs::read_to_string(out.join("index.html")).unwrap();
    let row = page.split("straight driving").nth(1).unwrap().split("</tr>").next().unwrap();
    // names are symbols there: the reason up to the first of them
    assert!(row.contains("class=bad") && row.contains(why.split(" where").next().unwrap()), "{row}");
    let text = String::from_utf8(verify(&[]).stdout).unwrap();
    let line = text.lines().find(|line| line.trim_start().starts_with("straight driving")).unwrap();
    assert!(line.contains(why) && line.ends_with("not as expected"), "{line}");
    // no claim fails, and the summary does not say that all is well
    assert!(text.contains("0 claims; 0 not as expected, and 1 result besides the claims\n"), "{text}");
    assert!(page.contains("1 result besides the claims</b> is not as expected"), "the page's summary");
}

/// The words of the new entries are names all the same.
#[test]
fn words_of_entries_are_names() {
    let text = "system \"s\"\nstate set, map, line, pole, reduction, to, from\nparam order, of\ndrift f\n  set' = map\n  \
        map' = line\n  others' = 0\noutput set\nsample\n  set in [0, 1]\n  map in [0, 1]\nset \"set\": set = 0\n\
        pole \"p\": map = 0\nmap \"map\": map in [0, 1], line in [1, 2] order 1\nline \"line\": line to map = 2 from {set = 1}\n\
        claim 1: L(f, f, set) = line\nclaim 2: pole(1/pole, pole) = 1\n";
    let system = System::parse("test.proof", text, Path::new("")).unwrap();
    assert_eq!((system.sets.len(), system.maps.len(), system.lines.len(), system.claims.len()), (2, 1, 1, 2));
}

/// A paper may have scenes of every kind: in motion, at rest, in space. A mistake in one is told before anything is decided.
#[test]
fn a_paper_has_scenes_of_every_kind() {
    let folder = folder();
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("proofs/moll2002/scenes");
    let named = |name: &str| format!("{:?}", scenes.join(name).to_str().unwrap());
    write(&folder, "cart.proof", "system \"cart\"\nstate x\nclaim one: x + x = 2*x\n");
    let all = ["figure_5_3.toml", "turning_point.toml", "slow_jump.toml"].map(named).join(", ");
    write(&folder, "paper.toml", format!("title = \"t\"\nscenes = [{all}]\n"));
    let out = folder.path().join("out");
    let verified =
        || palmistry(&["verify", folder.path().to_str().unwrap(), "--json", "--out", out.to_str().unwrap()]);
    let output = verified();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let found = json(&output);
    assert_eq!((&found["counts"]["proved"], found["experiments"].as_array().unwrap().len()), (&1.into(), 3));
    // of the ellipsoid the mass, which nobody has told
    let mass = &found["experiments"][2]["updates"][0]["states"]["m"];
    assert!((mass["recovered"].as_f64().unwrap() - 1.0).abs() < 1e-6, "{mass}");
    let page = std::fs::read_to_string(out.join("index.html")).unwrap();
    for title in ["Figure 5.3: an ellipsoid on three palms", "Section 3.7: a body that jumps"] {
        assert_eq!(page.matches(&format!("<h3>{title}</h3>")).count(), 1, "{title}");
    }
    assert!(page.contains("id=space") && page.contains("class=solid") && !page.contains("NaN"));

    let text = std::fs::read_to_string(scenes.join("figure_5_3.toml")).unwrap();
    write(&folder, "wrong.toml", text.replace("balanced = true", "balances = true"));
    write(&folder, "paper.toml", "title = \"t\"\nscenes = [\"wrong.toml\"]\n");
    let output = verified();
    let error = json(&output)["error"].clone();
    assert_eq!(output.status.code(), Some(2));
    assert!(error["message"].as_str().unwrap().contains("balances"), "{error}");
    assert_eq!(error["line"], 12, "{error}");
}

/// What paper.toml may not say, and what is said of it.
#[test]
fn a_bad_description_is_told() {
    let folder = folder();
    write(&folder, "cart.proof", CART);
    for (text, message) in [
        ("", "missing field `title`"),
        ("title = 3", "invalid type"),
        ("title = \"t\"\nauthor = \"a\"", "unknown field `author`"),
        ("title = \"t\"\norder = [\"card.proof\"]", "there is no file"),
        ("title = \"t\"\norder = [\"cart.proof\", \"cart.proof\"]", "named twice"),
        ("title = \"t\"\nscenes = [\"none.toml\"]", "there is no file"),
        ("title = \"t\"\nequations = 1000000", "more than 100000 equations"),
        ("title = \"t\"\nequations = -1", "last equation"),
        ("title = \"t\"\n[equations]\n4 = \"x\"", "u32"),
        ("title = ", ""),
        ("\u{0}", ""),
    ] {
        let file = write(&folder, "paper.toml", text);
        let output = palmistry(&["verify", folder.path().to_str().unwrap(), "--json", "--out", "none"]);
        assert_eq!(output.status.code(), Some(2), "{text}");
        let error = json(&output)["error"].clone();
        assert!(error["message"].as_str().unwrap().contains(message), "{text}: {error}");
        assert_eq!(error["file"].as_str().unwrap(), file.to_str().unwrap(), "{text}");
    }
    // parts in the order of the file
    write(&folder, "paper.toml", "title = \"t\"\n[equations]\n10 = 2\n9 = 1\nA = 1\n");
    let paper = Paper::read(folder.path()).unwrap();
    let numbers: Vec<String> = paper.numbering.equations([]).into_iter().map(|e| e.number).collect();
    assert_eq!(numbers, ["10.1", "10.2", "9.1", "A.1"]);
    std::fs::remove_file(folder.path().join("paper.toml")).unwrap();
    let paper = Paper::read(folder.path()).unwrap();
    assert_eq!((paper.files, paper.numbering.count()), (vec!["cart.proof".to_owned()], 0));
    let empty = crate::common::folder();
    assert!(Paper::read(empty.path()).unwrap_err().message.contains("holds no proof file"));
    assert!(
        Paper::read(&empty.path().join("none")).unwrap_err().message.contains("there is no folder or file")
    );
}

/// The program has its papers with it, wherever it runs; all files that are there, and as they are.
#[test]
fn papers_come_with_the_program() {
    let folder = folder();
    let run = |arguments: &[&str]| {
        let program = env!("CARGO_BIN_EXE_palmistry");
        std::process::Command::new(program).args(arguments).current_dir(folder.path()).output().unwrap()
    };
    let output = run(&["verify", "--paper", "none", "--json"]);
    assert_eq!(output.status.code(), Some(2));
    let error = json(&output)["error"].clone();
    for entry in std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("proofs")).unwrap() {
        let entry = entry.unwrap();
        if !entry.path().join("paper.toml").is_file() {
            continue; // the library for Coq
        }
        let name = entry.file_name().into_string().unwrap();
        let advice = "a paper that is new is packed when build.rs runs again: touch it";
        assert!(error["help"].as_str().unwrap().contains(&name), "{error}; {advice}");
    }
    // a file that came with the program, by its path
    let output = run(&["prove", "papers:moll2002/same_rate.proof", "--json"]);
    let packed = json(&output);
    let output = palmistry(&["prove", "proofs/moll2002/same_rate.proof", "--json"]);
    let on_disk = json(&output);
    let statements = |found: &serde_json::Value| {
        let claims = found["claims"].as_array().unwrap();
        claims.iter().map(|claim| (claim["id"].clone(), claim["verdict"].clone())).collect::<Vec<_>>()
    };
    assert!(statements(&packed).len() > 70);
    assert_eq!(statements(&packed), statements(&on_disk));
}

/// A new paper proves and is verified, and nothing that is there is lost to it.
#[test]
fn a_new_paper_proves() {
    let folder = folder();
    let place = folder.path().join("a/b");
    let name = place.to_str().unwrap();
    let made = palmistry(&["new", name, "--json"]);
    assert_eq!((made.status.code(), json(&made)["files"].as_array().unwrap().len()), (Some(0), 2));
    for file in ["paper.toml", "pendulum.proof"] {
        let text = std::fs::read_to_string(place.join(file)).unwrap();
        // a comment on each line that is not blank, or on the one above
        let lines: Vec<&str> = text.lines().collect();
        let commented = lines.iter().filter(|line| line.contains('#') || line.contains('"')).count();
        assert!(commented > lines.iter().filter(|line| !line.trim().is_empty()).count() / 2, "{file}");
    }
    let found =
        json(&palmistry(&["verify", name, "--json", "--out", folder.path().join("out").to_str().unwrap()]));
    assert_eq!((&found["ok"], &found["paper"]["title"]), (&true.into(), &"A paper of my own".into()));
    assert_eq!(found["files"][0]["left_out"].as_array().unwrap().len(), 0);
    let page = std::fs::read_to_string(folder.path().join("out/index.html")).unwrap();
    assert!(page.contains("A pendulum whose angle is measured") && page.contains("no length"));
    // what is there stays as it is, and nothing is left beside it
    write(&folder, "a/b/mine.proof", "system \"mine\"");
    for taken in
        [name, place.join("paper.toml").to_str().unwrap(), place.join("paper.toml/x").to_str().unwrap()]
    {
        let output = palmistry(&["new", taken, "--json"]);
        assert_eq!(output.status.code(), Some(2), "{taken}");
    }
    assert_eq!(std::fs::read_dir(&place).unwrap().count(), 3);
    assert_eq!(std::fs::read_dir(folder.path().join("a")).unwrap().count(), 1);
    // an empty folder is taken
    let empty = folder.path().join("empty");
    std::fs::create_dir(&empty).unwrap();
    assert_eq!(palmistry(&["new", empty.to_str().unwrap()]).status.code(), Some(0));
    assert!(empty.join("paper.toml").is_file());
}

/// The demonstration answers its four questions, each command shown before its answer, and its files are there to be changed.
#[test]
fn a_demonstration_answers_four_questions() {
    let folder = folder();
    let place = folder.path().join("shown");
    let name = place.to_str().unwrap();
    let output = palmistry(&["demo", name]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    let mut rest = told.as_str();
    for words in [
        "system \"A spring with a damper",
        "$ palmistry rank",
        "k  parameter  locally identifiable",
        "$ palmistry prove",
        "ok   proved     energy",
        "3 claims: 2 proved, 1 refuted; 0 not as expected",
        "$ palmistry observe",
        "passes the chi-square test",
        "$ palmistry verify",
        "page/index.html in a browser",
    ] {
        let at = rest
            .find(words)
            .unwrap_or_else(|| panic!("'{words}' is not there, or not in its place:\n{told}"));
        rest = &rest[at..];
    }
    let page = std::fs::read_to_string(place.join("page/index.html")).unwrap();
    assert!(page.contains("A spring with a damper") && page.contains("<svg"));
    // nothing that is there is lost
    let again = palmistry(&["demo", name, "--json"]);
    assert_eq!(again.status.code(), Some(2));
    assert!(json(&again)["error"]["message"].as_str().unwrap().contains("is not empty"));
    let other = folder.path().join("other");
    let found = json(&palmistry(&["demo", other.to_str().unwrap(), "--json"]));
    let statuses: Vec<_> =
        found["commands"].as_array().unwrap().iter().map(|c| c["status"].as_i64()).collect();
    assert_eq!(statuses, [Some(0); 4]);
}

#[test]
fn a_version_tells_what_was_built() {
    let line = concat!("palmistry ", env!("CARGO_PKG_VERSION"));
    for short in ["--version", "-V"] {
        assert_eq!(String::from_utf8_lossy(&palmistry(&[short]).stdout).trim_end(), line);
    }
    let told = String::from_utf8_lossy(&palmistry(&["--version", "--verbose"]).stdout).into_owned();
    assert!(told.starts_with(line), "{told}");
    for row in ["commit", "compiler   rustc", "target", "features", "numbers", "processor"] {
        assert!(told.contains(&format!("\n  {row}")), "{row}: {told}");
    }
    assert_eq!(palmistry(&["--verbose"]).status.code(), Some(2));
}

/// Shipped files are in normal form; and whatever is cut out of one, its form is the same signs, read as before, and its own form.
#[test]
fn the_normal_form_changes_no_sign() {
    use palmistry::system::format_text;
    let mut files = Vec::new();
    for folder in std::fs::read_dir("proofs").unwrap() {
        for file in std::fs::read_dir(folder.unwrap().path()).unwrap() {
            let path = file.unwrap().path();
            if path.extension().is_some_and(|e| e == "proof") {
                files.push(path);
            }
        }
    }
    assert!(files.len() > 30);
    let check = palmistry(&["fmt", "proofs", "--check", "--json"]);
    assert_eq!((check.status.code(), &json(&check)["changed"]), (Some(0), &serde_json::json!([])));
    let signs = |text: &str| text.chars().filter(|c| !c.is_whitespace()).collect::<String>();
    let claims = |text: &str, folder: &Path| {
        let system = System::parse("", text, folder).unwrap();
        let statement = |span: &std::ops::Range<usize>| {
            system.source[span.clone()].split_whitespace().collect::<String>()
        };
        let all = system
            .claims
            .iter()
            .flat_map(|claim| claim.body.statements().into_iter().map(|s| statement(&s.span)));
        all.collect::<Vec<_>>()
    };
    let (mut formed, mut refused) = (0, 0);
    for (number, file) in files.iter().enumerate() {
        let text = std::fs::read_to_string(file).unwrap();
        let folder = file.parent().unwrap();
        // blanks in front of lines, tabulators and empty lines, where no text goes on
        let spoilt = text.replace("\nlet ", "  \n\n\n\tlet ").replace("\n  others'", "\n\t  others'");
        let form = format_text("a", &spoilt).unwrap();
        assert_eq!(claims(&form, folder), claims(&text, folder), "{}", file.display());
        let lines: Vec<&str> = text.lines().collect();
        for place in (number % 7..lines.len()).step_by(23) {
            let damaged = [&lines[..place], &lines[place + 1..]].concat().join("\n");
            match format_text("a", &damaged) {
                Ok(form) => {
                    assert_eq!(signs(&form), signs(&damaged));
                    assert_eq!(
                        format_text("a", &form).unwrap(),
                        form,
                        "{} without line {place}",
                        file.display()
                    );
                    formed += 1;
                }
                Err(_) => refused += 1,
            }
        }
    }
    assert!(formed > 50 && refused > 5, "{formed} {refused}");
    // a file that cannot be read is left, and so are all others of the same run
    let folder = folder();
    let good = write(&folder, "a.proof", "system \"s\"\n\n\nstate x\n");
    write(&folder, "b.proof", "sistem");
    let output = palmistry(&["fmt", folder.path().to_str().unwrap(), "--json"]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(std::fs::read_to_string(&good).unwrap(), "system \"s\"\n\n\nstate x\n");
    std::fs::remove_file(folder.path().join("b.proof")).unwrap();
    let check = palmistry(&["fmt", folder.path().to_str().unwrap(), "--check"]);
    assert_eq!(check.status.code(), Some(1));
    assert_eq!(palmistry(&["fmt", folder.path().to_str().unwrap()]).status.code(), Some(0));
    assert_eq!(std::fs::read_to_string(&good).unwrap(), "system \"s\"\n\nstate x\n");
}
