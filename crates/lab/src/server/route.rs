//! Which request gets which response.

use super::guard::{Access, Refusal, is_of_this_page, may_ask, of_this_host};
use super::pages::{NONCE, OF_AN_ANSWER, Pages, asset, policy};
use super::secret::random_name;
use super::work::{Effort, Lines, Workers, error, line};
use super::{QuestionLimits, folder};
use http_body_util::{BodyExt, Either, Full, LengthLimitError, Limited};
use hyper::body::{Bytes, Incoming};
use hyper::header::{ALLOW, CACHE_CONTROL, CONTENT_SECURITY_POLICY, CONTENT_TYPE, HeaderValue};
use hyper::{Method, Request, Response, StatusCode};
use palmistry_lang::vocabulary;
use serde_json::{Value, json};
use std::net::{IpAddr, SocketAddr};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// Who sends a question more slowly is not waited for.
const SENDING: Duration = Duration::from_secs(30);

type Whole = Full<Bytes>;
type Answer = Response<Either<Whole, Lines>>;

pub(super) struct Router {
    access: Access,
    own: SocketAddr,
    folder: Option<PathBuf>,
    /// The file of it with which the page begins.
    file: Option<String>,
    workers: Arc<Workers>,
    pages: Arc<Pages>,
}

impl Router {
    pub fn new(
        access: Access,
        own: SocketAddr,
        (folder, file): (Option<PathBuf>, Option<String>),
        limits: QuestionLimits,
        program: (PathBuf, Vec<String>),
    ) -> Router {
        let folder = folder.filter(|_| !matches!(access, Access::Public));
        let workers = Arc::new(Workers::new(program, folder.clone(), limits));
        Router { access, own, folder, file, workers, pages: Arc::default() }
    }

    /// How many connections there may be, of all clients and of one.
    pub fn connections(&self) -> [usize; 2] {
        self.workers.limits.connections
    }

    /// How long an answer may take: as long as all questions before it, and as long as it takes to send it.
    pub fn longest(&self) -> Duration {
        let QuestionLimits { dear, places, at_once, .. } = self.workers.limits;
        let before = places[0].div_ceil(at_once[0].max(1)).max(places[1].div_ceil(at_once[1].max(1)));
        dear * u32::try_from(before + 1).unwrap_or(u32::MAX) + 10 * SENDING
    }

    pub async fn respond(&self, request: Request<Incoming>, client: IpAddr) -> Answer {
        let mut answer = self.answer(request, client).await;
        let headers = answer.headers_mut();
        let fixed = [
            ("x-content-type-options", "nosniff"),
            ("referrer-policy", "no-referrer"),
            ("cross-origin-resource-policy", "same-origin"),
            ("cross-origin-opener-policy", "same-origin"),
        ];
        for (name, value) in fixed {
            headers.insert(name, HeaderValue::from_static(value));
        }
        headers.insert(CACHE_CONTROL, HeaderValue::from_static("no-store"));
        answer
    }

    async fn answer(&self, request: Request<Incoming>, client: IpAddr) -> Answer {
        let path = request.uri().path().to_owned();
        match *request.method() {
            Method::GET | Method::HEAD => match of_this_host(&self.access, self.own, request.headers()) {
                Ok(()) => self.page(&path),
                Err(refusal) => refused(StatusCode::FORBIDDEN, refusal.words()),
            },
            Method::POST if path.starts_with("/api/") => {
                // who has the code of the address that was opened has no token yet
                let may = match path.as_str() {
                    "/api/enter" => is_of_this_page(&self.access, self.own, request.headers()),
                    _ => may_ask(&self.access, self.own, request.headers()),
                };
                if let Err(refusal) = may {
                    return refused(StatusCode::FORBIDDEN, refusal.words());
                }
                let kind = request.headers().get(CONTENT_TYPE).and_then(|kind| kind.to_str().ok());
                if kind != Some("application/json") {
                    return refused(StatusCode::UNSUPPORTED_MEDIA_TYPE, "a question is a text in JSON");
                }
                let body = Limited::new(request.into_body(), self.workers.limits.question).collect();
                match tokio::time::timeout(SENDING, body).await {
                    Ok(Ok(body)) => self.question(&path, body.to_bytes(), client).await,
                    Ok(Err(why)) if why.is::<LengthLimitError>() => {
                        refused(StatusCode::PAYLOAD_TOO_LARGE, "this question is longer than one may be here")
                    }
                    Ok(Err(_)) => refused(StatusCode::BAD_REQUEST, "the question did not come whole"),
                    Err(_) => refused(StatusCode::REQUEST_TIMEOUT, "the question did not come in time"),
                }
            }
            _ => {
                let mut answer =
                    refused(StatusCode::METHOD_NOT_ALLOWED, "pages are read and questions are asked");
                answer.headers_mut().insert(ALLOW, HeaderValue::from_static("GET, POST"));
                answer
            }
        }
    }

    fn page(&self, path: &str) -> Answer {
        if let Some(page) = path.strip_prefix("/page/").and_then(|name| self.pages.get(name)) {
            return whole("text/html; charset=utf-8", page.into(), OF_AN_ANSWER);
        }
        let Some(asset) = asset(path) else {
            return refused(StatusCode::NOT_FOUND, "there is no such page here");
        };
        let nonce = random_name();
        let text = match path {
            "/" => asset.text.replace(NONCE, &nonce).into(),
            _ => Bytes::from_static(asset.text.as_bytes()),
        };
        whole(asset.kind, text, &policy(&nonce))
    }

    async fn question(&self, path: &str, question: Bytes, client: IpAddr) -> Answer {
        // what is no JSON ends here, and is no process
        let Ok(asked) = serde_json::from_slice::<Value>(&question) else {
            return refused(StatusCode::BAD_REQUEST, "this is no JSON");
        };
        match (path, &self.folder) {
            ("/api/session", _) => lines_of(&json!({
                "kind": "done",
                "version": env!("CARGO_PKG_VERSION"),
                "folder": self.folder.as_ref().and_then(|folder| folder.file_name()).map(|name| name.to_string_lossy()),
                "file": self.file,
                "public": matches!(self.access, Access::Public),
                "words": words(),
            })),
            ("/api/enter", _) => match self.access.token_for(asked["code"].as_str().unwrap_or_default()) {
                Some(token) => lines_of(&json!({ "kind": "done", "token": token })),
                None => refused(StatusCode::FORBIDDEN, Refusal::Token.words()),
            },
            ("/api/answer", _) => {
                let is_cheap = matches!(
                    asked["ask"].as_str(),
                    Some("draft" | "hover" | "complete" | "format" | "models" | "model")
                );
                let effort = if is_cheap { Effort::Cheap } else { Effort::Dear };
                let (sender, lines) = Lines::new();
                let Some(place) = self.workers.place(client) else {
                    let why = "too many questions wait here: ask again when some are answered";
                    return refused(StatusCode::TOO_MANY_REQUESTS, why);
                };
                let (workers, pages) = (self.workers.clone(), self.pages.clone());
                tokio::spawn(async move {
                    workers.answer(question, (client, effort), sender, &pages).await;
                    drop(place);
                });
                answer_with(StatusCode::OK, "application/x-ndjson", Either::Right(lines))
            }
            ("/api/files" | "/api/read" | "/api/save", Some(served)) => {
                let (served, path) = (served.clone(), path.to_owned());
                let done = tokio::task::spawn_blocking(move || folder::respond(&served, &path, &asked)).await;
                lines_of(&done.unwrap_or_else(|_| error("the folder cannot be used", "")))
            }
            ("/api/files" | "/api/read" | "/api/save", None) => {
                refused(StatusCode::FORBIDDEN, "no folder is served here")
            }
            _ => refused(StatusCode::NOT_FOUND, "there is no such question"),
        }
    }
}

/// The words of the language, for syntax highlighting.
fn words() -> Value {
    json!({
        "entries": vocabulary::ENTRIES,
        "reserved": vocabulary::RESERVED,
        "special": vocabulary::SPECIAL,
        "functions": vocabulary::functions().collect::<Vec<_>>(),
    })
}

fn answer_with(status: StatusCode, kind: &'static str, body: Either<Whole, Lines>) -> Answer {
    let mut answer = Response::new(body);
    *answer.status_mut() = status;
    answer.headers_mut().insert(CONTENT_TYPE, HeaderValue::from_static(kind));
    answer
}

fn whole(kind: &'static str, text: Bytes, policy: &str) -> Answer {
    let mut answer = answer_with(StatusCode::OK, kind, Either::Left(Full::new(text)));
    if let Ok(policy) = HeaderValue::from_str(policy) {
        answer.headers_mut().insert(CONTENT_SECURITY_POLICY, policy);
    }
    answer
}

fn lines_of(value: &Value) -> Answer {
    answer_with(StatusCode::OK, "application/x-ndjson", Either::Left(Full::new(line(value))))
}

fn refused(status: StatusCode, why: &str) -> Answer {
    answer_with(status, "application/x-ndjson", Either::Left(Full::new(line(&error(why, "")))))
}
