//! An editor and `palmistry lsp`, over the server's standard input and output.

use crate::common::{folder, json, palmistry, write};
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

/// A server that is silent for longer hangs.
const HUNG: Duration = Duration::from_secs(120);

struct Editor {
    server: Child,
    input: Option<ChildStdin>,
    messages: Receiver<Value>,
    asked: u64,
}

impl Editor {
    /// Starts a server, and the session with it.
    fn begin() -> Editor {
        let mut editor = Editor::start();
        let answer =
            editor.ask("initialize", json!({ "processId": null, "rootUri": null, "capabilities": {} }));
        assert_eq!(answer["capabilities"]["hoverProvider"], true, "{answer}");
        editor.tell("initialized", json!({}));
        editor
    }

    fn start() -> Editor {
        let mut command = Command::new(env!("CARGO_BIN_EXE_palmistry"));
        let mut server = command
            .args(["lsp", "--stdio"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("the server starts");
        let mut output = BufReader::new(server.stdout.take().expect("its output"));
        let (sender, messages) = channel();
        std::thread::spawn(move || {
            while let Some(message) = next(&mut output)
                && sender.send(message).is_ok()
            {}
        });
        Editor { input: server.stdin.take(), server, messages, asked: 0 }
    }

    fn send(&mut self, message: &Value) {
        let text = message.to_string();
        let input = self.input.as_mut().expect("the channel is open");
        write!(input, "Content-Length: {}\r\n\r\n{text}", text.len()).expect("the server listens");
        input.flush().expect("the server listens");
    }

    fn tell(&mut self, method: &str, params: Value) {
        self.send(&json!({ "jsonrpc": "2.0", "method": method, "params": params }));
    }

    /// What is answered to a request, an error as the object that it is. What is told before is left out.
    fn ask(&mut self, method: &str, params: Value) -> Value {
        self.asked += 1;
        let id = self.asked;
        self.send(&json!({ "jsonrpc": "2.0", "id": id, "method": method, "params": params }));
        loop {
            let message = self.messages.recv_timeout(HUNG).expect("an answer");
            if message["id"] == id {
                return if message["error"].is_null() {
                    message["result"].clone()
                } else {
                    message["error"].clone()
                };
            }
        }
    }

    /// The mistakes that are told next of a text of this version.
    fn mistakes(&mut self, uri: &str, version: u64) -> Vec<Value> {
        loop {
            let message = self.messages.recv_timeout(HUNG).expect("diagnostics");
            let params = &message["params"];
            let is_it = message["method"] == "textDocument/publishDiagnostics" && params["uri"] == uri;
            if is_it && params["version"] == version {
                return params["diagnostics"].as_array().expect("a list").clone();
            }
        }
    }

    fn open(&mut self, uri: &str, text: &str) {
        let document = json!({ "uri": uri, "languageId": "palmistry", "version": 1, "text": text });
        self.tell("textDocument/didOpen", json!({ "textDocument": document }));
    }

    fn change(&mut self, uri: &str, version: u64, text: &str) {
        let document = json!({ "uri": uri, "version": version });
        let changes = json!([{ "text": text }]);
        self.tell("textDocument/didChange", json!({ "textDocument": document, "contentChanges": changes }));
    }

    /// Asks about a place.
    fn at(&mut self, method: &str, uri: &str, (line, character): (u64, u64)) -> Value {
        let position = json!({ "line": line, "character": character });
        self.ask(method, json!({ "textDocument": { "uri": uri }, "position": position }))
    }

    /// Ends the session as an editor should; the exit status.
    fn end(mut self) -> Option<i32> {
        assert_eq!(self.ask("shutdown", Value::Null), Value::Null);
        assert_eq!(self.ask("textDocument/hover", json!({}))["code"], -32600);
        self.tell("exit", Value::Null);
        self.server.wait().expect("it ends").code()
    }
}

/// Reads a message, unless the channel is at its end.
fn next(output: &mut impl BufRead) -> Option<Value> {
    let mut length = 0;
    loop {
        let mut line = String::new();
        if output.read_line(&mut line).ok()? == 0 {
            return None;
        }
        match line.trim_end() {
            "" => break,
            line => {
                if let Some(number) = line.strip_prefix("Content-Length: ") {
                    length = number.parse().expect("a length");
                }
            }
        }
    }
    let mut bytes = vec![0; length];
    output.read_exact(&mut bytes).expect("a whole message");
    Some(serde_json::from_slice(&bytes).expect("a message is JSON"))
}

fn uri(path: &Path) -> String {
    format!("file://{}", path.canonicalize().expect("it is there").display())
}

/// A file that is imported.
const BASE: &str = "system \"the base\"\nstate x : length, v\nparam k : time^(-2) = 4\ndrift f\n  x' = v\n  v' = -k*x\n\
                    claim energy: L(f, v^2 + k*x^2) = 0\noutput x\n";

/// One that imports it; a sign of two units stands in its first line.
const TOP: &str = "system \"above the base\"  # \u{1d54f}\nuse base = \"base.proof\"\nlet energy = v^2 + k*x^2\n\
                   let pair = [x; v]\nclaim e restates energy in \"base.proof\": L(base.f, energy) = 0\n\
                   set \"at rest\": v = 0\nclaim out: base.output = [x]\n";

/// Mistakes appear, move and go while a text changes; they are those of `check`, in units of UTF-16.
#[test]
fn mistakes_are_those_of_check_while_one_types() {
    let folder = folder();
    write(&folder, "base.proof", BASE);
    let broken = "system \"\u{1d54f} s\" state \u{1d54f}\nstate x, y\nlet a = sin(\"\u{1d54f}\nlet b = nobody + x*nowhere\nclaim 1: [x] = [x; x]\n";
    let path = write(&folder, "typed.proof", broken);
    let checked = json(&palmistry(&["check", path.to_str().unwrap(), "--json"]));
    let checked = checked["errors"].as_array().unwrap();
    assert!(checked.len() >= 4, "{checked:?}");

    let mut editor = Editor::begin();
    let uri = uri(&path);
    editor.open(&uri, broken);
    let told = editor.mistakes(&uri, 1);
    assert_eq!(told.len(), checked.len(), "{told:?}");
    for (told, checked) in told.iter().zip(checked) {
        let message = told["message"].as_str().unwrap();
        assert!(message.starts_with(checked["message"].as_str().unwrap()), "{told} {checked}");
        let start = &told["range"]["start"];
        assert_eq!(start["line"].as_u64().unwrap() + 1, checked["line"].as_u64().unwrap());
        // characters of the line before the place, and of these one has two units
        let line = broken.lines().nth(start["line"].as_u64().unwrap() as usize).unwrap();
        let before: String = line.chars().take(checked["column"].as_u64().unwrap() as usize - 1).collect();
        assert_eq!(start["character"].as_u64().unwrap() as usize, before.encode_utf16().count(), "{told}");
    }
    // a whole word is marked
    let nowhere = told.iter().find(|one| one["message"].as_str().unwrap().contains("'nowhere'")).unwrap();
    assert_eq!(
        nowhere["range"],
        json!({ "start": { "line": 3, "character": 19 }, "end": { "line": 3, "character": 26 } })
    );

    let mended = "system \"s\"\nstate x, y\nlet b = x*y\n";
    editor.change(&uri, 2, "system \"s\"\nstate x, y\nlet b = x*z\n");
    editor.change(&uri, 3, mended);
    assert_eq!(editor.mistakes(&uri, 3), Vec::<Value>::new());
    // a file that it imports is read again when it is saved
    editor.change(&uri, 4, "system \"s\"\nuse base = \"base.proof\"\nlet b = base.g\n");
    assert_eq!(editor.mistakes(&uri, 4).len(), 1);
    write(&folder, "base.proof", format!("{BASE}let g = 1\n"));
    editor.tell("textDocument/didSave", json!({ "textDocument": { "uri": uri } }));
    assert_eq!(editor.mistakes(&uri, 4), Vec::<Value>::new());
    editor.tell("textDocument/didClose", json!({ "textDocument": { "uri": uri } }));
    assert_eq!(editor.end(), Some(0));
}

/// Names of the text and of what it imports: what they are, and where they are declared.
#[test]
fn names_are_told_and_found() {
    let folder = folder();
    let other = write(&folder, "base.proof", BASE);
    let text = TOP;
    let path = write(&folder, "top.proof", text);
    assert_eq!(palmistry(&["check", path.to_str().unwrap()]).status.code(), Some(0));
    let (own, other) = (uri(&path), uri(&other));
    let mut editor = Editor::begin();
    editor.open(&own, text);

    let range = |line: u64, from: u64, to: u64| json!({ "start": { "line": line, "character": from }, "end": { "line": line, "character": to } });
    let place = |uri: &str, range: Value| json!([{ "uri": uri, "range": range }]);
    // a cursor; what is told of the name; where it is declared
    let system = range(0, 0, 6);
    for (cursor, told, declared) in [
        (
            (2, 14),
            "**state** `v`; dimension length/time (m/s); declared in `base.proof`, line 2",
            place(&other, range(1, 18, 19)),
        ),
        (
            (2, 20),
            "**param** `k`; dimension 1/time^2 (1/s^2); value 4 unless given; declared in `base.proof`, line 3",
            place(&other, range(2, 6, 7)),
        ),
        // within 'base.f', on either part
        ((4, 46), "**use** `base`", place(&other, system.clone())),
        (
            (4, 49),
            "**drift** `base.f`; the unforced dynamics; declared in `base.proof`, line 4",
            place(&other, range(3, 6, 7)),
        ),
        // at the end of a name
        ((4, 57), "**let** `energy`; dimension length^2/time^2 (m^2/s^2)", place(&own, range(2, 4, 10))),
        (
            (3, 5),
            "**let** `pair`; a matrix of 2 by 1; entries of several dimensions",
            place(&own, range(3, 4, 8)),
        ),
        // what a claim restates
        ((4, 19), "**claim** `energy`; declared in `base.proof`, line 7", place(&other, range(6, 6, 12))),
        ((1, 5), "**use** `base`", place(&other, system.clone())),
        (
            (6, 17),
            "**output** `base.output`; declared in `base.proof`, line 8",
            place(&other, range(7, 7, 8)),
        ),
    ] {
        let hover = editor.at("textDocument/hover", &own, cursor);
        let shown = hover["contents"]["value"].as_str().unwrap_or_else(|| panic!("{cursor:?}: {hover}"));
        assert_eq!(shown.lines().next(), Some(told), "{cursor:?}");
        assert_eq!(editor.at("textDocument/definition", &own, cursor), declared, "{cursor:?}");
    }
    let hover = editor.at("textDocument/hover", &own, (4, 49));
    assert!(
        hover["contents"]["value"]
            .as_str()
            .unwrap()
            .ends_with("```palmistry\ndrift f\n  x' = v\n  v' = -k*x\n```")
    );
    assert_eq!(hover["range"], range(4, 43, 49));
    // a file by its name; a comment, a title, a word of the language and a number are no names
    assert_eq!(editor.at("textDocument/definition", &own, (1, 15)), place(&other, system));
    for nothing in [(0, 27), (0, 12), (3, 1), (2, 16), (5, 7)] {
        assert_eq!(editor.at("textDocument/definition", &own, nothing), json!([]), "{nothing:?}");
        assert_eq!(editor.at("textDocument/hover", &own, nothing), Value::Null, "{nothing:?}");
    }
    // the same where something else is wrong, and with a text that is in no file
    editor.change(&own, 2, &format!("{text}let bad = (\n"));
    let told = editor.at("textDocument/hover", &own, (2, 14));
    assert!(
        told["contents"]["value"].as_str().unwrap().starts_with("**state** `v`; dimension length/time"),
        "{told}"
    );
    editor.open("untitled:1", "system \"s\" state here");
    let told = editor.at("textDocument/hover", "untitled:1", (0, 20));
    assert_eq!(told["contents"]["value"], "**state** `here`\n\n```palmistry\nsystem \"s\" state here\n```");
    assert_eq!(editor.end(), Some(0));
}

#[test]
fn outline_and_normal_form() {
    let mut editor = Editor::begin();
    let text = "system  \"s\"\nstate x\ndrift f\n x' = x # why\nclaim 1.2: x = x\nerratum 3: printed x = 1 corrected x = x\nset \"a  b\": x = 0\n\
                map \"m\": x in [0, 1], x in [0, 2]\n";
    editor.open("untitled:1", text);
    let of_it =
        json!({ "textDocument": { "uri": "untitled:1" }, "options": { "tabSize": 2, "insertSpaces": true } });
    let symbols = editor.ask("textDocument/documentSymbol", of_it.clone());
    let found: Vec<(&str, &str, u64)> = symbols
        .as_array()
        .unwrap()
        .iter()
        .map(|one| {
            let line = one["range"]["start"]["line"].as_u64().unwrap();
            (one["name"].as_str().unwrap(), one["detail"].as_str().unwrap(), line)
        })
        .collect();
    assert_eq!(
        found,
        [
            ("s", "system", 0),
            ("x", "state", 1),
            ("f", "drift", 2),
            ("1.2", "claim x = x", 4),
            ("3", "erratum printed x = 1 corrected x = x", 5),
            ("a b", "set x = 0", 6),
            ("m", "map x in [0, 1], x in [0, 2]", 7),
        ]
    );
    let drift = &symbols[2];
    assert_eq!(drift["range"]["end"], json!({ "line": 3, "character": 7 }), "{drift}");
    assert_eq!(drift["selectionRange"]["start"], json!({ "line": 2, "character": 6 }));

    let edits = editor.ask("textDocument/formatting", of_it.clone());
    let whole = json!({ "start": { "line": 0, "character": 0 }, "end": { "line": 8, "character": 0 } });
    assert_eq!(edits, json!([{ "range": whole, "newText": text.replace("\n x'", "\n  x'") }]));
    editor.change("untitled:1", 2, edits[0]["newText"].as_str().unwrap());
    assert_eq!(editor.ask("textDocument/formatting", of_it.clone()), json!([]));
    // what cannot be read has no normal form
    editor.change("untitled:1", 3, "sistem \"s\"");
    assert_eq!(editor.ask("textDocument/formatting", of_it), Value::Null);
    assert_eq!(editor.end(), Some(0));
}

/// The order of a session, and its ends: a request before it begins, an unknown one, an exit without a warning, an editor that
/// goes away, and one that sends what is no message.
#[test]
fn sessions_begin_and_end_as_the_protocol_says() {
    let mut editor = Editor::start();
    assert_eq!(editor.ask("textDocument/hover", json!({}))["code"], -32002);
    let _ = editor.ask("initialize", json!({}));
    assert_eq!(editor.ask("initialize", json!({}))["code"], -32600);
    assert_eq!(editor.ask("textDocument/rename", json!({}))["code"], -32601);
    // parameters that are none
    for params in
        [json!(null), json!([1]), json!({ "textDocument": 3 }), json!({ "position": { "line": "x" } })]
    {
        for method in ["textDocument/hover", "textDocument/definition", "textDocument/formatting"] {
            assert_eq!(editor.ask(method, params.clone()), Value::Null);
        }
        for method in ["textDocument/didOpen", "textDocument/didChange", "textDocument/didClose"] {
            editor.tell(method, params.clone());
        }
    }
    assert_eq!(editor.end(), Some(0));

    let mut editor = Editor::begin();
    editor.tell("exit", Value::Null);
    assert_eq!(editor.server.wait().unwrap().code(), Some(1));

    let mut editor = Editor::begin();
    editor.input = None;
    assert_eq!(editor.server.wait().unwrap().code(), Some(1));

    let mut editor = Editor::begin();
    editor.input.as_mut().unwrap().write_all(b"Content-Length: 3\r\n\r\n{{{").unwrap();
    editor.input = None;
    assert_eq!(editor.server.wait().unwrap().code(), Some(2));
}

/// Vectors are one declaration as they are written, and each of their components has facts of its own.
#[test]
fn components_and_steps_are_told() {
    let folder = folder();
    let text = "system \"s\"\nstate x[1..3] : length\nlet w[i] = i*x[i] for i in 1..3\ndrift f\n  x[i]+ = x[i + 1]/2 for i in 1..2\n\
                output x[1], w[2..3]\nsample\n  x[1..3] in [0, 1]\n";
    let path = write(&folder, "v.proof", text);
    assert_eq!(palmistry(&["check", path.to_str().unwrap()]).status.code(), Some(0));
    let uri = uri(&path);
    let mut editor = Editor::begin();
    editor.open(&uri, text);
    let outline = editor.ask("textDocument/documentSymbol", json!({ "textDocument": { "uri": uri } }));
    let names: Vec<&str> =
        outline.as_array().unwrap().iter().map(|one| one["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["s", "x[1..3]", "w[i]", "f", "x[1]", "w[2..3]"]);
    for (cursor, told) in [
        // the component that is meant, the vector where the index is not a number, a definition
        ((5, 7), "**state** `x[1]`; dimension length (m); drawn from [0, 1]"),
        ((4, 2), "**state** `x`; dimension length (m); drawn from [0, 1]"),
        ((5, 13), "**let** `w`"),
    ] {
        let hover = editor.at("textDocument/hover", &uri, cursor);
        let shown = hover["contents"]["value"].as_str().unwrap_or_else(|| panic!("{cursor:?}: {hover}"));
        assert_eq!(shown.lines().next(), Some(told), "{cursor:?}");
        let declared = editor.at("textDocument/definition", &uri, cursor);
        assert_eq!(declared.as_array().unwrap().len(), 1, "{cursor:?}: {declared}");
    }
    let form = editor.ask(
        "textDocument/formatting",
        json!({ "textDocument": { "uri": uri }, "options": { "tabSize": 2, "insertSpaces": true } }),
    );
    assert_eq!(form, json!([]));
    assert_eq!(editor.end(), Some(0));
}
