//! The pictures of the README are made by the program: taken out of the pages that it writes, on a ground of their own, so that they
//! are legible on white and on dark pages.

use crate::blocks::blocks;
use crate::common::{folder, palmistry};
use crate::picture::Picture;
use std::path::{Path, PathBuf};

/// A picture of a page, as a file of its own.
fn alone(page: &Path, title: &str) -> String {
    let html = std::fs::read_to_string(page).expect("a page");
    let label = format!("aria-label=\"{title}\"");
    let found = html.split("<svg ").skip(1).filter_map(|rest| rest.split_once("</svg>"));
    let (svg, _) = found.into_iter().find(|(svg, _)| svg.contains(&label)).expect("a picture of that title");
    let (tag, inside) = svg.split_once('>').expect("a tag");
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" color=\"#282c34\" font-family=\"system-ui,sans-serif\" {tag}>\
         <rect width=\"100%\" height=\"100%\" rx=\"8\" shape-rendering=\"auto\" fill=\"#fff\"/>{inside}</svg>\n"
    )
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
