//! What the browser is given: the page with its style and scripts, all of them in the program, and pages that answers have written.

use super::secret::random_name;
use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};

/// A file of the page.
pub(super) struct Asset {
    pub kind: &'static str,
    pub text: &'static str,
}

/// The file of a path; the page itself has a mark in it, see [`NONCE`].
pub(super) fn asset(path: &str) -> Option<Asset> {
    const SCRIPT: &str = "text/javascript; charset=utf-8";
    let (kind, text) = match path {
        "/" => ("text/html; charset=utf-8", include_str!("../../web/index.html")),
        "/lab.css" => ("text/css; charset=utf-8", include_str!("../../web/lab.css")),
        "/lab.js" => (SCRIPT, include_str!("../../web/lab.js")),
        "/ask.js" => (SCRIPT, include_str!("../../web/ask.js")),
        "/text.js" => (SCRIPT, include_str!("../../web/text.js")),
        "/answers.js" => (SCRIPT, include_str!("../../web/answers.js")),
        "/map.js" => (SCRIPT, include_str!("../../web/map.js")),
        "/motion.js" => (SCRIPT, include_str!("../../web/motion.js")),
        "/observe.js" => (SCRIPT, include_str!("../../web/observe.js")),
        "/models.js" => (SCRIPT, include_str!("../../web/models.js")),
        "/values.js" => (SCRIPT, include_str!("../../web/values.js")),
        "/scene.js" => (SCRIPT, include_str!("../../web/scene.js")),
        "/chart.js" => (SCRIPT, include_str!("../../web/chart.js")),
        "/editor.js" => (SCRIPT, include_str!("../../web/editor.min.js")),
        "/licences.txt" => ("text/plain; charset=utf-8", include_str!("../../web/licences.txt")),
        "/icon.svg" => ("image/svg+xml", include_str!("../../web/icon.svg")),
        _ => return None,
    };
    Some(Asset { kind, text })
}

/// Stands for the number used once by which the editor's own style is known.
pub(super) const NONCE: &str = "the-nonce-of-this-page";

/// What the page may load and do: its own files, and nothing from elsewhere.
pub(super) fn policy(nonce: &str) -> String {
    format!(
        "default-src 'none'; script-src 'self'; style-src 'self' 'nonce-{nonce}'; style-src-attr 'unsafe-inline'; img-src 'self' data: blob:; \
         connect-src 'self'; frame-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    )
}

/// What pages of answers may do: their own scripts run without an origin, so that they can ask this server nothing.
pub(super) const OF_AN_ANSWER: &str = "sandbox allow-scripts";

/// So many pages of answers are kept.
const MOST_PAGES: usize = 64;
/// And so many bytes of them.
const MOST_BYTES: usize = 64 << 20;

/// Pages of answers, by names that nobody guesses.
#[derive(Default)]
pub(super) struct Pages {
    kept: Mutex<VecDeque<(String, String)>>,
}

impl Pages {
    /// Keeps a page and returns its name. The oldest ones are dropped.
    pub fn keep(&self, page: String) -> String {
        let name = random_name();
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        kept.push_back((name.clone(), page));
        let size = |kept: &VecDeque<(String, String)>| kept.iter().map(|(_, page)| page.len()).sum::<usize>();
        while kept.len() > MOST_PAGES || (kept.len() > 1 && size(&kept) > MOST_BYTES) {
            kept.pop_front();
        }
        name
    }

    /// The page of a name.
    pub fn get(&self, name: &str) -> Option<String> {
        let kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        kept.iter().find(|(known, _)| known == name).map(|(_, page)| page.clone())
    }
}
