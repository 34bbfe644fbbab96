//! A real browser, driven as a person would: by the protocol of its own tools over a pipe.

use crate::page::browser;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// What has not happened by then does not happen.
const LATE: Duration = Duration::from_secs(60);

pub struct Browser {
    child: Child,
    input: ChildStdin,
    messages: Receiver<Value>,
    session: String,
    next: u64,
    /// What went wrong in the page: exceptions, and what its policy has refused.
    pub faults: Vec<String>,
    _profile: tempfile::TempDir,
}

impl Browser {
    /// An empty page; none where there is no browser here.
    pub fn begin() -> Option<Browser> {
        let program = browser()?;
        let profile = tempfile::tempdir().expect("a folder");
        // the protocol is spoken over the descriptors 3 and 4
        let mut child = Command::new("sh")
            .args(["-c", "exec \"$0\" \"$@\" 3<&0 4>&1 </dev/null >/dev/null 2>&1"])
            .arg(program)
            .args([
                "--headless",
                "--no-sandbox",
                "--disable-gpu",
                "--hide-scrollbars",
                "--no-first-run",
                "--disable-dev-shm-usage",
            ])
            .arg("--remote-debugging-pipe")
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("the browser starts");
        let (input, output) = (child.stdin.take().expect("a pipe"), child.stdout.take().expect("a pipe"));
        let (tell, messages) = channel();
        std::thread::spawn(move || {
            for message in BufReader::new(output).split(0).map_while(Result::ok) {
                let _ = tell.send(serde_json::from_slice(&message).expect("it speaks JSON"));
            }
        });
        let mut browser = Browser {
            child,
            input,
            messages,
            session: String::new(),
            next: 0,
            faults: Vec::new(),
            _profile: profile,
        };
        browser.page();
        Some(browser)
    }

    /// Goes on in a new page.
    pub fn page(&mut self) {
        self.session.clear();
        let target = self.send("Target.createTarget", json!({ "url": "about:blank" }))["targetId"].clone();
        let session = self.send("Target.attachToTarget", json!({ "targetId": target, "flatten": true }));
        self.session = session["sessionId"].as_str().expect("a session").to_owned();
        for domain in ["Page", "Runtime", "Log", "DOM", "Accessibility"] {
            self.send(&format!("{domain}.enable"), json!({}));
        }
        self.size(1400, 1000);
    }

    pub fn send(&mut self, method: &str, params: Value) -> Value {
        self.next += 1;
        let mut message = json!({ "id": self.next, "method": method, "params": params });
        if !self.session.is_empty() {
            message["sessionId"] = json!(self.session);
        }
        self.input.write_all(format!("{message}\0").as_bytes()).expect("the browser reads");
        loop {
            let message = match self.messages.recv_timeout(LATE) {
                Ok(message) => message,
                Err(RecvTimeoutError::Timeout) => panic!("{method}: the browser does not answer"),
                Err(RecvTimeoutError::Disconnected) => panic!("{method}: the browser has ended"),
            };
            if message["id"] == self.next {
                assert!(message.get("error").is_none(), "{method}: {}", message["error"]);
                return message["result"].clone();
            }
            let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
            match message["method"].as_str() {
                Some("Runtime.exceptionThrown") => {
                    let details = &message["params"]["exceptionDetails"];
                    self.faults.push(format!(
                        "{} {}",
                        text(&details["text"]),
                        text(&details["exception"]["description"])
                    ));
                }
                Some("Log.entryAdded") if message["params"]["entry"]["level"] == "error" => {
                    self.faults.push(text(&message["params"]["entry"]["text"]));
                }
                _ => {}
            }
        }
    }

    pub fn go(&mut self, url: &str) {
        self.send("Page.navigate", json!({ "url": url }));
        self.until("document.body && document.body.dataset.ready === 'true'");
        self.until("document.body.dataset.told === 'true'");
    }

    pub fn size(&mut self, width: u32, height: u32) {
        self.send(
            "Emulation.setDeviceMetricsOverride",
            json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false }),
        );
    }

    pub fn dark(&mut self) {
        let feature = json!([{ "name": "prefers-color-scheme", "value": "dark" }]);
        self.send("Emulation.setEmulatedMedia", json!({ "features": feature }));
    }

    /// The value of an expression in the page.
    pub fn value(&mut self, expression: &str) -> Value {
        let params = json!({ "expression": expression, "awaitPromise": true, "returnByValue": true });
        let found = self.send("Runtime.evaluate", params);
        assert!(found.get("exceptionDetails").is_none(), "{expression}: {}", found["exceptionDetails"]);
        found["result"]["value"].clone()
    }

    pub fn text(&mut self, expression: &str) -> String {
        self.value(expression).as_str().unwrap_or_default().to_owned()
    }

    /// Waits until an expression is true; how long that took.
    pub fn until(&mut self, expression: &str) -> Duration {
        let begin = Instant::now();
        while self.value(&format!("!!({expression})")) != true {
            assert!(begin.elapsed() < LATE, "never: {expression}\n{:?}", self.faults);
            std::thread::sleep(Duration::from_millis(10));
        }
        begin.elapsed()
    }

    pub fn click(&mut self, selector: &str) {
        let found = self.value(&format!(
            "(() => {{ const found = document.querySelector({}); found?.click(); return !!found; }})()",
            json!(selector)
        ));
        assert_eq!(found, true, "{selector}");
    }

    /// Types letters at the cursor.
    pub fn type_text(&mut self, text: &str) {
        self.send("Input.insertText", json!({ "text": text }));
    }

    /// Presses a key, with the modifiers of the protocol (2 is Ctrl, 8 is Shift).
    pub fn key(&mut self, key: &str, code: u32, modifiers: u32) {
        for kind in ["rawKeyDown", "keyUp"] {
            let params = json!({ "type": kind, "key": key, "code": key, "windowsVirtualKeyCode": code, "modifiers": modifiers });
            self.send("Input.dispatchKeyEvent", params);
        }
        if key == "Enter" {
            self.send("Input.dispatchKeyEvent", json!({ "type": "char", "text": "\r", "key": key }));
        }
    }

    /// Chooses files in an input of files.
    pub fn choose(&mut self, selector: &str, files: &[&Path]) {
        let found = self.send(
            "Runtime.evaluate",
            json!({ "expression": format!("document.querySelector({})", json!(selector)) }),
        );
        let files: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
        self.send(
            "DOM.setFileInputFiles",
            json!({ "objectId": found["result"]["objectId"], "files": files }),
        );
    }

    /// The text in the editor replaced by another one, as by a person who selects all and types.
    pub fn write(&mut self, text: &str) {
        self.value("document.querySelector('.cm-content').focus()");
        self.key("a", 65, 2);
        self.type_text(text);
        self.until("document.body.dataset.told === 'false' || document.querySelector('#state.bad')");
    }

    /// A picture of the window, where one is asked for.
    pub fn picture(&mut self, name: &str) {
        let Some(folder) = std::env::var_os("PALMISTRY_PICTURES") else { return };
        let shot = self.send("Page.captureScreenshot", json!({ "format": "png" }));
        let file = Path::new(&folder).join(format!("{name}.png"));
        std::fs::write(file, decoded(shot["data"].as_str().expect("a picture")))
            .expect("a picture is written");
    }
}

/// Base 64.
fn decoded(text: &str) -> Vec<u8> {
    let value =
        |letter: u8| "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/".find(letter as char);
    let bits: Vec<u32> = text.bytes().filter_map(value).map(|value| value as u32).collect();
    let bytes = bits.chunks(4).flat_map(|four| {
        let whole = four.iter().fold(0, |sum, six| sum << 6 | six) << (6 * (4 - four.len()));
        (0..four.len().saturating_sub(1)).map(move |place| (whole >> (16 - 8 * place)) as u8)
    });
    bytes.collect()
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
