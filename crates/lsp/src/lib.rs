//! A language server: what an editor asks of a proof file while somebody writes it.
//!
//! Mistakes as `palmistry check` finds them, by the same reader; what a name is and where it is declared, also in the files
//! that are imported; what can stand at the cursor; the outline of a file; its normal form. Nothing is decided: claims are for `palmistry prove`.
//!
//! A text is taken from the editor as a whole and read again when it has stopped changing for a moment. What it imports is
//! read from files as they are saved. Places are counted in lines and units of UTF-16.
//!
//! The channel and its messages are those of `lsp-server`. What stands in them is written down here: the last release of
//! `lsp-types` is of June 2024, and a dozen messages need no crate of thousands of types.

#![warn(missing_docs)]

mod channel;
mod completion;
mod draft;
mod hover;
mod lookup;
mod outline;
mod source;

pub use channel::{EditorStreams, standard_streams};
pub use draft::Draft;
use hover::described;
use lookup::{Found, Library, Under, under};
pub use lsp_server::Connection;
use lsp_server::{ErrorCode, Message, Notification, Request, Response};
use palmistry_lang::{DeclarationKind, MOST_PROBLEMS, ReadError, System, format_text};
use serde_json::{Value, json};
use source::{Source, path_of};
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;
use std::time::{Duration, Instant};

/// A text is read when it has not changed for so long.
const QUIET: Duration = Duration::from_millis(60);

/// How often the server checks whether to stop.
const PAUSE: Duration = Duration::from_millis(200);

/// How a session ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SessionEnd {
    /// As it should: the editor asked to shut down, and then to exit.
    Asked,
    /// The editor went away, asked to exit without a warning, or `stop` said so.
    Left,
}

/// Serves an editor until it is done, or until `stop` says so.
pub fn serve(connection: &Connection, stop: &dyn Fn() -> bool) -> SessionEnd {
    let (documents, library, changed) = Default::default();
    Server { connection, documents, library, changed }.run(stop)
}

/// How far a session has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    NotInitialized,
    Serving,
    ShutDown,
}

/// What is served.
fn capabilities() -> Value {
    json!({
        "capabilities": {
            "positionEncoding": "utf-16",
            // texts come whole
            "textDocumentSync": { "openClose": true, "change": 1, "save": { "includeText": false } },
            "hoverProvider": true,
            "completionProvider": { "triggerCharacters": ["."] },
            "definitionProvider": true,
            "documentSymbolProvider": true,
            "documentFormattingProvider": true,
        },
        "serverInfo": { "name": "palmistry", "version": env!("CARGO_PKG_VERSION") },
    })
}

/// A text that is open.
struct Document {
    source: Rc<Source>,
    version: Value,
    /// What it means, as far as it could be understood when it was last read.
    system: Option<System>,
}

struct Server<'c> {
    connection: &'c Connection,
    documents: BTreeMap<String, Document>,
    library: Library,
    /// The texts that were not read since they changed.
    changed: BTreeSet<String>,
}

impl Server<'_> {
    fn run(&mut self, stop: &dyn Fn() -> bool) -> SessionEnd {
        let mut stage = Stage::NotInitialized;
        let mut last_change = Instant::now();
        while !stop() {
            let wait = match self.changed.is_empty() {
                true => PAUSE,
                false => QUIET.saturating_sub(last_change.elapsed()),
            };
            match self.connection.receiver.recv_timeout(wait) {
                Ok(Message::Request(request)) => {
                    let response = self.respond(request, &mut stage);
                    self.send(Message::Response(response));
                }
                Ok(Message::Notification(told)) if told.method == "exit" => {
                    return if stage == Stage::ShutDown { SessionEnd::Asked } else { SessionEnd::Left };
                }
                Ok(Message::Notification(told)) if stage == Stage::Serving => {
                    if self.take_note(&told) {
                        last_change = Instant::now();
                    }
                }
                // nothing was asked of the editor
                Ok(Message::Notification(_) | Message::Response(_)) => {}
                Err(error) if error.is_timeout() => self.read_changed(),
                Err(_) => return SessionEnd::Left,
            }
        }
        SessionEnd::Left
    }

    /// Sends a message; an editor that has gone away is noticed where the next one is waited for.
    fn send(&self, message: Message) {
        let _ = self.connection.sender.send(message);
    }

    /// Takes in what happened to a text; whether something changed.
    fn take_note(&mut self, told: &Notification) -> bool {
        let params = &told.params;
        let Some(uri) = params["textDocument"]["uri"].as_str() else { return false };
        let text = match told.method.as_str() {
            "textDocument/didOpen" => params["textDocument"]["text"].as_str(),
            // the last change is the whole text
            "textDocument/didChange" => params["contentChanges"]
                .as_array()
                .and_then(|all| all.last())
                .and_then(|last| last["text"].as_str()),
            "textDocument/didSave" => {
                // others may import what was saved
                self.changed.extend(self.documents.keys().cloned());
                return true;
            }
            "textDocument/didClose" => {
                if let Some(closed) = self.documents.remove(uri) {
                    let is_other = |open: &Rc<Source>| !Rc::ptr_eq(open, &closed.source);
                    self.library.open.retain(|_, open| is_other(open));
                }
                self.changed.remove(uri);
                self.publish(uri, &Value::Null, &[]);
                return false;
            }
            _ => return false,
        };
        let Some(text) = text else { return false };
        let path = path_of(uri).map(|path| std::fs::canonicalize(&path).unwrap_or(path));
        let source = Rc::new(Source::new(uri, path.clone(), text));
        if let Some(path) = path {
            self.library.open.insert(path, source.clone());
        }
        let version = params["textDocument"]["version"].clone();
        let system = self.documents.remove(uri).and_then(|old| old.system);
        self.documents.insert(uri.to_owned(), Document { source, version, system });
        self.changed.insert(uri.to_owned());
        true
    }

    /// Reads the texts that have changed, and publishes what is wrong with them.
    fn read_changed(&mut self) {
        for uri in std::mem::take(&mut self.changed) {
            self.read(&uri);
        }
    }

    fn read(&mut self, uri: &str) {
        self.changed.remove(uri);
        let Some(document) = self.documents.get_mut(uri) else { return };
        let source = document.source.clone();
        let found = System::examine_draft(&source.name(), &source.text, source.folder(), MOST_PROBLEMS);
        document.system = found.system;
        let version = document.version.clone();
        let diagnostics: Vec<Value> =
            found.problems.iter().map(|problem| diagnostic(&source, problem)).collect();
        self.publish(uri, &version, &diagnostics);
    }

    fn publish(&self, uri: &str, version: &Value, diagnostics: &[Value]) {
        let mut params = json!({ "uri": uri, "diagnostics": diagnostics });
        if version.is_i64() {
            params["version"] = version.clone();
        }
        self.send(Message::Notification(Notification::new(
            "textDocument/publishDiagnostics".to_owned(),
            params,
        )));
    }

    fn respond(&mut self, request: Request, stage: &mut Stage) -> Response {
        let Request { id, method, params } = request;
        let refused = |code: ErrorCode, why: &str| Response::new_err(id.clone(), code as i32, why.to_owned());
        match (*stage, method.as_str()) {
            (Stage::NotInitialized, "initialize") => {
                *stage = Stage::Serving;
                return Response::new_ok(id, capabilities());
            }
            (Stage::NotInitialized, _) => {
                return refused(ErrorCode::ServerNotInitialized, "the session has not begun");
            }
            (Stage::ShutDown, _) => return refused(ErrorCode::InvalidRequest, "the session is over"),
            (Stage::Serving, "initialize") => {
                return refused(ErrorCode::InvalidRequest, "the session has begun before");
            }
            (Stage::Serving, "shutdown") => {
                *stage = Stage::ShutDown;
                return Response::new_ok(id, Value::Null);
            }
            (Stage::Serving, _) => {}
        }
        let uri = params["textDocument"]["uri"].as_str().unwrap_or_default().to_owned();
        let answer = match method.as_str() {
            "textDocument/hover" => {
                // what a name means is that of the text as it is now
                if self.changed.contains(&uri) {
                    self.read(&uri);
                }
                self.documents.get(&uri).and_then(|document| {
                    hover_of(&self.library, &document.source, document.system.as_ref(), &params["position"])
                })
            }
            "textDocument/completion" => self.documents.get(&uri).map(|document| {
                let at = document.source.offset(&params["position"]);
                completion::completions(&self.library, &document.source, at).into()
            }),
            "textDocument/definition" => self
                .documents
                .get(&uri)
                .map(|document| self.definition(&document.source, &params["position"])),
            "textDocument/documentSymbol" => {
                self.documents.get(&uri).map(|document| outline::symbols(&document.source))
            }
            "textDocument/formatting" => {
                self.documents.get(&uri).and_then(|document| form_edits(&document.source))
            }
            _ => {
                return refused(ErrorCode::MethodNotFound, &format!("'{method}' is not served"));
            }
        };
        Response::new_ok(id, answer.unwrap_or(Value::Null))
    }

    fn definition(&self, source: &Rc<Source>, position: &Value) -> Value {
        let found = match under(source, source.offset(position)) {
            None => Vec::new(),
            Some(Under::Name(name, _)) => self.library.find(source, name),
            Some(Under::Reference(reference)) => self.library.referred(source, reference),
            Some(Under::Claim(claim)) => vec![Found { source: source.clone(), declaration: claim.clone() }],
            Some(Under::File(file)) => return self.beginning(source, file).into_iter().collect(),
        };
        let place = |found: &Found| {
            let Found { source, declaration } = found;
            let import = source.outline.imports.iter().find(|import| import.alias == declaration.name);
            let other = import
                .filter(|_| declaration.kind == DeclarationKind::Import)
                .and_then(|import| self.beginning(source, &import.path));
            other.unwrap_or_else(|| json!({ "uri": source.uri, "range": source.range(&declaration.span) }))
        };
        found.iter().map(place).collect()
    }

    /// Where a file begins: at the entry that names its system.
    fn beginning(&self, source: &Source, file: &str) -> Option<Value> {
        let other = self.library.beside(source, file)?;
        let system = other.outline.declarations.iter().find(|one| one.kind == DeclarationKind::System);
        let span = system.map_or(0..0, |system| system.span.clone());
        Some(json!({ "uri": other.uri, "range": other.range(&span) }))
    }
}

/// What stands at a position, as a hover.
fn hover_of(
    library: &Library,
    source: &Rc<Source>,
    system: Option<&System>,
    position: &Value,
) -> Option<Value> {
    let (found, name, span) = match under(source, source.offset(position))? {
        Under::Name(name, span) => (library.find(source, name), name, span),
        Under::Reference(reference) => {
            (library.referred(source, reference), reference.name.as_str(), reference.span.clone())
        }
        Under::Claim(claim) => {
            let found = Found { source: source.clone(), declaration: claim.clone() };
            (vec![found], claim.name.as_str(), claim.span.clone())
        }
        Under::File(_) => return None,
    };
    let texts: Vec<String> = found.iter().map(|one| described(one, name, source, system)).collect();
    (!texts.is_empty()).then(|| {
        json!({
            "contents": { "kind": "markdown", "value": texts.join("\n\n") },
            "range": source.range(&span),
        })
    })
}

fn diagnostic(source: &Source, problem: &ReadError) -> Value {
    let begin = problem.span.offset();
    let message = match &problem.help {
        Some(help) => format!("{}\n{help}", problem.message),
        None => problem.message.clone(),
    };
    json!({
        "range": source.range(&(begin..begin + problem.span.len())),
        "severity": 1,
        "source": "palmistry",
        "code": problem.code.id(),
        "message": message,
    })
}

/// What turns a text into its normal form: nothing where it has none, or is in it.
fn form_edits(source: &Source) -> Option<Value> {
    let form = format_text(&source.name(), &source.text).ok()?;
    let edits =
        if form == source.text { json!([]) } else { json!([{ "range": source.whole(), "newText": form }]) };
    Some(edits)
}
