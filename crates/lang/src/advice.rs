//! What to write where an entry does not read: by the part of the entry, and by what stands before the place and at it.
//!
//! Habits that have nothing to do with entries (signs, numbers, functions) are known to the parser of expressions.

use super::entry_words::{ENTRIES, NEXT_ENTRY};
use super::error::nearest;
use palmistry_math::expression::Expected;
use palmistry_math::expression::parse::ends_a_line;

/// The part of an entry; what stands before the place; what stands at it; what to write. Of the parts and of what stands somewhere
/// alternatives have blanks between them, and nothing stands for anything. `NAME`, `NUMBER`, `NOTHING` (but the
/// word of the entry), `OPEN` and `BRACE` (brackets), and `END` (of the line, perhaps behind a sign) are not meant literally; blanks
/// between signs do not count. In the advice `{entry}` is the word of the entry, `{name}` the
/// last name before the place and `{next}` the one at it. The first row that fits counts.
#[rustfmt::skip]
const ADVICE: &[(&str, &str, &str, &str)] = &[
    // everywhere
    ("", "", ":= <-", "write '=' alone"),
    ("", "=", "=", "an equation has one '=', as in x = y"),
    ("", "", ",END", "an entry ends with its line: leave ',' out"),
    ("", "OPEN", "END", "a bracket is open: each '(' needs its ')'"),
    ("", "+ - * / ^", "END", "something is missing behind the sign '{sign}'"),
    // titles
    ("system", "NOTHING", "NAME", "a title stands in quotation marks, as in system \"{next}\""),
    // lists of names
    ("state angle param", "NOTHING", ":", "leave ':' out behind '{entry}'"),
    ("state angle param initial", "NOTHING", "[ ( {", "names stand without brackets, with ',' between them, as in {entry} x, y"),
    ("state angle param-names let-name", "", "\" '", "names stand without quotation marks; a remark is a comment, # ..."),
    ("state", "", ";", "names stand with ',' between them, as in {entry} x, y"),
    ("param", "", ";", "constants stand with ',' between them, as in param k = 2, m = 3"),
    ("state", "", "known unknown", "a known initial condition is an entry of its own, as in initial {name} known; a constant is declared as in param {name} {next}"),
    ("param", "known unknown", "known unknown", "a constant is either known or unknown: one of the words, as in param k unknown"),
    ("param", "known unknown", "=", "the value stands before the word, as in param k = 2 {name}"),
    ("param", "known unknown", ":", "a unit stands before the word, as in param k = 2 : m/s {name}; a remark is a comment, # ..."),
    ("param", "known unknown", "NAME", "the word stands behind the name, as in param {next} {name}"),
    ("param", "real double float int integer", "NAME", "a constant has no type: leave '{name}' out"),
    ("param", "", "(unknown (known", "behind a constant stands 'known' or 'unknown' without brackets, as in param k = 1 unknown"),
    ("param", "", "fixed estimated free constant fit fitted", "behind a constant stands 'known' or 'unknown', as in param k unknown"),
    ("param", "", "positive negative nonnegative real integer small", "what is assumed is an inequality in an entry of its own, as in assume k > 0"),
    ("param", "", "< > <= >=", "what is assumed of it is an entry of its own, as in assume {name} > 0"),
    ("param-names", "", "(", "a signal is declared as in known {name}(t); a constant without brackets, as in param {name}"),
    ("param-names", "", "~", "a range is an entry of its own, as in sample {name} in [0, 1]"),
    ("param-names", ",", "NUMBER", "each constant has its own value, as in param k = 2, m = 3"),
    ("param-names", "NOTHING", "0", "what is assumed is an inequality in an entry of its own, as in assume k > 0"),
    ("param-names", "", "[", "a range is an entry of its own, as in sample {name} in [1, 2]; a unit stands behind a colon, as in param {name} : m"),
    ("param-value", "", "in to or .. [", "a range is an entry of its own, as in sample k in [1, 2]; a unit stands behind a colon, as in param k = 2 : m/s"),
    ("param-value", ".", ".", "a range is an entry of its own, as in sample k in [1, 2]"),
    ("param-value", "=", "?", "a constant without a value is declared as in param {name} unknown"),
    ("param-value let-value", "=", "\" '", "numbers stand without quotation marks"),
    ("param-value", "NUMBER", "\" NAME NUMBER", "a unit stands behind a colon, as in param k = 2 : m/s; constants stand with ',' between them, as in param k = 2, m = 3"),
    ("param-value", "", "=", "a constant has one value, as in param k = 2"),
    ("state", "", "(1 (2 (3 (4 (5 (0 .. ...", "a vector is declared by its range, as in state x[1..3]; its ends are whole numbers"),
    ("state param-names angle", "NUMBER", ":", "a vector is declared by its range, as in {entry} x[1..3]"),
    ("state angle", "", "(", "a state is named alone, without (t)"),
    ("state angle", "", "[", "a unit stands behind a colon, as in state x : m; a vector is declared as in state x[1..3]"),
    ("state", "", "=", "an initial condition is an entry of its own: initial {name} = ..."),
    ("state", "NAME", "in", "a range is an entry of its own, as in sample {name} in [0, 1]; a vector is declared as in state {name}[1..3]"),
    ("angle", "", "in :", "angles are in radians: leave it out, as in angle x"),
    ("param", "NAME", "in", "a range is an entry of its own, as in sample {name} in [0.1, 10]"),
    ("state param let", "NOTHING ,", "NUMBER", "a name begins with a letter, as in x1"),
    ("state angle param-names", "NAME", "- / * + .", "a name has letters, digits and '_', as in x_y"),
    ("state angle param-names", "NAME", "NAME", "names stand with ',' between them, as in {name}, {next}"),
    ("state angle param let-name", "[", "", "the index of a vector is a whole number, as in x[3] or x[1..3]"),
    // fields
    ("input-name", "NAME", "(", "a signal that drives the system is declared, as in known {name}(t)"),
    ("drift-name input-name field-name", "NAME", ":", "leave ':' out behind the name"),
    ("drift-name input-name field-name", "NAME", "'", "a field has a name: write {entry} f, and the rates below it"),
    ("drift-name input-name field-name", "", "{", "a field has no brackets: leave '{' and '}' out"),
    ("drift-name input-name field-name", "NAME", "= ( + , - *", "a field has a rate for each state below its name, as in {entry} {name}  x' = ..."),
    ("rates", "'", "=", "a rate stands alone on the left, as in {name}' = ..."),
    ("rates", "NAME", "'", "a rate stands alone on the left, as in {name}' = ..."),
    ("rates let", "OPEN", ",", "brackets hold one expression: a matrix is written [a; b], and there is no 'if'"),
    ("rates", "", ",", "rates stand one below the other, without ','"),
    ("drift-name input-name field-name", "NAME", "for", "a line for each index ends with 'for', as in x[i]' = v for i in 1..3"),
    ("rates", "'", "~ ->", "write '='"),
    ("rates", "'", "(", "a rate is written without (t), as in x' = ..."),
    ("rates", "+", "+", "the value after one step is written {name}+ = ..."),
    ("rates", "+", "END", "x+ stands on the left alone: write what it is equal to"),
    ("rates", "", "where", "what is assumed is an entry of its own, as in assume k > 0"),
    ("rates", "", ":", "a rate has the dimension of its state over time: leave it out"),
    ("rates let output assume", "", "\"", "a remark here is a comment: # ..."),
    ("rates let output", "", "< > <= >= !=", "a comparison is no number, and there is no 'if': write max(a, b), min(a, b), abs(a) or sign(a), or a claim for each case with 'where'"),
    // outputs
    ("output", "NOTHING", ":", "leave ':' out behind 'output'"),
    ("output", "NOTHING", "{", "outputs stand without brackets, with ',' between them, as in output x, y"),
    ("output", "OPEN", ",", "outputs stand without brackets, with ',' between them, as in output x, y"),
    ("output", "", ";", "outputs stand with ',' between them, as in output x, y"),
    ("output", "NUMBER", "=", "an equation that holds at all times has zero on the left, as in output 0 = x - 1"),
    ("output", "NAME", "=", "an output is an expression: name it by a definition, let {name} = ..., and write output {name}"),
    ("output", "", "=", "an output is an expression: name it by a definition, as in let y = x^2, and write output y"),
    ("output", "", "as", "an output is an expression: name it by a definition, as in let y = x^2, and write output y"),
    ("output", "", "[", "a dimension stands behind a colon, as in output x : rad"),
    ("output", "", "@ every at", "when it is measured stands in a scene, as in rate = 10"),
    ("output", "", "known unknown", "an output is what is measured: leave '{next}' out"),
    // definitions
    ("let", "", "where", "a definition has no condition: write the value in its place, as in e at {k = 1}"),
    ("let-name", "", "(", "functions are not defined: a definition is one expression of a name, as in let e = x^2"),
    ("let", "", ", =", "each definition is an entry of its own, as in let e = x^2"),
    // signals
    ("known unknown", "NOTHING", "input signal known unknown state", "the names of signals stand behind the word, as in {entry} u(t)"),
    ("known unknown", "NOTHING", "param", "the word stands behind the name, as in param k {entry}"),
    ("known unknown", "(", "", "a signal is one of time, as in {entry} u(t), with nothing else behind it: its function stands in a scene under [inputs]"),
    ("known unknown", "order", "", "as in unknown w(t) order 2; a known signal has all derivatives, without 'order'"),
    ("known unknown", ",", "order", "leave ',' out, as in unknown w(t) order 2"),
    ("known unknown", "input unknown known signal", "NAME", "one word begins the entry, as in {entry} {next}(t)"),
    ("known unknown", ",", "known unknown", "write the other signals as an entry of their own, as in {next} w(t)"),
    ("known unknown", "(t (t+1 t", "", "a signal is declared as in {entry} u(t), with nothing behind it: its function stands in a scene under [inputs]"),
    ("known unknown", "NAME", "= := (", "a signal is one of time, as in {entry} {name}(t); a constant is declared as in param {name} = 2"),
    ("known unknown", "NAME", "", "a signal is one of time, as in {entry} {name}(t); a constant is declared as in param {name} {entry}"),
    ("initial", "NAME", "(", "as in initial {name} = 1, without brackets"),
    ("initial-names", "NOTHING", "state known condition conditions value", "the name stands behind 'initial', as in initial x = 1, y known"),
    ("initial-names", "known condition conditions value", "", "the name stands behind 'initial', as in initial x = 1, y known"),
    ("initial-value", "", "known", "a value is known: leave 'known' out, as in initial x = 1"),
    ("initial-names", ",", "NUMBER", "each state has its own value, as in initial x = 1, y = 2"),
    // ranges
    ("sample", "NOTHING", ":", "leave ':' out behind 'sample'"),
    ("sample", "", "~", "a range is written x in [0, 1], as in sample x in [0, 1]"),
    ("sample", "in", "{", "a range has square brackets, as in x in [0, 1]"),
    ("sample", "NUMBER", ",", "a range has two ends, as in [0, 1]; a decimal point is written '.'"),
    ("sample", "except", "", "points are left out with 'avoid', as in sample x in [0, 1] avoid x - 1"),
    ("sample", "", "= from", "a range has square brackets, as in {name} in [-1, 1]"),
    ("sample-avoid", "", "!= < > = <= >=", "'avoid' has expressions that keep away from zero, with ',' between them, as in avoid x, x - 1"),
    ("sample-avoid", "", "NAME", "expressions stand with ',' between them, as in avoid x, x - 1"),
    ("sample", "]", ";", "ranges stand one behind the other, as in sample x in [0, 1], y in [0, 2]"),
    ("sample", "", ";", "the ends of a range have ',' between them, as in [0, 1]"),
    ("sample", "", "except", "points are left out with 'avoid', as in sample x in [0, 1] avoid x - 1"),
    ("sample", "NUMBER", "NUMBER", "the ends of a range have ',' between them, as in [0, 1]"),
    ("sample", "NUMBER", "to", "the ends of a range have ',' between them, as in x in [0, 1]"),
    ("sample", "NUMBER", "NAME", "numbers have no units here: leave it out"),
    ("sample", "NUMBER", ".. : )", "a range is written x in [0, 1], with square brackets and a ','"),
    ("assume", "NOTHING", ":", "leave ':' out behind 'assume'"),
    ("assume", "", ";", "assumptions stand with ',' between them, as in assume k > 0, a > 0"),
    ("assume", "", "where", "each assumption holds by itself, as in assume k > 0, a > 0"),
    ("assume", "", "positive negative real small is nonnegative", "what is assumed is an inequality, as in assume k > 0"),
    // names of claims
    ("claim-name", "NAME", "=", "a claim has a name and a colon, as in claim a: {name} = ..."),
    ("claim-name", "observable unobservable identifiable unidentifiable rank solutions", "", "a claim has a name and a colon, as in claim a: {name}(x)"),
    ("erratum-name damaged-name scan-name convention-name loose-name definition undecided", "NOTHING", ":", "the entry has a name, as in {entry} 1: ..."),
    ("claim-name", "restates", "", "as in claim 1 restates 2: ...; the name of what is meant stands without quotation marks"),
    ("claim-name", "consequence", "", "as in claim 1 consequence: ..."),
    ("claim-name", "", "proved refuted undecided false fails", "the verdict stands behind 'expect', as in claim a expect refuted: x = y"),
    ("claim-name", "", "expects expected", "it is called 'expect', as in claim a expect refuted: x = y"),
    ("claim-name", "expect", "", "as in claim a expect refuted: x = y; the verdicts are proved, refuted and undecided"),
    ("claim-name", "NOTHING", "( \" #", "a name of a claim has letters, digits, '.', '_' and '-', as in energy_balance"),
    ("claim-name", "NAME NUMBER", "NAME , (", "a claim has a name of one word and a colon, as in claim energy_balance: ..."),
    ("claim-name", "", ") . - \"", "a claim has a name and a colon, as in claim 1: rank = 3"),
    ("erratum-name damaged-name scan-name convention-name loose-name", "at", "", "where it stands is a text in quotation marks behind its name, as in erratum 4.2 at \"page 57\": ..."),
    ("erratum-name damaged-name scan-name convention-name loose-name", "\"", "follows", "'follows' stands before 'at', as in {entry} 2 follows 1 at \"page 57\": ..."),
    ("erratum damaged scan convention loose", "", "follows", "'follows' stands behind the name, as in {entry} 2 follows 1 at \"page 57\": ..."),
    ("erratum-statement damaged-statement scan-statement convention-statement loose-statement", "\"", "\"", "the remark stands before 'conclusion', as in ... \"remark\" conclusion \"none\""),
    // statements
    ("statement", "corrected repaired meant as", "\"", "here stands a statement without quotation marks, as in x = y"),
    ("statement", "at", "", "the value at a point is written x at {x = 1, y = 2}; a condition of a claim is written with 'where', as in '... where omega = 0'"),
    ("claim-statement", "NOTHING", ":", "one colon stands behind the name of a claim"),
    ("statement", "BRACE", ": ;", "the value at a point is written x at {x = 1, y = 2}"),
    ("statement", "", "|{", "the value at a point is written x at {x = 1, y = 2}"),
    ("conditions", "set", "", "a set has no name in conditions: write its equations, as in where x = 0, y = 0"),
    ("conditions", "NAME", "END", "a condition is an equation or an inequality, as in where x = 0, k > 0"),
    ("conditions", "", ",", "each condition has its own two sides, as in where x = 0, y = 0"),
    ("statement", "where", "( {", "conditions stand without brackets, as in where x = 0, y = 0"),
    ("conditions assume", "", "is", "write '=', as in where x = 0"),
    ("statement", "", ",where", "leave ',' out before 'where'"),
    ("statement", "OPEN", ",", "a matrix has square brackets, as in [1, 2]"),
    ("conditions", "", "=", "each equation by itself, as in x = 0, y = 0"),
    ("statement", "", "expect", "the verdict stands behind the name, as in claim a expect refuted: x = y"),
    ("statement", "", "when if unless given such with", "conditions stand behind 'where', as in rank = 4 where x = 0"),
    ("statement", "for", "", "a claim is about all states: leave 'for' out; conditions stand behind 'where', as in rank = 4 where x = 0"),
    ("conditions", "", "where", "all conditions stand behind one 'where', with ',' between them, as in where x = 0, k > 0"),
    ("statement", "", "for all", "a claim is about all states: leave it out; conditions stand behind 'where', as in rank = 4 where x = 0"),
    ("statement", "", "almost generically locally globally", "a rank is the generic one, without a word for it; at all states is 'everywhere'"),
    ("statement", "on", "", "write 'on sample' behind a comparison of numbers"),
    ("statement", "in", "sample", "write 'on sample'"),
    ("statement", "", "in", "write 'on sample', or conditions behind 'where', as in rank = 4 where x in [0, 1]"),
    ("statement", "everywhere", "on", "'everywhere' belongs to a rank, 'on sample' to a comparison of numbers: leave one of them out"),
    ("statement", "except", "", "as in except where x = 0"),
    ("claim-statement", "\"", "\" NAME", "a remark is one text in double quotation marks, without such marks inside"),
    ("statement", "]", "'", "a transpose is written transpose(M)"),
    ("statement", "", "'", "a remark stands in double quotation marks; a derivative along the drift f is L(f, x)"),
    ("statement", "", "remark", "a remark is a text in double quotation marks, as in claim 1: x = x \"remark\""),
    ("statement", "NUMBER", "..", "a range has square brackets, as in x in [-1, 1]"),
    ("statement", ")", "[1 [2 [3 [i", "an entry of a matrix has no name: it is [1, 0]*M*[1; 0]"),
    ("statement", "", "[ :", "numbers have no units here: leave it out; a dimension is declared once, as in state v : m/s"),
    ("statement", "", ".END", "an entry ends with its line: leave '.' out"),
    ("statement", "=", "!", UNEQUAL),
    ("statement", "", "!", "unequal is written '!=', as in x != 0; not observable is unobservable(x)"),
    ("statement", "'", "", "a derivative along the drift f is L(f, x)"),
    ("statement", "NOTHING", "system", "a claim is about unknowns, as in observable(x, y), or about the rank, as in rank = 4"),
    ("statement", "NOTHING rank", "is", "write '=', as in rank = 4"),
    ("statement", "", "is", "a statement has two sides, as in x = 0: all numbers are real"),
    ("claim-statement", "NOTHING", "\"", "words stand in an entry of their own, as in definition 1: \"...\" or undecided 1: \"...\""),
    ("statement", "carrying", "", "as in x = 2.718 within 0.001 carrying 10 digits"),
    ("claim-statement", "", ",", "each statement is a claim of its own, with its own name"),
    ("statement", "", "at", "a condition of a claim is written with 'where', as in '... where omega = 0'"),
    ("statement", "", "=", "an equation has one '=' and stands without brackets, as in x = y"),
    ("statement", "L_f L ad_f", "NAME", LIE),
    ("statement", "L^2 L_f^2 L(f) ad_f", "(", LIE),
    ("statement", "", "L_f", LIE),
    ("statement", "rank", "NAME (", "the rank of the system is rank = 4, that of a matrix rank([d(x); d(L(f, x))]) = 2"),
    ("statement", "observable( unobservable( identifiable( unidentifiable(", ")", "name the unknowns, as in observable(x, y)"),
    ("statement", "observable unobservable identifiable unidentifiable", "", "the unknowns stand in brackets, as in {name}(x, y)"),
    // pictures, sets and imports
    ("set singularity pole", "", "{", "conditions stand without brackets, as in set \"rest\": x = 0, y = 0"),
    ("set singularity pole", "", ";", "conditions stand with ',' between them, as in set \"rest\": x = 0, y = 0"),
    ("map", "", "where with", "values of other symbols stand in braces, as in map \"title\": x in [0, 1], y in [0, 2] at {z = 3}"),
    ("experiments", "", ":", "leave ':' out, as in experiments 2"),
];

const LIE: &str = "a Lie derivative is written L(f, x), the second one L(f, f, x)";
const UNEQUAL: &str = "unequal is written '!=', as in x != 0";

/// Words with which a statement begins elsewhere, and what to write.
#[rustfmt::skip]
const STATEMENTS: &[(&str, &str)] = &[
    ("controllable accessible reachable", "accessibility is decided by 'palmistry rank --accessible'; a claim is about observability"),
    ("detectable stable unstable convergent", "stability and detectability are no statements of the language; observable(x) is"),
    ("globally", "globally identifiable is written solutions(a) = 1"),
    ("locally", "a statement is a local and generic one, without a word for it, as in observable(x)"),
    ("not non", "what is not so is written unobservable(x), unidentifiable(a) or x != 0"),
    ("nonidentifiable", "write unidentifiable(a)"),
    ("nonobservable", "write unobservable(x)"),
    ("full", "full rank is the number of unknowns, as in rank = 3"),
    ("true false", "a statement has two sides, as in x = 0"),
    ("observability", "as in observable(x, y) or rank = 2"),
    ("identifiability", "as in identifiable(a, b)"),
    ("isobservable Observable", "it is called 'observable', as in observable(x, y)"),
    ("isidentifiable Identifiable", "it is called 'identifiable', as in identifiable(a, b)"),
];

/// How an entry is written.
#[rustfmt::skip]
const FORMS: &[(&str, &str)] = &[
    ("system", "as in system \"a pendulum\" cite \"a textbook\""),
    ("use", "as in use p = \"other.proof\""),
    ("state", "as in state x, y, or state x[1..3]"),
    ("param", "as in param k = 2, m, or param a unknown"),
    ("angle", "as in angle x, y"),
    ("latex", "as in latex x \"\\dot{x}\""),
    ("let", "a definition is one expression of a name, as in let e = x^2"),
    ("drift-name input-name field-name", "a field has a name, and below it a rate for each state, as in {entry} f  x' = v"),
    ("output", "as in output x, y"),
    ("sample", "a range is written x in [0, 1], each symbol with its own, as in sample x in [0, 1], y in [0, 2] avoid x - y"),
    ("assume", "as in assume k > 0, a > 0"),
    ("known unknown", "as in known u(t), or unknown w(t) order 2"),
    ("initial", "as in initial x = 1, y known"),
    ("experiments", "as in experiments 2"),
    ("claim-name", "a claim has a name and a colon, as in claim 1: rank = 3"),
    ("claim-statement", "a statement has two sides, as in x = 0, or is one like observable(x)"),
    ("conditions", "as in where x = 0, k > 0"),
    ("erratum", "as in erratum 1 at \"page 5\": printed x = y corrected x = x \"remark\" conclusion \"none\"; words that are printed as in printed \"x is y\" as x = y"),
    ("damaged", "as in damaged 1 at \"page 5\": reads x = y repaired x = x"),
    ("scan", "as in scan 1: scanned \"x = v\" repaired x = y"),
    ("convention", "as in convention 1: printed \"x is y\" as x = y meant x = x"),
    ("loose", "as in loose 1: printed \"x is small\" meant x = 0"),
    ("definition", "the words stand in quotation marks, as in definition 1: \"text\""),
    ("undecided", "the words stand in quotation marks, as in undecided 1: \"reason\""),
    ("set", "as in set \"rest\": x = 0, y = 0"),
    ("singularity pole", "as in singularity \"at the origin\": x = 0"),
    ("map", "as in map \"title\": x in [0, 1], y in [0, 2] at {z = 3} order 2 of x"),
    ("line", "as in line \"title\": x to 2 from {z = 3} of x"),
    ("reduction", "as in reduction of p: x = 0"),
];

/// Where an entry does not read.
struct Place<'t> {
    /// The word of the entry, and its part behind a dash.
    part: String,
    entry: &'t str,
    /// The entry as far as the place, without comments and the blanks at its end.
    head: String,
    rest: &'t str,
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

fn last_word(text: &str) -> &str {
    text.trim_end_matches(|c| !is_word(c)).rsplit(|c| !is_word(c)).next().unwrap_or_default()
}

fn first_word(text: &str) -> &str {
    &text[..text.find(|c| !is_word(c)).unwrap_or(text.len())]
}

/// A part of an entry, by the text of the entry so far.
fn part(entry: &str, head: &str) -> String {
    let has_word = |word: &str| head.split(|c| !is_word(c)).any(|one| one == word);
    let is_value = |list: &str| list.rsplit(',').next().is_some_and(|last| last.contains('='));
    let kind = match entry {
        "param" | "initial" if is_value(head) => "value",
        "param" | "initial" => "names",
        "let" if head.contains('=') => "value",
        "drift" | "input" | "field" if head.split_whitespace().count() > 2 => "rates",
        "let" | "drift" | "input" | "field" => "name",
        "sample" if has_word("avoid") => "avoid",
        "claim" | "erratum" | "damaged" | "scan" | "convention" | "loose" => match head.contains(':') {
            false => "name",
            true if has_word("where") => "statement-conditions",
            true => "statement",
        },
        "output" | "assume" | "set" | "singularity" | "pole" | "reduction" => "value",
        _ => return entry.to_owned(),
    };
    format!("{entry}-{kind}")
}

impl<'t> Place<'t> {
    fn new(text: &'t str, begin: usize, at: usize) -> Option<Place<'t>> {
        let (before, rest) = text.split_at_checked(at)?;
        let word = first_word(before.get(begin..)?);
        let entry = ENTRIES.into_iter().find(|entry| *entry == word)?;
        let lines = before[begin..].split(ends_a_line).map(|line| line.split('#').next().unwrap_or_default());
        let head = lines.collect::<Vec<_>>().join("\n").trim_end().to_owned();
        Some(Place { part: part(entry, &head), entry, head, rest })
    }

    /// Whether expressions stand here, and not names alone.
    fn has_expressions(&self) -> bool {
        ["value", "statement", "rates", "avoid"].into_iter().any(|kind| self.is_part(kind))
    }

    fn is_part(&self, wanted: &str) -> bool {
        wanted.split('-').all(|piece| self.part.split('-').any(|own| own == piece))
    }

    fn has_before(&self, wanted: &str) -> bool {
        let head = self.head.as_str();
        let last = last_word(head);
        let ends_in_word = head.ends_with(is_word);
        match wanted {
            "NOTHING" => head.trim() == self.entry || self.is_part("statement") && head.ends_with(':'),
            "OPEN" => head.matches('(').count() > head.matches(')').count(),
            "BRACE" => head.matches('{').count() > head.matches('}').count(),
            "NAME" if head == self.entry => false,
            "NAME" => ends_in_word && !last.starts_with(|c: char| c.is_ascii_digit()),
            "NUMBER" => ends_in_word && last.starts_with(|c: char| c.is_ascii_digit()),
            word if word.chars().all(is_word) => ends_in_word && last == word,
            sign => head.ends_with(sign),
        }
    }

    fn has_at(&self, wanted: &str) -> bool {
        let line = self.rest.split(|c| c == '#' || ends_a_line(c)).next().unwrap_or_default();
        let mut signs = line.chars().filter(|c| !c.is_whitespace());
        match wanted {
            "NAME" => self.rest.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_'),
            "NUMBER" => self.rest.starts_with(|c: char| c.is_ascii_digit()),
            word if word != "END" && word.chars().all(is_word) => first_word(self.rest) == word,
            sign => match sign.strip_suffix("END") {
                Some(sign) => signs.eq(sign.chars()),
                None => sign.chars().all(|wanted| signs.next() == Some(wanted)),
            },
        }
    }

    /// What to write, by the tables of this file.
    fn advice(&self) -> Option<String> {
        let any = |all: &str, fits: &dyn Fn(&str) -> bool| all.is_empty() || all.split(' ').any(fits);
        if self.is_part("statement")
            && let Some((_, statement)) = self.head.split_once(':')
        {
            let statement = if statement.trim().is_empty() { self.rest } else { statement.trim_start() };
            let word = first_word(statement);
            if let Some((_, advice)) =
                STATEMENTS.iter().find(|(words, _)| words.split(' ').any(|one| one == word))
            {
                return Some((*advice).to_owned());
            }
        }
        let behind_value = self.is_part("param-value") && self.has_before("NUMBER");
        let next = first_word(self.rest);
        if let Some(near) = nearest(next, ["known", "unknown"]).filter(|near| behind_value && *near != next) {
            return Some(format!("perhaps you meant '{near}'"));
        }
        let fits = |(parts, before, at, _): &&(&str, &str, &str, &str)| {
            any(parts, &|one| self.is_part(one))
                && any(before, &|one| self.has_before(one))
                && any(at, &|one| self.has_at(one))
        };
        ADVICE.iter().find(fits).map(|(.., advice)| self.filled_in(advice))
    }

    /// How the entry is written.
    fn form(&self, what: &str) -> Option<String> {
        // where an expression goes wrong in its middle, the form of the entry is no question
        let is_of_form =
            |what: &str| ["'", ":", "the words", "a text"].into_iter().any(|begin| what.starts_with(begin));
        if self.has_expressions() && !self.has_at("END") && !is_of_form(what) {
            return None;
        }
        let of_this = |(parts, _): &&(&str, &str)| parts.split(' ').any(|part| self.is_part(part));
        FORMS.iter().find(of_this).map(|(_, form)| self.filled_in(form))
    }

    fn filled_in(&self, advice: &str) -> String {
        let sign = self.head.char_indices().last().map_or("", |(at, _)| &self.head[at..]);
        let (name, next) = (last_word(&self.head), first_word(self.rest));
        let names = [("{entry}", self.entry), ("{name}", name), ("{next}", next), ("{sign}", sign)];
        names.into_iter().fold(advice.to_owned(), |text, (place, name)| text.replace(place, name))
    }
}

/// What was expected, with what to write: the entry in which it was begins at a place.
pub(super) fn advised(expected: Expected, text: &str, begin: usize) -> Expected {
    let Some(place) = Place::new(text, begin, expected.at) else { return expected.hinted(text) };
    let mut known = expected.with_habits_of_numbers(text);
    // `output y: phi`
    if place.entry == "output" && place.head.ends_with(':') && known.what.starts_with("a dimension") {
        let name = last_word(&place.head);
        let help = format!(
            "behind the colon stands a dimension, as in output {name} : length; what an output is called is a definition, as in let {name} = ..., and output {name}"
        );
        known.help = Some(help);
    }
    known.help = known.help.or_else(|| place.advice());
    if known.what == NEXT_ENTRY && !place.has_expressions() {
        known.what = "',', or the next entry on a line of its own".to_owned();
    }
    let hinted = known.hinted(text);
    Expected { help: hinted.help.clone().or_else(|| place.form(&hinted.what)), ..hinted }
}
