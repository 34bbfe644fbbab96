//! Who may ask. A page of another server that is open in the same browser may not: it has neither the token nor the origin.

use super::secret::random_name;
use hyper::header::{HOST, HeaderMap, HeaderName, ORIGIN};
use sha2::{Digest, Sha256};
use std::net::SocketAddr;
use std::sync::{Arc, Mutex, PoisonError};

/// The header that carries the token.
const TOKEN: &str = "x-palmistry-token";

/// Who may ask.
#[derive(Clone)]
pub enum Access {
    /// Pages that were opened with this token, on this machine.
    Token(Secrets),
    /// Everybody who reaches the address. Files are neither read nor written.
    Public,
}

/// What shows that a page is the user's own.
#[derive(Clone)]
pub struct Secrets {
    token: String,
    /// Is exchanged for the token, once: everyone who lists the processes of this machine can read the address that a browser
    /// is started with.
    code: Arc<Mutex<Option<String>>>,
}

impl std::fmt::Debug for Access {
    /// Without the token, which belongs into no log.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Access::Token(_) => "Token(..)",
            Access::Public => "Public",
        })
    }
}

impl Access {
    /// A token that nobody guesses: 128 bits of the system's random numbers.
    ///
    /// # Panics
    /// Where the system has none.
    pub fn with_token() -> Access {
        let code = Arc::new(Mutex::new(Some(random_name())));
        Access::Token(Secrets { token: random_name(), code })
    }

    /// The address of the page, for somebody to open: it is good as long as the lab runs.
    pub fn address(&self, own: SocketAddr) -> String {
        match self {
            Access::Token(secrets) => format!("http://{own}/?token={}", secrets.token),
            Access::Public => format!("http://{own}/"),
        }
    }

    /// The same for a browser to be started with: it is good once.
    pub fn address_once(&self, own: SocketAddr) -> String {
        let Access::Token(secrets) = self else { return self.address(own) };
        let code = secrets.code.lock().unwrap_or_else(PoisonError::into_inner);
        code.as_ref().map_or_else(|| self.address(own), |code| format!("http://{own}/?code={code}"))
    }

    /// The token, for the code that is good once.
    pub(super) fn token_for(&self, given: &str) -> Option<String> {
        let Access::Token(secrets) = self else { return None };
        let mut code = secrets.code.lock().unwrap_or_else(PoisonError::into_inner);
        let is_it = code.as_ref().is_some_and(|code| is_same(code, given));
        is_it.then(|| {
            *code = None;
            secrets.token.clone()
        })
    }
}

/// Whether two secrets are equal; hashes are compared, so that the time taken reveals nothing of the letters.
fn is_same(one: &str, other: &str) -> bool {
    Sha256::digest(one) == Sha256::digest(other)
}

/// Why a request is not answered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Refusal {
    /// It names another host: an address of a stranger that leads here.
    Host,
    /// It comes from a page of another origin.
    Origin,
    /// It has no token, or a wrong one.
    Token,
}

impl Refusal {
    pub fn words(self) -> &'static str {
        match self {
            Refusal::Host => "this lab answers under its own address alone",
            Refusal::Origin => "this lab answers its own page alone",
            Refusal::Token => {
                "this page was not opened by the address that 'palmistry lab' printed, or the lab was started anew: open that address"
            }
        }
    }
}

/// Whether the request is for this server by a name of its own. What is served to everybody has no names to check.
pub(super) fn of_this_host(access: &Access, own: SocketAddr, headers: &HeaderMap) -> Result<(), Refusal> {
    let host = one(headers, HOST).ok_or(Refusal::Host)?;
    let is_own = match access {
        Access::Public => true,
        Access::Token(_) => {
            let port = own.port();
            host == own.to_string()
                || host == format!("localhost:{port}")
                || host == format!("127.0.0.1:{port}")
        }
    };
    if is_own { Ok(()) } else { Err(Refusal::Host) }
}

/// Whether a question may be asked: from the page of this very server, with its token.
pub(super) fn may_ask(access: &Access, own: SocketAddr, headers: &HeaderMap) -> Result<(), Refusal> {
    is_of_this_page(access, own, headers)?;
    let Access::Token(secrets) = access else { return Ok(()) };
    let given = one(headers, HeaderName::from_static(TOKEN)).unwrap_or_default();
    if is_same(&secrets.token, given) { Ok(()) } else { Err(Refusal::Token) }
}

/// Whether it comes from the page of this very server.
pub(super) fn is_of_this_page(access: &Access, own: SocketAddr, headers: &HeaderMap) -> Result<(), Refusal> {
    of_this_host(access, own, headers)?;
    let host = one(headers, HOST).ok_or(Refusal::Host)?;
    // browsers name the origin of each question that a page asks by POST
    let origin = one(headers, ORIGIN).ok_or(Refusal::Origin)?;
    let by = origin
        .strip_prefix("http://")
        .or_else(|| origin.strip_prefix("https://").filter(|_| matches!(access, Access::Public)));
    if by != Some(host) {
        return Err(Refusal::Origin);
    }
    // a browser that says more says it too
    let site = HeaderName::from_static("sec-fetch-site");
    if headers.contains_key(&site) && one(headers, site) != Some("same-origin") {
        return Err(Refusal::Origin);
    }
    Ok(())
}

/// The one value of a header; nothing where there are several.
fn one(headers: &HeaderMap, name: HeaderName) -> Option<&str> {
    let mut all = headers.get_all(name).iter();
    let first = all.next()?.to_str().ok()?;
    if all.next().is_some() { None } else { Some(first) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn headers(pairs: &[(&'static str, &str)]) -> HeaderMap {
        let mut found = HeaderMap::new();
        for (name, value) in pairs {
            found.append(HeaderName::from_static(name), value.parse().expect("a value"));
        }
        found
    }

    /// By hand: the page itself may ask; pages of other ports, hosts and origins, and what has no token, may not.
    #[test]
    fn only_the_page_itself_may_ask() {
        let own: SocketAddr = "127.0.0.1:8417".parse().expect("an address");
        let code = Arc::new(Mutex::new(Some("once".to_owned())));
        let access = Access::Token(Secrets { token: "secret".to_owned(), code });
        let ask = |pairs: &[(&'static str, &str)]| may_ask(&access, own, &headers(pairs));
        let good = [
            ("host", "127.0.0.1:8417"),
            ("origin", "http://127.0.0.1:8417"),
            ("x-palmistry-token", "secret"),
        ];
        assert_eq!(ask(&good), Ok(()));
        let with = |place: usize, value: &'static str| {
            let mut pairs = good;
            pairs[place].1 = value;
            ask(&pairs)
        };
        for host in
            ["evil.example", "127.0.0.1", "127.0.0.1:80", "evil.example:8417", "127.0.0.1:8417.evil.example"]
        {
            assert_eq!(with(0, host), Err(Refusal::Host), "{host}");
        }
        for origin in [
            "null",
            "http://evil.example",
            "http://127.0.0.1:8418",
            "https://127.0.0.1:8417",
            "http://localhost:8417",
            "",
        ] {
            assert_eq!(with(1, origin), Err(Refusal::Origin), "{origin}");
        }
        for token in ["", "Secret", "secret ", "secre", "secrets"] {
            assert_eq!(with(2, token), Err(Refusal::Token), "{token}");
        }
        assert_eq!(ask(&good[..2]), Err(Refusal::Token));
        assert_eq!(ask(&[good[0], good[2]]), Err(Refusal::Origin));
        assert_eq!(ask(&good[1..]), Err(Refusal::Host));
        let twice = [good[0], good[1], good[2], ("x-palmistry-token", "other")];
        assert_eq!(ask(&twice), Err(Refusal::Token));
        let cross = [good[0], good[1], good[2], ("sec-fetch-site", "cross-site")];
        assert_eq!(ask(&cross), Err(Refusal::Origin));
        let local = [("host", "localhost:8417"), ("origin", "http://localhost:8417"), good[2]];
        assert_eq!(ask(&local), Ok(()));
        // everybody's server has no token, and answers its own page alone all the same
        let public = |pairs: &[(&'static str, &str)]| may_ask(&Access::Public, own, &headers(pairs));
        assert_eq!(public(&[("host", "lab.example"), ("origin", "https://lab.example")]), Ok(()));
        assert_eq!(
            public(&[("host", "lab.example"), ("origin", "https://evil.example")]),
            Err(Refusal::Origin)
        );
        assert!(!format!("{access:?}").contains("secret"));
        // the code is exchanged for the token once
        assert!(access.address_once(own).ends_with("?code=once"));
        assert_eq!(access.token_for("Once"), None);
        assert_eq!(access.token_for("once").as_deref(), Some("secret"));
        assert_eq!(access.token_for("once"), None);
        assert_eq!(access.token_for(""), None);
    }
}
