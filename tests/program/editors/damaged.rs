//! A server that is given damaged texts and asked about any place answers each time.

use super::shipped;
use lsp_server::{Connection, Message, Notification, Request};
use palmistry::lsp::{SessionEnd, serve};
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use serde_json::{Value, json};
use std::time::Duration;

const HUNG: Duration = Duration::from_secs(120);

/// What is written into a text: signs of the language and of none, and what ends lines for some and not for others.
const PIECES: [&str; 26] = [
    "\"",
    "#",
    "(",
    "[",
    "{",
    "}",
    "'",
    "=",
    ".",
    ",",
    ":",
    "\n",
    "\r",
    "\r\n",
    "\u{2028}",
    "\u{85}",
    "\u{feff}",
    "\u{1d54f}",
    "\u{301}",
    "\u{202e}",
    "use a = \"base.proof\"\n",
    "set \"\u{e9}   \u{e9}\": x = 0",
    "base.",
    "state x",
    "  follows 1",
    "claim ",
];

/// A change: at a share of the text, so many characters are lost and a piece is written.
fn changes() -> impl Strategy<Value = Vec<(f64, usize, usize)>> {
    prop::collection::vec(
        (0.0..1.0f64, prop::sample::select(vec![0usize, 0, 1, 3, 40]), 0..PIECES.len()),
        1..6,
    )
}

fn changed(text: &str, changes: &[(f64, usize, usize)]) -> String {
    let mut characters: Vec<char> = text.chars().collect();
    for (share, lost, piece) in changes {
        let at = (share * characters.len() as f64) as usize;
        let end = (at + lost).min(characters.len());
        characters.splice(at..end, PIECES[*piece].chars());
    }
    characters.into_iter().collect()
}

struct Client {
    connection: Connection,
    asked: i32,
}

impl Client {
    fn tell(&self, method: &str, params: Value) {
        self.connection
            .sender
            .send(Notification::new(method.to_owned(), params).into())
            .expect("the server is there");
    }

    fn ask(&mut self, method: &str, params: Value) -> Value {
        self.asked += 1;
        let id = self.asked.into();
        self.connection
            .sender
            .send(Request::new(self.asked.into(), method.to_owned(), params).into())
            .expect("the server is there");
        loop {
            match self.connection.receiver.recv_timeout(HUNG).expect("an answer") {
                Message::Response(response) if response.id == id => {
                    return response.response_result.expect("no error");
                }
                _ => {}
            }
        }
    }
}

#[test]
fn every_text_and_every_place_has_an_answer() {
    let (here, there) = Connection::memory();
    let server =
        std::thread::Builder::new().stack_size(16 << 20).spawn(move || serve(&there, &|| false)).unwrap();
    let client = std::cell::RefCell::new(Client { connection: here, asked: 0 });
    let _ = client.borrow_mut().ask("initialize", json!({}));
    // long files are as slow to read as they are long, and have no other entries
    let texts: Vec<String> = shipped()
        .iter()
        .map(|path| std::fs::read_to_string(path).expect("a text"))
        .filter(|text| text.len() < 5000)
        .collect();
    assert!(texts.len() > 12, "{}", texts.len());
    // imports are found
    let uri = format!("file://{}/proofs/martinelli2005/damaged.proof", env!("CARGO_MANIFEST_DIR"));
    let strategy =
        (prop::sample::select(texts), changes(), prop::collection::vec((0.0..1.1f64, 0u64..100), 4));
    let config = Config { cases: 200, failure_persistence: None, ..Config::default() };
    TestRunner::new(config)
        .run(&strategy, |(text, changes, cursors)| {
            let text = changed(&text, &changes);
            let mut client = client.borrow_mut();
            let document = json!({ "uri": uri, "version": 1, "text": text });
            client.tell("textDocument/didOpen", json!({ "textDocument": document }));
            let lines = text.lines().count() as f64;
            for (share, character) in cursors {
                let position = json!({ "line": (share * lines) as u64, "character": character });
                let place = json!({ "textDocument": { "uri": uri }, "position": position });
                for method in ["textDocument/hover", "textDocument/definition"] {
                    client.ask(method, place.clone());
                }
            }
            let of_it = json!({ "textDocument": { "uri": uri } });
            let symbols = client.ask("textDocument/documentSymbol", of_it.clone());
            for symbol in symbols.as_array().expect("a list") {
                let (whole, name) = (&symbol["range"], &symbol["selectionRange"]);
                let key = |position: &Value| (position["line"].as_u64(), position["character"].as_u64());
                prop_assert!(key(&whole["start"]) <= key(&name["start"]), "{symbol}");
                prop_assert!(key(&name["end"]) <= key(&whole["end"]), "{symbol}");
            }
            client.ask("textDocument/formatting", of_it);
            Ok(())
        })
        .unwrap();
    let mut client = client.into_inner();
    client.ask("shutdown", Value::Null);
    client.tell("exit", Value::Null);
    assert_eq!(server.join().expect("it has not panicked"), SessionEnd::Asked);
}
