//! `palmistry explain`: what a code in a message means.

use super::output::{Files, Form};
use super::{Status, Unusable};
use clap::Args;
use palmistry::report::Layout;
use palmistry::system::Code;
use serde_json::json;

/// Says what the code of a message means, with an example that is refused and one that is accepted; without a code, lists them all.
#[derive(Args)]
#[command(after_help = "Examples:
  palmistry explain                         all codes, a line each
  palmistry explain E201                    a name that is not known")]
pub(crate) struct Explain {
    /// The code at the end of a message, such as E201.
    #[arg(value_name = "CODE")]
    code: Option<String>,
    /// Print one JSON object: 'errors', each with code, title and page, the page in Markdown.
    #[arg(long)]
    pub json: bool,
}

impl Explain {
    pub fn run(self) -> miette::Result<Status> {
        let all = || Code::ALL.into_iter().map(|(code, _)| code);
        let asked: Vec<Code> = match &self.code {
            None => all().collect(),
            Some(id) => vec![Code::of(id).ok_or_else(|| {
                let known: Vec<&str> = all().map(Code::id).collect();
                Unusable::report(
                    Code::Option,
                    format!("there is no code '{id}'"),
                    format!("the codes are {}", known.join(", ")),
                )
            })?],
        };
        let errors: Vec<_> = asked
            .iter()
            .map(|code| json!({ "code": code.id(), "title": code.title(), "page": code.page() }))
            .collect();
        let words = || match (&self.code, asked.as_slice()) {
            (Some(_), [code]) => page_in_words(*code),
            _ => asked
                .iter()
                .map(|code| format!("{}  {}", code.id(), code.title()))
                .collect::<Vec<_>>()
                .join("\n"),
        };
        Files::default().print(Form::of(self.json), json!({ "errors": errors }), words, Status::AsExpected)
    }
}

/// The page of a code for a terminal: 80 columns, examples further in.
fn page_in_words(code: Code) -> String {
    let layout = Layout { width: Some(80), ..Layout::default() };
    let mut parts = vec![format!("{}: {}", code.id(), code.title())];
    let (mut prose, mut block): (Vec<&str>, Option<Vec<String>>) = (Vec::new(), None);
    for line in code.page().lines().chain([""]) {
        match (&mut block, line.strip_prefix("```")) {
            (None, Some(fence)) => {
                let word = if fence.contains("refused") { "Refused" } else { "Accepted" };
                let place = match fence.contains("after=") {
                    true => ", below a pendulum with the states phi and omega, a known k and an unknown b",
                    false => "",
                };
                parts.push(format!("{word}{place}:"));
                block = Some(Vec::new());
            }
            (Some(lines), Some(_)) => {
                parts.push(lines.join("\n"));
                block = None;
            }
            (Some(lines), None) => lines.push(format!("    {line}").trim_end().to_owned()),
            (None, None) if !line.is_empty() => prose.push(line),
            (None, None) => {
                let text = without_links(&std::mem::take(&mut prose).join(" "));
                parts.extend((!text.is_empty()).then(|| layout.wrap("", 0, &text)));
            }
        }
    }
    parts.join("\n\n")
}

/// A text of Markdown with the words of its links alone.
fn without_links(text: &str) -> String {
    let mut pieces = text.split("](");
    let first = pieces.next().unwrap_or_default().to_owned();
    pieces.fold(first, |whole, piece| {
        let (words, rest) = (whole.rsplit_once('['), piece.split_once(')'));
        match (words, rest) {
            (Some((before, words)), Some((_, after))) => format!("{before}{words}{after}"),
            _ => format!("{whole}]({piece}"),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_for_a_terminal() {
        for (code, id) in Code::ALL {
            let text = page_in_words(code);
            assert!(text.starts_with(id) && text.contains("Refused") && text.contains("Accepted"), "{text}");
            assert!(!text.contains("```") && !text.contains("]("), "{text}");
        }
        assert_eq!(without_links("a [b](c.md#d), [e](f) g"), "a b, e g");
    }
}
