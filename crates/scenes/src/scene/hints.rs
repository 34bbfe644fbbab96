//! What to write in place of what a scene has: for texts that are no TOML, values of the wrong kind, and keys and words under the
//! names that other programs give them. All of it in tables, so that a mistake more is a line more.

use palmistry_io::foreign::shown_path;
use palmistry_lang::{nearest, nearest_file};
use std::io::ErrorKind;
use std::ops::Range;
use std::path::Path;

/// Keys by other names: what is written, a key that the same table has, and what to do.
const KEYS: &[(&[&str], &str, &str)] = &[
    (
        &["time", "t", "t_end", "tend", "t_final", "length"],
        "duration",
        "the length in time is called 'duration', in s",
    ),
    (&["tspan", "t_span"], "duration", "write duration = 40, in s; it begins at 0"),
    (&["dt", "step", "ts", "timestep"], "rate", "write samples = 401, or rate = 10 in Hz"),
    (&["frequency", "fs", "sampling_rate"], "rate", "it is called 'rate', in Hz"),
    (&["n", "points", "count"], "samples", "it is called 'samples'"),
    (&["system", "proof", "file"], "model", "it is called 'model'"),
    (&["initial", "states", "x0", "init", "state"], "start", "the values at the start stand under [start]"),
    (&["parameters", "params", "constants"], "start", "values of constants stand under [start]"),
    (&["u", "controls"], "inputs", "functions of time stand under [inputs]"),
    (
        &["recording", "file", "csv", "measurements"],
        "data",
        "a recording stands under [data], as in record = \"run.csv\"",
    ),
    (&["file", "csv", "path", "data"], "record", "it is called 'record'"),
    (&["data", "csv", "record", "file"], "measurements", "it is called 'measurements'"),
    (
        &["noise", "errors", "measurement"],
        "sensor",
        "errors of measurements stand under [sensor], as in noise = 1e-3",
    ),
    (&["noise", "sigma", "std"], "size", "it is called 'size', one standard deviation"),
    (&["sigma", "std", "stddev", "sd", "error"], "noise", "it is called 'noise', one standard deviation"),
    (
        &["variance", "var", "covariance"],
        "noise",
        "write noise, the root of the variance: one standard deviation",
    ),
    (&["distribution", "law"], "jitter", "errors are normal: leave it out"),
    (
        &["bias", "gain", "delay"],
        "jitter",
        "it is that of one column: write [sensor.NAME], and below it this line",
    ),
    (&["estimator", "filter", "mhe", "kalman"], "observer", "it is called 'observer'"),
    (&["observer", "sensor"], "experiments", "several experiments are fitted as a whole: leave it out"),
    (
        &["duration", "samples", "rate"],
        "experiments",
        "several experiments are fitted to 'measurements', and none is simulated: leave it out",
    ),
    (&["solver", "tolerance", "tolerances"], "observer", "there are no tolerances to set: leave it out"),
    (
        &["plot", "plots", "output"],
        "observer",
        "pictures are written by 'palmistry observe SCENE --out DIR'; leave it out",
    ),
    (&["gravity"], "robot", "gravity stands under [body]"),
    (&["horizon"], "window", "it is called 'window', in samples"),
    (&["q", "r", "p0", "process_noise"], "kalman", "settings of a filter stand under kalman = { ... }"),
    (
        &["inputs", "start", "model"],
        "motion",
        "with 'motion' the scene has bodies between palms, and no model: leave this out, or 'motion'",
    ),
];

/// Words by other names, as [`KEYS`].
const WORDS: &[(&[&str], &str, &str)] = &[
    (&["ekf", "kf", "extended-kalman"], "kalman", "the extended Kalman filter is called 'kalman'"),
    (&["ukf"], "kalman", "the unscented Kalman filter is called 'unscented'"),
    (&["mhe"], "kalman", "moving-horizon estimation is 'multiple-shooting' or 'trust-region'"),
    (
        &["least-squares", "lsq", "lm"],
        "kalman",
        "least squares over a window are 'multiple-shooting' or 'trust-region'",
    ),
    (&["luenberger"], "kalman", "an observer with a high gain is called 'high-gain'"),
    (&["robust", "l1"], "huber", "the robust loss is called 'huber'"),
    (&["gauss", "gaussian"], "laplace", "it is called 'normal'"),
    (&["ln"], "log10", "it is called 'log'"),
    (&["lin"], "log10", "it is called 'linear'"),
];

/// Keys that hold a quantity: an example, and its unit.
const EXAMPLES: &[(&str, &str, &str)] = &[
    ("duration", "40", "s"),
    ("samples", "401", ""),
    ("rate", "10", "Hz"),
    ("seed", "1", ""),
    ("window", "40", ""),
    ("steps", "50", ""),
    ("starts", "8", ""),
    ("noise", "1e-3", "m"),
    ("resolution", "1e-3", "m"),
    ("jitter", "1e-3", "s"),
    ("mass", "1.0", "kg"),
    ("guess_off", "0.1", ""),
];

/// The nearest of the known names, one that differs in capital letters alone before all others.
pub(crate) fn near<'k>(name: &str, known: &[&'k str]) -> Option<&'k str> {
    let same = known.iter().find(|other| other.eq_ignore_ascii_case(name)).copied();
    same.or_else(|| nearest(name, known.iter().copied()))
}

/// What to do about a key that is not known.
pub(super) fn of_key(unknown: &str, known: &[&str]) -> String {
    of_name(unknown, known, KEYS)
}

/// What to do about a word that is not known.
pub(super) fn of_word(unknown: &str, known: &[&str]) -> String {
    // of words as short as log2 another one is no likely mistake
    let is_number = unknown.ends_with(|sign: char| sign.is_ascii_digit());
    match is_number
        && nearest(unknown, known.iter().copied()).is_some()
        && !known.iter().any(|k| k.eq_ignore_ascii_case(unknown))
    {
        true => format!("known here: {}", known.join(", ")),
        false => of_name(unknown, known, WORDS),
    }
}

fn of_name(unknown: &str, known: &[&str], table: &[(&[&str], &str, &str)]) -> String {
    if let Some(same) = known.iter().find(|name| name.eq_ignore_ascii_case(unknown)) {
        return format!("perhaps you meant '{same}'");
    }
    let is_one = |(names, witness, _): &&(&[&str], &str, &str)| {
        known.contains(witness) && names.iter().any(|name| name.eq_ignore_ascii_case(unknown))
    };
    match (table.iter().find(is_one), nearest(unknown, known.iter().copied())) {
        (Some((_, _, help)), _) => (*help).to_owned(),
        (None, Some(near)) => format!("perhaps you meant '{near}'"),
        (None, None) if known.contains(&"start") && known.contains(&"duration") => {
            format!("known here: {}; values of states and constants stand under [start]", known.join(", "))
        }
        (None, None) => format!("known here: {}", known.join(", ")),
    }
}

/// The ends of names of files that are no proof files.
const NO_PROOF_FILES: [&str; 4] = ["toml", "csv", "parquet", "json"];

/// That a file which a scene names is not there, or is of another kind, and what to do; `what` it has to be.
pub(crate) fn refused_file(file: &Path, what: &str) -> Option<(String, String)> {
    if palmistry_io::file::is_file(file) {
        let extension = file.extension().and_then(|end| end.to_str()).unwrap_or_default();
        let is_another = what == PROOF_FILE && NO_PROOF_FILES.contains(&extension);
        let message = || format!("{} is no proof file: its name ends in .{extension}", shown_path(file));
        return is_another
            .then(|| (message(), "name the proof file of the model, which ends in .proof".to_owned()));
    }
    if palmistry_io::file::is_folder(file) {
        return Some((format!("{} is a folder", shown_path(file)), format!("name {what} in it")));
    }
    let shown = shown_path(file);
    match std::fs::metadata(file) {
        // a device never ends, and a pipe is read once, while a scene may be read again
        Ok(_) => {
            let help = match what == RECORDING {
                true => {
                    "name a file; what another program writes is read by 'palmistry observe SCENE --data -'"
                        .to_owned()
                }
                false => format!("name {what} on the disk"),
            };
            return Some((format!("{shown} is no regular file, but a device, a pipe or a socket"), help));
        }
        Err(why) if !matches!(why.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
            let help = "let it be read, or name another file";
            return Some((format!("cannot read {shown}: {why}"), help.to_owned()));
        }
        Err(_) => {}
    }
    let help = match nearest_file(file) {
        Some(near) => format!("perhaps you meant '{near}'"),
        None => "a file is looked for from the folder in which the scene lies".to_owned(),
    };
    Some((format!("there is no file {shown}"), help))
}

/// What 'model' names.
pub(crate) const PROOF_FILE: &str = "a proof file";

/// What 'record' names.
pub(crate) const RECORDING: &str = "a recording";

/// The line in which something stands, its key and its value.
struct Line<'t> {
    text: &'t str,
    key: &'t str,
    value: Option<&'t str>,
}

impl<'t> Line<'t> {
    fn at(text: &'t str, place: usize) -> Line<'t> {
        let begin = text[..place].rfind('\n').map_or(0, |at| at + 1);
        let end = text[place..].find('\n').map_or(text.len(), |at| place + at);
        let text = text[begin..end].trim();
        let (key, value) = match text.split_once('=') {
            Some((key, value)) => (key.trim(), Some(value.split(" #").next().unwrap_or(value).trim())),
            None => (text, None),
        };
        Line { text, key, value }
    }
}

/// What to do about a text that is no TOML; `span` is where its reader stopped.
pub(super) fn of_syntax(text: &str, span: &Range<usize>) -> Option<String> {
    let place = (0..=span.start.min(text.len())).rev().find(|at| text.is_char_boundary(*at)).unwrap_or(0);
    let line = Line::at(text, place);
    if let Some(sign) = line.text.chars().chain(text[place..].chars().take(1)).find(|sign| is_foreign(*sign))
    {
        return Some(of_foreign(sign));
    }
    let Line { text, key, value } = line;
    if text.starts_with("//") || text.starts_with('%') {
        return Some("a comment begins with '#'".to_owned());
    }
    if text.starts_with('[') && !text.contains(']') {
        return Some(format!("the name of a table ends with ']', as in {text}]"));
    }
    if text.starts_with('{') {
        return Some("a key stands without brackets, as in duration = 40".to_owned());
    }
    let Some(value) = value else {
        return text.split_once(':').map(|(key, value)| match value.trim() {
            "" => format!("a table is written [{}]", key.trim()),
            value => format!("a value stands behind '=', as in {} = {value}", key.trim()),
        });
    };
    if let Some((name, _)) = key.split_once('(') {
        return Some(format!("write {} = ..., without brackets", name.trim()));
    }
    of_value(key, value)
}

/// Where nothing better is known of a value.
pub(super) const ANY_KIND: &str = "write a value of the kind that is expected";

/// Signs that look like others, or like none.
fn is_foreign(sign: char) -> bool {
    matches!(sign, '\u{feff}' | '\u{200b}'..='\u{200d}' | '\u{2060}' | '\u{2212}' | '\u{2013}' | '\u{201c}'..='\u{201f}' | '\u{2018}' | '\u{2019}')
        || (sign.is_whitespace() && !matches!(sign, ' ' | '\t' | '\r' | '\n'))
}

fn of_foreign(sign: char) -> String {
    let code = format!("U+{:04X}", u32::from(sign));
    match sign {
        '\u{2212}' | '\u{2013}' => "write the minus sign of the keyboard, '-'".to_owned(),
        '\u{2018}'..='\u{201f}' => format!("write straight quotation marks, \" ({code} stands here)"),
        _ if sign.is_whitespace() => format!("a blank of another kind ({code}) stands here: type it anew"),
        _ => format!("an invisible character ({code}) stands here: delete it"),
    }
}

/// A number at the beginning of a text, and what follows it.
fn number_and_rest(text: &str) -> Option<(&str, &str)> {
    let end =
        text.find(|sign: char| !(sign.is_ascii_digit() || "+-.eE_".contains(sign))).unwrap_or(text.len());
    // what looks like an exponent may be a unit
    let end = (1..=end).rev().find(|end| text[..*end].parse::<f64>().is_ok())?;
    Some((&text[..end], text[end..].trim()))
}

fn of_value(key: &str, value: &str) -> Option<String> {
    let quoted = value.starts_with(['"', '\'']);
    if let Some(before) = value.strip_suffix(';') {
        return Some(format!("leave ';' out: {key} = {}", before.trim()));
    }
    if quoted {
        return (value.matches('"').count() == 1)
            .then(|| "a text ends with a quotation mark on its line".to_owned());
    }
    let is_digits = |text: &str| !text.is_empty() && text.chars().all(|sign| sign.is_ascii_digit());
    if let Some((whole, part)) = value.split_once(',')
        && is_digits(whole.trim_start_matches('-'))
        && is_digits(part)
    {
        return Some(format!("a decimal point is written '.', as in {key} = {whole}.{part}"));
    }
    if value.strip_prefix('.').is_some_and(is_digits) {
        return Some(format!("write a digit before the point, as in {key} = 0{value}"));
    }
    if value.strip_suffix('.').is_some_and(is_digits) {
        return Some(format!("write a digit behind the point, as in {key} = {value}0"));
    }
    if let Some((number, rest)) = number_and_rest(value).filter(|(_, rest)| !rest.is_empty()) {
        return Some(match rest.starts_with(['/', '*', '^']) {
            true => format!("write a decimal, as in {key} = 0.5: numbers are not computed here"),
            false if rest.starts_with(char::is_alphabetic) || rest.starts_with('%') => {
                format!("a number stands without its unit: write {key} = {number}{}", in_unit(key))
            }
            false if rest.starts_with(['+', '-']) => {
                format!("a formula stands in quotation marks, as in {key} = \"{value}\"")
            }
            false => return None,
        });
    }
    if value == "pi" {
        return Some(format!("write a decimal, as in {key} = 3.14159"));
    }
    let word = value.trim_start_matches('[').trim();
    if !word.starts_with(|sign: char| sign.is_alphabetic() || sign == '/' || sign == '.') {
        return None;
    }
    let first = word.split([',', ']']).next().unwrap_or(word).trim();
    Some(match (key, value.starts_with('[')) {
        ("estimate" | "methods", _) => format!("write a list of texts, as in {key} = [\"{first}\"]"),
        (_, true) => format!("texts stand in quotation marks, as in {key} = [\"{first}\"]"),
        (_, false) => format!("a text stands in quotation marks, as in {key} = \"{word}\""),
    })
}

/// The unit of a key, where it has one.
fn in_unit(key: &str) -> String {
    match EXAMPLES.iter().find(|(name, _, unit)| *name == key && !unit.is_empty()) {
        Some((_, _, unit)) => format!(", in {unit}"),
        None => String::new(),
    }
}

/// What to do about a value of another kind than is expected: the keys on the way to it, the value as it is written, and the kind in
/// the words of the reader.
pub(super) fn of_kind(path: &[&str], written: &str, expected: &str) -> String {
    let key = path.last().copied().unwrap_or("it");
    let table = path.len().checked_sub(2).and_then(|place| path.get(place)).copied().unwrap_or_default();
    let text = written.trim().trim_matches(['"', '\'']);
    let is_list = written.starts_with('[');
    let example = EXAMPLES.iter().find(|(name, ..)| *name == key).map_or("1.0", |(_, example, _)| example);
    let unit = in_unit(key);
    // tables of a list, where one is meant
    if written.starts_with("[[") {
        return format!("write [{key}], with one bracket");
    }
    match expected {
        "a list of length 2" if table == "parameters" => {
            format!("write {key} = {{ bounds = [1e-3, 1e3] }}")
        }
        _ if expected.starts_with("a list of length") && is_list => {
            format!("{key} is {expected}: write so many, with ',' between them")
        }
        _ if expected.starts_with("a list of length") => {
            format!("write {expected}, as in {key} = [0, inf]{unit}")
        }
        "a number" | "a whole number that is not negative" => {
            let whole = if expected == "a number" { "a number" } else { "a whole number from 0 on" };
            let example = if expected == "a number" {
                example
            } else {
                EXAMPLES.iter().find(|(name, ..)| *name == key).map_or("8", |(_, example, _)| example)
            };
            match number_and_rest(text) {
                _ if key == "duration" && is_list => {
                    format!("write one number, as in {key} = 40{unit}; it begins at 0")
                }
                _ if is_list => format!("write one number, as in {key} = {example}{unit}"),
                _ if written.starts_with('{') && table == "sensor" => {
                    format!("write [sensor.NAME] with the name of a column, and below it {key} = {example}")
                }
                Some((number, rest)) if expected == "a number" && rest.starts_with('%') => {
                    let part = number.parse::<f64>().unwrap_or(f64::NAN) / 100.0;
                    format!("write a fraction, as in {key} = {part}")
                }
                Some((number, "")) if expected == "a number" => {
                    format!("write {key} = {number}{unit}, without quotation marks")
                }
                Some((number, _)) if expected == "a number" => {
                    format!("write {key} = {number}{unit}, without quotation marks and unit")
                }
                Some((number, "")) if number.parse::<u64>().is_ok() => {
                    format!("write {key} = {number}, without quotation marks")
                }
                _ => format!("write {whole}, as in {key} = {example}{unit}"),
            }
        }
        "a list" if key == "estimate" && written.starts_with('{') => {
            "write a list, as in estimate = [\"x\"]; a first guess stands in guess = { x = 1 }".to_owned()
        }
        "a list" if written.starts_with(['"', '\'']) => format!("write a list, as in {key} = [\"{text}\"]"),
        "a list" => {
            let one = if key == "methods" { "newton" } else { "x" };
            format!("write a list, as in {key} = [\"{one}\"]")
        }
        "a table" => format!("write a table, as in {key} = {{ x = 1 }}"),
        "a table with 'bounds'" => {
            format!("write {key} = {{ bounds = [1e-3, 1e3] }}; a value that is known stands under [known]")
        }
        "a table with 'law', 'centre' and 'spread'" => {
            format!("write {key} = {{ law = \"normal\", centre = 0, spread = 1 }}")
        }
        "a text" if is_list && table != "inputs" => {
            let inner = written.trim_matches(['[', ']', ' ']);
            format!("write {key} = {inner}, without [ ]")
        }
        "a text" if is_list => format!(
            "write a function of t, as in {key} = \"sin(t)\"; measured values come from a recording, [data] record = \"run.csv\""
        ),
        "a text" if table == "inputs" => {
            format!("a function stands in quotation marks, as in {key} = \"{text}\"")
        }
        "a text" => format!("a text stands in quotation marks, as in {key} = \"{text}\""),
        _ => ANY_KIND.to_owned(),
    }
}

/// What other programs write in a function of time, and what to do; [`of_function`] looks for the first of them.
const FUNCTIONS: &[(&[&str], &str)] = &[
    (&[".csv", ".parquet", ".txt"], "measured values come from a recording: [data] record = \"run.csv\""),
    (
        &["if ", "step(", "heaviside(", "square(", "piecewise("],
        "there are no jumps and no 'if': write 1/2 + tanh(100*(t - 1))/2 for a step at t = 1",
    ),
    (&["rand", "noise("], "errors of measurements stand under [sensor], as in noise = 1e-3"),
    (&["np.", "math.", "numpy."], "functions are written without what stands before the point, as in sin(t)"),
    (&["time"], "the time is called 't'"),
];

/// What to do about a function of time that cannot be read: `known` is what the language says.
pub(crate) fn of_function(text: &str, known: Option<&str>) -> Option<String> {
    if text.trim().is_empty() {
        return Some("write a function of the time t, as in \"0\" or \"0.1*sin(t)\"".to_owned());
    }
    let small = text.to_ascii_lowercase();
    let is_one = |(parts, _): &&(&[&str], &str)| parts.iter().any(|part| small.contains(part));
    if let Some((_, help)) = FUNCTIONS.iter().find(is_one) {
        return Some((*help).to_owned());
    }
    // signs that stand between digits
    let between = |sign: char| {
        text.split_once(sign).filter(|(before, after)| {
            before.ends_with(|c: char| c.is_ascii_digit()) && after.starts_with(|c: char| c.is_ascii_digit())
        })
    };
    if between(',').is_some() {
        return Some("a decimal point is written '.', as in 0.5".to_owned());
    }
    match known {
        // a scene declares nothing
        Some(help) if !help.starts_with("declare it") => Some(help.to_owned()),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_toml_is_said_how_to_write() {
        for (text, at, help) in [
            ("duration = 40s", 11, "write duration = 40, in s"),
            ("duration = 40 s", 11, "write duration = 40, in s"),
            ("duration = 40,0", 13, "duration = 40.0"),
            ("duration: 40", 8, "as in duration = 40"),
            ("start:", 5, "a table is written [start]"),
            ("[start", 6, "as in [start]"),
            ("{duration = 40}", 0, "without brackets"),
            ("// c", 3, "'#'"),
            ("% c", 2, "'#'"),
            ("duration = 40;", 11, "leave ';' out"),
            ("duration = \u{2212}40", 11, "'-'"),
            ("\u{feff}duration = 40", 0, "U+FEFF"),
            ("duration\u{a0}= 40", 8, "U+00A0"),
            ("title = Two tanks", 8, "as in title = \"Two tanks\""),
            ("title = \"Two tanks", 18, "ends with a quotation mark"),
            ("model = a.proof", 8, "as in model = \"a.proof\""),
            ("methods = [newton]", 11, "methods = [\"newton\"]"),
            ("estimate = all", 11, "estimate = [\"all\"]"),
            ("h1 = 6/5", 5, "write a decimal"),
            ("h1 = .2", 5, "0.2"),
            ("h1 = 1.", 7, "1.0"),
            ("h1(0) = 1.2", 2, "write h1 = ..."),
            ("h1 = pi", 5, "3.14159"),
            ("u = 0.2 + sin(t)", 4, "as in u = \"0.2 + sin(t)\""),
        ] {
            let found = of_syntax(text, &(at..at)).unwrap_or_default();
            assert!(found.contains(help), "{text}: {found}");
        }
        assert_eq!(of_syntax("a = = 3", &(4..5)), None);
    }

    #[test]
    fn values_of_another_kind_are_said_how_to_write() {
        let number = "a number";
        let whole = "a whole number that is not negative";
        for (path, written, expected, help) in [
            ("duration", "\"40 s\"", number, "write duration = 40, in s, without quotation marks and unit"),
            ("duration", "'40'", number, "write duration = 40, in s, without quotation marks"),
            ("duration", "[0, 40]", number, "it begins at 0"),
            ("duration", "true", number, "write a number, as in duration = 40, in s"),
            ("observer.guess_off", "\"10%\"", number, "guess_off = 0.1"),
            ("sensor.noise", "{ h2 = 1e-3 }", number, "[sensor.NAME]"),
            ("samples", "41.5", whole, "write a whole number from 0 on, as in samples = 401"),
            ("samples", "\"41\"", whole, "write samples = 41, without quotation marks"),
            ("seed", "-1", whole, "a whole number from 0 on"),
            ("observer.methods", "\"kalman\"", "a list", "methods = [\"kalman\"]"),
            ("observer.estimate", "{ h1 = 1 }", "a list", "guess = {"),
            ("start", "[[start]]", "a table", "write [start], with one bracket"),
            ("observer.guess", "[1, 1]", "a table", "guess = { x = 1 }"),
            ("title", "3", "a text", "title = \"3\""),
            ("model", "[\"a.proof\"]", "a text", "write model = \"a.proof\", without [ ]"),
            ("inputs.u", "0.2", "a text", "a function stands in quotation marks, as in u = \"0.2\""),
            ("parameters.k", "0.001", "a list of length 2", "write k = { bounds = "),
        ] {
            let path: Vec<&str> = path.split('.').collect();
            let found = of_kind(&path, written, expected);
            assert!(found.contains(help), "{written}: {found}");
        }
    }

    #[test]
    fn functions_of_time_are_said_how_to_write() {
        for (text, help) in [
            ("", "as in \"0\""),
            ("u.csv", "[data] record"),
            ("if t > 1 then 1 else 0", "no jumps"),
            ("step(t)", "no jumps"),
            ("np.sin(t)", "as in sin(t)"),
            ("0.1*sin(0.5*time)", "'t'"),
            ("rand()", "[sensor]"),
            ("0,2", "'.'"),
        ] {
            assert!(of_function(text, None).is_some_and(|found| found.contains(help)), "{text}");
        }
        assert_eq!(
            of_function("2 t", Some("a product is written with '*'")).unwrap(),
            "a product is written with '*'"
        );
        assert_eq!(of_function("v", Some("declare it: 'state v'")), None);
    }

    #[test]
    fn other_names_are_known() {
        let top =
            ["title", "model", "duration", "samples", "rate", "start", "sensor", "data", "observer", "robot"];
        for (unknown, help) in [
            ("time", "'duration'"),
            ("tspan", "begins at 0"),
            ("Duration", "perhaps you meant 'duration'"),
            ("filter", "'observer'"),
            ("states", "[start]"),
            ("noise", "[sensor]"),
            ("titel", "perhaps you meant 'title'"),
            ("zzzzz", "known here: title"),
        ] {
            assert!(of_key(unknown, &top).contains(help), "{unknown}: {}", of_key(unknown, &top));
        }
        assert!(of_word("EKF", &["newton", "kalman"]).contains("called 'kalman'"));
        assert_eq!(of_word("log2", &["linear", "log", "log10"]), "known here: linear, log, log10");
        assert_eq!(near("H1", &["a1", "h1"]), Some("h1"));
    }
}
