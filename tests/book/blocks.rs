//! The fenced blocks of a page, as they stand in it.

use std::ops::Range;

/// A fenced block of a page.
pub struct Block {
    /// The first word behind the fence.
    pub kind: String,
    /// What stands behind that word.
    pub info: String,
    /// Its lines, without the fences.
    pub text: String,
    /// Where these lines are in the page, in bytes.
    pub span: Range<usize>,
    /// The line of its first fence, from 1.
    pub line: usize,
}

impl Block {
    /// The value of `key=value` behind the fence.
    pub fn value(&self, key: &str) -> Option<&str> {
        self.info.split_whitespace().find_map(|word| word.strip_prefix(key)?.strip_prefix('='))
    }

    /// Whether a word stands behind the fence.
    pub fn says(&self, word: &str) -> bool {
        self.info.split_whitespace().any(|own| own == word)
    }

    /// Why it is not run, where the page says so.
    pub fn not_run(&self) -> Option<&str> {
        self.info.strip_prefix("not run:").map(str::trim).filter(|why| !why.is_empty())
    }
}

/// All fenced blocks of a page.
pub fn blocks(page: &str) -> Vec<Block> {
    let mut found = Vec::new();
    let mut open: Option<Block> = None;
    let mut at = 0;
    for (number, line) in (1..).zip(page.split_inclusive('\n')) {
        let fence = line.trim_end().strip_prefix("```");
        match (fence, &mut open) {
            (Some(""), Some(_)) => {
                let mut block = open.take().expect("it is open");
                block.span.end = at;
                block.text = page[block.span.clone()].to_owned();
                found.push(block);
            }
            (Some(info), None) => {
                let (kind, info) = info.split_once(' ').unwrap_or((info, ""));
                let span = at + line.len()..0;
                let (kind, info) = (kind.to_owned(), info.trim().to_owned());
                open = Some(Block { kind, info, text: String::new(), span, line: number });
            }
            _ => {}
        }
        at += line.len();
    }
    assert!(open.is_none(), "a block is not closed");
    found
}

/// A command of a console block and the lines that are shown below it.
pub struct Shown {
    pub command: String,
    pub output: Vec<String>,
}

/// The commands of a console block. A command ends with its line, unless that ends with a backslash.
pub fn commands(block: &str) -> Vec<Shown> {
    let mut found: Vec<Shown> = Vec::new();
    let mut goes_on = false;
    for line in block.lines() {
        match (line.strip_prefix("$ "), found.last_mut()) {
            (Some(command), _) => {
                found.push(Shown { command: command.to_owned(), output: Vec::new() });
                goes_on = command.ends_with('\\');
            }
            (None, Some(last)) if goes_on => {
                last.command = format!("{}\n{line}", last.command);
                goes_on = line.ends_with('\\');
            }
            (None, Some(last)) => last.output.push(line.to_owned()),
            (None, None) => panic!("a console block begins with '$ ': {line}"),
        }
    }
    found
}
