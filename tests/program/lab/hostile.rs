//! Requests that are malformed, and those of somebody who wants what is not his.

use super::{Lab, Reply};
use crate::common::{folder, write};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

const SECRET: &str = "nobody-may-read-this-4711";

/// All files under a folder with their texts.
fn files(folder: &Path) -> BTreeMap<PathBuf, String> {
    let mut found = BTreeMap::new();
    for entry in std::fs::read_dir(folder).unwrap().flatten() {
        let path = entry.path();
        if path.is_dir() && !path.is_symlink() {
            found.extend(files(&path));
        } else {
            found.insert(path.clone(), std::fs::read_to_string(&path).unwrap_or_default());
        }
    }
    found
}

/// What is sent, and the status that it has to get; 0 where the connection may end without a word.
struct Case {
    what: String,
    bytes: Vec<u8>,
    allowed: &'static [u16],
}

/// Requests that say who asks wrongly, or are none.
fn malformed(lab: &Lab) -> Vec<Case> {
    let Lab { host, token, .. } = lab;
    let body = json!({ "ask": "draft", "text": "system \"s\"\nstate x" }).to_string();
    let case = |what: &str, bytes: String, allowed: &'static [u16]| Case {
        what: what.to_owned(),
        bytes: bytes.into_bytes(),
        allowed,
    };
    let with = |replaced: &[(&str, &str)]| {
        let mut text = String::from_utf8(lab.request("answer", &body)).unwrap();
        for (from, to) in replaced {
            assert!(text.contains(from), "{from}");
            text = text.replace(from, to);
        }
        text
    };
    let [host_line, origin, token_line] = [
        format!("host: {host}\r\n"),
        format!("origin: http://{host}\r\n"),
        format!("x-palmistry-token: {token}\r\n"),
    ];
    let kind = "content-type: application/json\r\n";
    let get = |path: &str| format!("GET {path} HTTP/1.1\r\nhost: {host}\r\nconnection: close\r\n\r\n");
    let mut cases = vec![
        case("nothing", String::new(), &[0]),
        case("no HTTP", "hello\r\n\r\n".into(), &[0, 400]),
        case("another protocol", "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n".into(), &[0, 400, 505]),
        case("no host", with(&[(&host_line, "")]), &[400, 403]),
        case("a stranger's host", with(&[(&host_line, "host: evil.example\r\n")]), &[403]),
        case(
            "a stranger's host with the port",
            with(&[(&host_line, &format!("host: evil.example:{}\r\n", host.split(':').nth(1).unwrap()))]),
            &[403],
        ),
        case(
            "two hosts",
            with(&[(&host_line, &format!("host: {host}\r\nhost: evil.example\r\n"))]),
            &[400, 403],
        ),
        case("no origin", with(&[(&origin, "")]), &[403]),
        case("a stranger's origin", with(&[(&origin, "origin: http://evil.example\r\n")]), &[403]),
        case("no origin's origin", with(&[(&origin, "origin: null\r\n")]), &[403]),
        case("another port's origin", with(&[(&origin, "origin: http://127.0.0.1:1\r\n")]), &[403]),
        case(
            "a frame of a stranger",
            with(&[(&token_line, &format!("{token_line}sec-fetch-site: cross-site\r\n"))]),
            &[403],
        ),
        case("no token", with(&[(&token_line, "")]), &[403]),
        case("a wrong token", with(&[(token, "00000000000000000000000000000000")]), &[403]),
        case("half a token", with(&[(token, &token[..16])]), &[403]),
        case("two tokens", with(&[(&token_line, &format!("{token_line}x-palmistry-token: 1\r\n"))]), &[403]),
        case("a form", with(&[(kind, "content-type: application/x-www-form-urlencoded\r\n")]), &[415]),
        case("plain text", with(&[(kind, "content-type: text/plain\r\n")]), &[415]),
        case("no kind", with(&[(kind, "")]), &[415]),
        case("another method", with(&[("POST ", "PUT ")]), &[405]),
        case("a method of nobody", with(&[("POST ", "PWN ")]), &[405]),
        case("a preflight", with(&[("POST ", "OPTIONS ")]), &[405]),
        case("a question by GET", get(&format!("/api/answer?token={token}")), &[404]),
        case("no such question", with(&[("/api/answer", "/api/shell")]), &[404]),
        case("a code that is none", with(&[("/api/answer", "/api/enter")]), &[403]),
        case(
            "a code from a stranger's page",
            with(&[("/api/answer", "/api/enter"), (&origin, "origin: http://evil.example\r\n")]),
            &[403],
        ),
        case("a page of one's own", with(&[("/api/answer", "/api/page")]), &[404]),
        case("a folder that is not served", with(&[("/api/answer", "/api/../../etc/passwd")]), &[404]),
        case("a length that is none", with(&[("content-length: ", "content-length: -")]), &[0, 400]),
        case(
            "a length that is too long",
            with(&[("content-length: ", "content-length: 9999999999")]),
            &[0, 400, 413],
        ),
        case(
            "a head without an end",
            format!("GET / HTTP/1.1\r\nhost: {host}\r\nx: {}\r\n\r\n", "a".repeat(1 << 20)),
            &[0, 431],
        ),
        case(
            "ten thousand heads",
            format!("GET / HTTP/1.1\r\nhost: {host}\r\n{}\r\n", "a: b\r\n".repeat(10_000)),
            &[0, 431],
        ),
        case(
            "a chunk of nonsense",
            with(&[("content-length: ", "transfer-encoding: chunked\r\nx: ")]),
            &[0, 400],
        ),
    ];
    for path in [
        "/../Cargo.toml",
        "/..%2f..%2fetc/passwd",
        "//etc/passwd",
        "/page/",
        "/page/../secret",
        "/page/0",
        "/lab.js/..",
        "/%00",
        "/web/editor.js",
    ] {
        cases.push(case(path, get(path), &[404]));
    }
    cases
}

/// Questions of somebody who has the token.
fn questions() -> Vec<(&'static str, Value)> {
    let text = "system \"s\"\nstate x\ndrift f x' = -x\noutput x\n";
    let import = |file: &str| json!({ "ask": "draft", "file": "a.proof", "text": format!("system \"s\"\nuse b = \"{file}\"\nstate x\n") });
    let import_to_page = |file: &str| json!({ "ask": "page", "file": "a.proof", "text": format!("system \"s\"\nuse b = \"{file}\"\nstate x\n") });
    let observe = |title: &str, extra: Value| {
        let mut question = json!({
            "ask": "observe", "text": text.replace("\"s\"", title), "estimate": ["x"],
            "from": { "record": { "csv": "time,x\n0,1\n1,0.3\n2,0.1\n", "columns": {} } },
        });
        question.as_object_mut().unwrap().extend(extra.as_object().unwrap().clone());
        question
    };
    let injected = "x\"\nmodel = \"../../secret.proof";
    vec![
        ("no object", json!(3)),
        ("nothing", json!({})),
        ("no such question", json!({ "ask": "shell", "command": "id" })),
        ("a text that is none", json!({ "ask": "draft", "text": 7 })),
        ("a text of zeros", json!({ "ask": "draft", "text": "\0\0\0" })),
        (
            "brackets",
            json!({ "ask": "draft", "text": format!("system \"s\"\nstate x\nlet a = {}", "(".repeat(200_000)) }),
        ),
        (
            "powers",
            json!({ "ask": "claims", "only": ["1"], "text": "system \"s\"\nstate x\nclaim 1: (x + 1)^999999999 = 9^9^9^9^9\n" }),
        ),
        (
            "many states",
            json!({ "ask": "rank", "samples": 0, "text": format!("system \"s\"\nstate {}\n", (0..100_000).map(|i| format!("x{i}")).collect::<Vec<_>>().join(", ")) }),
        ),
        ("an import above", import("../secret.proof")),
        ("an import from the root", import("/etc/passwd")),
        ("an import of a link", import("link.proof")),
        ("an import of a link, as a page", import_to_page("link.proof")),
        ("an import through a folder", import("sub/../../secret.proof")),
        ("an import of a device", import("/dev/zero")),
        (
            "a reference above",
            json!({ "ask": "draft", "file": "a.proof", "text": "system \"s\"\nstate x\nclaim a restates b in \"../secret.proof\": x = x\n" }),
        ),
        ("a name above", json!({ "ask": "draft", "file": "../secret.proof", "text": text })),
        (
            "a name of the papers that leads out",
            json!({ "ask": "page", "file": "papers:../../secret.proof", "text": text }),
        ),
        ("a model that is none", json!({ "ask": "model", "model": "/etc/passwd" })),
        ("a model above", json!({ "ask": "model", "model": "papers:../../../etc/passwd" })),
        ("a scene that is none", json!({ "ask": "scene", "scene": "/etc/passwd" })),
        ("a scene that is an option", json!({ "ask": "scene", "scene": "--help" })),
        ("an import by an option", json!({ "ask": "import", "files": { "--out=x": "text" } })),
        (
            "an import above the folder",
            json!({ "ask": "import", "files": { "../../../secret.proof": "text" } }),
        ),
        ("an import of nothing", json!({ "ask": "import", "files": {} })),
        (
            "a problem that names others",
            json!({ "ask": "import", "files": { "p.yaml": "format_version: 1\nparameter_file: ../secret.proof\nproblems:\n- sbml_files: [../secret.proof]\n  measurement_files: [/etc/passwd]\n  condition_files: [/etc/passwd]\n  observable_files: [/etc/passwd]\n" } }),
        ),
        (
            "a program in a link",
            json!({ "ask": "import", "files": { "a.xml": "<!DOCTYPE x [<!ENTITY e SYSTEM \"file:///etc/passwd\">]><sbml>&e;</sbml>" } }),
        ),
        ("a key into the scene", observe("\"s\"", json!({ "estimate": [injected] }))),
        ("a method into the scene", observe("\"s\"", json!({ "method": injected }))),
        (
            "a column into the scene",
            observe(
                "\"s\"",
                json!({ "from": { "record": { "csv": "time,x\n0,1\n", "columns": { injected: { "from": injected, "unit": injected } } } } }),
            ),
        ),
        (
            "a function into the scene",
            observe(
                "\"s\"",
                json!({ "from": { "motion": { "start": { "x": 1.0 }, "inputs": { injected: injected }, "duration": 1.0, "samples": 5 } } }),
            ),
        ),
        ("a window beyond all", observe("\"s\"", json!({ "window": 4_000_000_000_u32 }))),
        (
            "samples beyond all",
            observe(
                "\"s\"",
                json!({ "from": { "motion": { "start": { "x": 1.0 }, "inputs": {}, "duration": 1e300, "samples": 4_000_000_000_u32 } } }),
            ),
        ),
        (
            "a map without a width",
            json!({ "ask": "map", "text": text, "x": ["x", 1.0, 1.0], "y": ["x", 0.0, 1.0], "cells": 10 }),
        ),
        (
            "a map of too many cells",
            json!({ "ask": "map", "text": text, "x": ["x", 0.0, 1.0], "y": ["nobody", 0.0, 1.0], "cells": 4_000_000_000_u32 }),
        ),
        (
            "a motion without a time",
            json!({ "ask": "motion", "text": text, "start": { "x": 1.0 }, "duration": -1.0, "samples": 10 }),
        ),
        (
            "a motion that is infinite",
            json!({ "ask": "motion", "text": "system \"s\"\nstate x\ndrift f x' = x^2\noutput x\n", "start": { "x": 1.0 }, "duration": 1e9, "samples": 4_000_000 }),
        ),
        (
            "a position that is none",
            json!({ "ask": "hover", "text": text, "position": { "line": -1, "character": "x" } }),
        ),
        (
            "a position beyond all",
            json!({ "ask": "complete", "text": text, "position": { "line": 4e18, "character": 4e18 } }),
        ),
    ]
}

/// Nothing of a secret beside the folder comes back, nothing is written, and the lab goes on answering.
#[test]
fn hostile_requests_get_nothing_and_leave_nothing() {
    let outer = folder();
    let served = outer.path().join("served");
    std::fs::create_dir(&served).unwrap();
    let secret =
        write(&outer, "secret.proof", format!("system \"{SECRET}\"\nstate {}\n", SECRET.replace('-', "_")));
    std::fs::write(served.join("own.proof"), "system \"own\"\nstate x\n").unwrap();
    std::os::unix::fs::symlink(&secret, served.join("link.proof")).unwrap();
    let lab = Lab::begin(&["--port", "0", served.to_str().unwrap()]);
    let before = files(outer.path());
    let mut count = 0;
    let mut check = |what: &str, reply: Option<&Reply>| {
        let said = reply.map_or(String::new(), |reply| format!("{}\n{}", reply.head, reply.body));
        for word in [SECRET, &SECRET.replace('-', "_"), "root:x:", &lab.token] {
            assert!(!said.contains(word), "{what}: {said}");
        }
        count += 1;
    };
    for Case { what, bytes, allowed } in malformed(&lab) {
        // what waits for more has to end where no more comes
        let reply = if allowed.contains(&0) { lab.raw_and_close(&bytes) } else { lab.raw(&bytes) };
        let status = reply.as_ref().map_or(0, |reply| reply.status);
        assert!(allowed.contains(&status), "{what}: {status}");
        check(&what, reply.as_ref());
    }
    for (what, question) in questions() {
        let reply = lab
            .raw(&lab.request("answer", &question.to_string()))
            .unwrap_or_else(|| panic!("{what}: no reply"));
        let mut lines = reply.body.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok());
        let last = lines.rfind(|line| line["kind"] != "page");
        let last = last.unwrap_or_else(|| panic!("{what}: {}", reply.body));
        // an answer, or why there is none: never a process that fell
        assert!(["done", "error"].iter().any(|kind| last["kind"] == *kind), "{what}: {last}");
        assert!(
            !reply.body.contains("panicked") && !reply.body.contains("has ended without an answer"),
            "{what}: {last}"
        );
        check(what, Some(&reply));
    }
    for (what, file) in [
        ("above", "../secret.proof"),
        ("a link", "link.proof"),
        ("another kind", "notes.txt"),
        ("the root", "/etc/passwd"),
        ("hidden", ".own"),
        ("nothing", ""),
    ] {
        for path in ["read", "save"] {
            let reply = lab
                .raw(&lab.request(path, &json!({ "file": file, "text": "gone" }).to_string()))
                .expect("a reply");
            assert!(reply.body.contains("\"kind\":\"error\""), "{path} {what}: {}", reply.body);
            check(what, Some(&reply));
        }
    }
    let long =
        lab.request("answer", &format!("{{\"ask\": \"draft\", \"text\": \"{}\"}}", "x".repeat(33 << 20)));
    let reply = lab.raw(&long);
    assert!(reply.as_ref().is_none_or(|reply| reply.status == 413));
    check("a long one", reply.as_ref());
    assert!(count >= 90, "{count}");
    assert_eq!(files(outer.path()), before);
    let still = lab.last(
        &json!({ "ask": "claims", "only": ["1"], "text": "system \"s\"\nstate x\nclaim 1: x = x + 0\n" }),
    );
    assert_eq!(still["kind"], "done");
}

/// A page comes from the program alone: what a stranger calls one is none.
#[test]
fn nobody_puts_a_page_there() {
    let lab = Lab::begin(&["--public", "127.0.0.1:0"]);
    let page = "<h1>phish</h1><script>alert(1)</script>";
    for name in ["page.html", "../page.html", "the-page-of-this-answer.html"] {
        for question in [
            json!({ "ask": "import", "files": { name: page } }),
            json!({ "ask": "page", "file": name, "text": page }),
        ] {
            let lines = lab.ask("answer", &question);
            assert!(lines.iter().all(|line| line["kind"] == "error"), "{lines:?}");
        }
    }
}

/// One client that asks and asks waits for itself: further questions are refused, and those of others are answered.
#[test]
fn one_client_does_not_shut_out_the_others() {
    let lab = Lab::begin(&["--public", "127.0.0.1:0"]);
    let long = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/proofs/benchmarks/pharm.proof"))
        .unwrap();
    let question = lab.request("answer", &json!({ "ask": "values", "text": long }).to_string());
    let send = |_| {
        let mut stream = std::net::TcpStream::connect(&lab.host).expect("it listens");
        std::io::Write::write_all(&mut stream, &question).expect("it reads");
        stream
    };
    let mut waiting: Vec<_> = (0..160).map(send).collect();
    let begin = std::time::Instant::now();
    let refused = || lab.raw(&lab.request("answer", "{\"ask\": \"models\"}")).map(|reply| reply.status);
    while refused() != Some(429) {
        // on a busy machine some may have been answered before all were sent
        waiting.extend((0..16).map(send));
        assert!(begin.elapsed().as_secs() < 20, "{:?}", refused());
    }
    // the page itself is there all the same, and when they have gone there is room again
    assert_eq!(
        lab.raw(format!("GET / HTTP/1.1\r\nhost: {}\r\nconnection: close\r\n\r\n", lab.host).as_bytes())
            .map(|reply| reply.status),
        Some(200)
    );
    drop(waiting);
    while refused() == Some(429) {
        assert!(begin.elapsed().as_secs() < 60);
    }
}

/// What everybody reaches reads and writes no file, answers its own page alone, and needs no token.
#[test]
fn a_public_lab_has_no_files() {
    let lab = Lab::begin(&["--public", "127.0.0.1:0"]);
    assert!(lab.token.is_empty());
    for path in ["files", "read", "save"] {
        let reply = lab.raw(&lab.request(path, "{\"file\": \"a.proof\"}")).expect("a reply");
        assert_eq!(reply.status, 403);
    }
    let import = json!({ "ask": "draft", "text": "system \"s\"\nuse b = \"Cargo.toml\"\nstate x\n" });
    assert_eq!(lab.last(&import)["kind"], "error");
    let foreign = String::from_utf8(lab.request("answer", "{\"ask\": \"models\"}"))
        .unwrap()
        .replace("origin: http://", "origin: http://evil.");
    assert_eq!(lab.raw(foreign.as_bytes()).map(|reply| reply.status), Some(403));
    let papers = lab.last(&json!({ "ask": "models" }));
    assert!(papers["papers"].as_array().is_some_and(|papers| papers.len() >= 5), "{papers}");
}

impl Lab {
    /// Sends bytes and says that no more will come.
    fn raw_and_close(&self, bytes: &[u8]) -> Option<Reply> {
        use std::io::{Read, Write};
        let mut stream = std::net::TcpStream::connect(&self.host).expect("it listens");
        stream.set_read_timeout(Some(super::LATE)).expect("a time");
        let _ = stream.write_all(bytes);
        let _ = stream.shutdown(std::net::Shutdown::Write);
        let mut found = Vec::new();
        let _ = stream.read_to_end(&mut found);
        let text = String::from_utf8_lossy(&found).into_owned();
        let (head, body) = text.split_once("\r\n\r\n")?;
        Some(Reply {
            status: head.split(' ').nth(1)?.parse().ok()?,
            head: head.to_owned(),
            body: body.to_owned(),
        })
    }
}
