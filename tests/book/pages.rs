//! A page with its folder: the files that it shows are written there, its commands run there.

use crate::blocks::{Block, blocks, commands};
use crate::likeness::is_shown;
use palmistry::{System, decide_all};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What came of a page.
#[derive(Default)]
pub struct Findings {
    /// What is not as the page has it, each with its place.
    pub wrong: Vec<String>,
    /// The blocks that are not run, and why.
    pub not_run: Vec<String>,
    /// How many blocks were run.
    pub run: usize,
    /// The page with the outputs that were found in the place of those that are not so any more.
    pub renewed: String,
    /// Whether that is another text.
    pub has_changed: bool,
}

/// The pages of the book and the README, in order of their names.
pub fn pages() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = vec![root.join("README.md")];
    let folders = ["book/src", "book/src/commands", "book/src/questions"]
        .map(|name| std::fs::read_dir(root.join(name)).expect("the book"));
    let mut chapters: Vec<PathBuf> =
        folders.into_iter().flatten().map(|entry| entry.expect("an entry").path()).collect();
    chapters.retain(|path| path.extension().is_some_and(|extension| extension == "md"));
    chapters.sort();
    found.extend(chapters);
    found
}

/// A page that is being gone through.
struct Page<'a> {
    name: String,
    folder: &'a Path,
    /// The proof files that were shown so far.
    shown: BTreeMap<String, String>,
    /// The status of the last command.
    status: i32,
    found: Findings,
    /// Where the outputs of commands begin and end in the page, and what they are now.
    outputs: Vec<(std::ops::Range<usize>, String)>,
}

/// Goes through a page. What its commands write is left in the folder.
pub fn go_through(path: &Path, folder: &Path) -> Findings {
    let text = std::fs::read_to_string(path).expect("a page");
    let name = path.file_name().expect("a name").to_string_lossy().into_owned();
    // the papers lie where they do as seen from the project's folder
    let papers = Path::new(env!("CARGO_MANIFEST_DIR")).join("proofs");
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    std::os::unix::fs::symlink(papers, folder.join("proofs")).expect("a link");
    std::os::unix::fs::symlink(examples, folder.join("examples")).expect("a link");
    let mut page = Page {
        name,
        folder,
        shown: BTreeMap::new(),
        status: 0,
        found: Findings::default(),
        outputs: Vec::new(),
    };
    for block in blocks(&text) {
        page.block(&block);
    }
    let mut renewed = text;
    for (span, output) in page.outputs.iter().rev() {
        renewed.replace_range(span.clone(), output);
    }
    page.found.has_changed = !page.outputs.is_empty();
    page.found.renewed = renewed;
    page.found
}

impl Page<'_> {
    fn wrong(&mut self, block: &Block, what: impl std::fmt::Display) {
        self.found.wrong.push(format!("{}:{}: {what}", self.name, block.line));
    }

    fn block(&mut self, block: &Block) {
        if let Some(why) = block.not_run() {
            self.found.not_run.push(format!("{}:{}: {why}", self.name, block.line));
            return;
        }
        self.found.run += 1;
        if let Some(file) = block.value("file") {
            let path = self.folder.join(file);
            std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder is made");
            std::fs::write(path, &block.text).expect("a file is written");
        }
        match block.kind.as_str() {
            "palmistry" => self.proof(block),
            "console" => self.console(block),
            "json" => {
                if let Err(why) = serde_json::from_str::<serde_json::Value>(&block.text) {
                    self.wrong(block, why);
                }
            }
            "toml" | "julia" if block.value("refused").is_some() || block.says("accepted") => {
                self.described(block);
            }
            // a file that commands below it read
            "toml" | "csv" | "julia" | "xml" | "python" | "matlab" | "text"
                if block.value("file").is_some() => {}
            kind => self.wrong(block, format!("a block of kind '{kind}' that nobody runs")),
        }
    }

    /// A block of the language: a whole file, or entries that stand behind one that was shown.
    fn proof(&mut self, block: &Block) {
        let mut text = block.text.clone();
        if let Some(before) = block.value("after") {
            match self.shown.get(before) {
                Some(shown) => text = format!("{shown}\n{text}"),
                None => return self.wrong(block, format!("{before} is not shown above")),
            }
        }
        let name = self.folder.join(block.value("file").unwrap_or("block.proof")).display().to_string();
        let system = match System::parse(&name, &text, self.folder) {
            Ok(system) if block.says("refused") || block.value("refused").is_some() => {
                return self.wrong(block, format!("{} is read, and not refused", system.name));
            }
            Ok(system) => system,
            Err(_) if block.says("refused") => return,
            Err(why) if block.value("refused").is_some() => {
                let code = why.code.id();
                if block.value("refused") != Some(code) {
                    self.wrong(block, format!("refused with {code}: {why}"));
                }
                return;
            }
            Err(why) => return self.wrong(block, format!("{:?}", miette::Report::new(why))),
        };
        let fails: Vec<&str> = block.value("fails").map_or(Vec::new(), |list| list.split(',').collect());
        for outcome in decide_all(&system, 1, &false.into(), &|_| ()) {
            if outcome.ok == fails.contains(&outcome.id.as_str()) {
                self.wrong(block, format!("{}: {} is {}", outcome.id, outcome.statement, outcome.word()));
            }
        }
        if let Some(file) = block.value("file") {
            self.shown.insert(file.to_owned(), text);
        }
    }

    /// A scene, a model of another program, or a paper's description where it says so: accepted, or refused with a code.
    fn described(&mut self, block: &Block) {
        let (name, command) = match block.kind.as_str() {
            "toml" if block.says("paper") => ("paper/paper.toml", "palmistry verify paper --out page"),
            "toml" => ("scene.toml", "palmistry observe scene.toml"),
            _ => ("model.jl", "palmistry import model.jl"),
        };
        std::fs::create_dir_all(self.folder.join("paper")).expect("a folder is made");
        for (model, text) in &self.shown {
            std::fs::write(self.folder.join("paper").join(model), text).expect("a file is written");
        }
        std::fs::write(self.folder.join(name), &block.text).expect("a file is written");
        let output = self.run(block, command);
        let is_refused = std::mem::take(&mut self.status) == 2;
        let is_so = match block.value("refused") {
            Some(code) => is_refused && output.contains(&format!("'palmistry explain {code}'")),
            None => !is_refused,
        };
        if !is_so {
            self.wrong(block, output);
        }
    }

    /// Commands, each with its output.
    fn console(&mut self, block: &Block) {
        let (mut now, mut all_like) = (String::new(), true);
        if let Some(code) = block.value("refused")
            && !block.text.contains(&format!("'palmistry explain {code}'"))
        {
            self.wrong(block, format!("no message with {code} is shown"));
        }
        for shown in commands(&block.text) {
            let output = self.run(block, &shown.command);
            let lines: Vec<&str> = output.lines().map(str::trim_end).collect();
            now.push_str(&format!("$ {}\n", shown.command));
            if is_shown(&shown.output, &lines) {
                shown.output.iter().for_each(|line| now.push_str(&format!("{line}\n")));
            } else {
                all_like = false;
                self.wrong(
                    block,
                    format!("$ {}\nshown:\n{}\nnow:\n{output}", shown.command, shown.output.join("\n")),
                );
                lines.iter().for_each(|line| now.push_str(&format!("{line}\n")));
            }
        }
        if self.status != 0 {
            self.wrong(block, format!("status {} at the end, and no 'echo $?' below", self.status));
        }
        if !all_like {
            self.outputs.push((block.span.clone(), now));
        }
    }

    /// What a command prints, on both streams.
    fn run(&mut self, block: &Block, command: &str) -> String {
        if command == "echo $?" {
            return format!("{}\n", std::mem::take(&mut self.status));
        }
        if self.status != 0 {
            self.wrong(block, format!("status {} before '{command}', and no 'echo $?' between", self.status));
        }
        let program = Path::new(env!("CARGO_BIN_EXE_palmistry"));
        let mut path = program.parent().expect("a folder").as_os_str().to_owned();
        path.push(":");
        path.push(std::env::var_os("PATH").unwrap_or_default());
        let line = format!("exec 2>&1\n{command}");
        let output = Command::new("bash")
            .args(["-c", &line])
            .current_dir(self.folder)
            .env("PATH", path)
            .envs([("LANG", "C.UTF-8"), ("NO_COLOR", "1")])
            .env_remove("COLUMNS")
            .output()
            .expect("there is a bash");
        self.status = output.status.code().unwrap_or(-1);
        String::from_utf8(output.stdout).expect("a text")
    }
}
