//! Where results are read: a terminal with colours and a width, or a file.

use palmistry::report::{Colour, Layout};
use std::io::IsTerminal;

/// How to lay out what is printed to standard output.
///
/// Colour as people agreed on it (no-color.org, bixense.com/clicolors): `NO_COLOR` that is not empty forbids it,
/// `CLICOLOR_FORCE` other than 0 asks for it, and otherwise a terminal has it unless `CLICOLOR` is 0 or `TERM` is dumb. Lines
/// are broken at the width of the terminal, or at `COLUMNS` where that is set; in a file they are whole.
pub(crate) fn layout() -> Layout {
    let variable = |name: &str| std::env::var_os(name).map(|value| value.to_string_lossy().into_owned());
    let stdout = std::io::stdout();
    let colour = colour(variable, stdout.is_terminal());
    let asked = variable("COLUMNS").and_then(|text| text.trim().parse().ok()).filter(|width| *width > 0);
    let shown = || terminal_size::terminal_size_of(&stdout).map(|(width, _)| usize::from(width.0));
    Layout { width: asked.or_else(shown), colour }
}

/// Whether standard output is a terminal, so that it can be cleared.
pub(crate) fn is_terminal() -> bool {
    std::io::stdout().is_terminal()
}

fn colour(variable: impl Fn(&str) -> Option<String>, is_terminal: bool) -> Colour {
    let is = |name: &str, value: &str| variable(name).is_some_and(|found| found == value);
    let is_set = |name: &str| variable(name).is_some_and(|found| !found.is_empty());
    let coloured = if is_set("NO_COLOR") {
        false
    } else if is_set("CLICOLOR_FORCE") && !is("CLICOLOR_FORCE", "0") {
        true
    } else {
        is_terminal && !is("CLICOLOR", "0") && !is("TERM", "dumb")
    };
    if coloured { Colour::Ansi } else { Colour::Plain }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_asked_for_in_the_environment_is_heeded() {
        let with = |set: &'static [(&str, &str)]| {
            move |name: &str| {
                set.iter().find(|(known, _)| *known == name).map(|(_, value)| (*value).to_owned())
            }
        };
        for (set, on_a_terminal, in_a_file) in [
            (&[][..], Colour::Ansi, Colour::Plain),
            (&[("NO_COLOR", "1")], Colour::Plain, Colour::Plain),
            (&[("NO_COLOR", "")], Colour::Ansi, Colour::Plain),
            (&[("CLICOLOR_FORCE", "1")], Colour::Ansi, Colour::Ansi),
            (&[("CLICOLOR_FORCE", "0")], Colour::Ansi, Colour::Plain),
            (&[("NO_COLOR", "1"), ("CLICOLOR_FORCE", "1")], Colour::Plain, Colour::Plain),
            (&[("CLICOLOR", "0")], Colour::Plain, Colour::Plain),
            (&[("TERM", "dumb")], Colour::Plain, Colour::Plain),
        ] {
            assert_eq!(colour(with(set), true), on_a_terminal, "{set:?}");
            assert_eq!(colour(with(set), false), in_a_file, "{set:?}");
        }
    }
}
