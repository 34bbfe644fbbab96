//! The address with which a browser is started.

use super::browser::Browser;
use crate::common::{folder, write};
use std::io::{BufRead, BufReader};
use std::os::unix::fs::PermissionsExt;
use std::process::{Command, Stdio};

/// Everybody on a machine sees with which arguments a browser was started: that address opens the page once, and the token is not in it.
#[test]
fn a_browser_is_started_with_a_code_that_is_good_once() {
    let Some(mut browser) = Browser::begin() else { return };
    let folder = folder();
    let seen = folder.path().join("seen");
    let opener = write(
        &folder,
        "xdg-open",
        format!("#!/bin/sh\nprintf %s \"$1\" > '{0}.part' && mv '{0}.part' '{0}'\n", seen.display()),
    );
    std::fs::set_permissions(&opener, std::fs::Permissions::from_mode(0o755)).expect("it can be run");
    let path = format!("{}:{}", folder.path().display(), std::env::var("PATH").unwrap_or_default());
    let mut child = Command::new(env!("CARGO_BIN_EXE_palmistry"))
        .args(["lab", "--port", "0"])
        .env("PATH", path)
        .env_remove("BROWSER")
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program runs");
    let mut printed = String::new();
    BufReader::new(child.stdout.take().expect("a pipe")).read_line(&mut printed).expect("an address");
    let token = printed.trim().split("token=").nth(1).expect("a token").to_owned();
    let begin = std::time::Instant::now();
    while !seen.exists() && begin.elapsed().as_secs() < 30 {
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    let opened = std::fs::read_to_string(&seen).expect("a browser was started");
    assert!(opened.contains("?code=") && !opened.contains(&token), "{opened}");
    browser.go(&opened);
    assert_eq!(browser.text("location.search"), "");
    // whoever comes second, without what the first page keeps, gets nothing
    browser.value("localStorage.clear()");
    browser.send("Page.navigate", serde_json::json!({ "url": opened }));
    browser.until("document.body && document.getElementById('notice')?.textContent.includes('was not opened by the address')");
    // the printed address is for the one who sees this terminal, and stays
    browser.go(printed.trim());
    let _ = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(child.wait().expect("it ends").success());
}
