//! A real browser that opens a page in a frame of some width, runs checks in it and tells what they found.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Set to `required` where a browser has to be there.
const BROWSER: &str = "PALMISTRY_BROWSER";

/// How a page is looked at.
pub struct Look {
    pub width: u32,
    pub dark: bool,
}

/// Chromium, under the names that it has; none where it is not installed.
///
/// # Panics
/// Where there is none, and the environment says that there has to be one.
pub fn browser() -> Option<PathBuf> {
    let folders: Vec<PathBuf> =
        std::env::var_os("PATH").map(|path| std::env::split_paths(&path).collect()).unwrap_or_default();
    let names = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];
    let found =
        folders.iter().flat_map(|folder| names.map(|name| folder.join(name))).find(|file| file.is_file());
    let required = std::env::var(BROWSER).is_ok_and(|value| value == "required");
    assert!(found.is_some() || !required, "no Chromium, and {BROWSER} says that there has to be one");
    if found.is_none() {
        eprintln!("left out: there is no Chromium here to open the page in");
    }
    found
}

/// What the checks tell of a page.
pub fn look(browser: &Path, page: &str, searches: &[&str], look: &Look) -> Value {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    let searches = serde_json::to_string(searches).unwrap();
    let checks = include_str!("checks.js");
    // the page's own policy stays, and lets the checks in beside what it lets in anyway
    let page = &page.replacen("script-src ", "script-src 'nonce-checks' ", 1);
    let checked = page.replace(
        "</body>",
        &format!(
            "<script id=\"checks\" nonce=\"checks\">window.searches = {searches};\n{checks}</script></body>"
        ),
    );
    assert_ne!(&checked, page);
    std::fs::write(file("page.html"), checked).unwrap();
    // windows are at least 500 pixels wide, frames are not; what is told stands in the frame's parent
    let frame = format!(
        "<!DOCTYPE html><meta charset=\"utf-8\"><meta name=\"color-scheme\" content=\"light dark\"><body style=\"margin:0\">\
         <iframe src=\"page.html\" style=\"border:0;width:{}px;height:900px\"></iframe><pre id=\"told\"></pre><script>\
         addEventListener('message', event => document.getElementById('told').textContent = event.data)</script></body>",
        look.width
    );
    std::fs::write(file("frame.html"), frame).unwrap();
    let output = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--no-first-run"])
        .args(["--disable-dev-shm-usage", "--virtual-time-budget=60000", "--dump-dom"])
        .arg(format!("--user-data-dir={}", file("profile").display()))
        .arg(format!("--blink-settings=preferredColorScheme={}", u8::from(!look.dark)))
        .arg(format!("--window-size={},1000", look.width.max(500)))
        .arg(format!("file://{}", file("frame.html").display()))
        .output()
        .unwrap();
    let dom = String::from_utf8_lossy(&output.stdout).into_owned();
    let told = dom
        .split("<pre id=\"told\">")
        .nth(1)
        .and_then(|rest| rest.split("</pre>").next())
        .unwrap_or_default();
    let told = told.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&");
    serde_json::from_str(&told).unwrap_or_else(|error| {
        panic!("{error}: the page told {told:?}\n{}", String::from_utf8_lossy(&output.stderr))
    })
}
