//! The page of a paper: what it holds, and what a reader does with it in a real browser.

mod browser;
mod size;

use crate::common::{folder, write};
pub use browser::browser;
use browser::{Look, look};
use palmistry::experiment::{BasinStudy, Experiment, Scene, Studied, basins};
use palmistry::paper::{Findings, Paper, VerifyOptions, verify};
use palmistry::report::{Observed, observe_page, page};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A file with a claim of every kind, a map, lines, sets; ids and a title that mean something in HTML and in addresses.
const PENDULUM: &str = r#"# a pendulum & its <length>
system "A pendulum <b>& more</b>"  cite "A. Author 1999, section 2"
state phi, omega0
param g = 10, k_1 = 2, k1 = 3
angle phi
let long = cos(phi)*omega0*g*k_1 + cos(phi)^2*omega0^2*g^2*k_1^2 + cos(phi)^3*omega0^3*g^3*k_1^3
drift f
  phi'    = omega0
  omega0' = -g*sin(phi)
output omega0^2 + k1*cos(phi) + sin(phi)
sample
  phi    in [-1, 1]
  omega0 in [1, 2]
set "at rest": omega0 = 0
set "with many conditions": omega0 = 0, phi = 0, g = 1, k_1 = 1, k1 = 1
map "plane": phi in [-1, 1], omega0 in [0, 2] at {g = 9} order 1 "nothing happens"
line "to rest": omega0 to 0
line "away": omega0 to infinity from {phi = 1/2}

claim 1: L(f, omega0) = -g*sin(phi)   # a comment that says pterodactyl
claim 1.b: rank = 2 "with a remark <i>that is no markup</i>"
claim 2: (k1 + omega0 + g + k_1)^2 = k1^2 + omega0^2 + g^2 + k_1^2 + 2*k1*omega0 + 2*k1*g + 2*k1*k_1 + 2*omega0*g
  + 2*omega0*k_1 + 2*g*k_1
claim text.same expect refuted: k_1 = k1
claim wide: det([long/(1 + long^2), 1, 0; 0, long, k1/(g*(omega0^2 + 1)^2); 1, 0, 1])
  = long^2/(1 + long^2) + k1/(g*(omega0^2 + 1)^2)
claim positive.wherever_the_stiffness_and.the_acceleration_are: 0 < g*k1 where g > 0, k1 > 0
erratum 3: printed g + g = 3*g  corrected g + g = 2*g "twice & not thrice"
definition 4: "a word that is defined"
undecided 5: "nobody knows < why"
"#;
/// Another file with a name that needs care, and the same ids.
const OTHER: &str =
    "system \"Another\"\nstate x\nclaim 1: x + x = 2*x\nclaim ä: x - x = 0\nclaim 10: x*x = x^2\n";

fn found() -> Findings {
    let folder = folder();
    write(&folder, "pendulum.proof", PENDULUM);
    write(&folder, "an other #1.proof", OTHER);
    write(
        &folder,
        "paper.toml",
        "title = \"Swings & <roundabouts>\"\nauthors = [\"A\"]\nyear = 1999\nequations = 6\n",
    );
    let options = VerifyOptions { seed: 1, interrupt: &false.into(), progress: &|_, _, _| (), timed: true };
    verify(&Paper::read(folder.path()).unwrap(), &options).unwrap()
}

/// The values of an attribute, in order.
fn values<'a>(page: &'a str, attribute: &str) -> Vec<&'a str> {
    let begin = format!(" {attribute}=");
    let value = |rest: &'a str| match rest.strip_prefix('"') {
        Some(quoted) => quoted.split('"').next(),
        None => rest.split([' ', '>']).next(),
    };
    page.split(&begin).skip(1).filter_map(value).collect()
}

/// Without a script: everything is there, once, and every way leads somewhere.
#[test]
fn the_page_is_whole() {
    let found = found();
    let claims = found.outcomes().count();
    assert_eq!(claims, 12);
    let page = page(&found);
    let ids = values(&page, "id");
    let unique: BTreeSet<&str> = ids.iter().copied().collect();
    assert_eq!(unique.len(), ids.len(), "{ids:?}");
    for id in &ids {
        assert!(id.chars().all(|c| c.is_ascii_alphanumeric() || "._-:".contains(c)), "{id}");
    }
    for href in values(&page, "href") {
        let target = href.strip_prefix('#').unwrap_or_else(|| panic!("{href} leaves the page"));
        assert!(unique.contains(target), "{href}");
    }
    // an entry a claim, each with its line: that on which its file has it
    let entries: Vec<&str> =
        page.split("<article ").skip(1).map(|part| part.split("</article>").next().unwrap()).collect();
    assert_eq!(entries.len(), claims);
    for (entry, outcome) in entries.iter().zip(found.outcomes()) {
        let (file, text) = match outcome.file.contains("pendulum") {
            true => ("1", PENDULUM),
            false => ("0", OTHER),
        };
        let link = values(entry, "href")[0].to_owned();
        let (name, line) = link.rsplit_once(':').unwrap();
        assert_eq!(name, format!("#{file}"), "{entry}");
        let line = text.lines().nth(line.parse::<usize>().unwrap() - 1).unwrap();
        assert!(
            line.contains(&format!(" {}:", outcome.id)) || line.contains(&format!(" {} ", outcome.id)),
            "{line}"
        );
        assert!(entry.contains(&format!("<b>{}</b>", outcome.word())), "{entry}");
    }
    assert!(
        page.contains("pterodactyl") && page.contains("&amp; its &lt;length>"),
        "the text of the file is there"
    );
    assert!(!page.contains("<i>that is") && !page.contains("<roundabouts>"));
    // what the header counts is what there is
    let tally = page.split("<ul class=tally>").nth(1).unwrap().split("</ul>").next().unwrap();
    let counts =
        tally.split("<b>").skip(1).map(|part| part.split('<').next().unwrap().parse::<usize>().unwrap());
    assert_eq!(counts.sum::<usize>(), claims, "{tally}");
    assert!(page.contains("id=filter hidden"));
    assert!(page.contains("<msub><mi>L</mi><mi>f</mi></msub>") && page.contains("k_1"));
    // one for each of: map, two lines
    assert!(page.matches("<svg ").count() >= 3);
    assert!(!page.contains("could not be drawn") && !page.contains("NaN"));
}

#[test]
fn a_reader_finds_their_way() {
    let Some(browser) = browser() else { return };
    let page = page(&found());
    if let Some(file) = std::env::var_os("PALMISTRY_KEEP_PAGE") {
        std::fs::write(file, &page).unwrap();
    }
    let searches = ["pterodactyl", "twice & not", "k_1", "no such thing"];
    for width in [400, 1400] {
        for dark in [false, true] {
            let seen = look(&browser, &page, &searches, &Look { width, dark });
            let place = format!("{width} pixels, dark: {dark}: {seen:#}");
            assert!(seen.get("error").is_none(), "{place}");
            assert_eq!((&seen["lost"], &seen["outside"]), (&json!([]), &json!([])), "{place}");
            assert!(seen["links"].as_u64() > Some(20), "{place}");
            assert_eq!((&seen["folded"], &seen["opened"]), (&json!(true), &json!(true)), "{place}");
            assert!(seen["line"].as_str().unwrap().contains("claim 1: x + x"), "{place}");
            assert_eq!(seen["inner"], width, "{place}");
            assert!(seen["scroll"].as_u64() <= Some(u64::from(width)), "{place}");
            assert_eq!(seen["wide"], json!([]), "{place}");
            assert_eq!((&seen["cut"], &seen["unmarked"]), (&json!([]), &json!([])), "{place}");
            assert_eq!(seen["untitled"], json!([]), "{place}");
            assert!(seen["pictures"].as_u64() >= Some(3), "{place}");
            assert!(seen["label"].as_f64() >= Some(10.0), "{place}");
            // each of the 12 steps of the map, and on each of two lines stripes whose values differ
            assert!(seen["hover"].as_u64() >= Some(12 + 2 * 2), "{place}");
            // WCAG 2.2, criterion 1.4.3
            assert!(seen["contrast"].as_f64() >= Some(4.5) && seen["texts"].as_u64() > Some(200), "{place}");
            assert_eq!(seen["paper"].as_f64() < Some(0.2), dark, "{place}");
            filters(&seen, &place);
        }
    }
}

/// A body in motion, its observers and their studies: the page of a scene.
const SCENE: &str = r#"
title = "A small <scene>"
model = "proofs/moll2002/general.proof"
duration = 0.3
samples = 61

[body]
shape = { kind = "harmonics", mean = 1.0, harmonics = [[0, 0], [0.08, 0.03]] }
mass = 1.0
rate = -1.0

[palms]
inertia = [0.5, 0.5]
prescribed = [{ start = 0.6, rate = 0.3 }, { start = 1.7 }]

[observer]
methods = ["trust-region", "integration"]
inputs = { g1 = "tau1", g2 = "tau2" }
estimate = ["r1", "r2", "omega0"]
guess_off = 0.1
window = 30
steps = 20
"#;

#[test]
fn the_page_of_a_scene_fits_too() {
    let Some(browser) = browser() else { return };
    let never = false.into();
    let scene = Scene::parse("small.toml", SCENE).unwrap();
    let experiment = Experiment::new(scene, None).unwrap();
    let answers = experiment.run(&never, &|_| {}).unwrap();
    let ranges = ["r1", "r2"].map(|name| (name.to_owned(), [0.9, 1.1])).into();
    let basins = basins(&experiment, &BasinStudy { ranges, points: 2 }, &never, &|| {}).unwrap();
    let (experiment, answers) = (&experiment, &answers[..]);
    let studied = &Studied { basins, ..Studied::default() };
    let page = observe_page(&Observed { experiment, answers, studied, interrupted: false });
    for (width, dark) in [(400, true), (1400, false)] {
        let seen = look(&browser, &page, &[], &Look { width, dark });
        let place = format!("{width} pixels, dark: {dark}: {seen:#}");
        assert!(seen.get("error").is_none(), "{place}");
        assert_eq!((&seen["lost"], &seen["outside"]), (&json!([]), &json!([])), "{place}");
        assert!(seen["scroll"].as_u64() <= Some(u64::from(width)), "{place}");
        assert_eq!((&seen["wide"], &seen["untitled"]), (&json!([]), &json!([])), "{place}");
        assert_eq!((&seen["cut"], &seen["unmarked"]), (&json!([]), &json!([])), "{place}");
        // twelve frames and the outline, three states with their errors, sensor errors, two basins
        assert_eq!(seen["pictures"], 12 + 1 + 6 + 3 + 2, "{place}");
        assert!(seen["label"].as_f64() >= Some(10.0), "{place}");
        assert!(seen["contrast"].as_f64() >= Some(4.5), "{place}");
        assert!(seen.get("form").is_none(), "{place}");
    }
}

/// Papers whose formulas are wide and whose ids are long: on no screen is something cut.
#[test]
fn nothing_of_a_paper_is_cut() {
    let Some(browser) = browser() else { return };
    for paper in ["proofs/koteich2015", "examples/papers/tyre", "examples/papers/bioreactor"] {
        let options = VerifyOptions { timed: false, ..VerifyOptions::default() };
        let page = page(&verify(&Paper::read(Path::new(paper)).unwrap(), &options).unwrap());
        // marks of indices that have become none
        assert!(!page.contains(['\u{e000}', '\u{e001}']), "{paper}");
        for (width, dark) in [(400, false), (1400, true)] {
            let seen = look(&browser, &page, &[], &Look { width, dark });
            let place = format!("{paper}, {width} pixels: {seen:#}");
            assert!(seen.get("error").is_none(), "{place}");
            for none in ["cut", "unmarked", "wide", "untitled", "lost"] {
                assert_eq!(seen[none], json!([]), "{none} of {place}");
            }
            assert!(seen["scroll"].as_u64() <= Some(u64::from(width)), "{place}");
            assert!(
                seen["label"].as_f64() >= Some(10.0) && seen["contrast"].as_f64() >= Some(4.5),
                "{place}"
            );
            let of_sets = |text: &Value| text.as_str().unwrap().starts_with("SPAN  f");
            assert!(!seen["scrolling"].as_array().unwrap().iter().any(of_sets) || width < 1400, "{place}");
        }
    }
}

/// A file without claims says so in a sentence, and has no list of none.
#[test]
fn a_file_without_claims_is_no_list_of_none() {
    let folder = folder();
    write(
        &folder,
        "one.proof",
        "system \"A decay\" state x, Fyf param k unknown drift f x' = -k*x Fyf' = x output x",
    );
    let options = VerifyOptions { timed: false, ..VerifyOptions::default() };
    let page = page(&verify(&Paper::read(folder.path()).unwrap(), &options).unwrap());
    assert!(page.contains("Nothing is claimed here"), "{page}");
    for part in ["0 claims", "as expected", "No errata", "id=claims", "#claims"] {
        assert!(!page.contains(part), "{part}");
    }
}

/// What sorting and filtering did.
fn filters(seen: &Value, place: &str) {
    assert_eq!((&seen["form"], &seen["claims"]), (&json!(true), &json!(12)), "{place}");
    let tally: BTreeMap<&str, u64> = seen["tally"]
        .as_array()
        .unwrap()
        .iter()
        .map(|one| (one[0].as_str().unwrap(), one[1].as_u64().unwrap()))
        .collect();
    assert_eq!(tally.values().sum::<u64>(), 12, "{place}");
    let words = seen["words"].as_array().unwrap();
    assert_eq!(words.len(), tally.len(), "{place}");
    for word in words {
        let (name, count) = (word[0].as_str().unwrap(), word[1].as_u64().unwrap());
        assert_eq!(tally.get(name), Some(&count), "{place}");
        assert_eq!(word[2], true, "{place}");
        assert_eq!(word[3], format!("{count} of 12 claims: {count} {name}"), "{place}");
    }
    assert_eq!(seen["files"], json!([["an other #1 (3)", 3], ["pendulum (9)", 9]]), "{place}");
    let searches = &seen["searches"];
    assert_eq!(searches["pterodactyl"], json!(["1"]), "{place}");
    assert_eq!(searches["twice & not"], json!(["3"]), "{place}");
    assert_eq!(searches["k_1"], json!(["2", "text.same"]), "{place}");
    assert_eq!(searches["no such thing"], json!([]), "{place}");
    let sorted = json!([
        "1",
        "1",
        "1.b",
        "2",
        "3",
        "4",
        "5",
        "10",
        "ä",
        "positive.wherever_the_stiffness_and.the_acceleration_are",
        "text.same",
        "wide"
    ]);
    assert_eq!(seen["sorted"], sorted, "{place}");
    assert_eq!(seen["again"], true, "{place}");
    assert_eq!((&seen["hidden"], &seen["revealed"]), (&json!(true), &json!(true)), "{place}");
}
