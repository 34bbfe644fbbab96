//! The pictures of the README are made by the program: taken out of the pages that it writes, on a ground of their own, so that they
//! are legible on white and on dark pages.

use crate::blocks::blocks;
use crate::common::{folder, palmistry};
use crate::picture::Picture;
use std::path::{Path, PathBuf};

/// A picture of a page, as a file of its own: with quotes around values, and the looks that the page keeps in its style.
fn alone(page: &Path, title: &str) -> String {
    let html = std::fs::read_to_string(page).expect("a page");
    let pictures = html.split("<svg ").skip(1).filter_map(|rest| rest.split_once("</svg>"));
    let mut pictures = pictures.map(|(svg, _)| quoted(&format!("<svg {svg}")));
    let label = format!("aria-label=\"{title}\"");
    let svg = pictures.find(|svg| svg.contains(&label)).expect("a picture of that title");
    let (tag, inside) = svg.strip_prefix("<svg ").and_then(|rest| rest.split_once('>')).expect("a tag");
    let style =
        html.split_once("<style>").and_then(|(_, rest)| rest.split_once("</style>")).expect("a style").0;
    let looks: String = (0..1000)
        .map(|number| format!("z{number}"))
        .filter(|class| svg.contains(&format!("class=\"{class}\"")))
        .map(|class| {
            let rule = style
                .split_once(&format!(".{class}{{"))
                .expect("a rule")
                .1
                .split_once('}')
                .expect("its end")
                .0;
            format!(".{class}{{{rule}}}")
        })
        .collect();
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" color=\"#282c34\" font-family=\"system-ui,sans-serif\" {tag}>\
         <style>{looks}</style><rect width=\"100%\" height=\"100%\" rx=\"8\" shape-rendering=\"auto\" fill=\"#fff\"/>\
         {inside}</svg>\n"
    )
}

/// The same with quotes around all values, as a file of its own needs them.
fn quoted(svg: &str) -> String {
    let (mut out, mut inside, mut in_quotes, mut bare) = (String::new(), false, false, false);
    for c in svg.chars() {
        let opens = inside && !in_quotes && !bare && out.ends_with('=') && c != '"';
        if opens {
            out.push('"');
            bare = true;
        }
        if bare && (c == ' ' || c == '>') {
            out.push('"');
            bare = false;
        }
        match c {
            '"' if inside => in_quotes = !in_quotes,
            '<' => inside = true,
            '>' if !in_quotes => inside = false,
            _ => {}
        }
        out.push(c);
    }
    out
}

#[test]
fn values_get_their_quotes() {
    assert_eq!(
        quoted("<g a=1 b=\"2 = 3\"><p d=m1/>x = y</g>"),
        "<g a=\"1\" b=\"2 = 3\"><p d=\"m1/\">x = y</g>"
    );
}

/// What a picture shows: where plain doubles round differently a colour may be another one, its words may not.
fn agrees(name: &str, now: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("book/src/pictures").join(name);
    if std::env::var("PALMISTRY_BOOK").is_ok_and(|word| word == "renew") {
        std::fs::write(&path, now).expect("a picture is written");
    }
    let kept = std::fs::read_to_string(&path).expect("a picture");
    assert!(kept.len() < 20_000, "{name} has {} bytes", kept.len());
    let (kept, now) = (Picture::read(&kept), Picture::read(now));
    assert_eq!((&kept.title, &kept.texts), (&now.title, &now.texts), "{name}");
}

#[test]
fn the_rank_map_is_that_of_the_readme() {
    let readme = include_str!("../../README.md");
    let found = blocks(readme).into_iter().find(|block| block.value("file") == Some("one.proof"));
    let text = found.expect("the robot").text.replace("output q1", "output q1, q2");
    let folder = folder();
    let file = crate::common::write(&folder, "two.proof", text);
    let out = folder.path().join("page");
    let run = palmistry(&["verify", file.to_str().unwrap(), "--out", out.to_str().unwrap()]);
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    agrees("rank_map.svg", &alone(&out.join("index.html"), "the full codistribution"));
}

#[test]
fn the_palms_are_those_of_a_scene() {
    let folder = folder();
    let out: PathBuf = folder.path().join("page");
    let scene = "proofs/moll2002/scenes/same_rate.toml";
    let run = palmistry(&["observe", scene, "--out", out.to_str().unwrap()]);
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    agrees("palms.svg", &alone(&out.join("index.html"), "the body between its palms at 1.400 s"));
}
