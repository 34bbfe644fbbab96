//! What is wrong with a command line, in words of ours where the parser's help is none.

use clap::error::{ContextKind, ContextValue, ErrorKind};

/// Options that are not there, and what to do instead.
const OPTIONS: &[(&[&str], &str)] = &[
    (&["--claim", "--claims", "--id"], "claims are chosen by '--only ID'"),
    (&["-n", "--n", "--states"], "the number of states is '--samples N'"),
    (&["--plot", "--plots", "--html"], "pictures are written by '--out DIR', where a command has it"),
    (&["--noise", "--sigma"], "the noise stands in the scene: [sensor] noise = 1e-3"),
    (&["--csv", "--input"], "measurements are read by '--data FILE', and written by '--record FILE'"),
    (&["--time", "--duration"], "the duration stands in the scene: duration = 40, in s"),
];

/// Commands that are not there, and what to do instead.
const COMMANDS: &[(&[&str], &str)] = &[
    (&["version"], "palmistry --version"),
    (
        &["run", "test", "proof"],
        "palmistry prove FILE decides the claims of a proof file, palmistry rank FILE what is observable",
    ),
    (&["simulate", "estimate", "filter"], "palmistry observe SCENE"),
    (&["observability", "identifiability", "observable"], "palmistry rank FILE"),
    (&["lint", "validate"], "palmistry check FILE"),
    (&["format"], "palmistry fmt FILE"),
];

/// The text of an error of the command line.
pub(super) fn mended(error: &clap::Error) -> String {
    let text = error.render().to_string();
    let argument = match error.get(ContextKind::InvalidArg) {
        Some(ContextValue::String(argument)) => argument.as_str(),
        _ => "",
    };
    let command = match error.get(ContextKind::InvalidSubcommand) {
        Some(ContextValue::String(command)) => command.as_str(),
        _ => "",
    };
    let help = match error.kind() {
        ErrorKind::UnknownArgument => of_argument(argument),
        ErrorKind::InvalidSubcommand => of_command(command),
        _ => None,
    };
    let no_whole_number = "a whole number from 0 on is meant, as in 1000";
    let text = text
        .replace("invalid digit found in string", no_whole_number)
        .replace("cannot parse integer from empty string", no_whole_number)
        .replace("number too large to fit in target type", "the number is too large")
        .replace("invalid float literal", "a number is meant, as in 0.5");
    // a tip of the parser is no help where ours is, and never to pass an option as a value
    let is_no_help = |line: &str| {
        let line = line.trim_start();
        line.starts_with("tip: to pass") || help.is_some() && line.starts_with("tip: ")
    };
    let mut lines: Vec<String> = Vec::new();
    for line in text.lines().filter(|line| !is_no_help(line)) {
        // one empty line between two parts
        if !(line.is_empty() && lines.last().is_some_and(String::is_empty)) {
            lines.push(line.to_owned());
        }
    }
    if let (Some(help), Some(at)) = (help, lines.iter().position(String::is_empty)) {
        lines.splice(at..at, [String::new(), format!("  tip: {help}")]);
    }
    lines.join("\n")
}

fn of_argument(argument: &str) -> Option<String> {
    let option = argument.split('=').next().unwrap_or(argument);
    if let Some((_, help)) = OPTIONS.iter().find(|(names, _)| names.contains(&option)) {
        return Some((*help).to_owned());
    }
    if argument.parse::<f64>().is_ok() && argument.starts_with('-') {
        return Some("the option before it takes no number below zero".to_owned());
    }
    if argument.starts_with('-') {
        return Some(format!(
            "there is no option '{option}' here; '--help' behind the command lists those that there are"
        ))
        .filter(|_| ["-v", "--verbose"].contains(&option) || option.len() == 2);
    }
    match argument.contains('=') {
        true => Some("values stand with ',' between them and no blanks, as in --at x=1,y=2".to_owned()),
        false => Some("what has blanks stands in quotation marks; of some commands one file is taken, of 'prove' and 'check' several".to_owned()),
    }
}

fn of_command(command: &str) -> Option<String> {
    if command.ends_with(".proof") {
        return Some(format!("palmistry prove {command}, or palmistry rank {command}"));
    }
    if command.ends_with(".toml") {
        return Some(format!("palmistry observe {command}"));
    }
    let found = COMMANDS.iter().find(|(names, _)| names.contains(&command));
    found.map(|(_, help)| (*help).to_owned())
}

#[cfg(test)]
mod tests {
    use super::super::Cli;
    use super::mended;
    use clap::Parser;

    #[test]
    fn command_lines_are_told_what_is_meant() {
        for (line, told) in [
            ("rank a.proof --samples -1", "takes no number below zero"),
            ("rank a.proof --samples abc", "a whole number from 0 on is meant"),
            ("rank a.proof --samples 1e3", "a whole number from 0 on is meant"),
            ("prove a.proof --claim 1", "'--only ID'"),
            ("prove a.proof -v", "there is no option '-v' here"),
            ("prove a.proof --verbose", "there is no option '--verbose' here"),
            ("prove a.proof --quite", "a similar argument exists: '--quiet'"),
            ("rank a.proof -n 5", "'--samples N'"),
            ("rank a.proof b.proof", "of some commands one file is taken"),
            ("eval a.proof x --at x=1 y=2", "as in --at x=1,y=2"),
            ("observe a.toml --plot", "'--out DIR'"),
            ("observe a.toml --noise 1", "[sensor] noise = 1e-3"),
            ("observe a.toml --csv a.csv", "'--data FILE'"),
            ("version", "palmistry --version"),
            ("run a.proof", "palmistry prove FILE"),
            ("a.proof", "palmistry prove a.proof"),
            ("proove a.proof", "'prove'"),
        ] {
            let words = std::iter::once("palmistry").chain(line.split(' '));
            let Err(error) = Cli::try_parse_from(words) else { panic!("{line}") };
            let text = mended(&error);
            assert!(text.contains(told) && !text.contains("tip: to pass"), "{line}: {text}");
            assert!(!text.contains("\n\n\n"), "{text}");
        }
    }
}
