//! Outputs of commands that take minutes, kept in `reports/kept`: the ordinary test compares numbers of the book with them, and on
//! request the commands run again and have to print the same.
//!
//! `reports/kept/commands.toml` has the command of each. `PALMISTRY_KEPT=renew cargo test --release --test book -- --ignored kept` writes
//! what is there now; `PALMISTRY_KEPT=NAME,NAME` runs these alone. Wall times may differ. Where an entry is `measured`, it has times
//! that differ from machine to machine, and is not compared: the sentence says when and where it was made.

use crate::likeness::is_shown;
use crate::numbers::{Output, root};
use crate::values::collapsed;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Kept {
    /// What bash runs in the project's folder.
    command: String,
    /// When and where it was made, if that makes a difference.
    measured: Option<String>,
}

fn folder() -> PathBuf {
    root().join("reports/kept")
}

fn commands() -> BTreeMap<String, Kept> {
    let text = std::fs::read_to_string(folder().join("commands.toml")).expect("a list of commands");
    toml::from_str(&text).expect("names with their commands")
}

/// A kept output. What is published lacks the reports: there it is nothing.
pub fn output(name: &str) -> Result<Option<Output>, String> {
    if !folder().exists() {
        return Ok(None);
    }
    let path = folder().join(name);
    let stdout = std::fs::read_to_string(&path).map_err(|why| format!("reports/kept/{name}: {why}"))?;
    Ok(Some(Output { all: collapsed(&stdout), stdout }))
}

/// What a command prints in the project's folder.
fn printed(command: &str) -> Result<String, String> {
    let program = Path::new(env!("CARGO_BIN_EXE_palmistry"));
    let mut path = program.parent().expect("a folder").as_os_str().to_owned();
    path.push(":");
    path.push(std::env::var_os("PATH").unwrap_or_default());
    let output = Command::new("bash")
        .args(["-c", &format!("set -o pipefail; {command}")])
        .current_dir(root())
        .env("PATH", path)
        .envs([("LANG", "C.UTF-8"), ("NO_COLOR", "1")])
        .env_remove("COLUMNS")
        .output()
        .expect("there is a bash");
    match output.status.success() {
        true => String::from_utf8(output.stdout).map_err(|why| why.to_string()),
        false => Err(format!("{}: {}", output.status, String::from_utf8_lossy(&output.stderr))),
    }
}

/// Each output has a command and each command its output, which is small and of use on a page.
#[test]
fn what_is_kept_is_of_use() {
    if !folder().exists() {
        return;
    }
    let commands = commands();
    let entries = std::fs::read_dir(folder()).expect("a folder");
    let mut names: Vec<String> =
        entries.map(|entry| entry.expect("an entry").file_name().into_string().expect("a name")).collect();
    names.retain(|name| name != "commands.toml" && name != "README.md");
    names.sort();
    assert_eq!(names, commands.keys().cloned().collect::<Vec<_>>(), "outputs, and commands.toml");
    let pages: String = crate::pages::pages()
        .iter()
        .map(|path| std::fs::read_to_string(path).expect("a page"))
        .collect::<Vec<_>>()
        .join("\n");
    for name in names {
        let length = std::fs::metadata(folder().join(&name)).expect("a file").len();
        assert!((1..50_000).contains(&length), "reports/kept/{name} has {length} bytes");
        assert!(pages.contains(&format!(": kept {name}\n")), "no page is held to reports/kept/{name}");
    }
}

#[test]
#[ignore = "takes an hour or two"]
fn what_is_kept_is_what_the_commands_print() {
    let asked = std::env::var("PALMISTRY_KEPT").unwrap_or_default();
    let renew = asked == "renew";
    let names: Vec<&str> = asked.split(',').filter(|name| !name.is_empty() && !renew).collect();
    let mut wrong = Vec::new();
    for (name, kept) in commands() {
        let is_asked =
            if names.is_empty() { kept.measured.is_none() } else { names.contains(&name.as_str()) };
        if !is_asked {
            println!(
                "not run: {name}{}",
                kept.measured.map_or(String::new(), |when| format!(", measured {when}"))
            );
            continue;
        }
        let begin = std::time::Instant::now();
        let path = folder().join(&name);
        let now = match printed(&kept.command) {
            Ok(now) => now,
            Err(why) => {
                wrong.push(format!("{name}: '{}' fails: {why}", kept.command));
                continue;
            }
        };
        println!("{:6.1} s  {name}: {}", begin.elapsed().as_secs_f64(), kept.command);
        let own = std::fs::read_to_string(&path).unwrap_or_default();
        let shown: Vec<String> = own.lines().map(str::to_owned).collect();
        if is_shown(&shown, &now.lines().collect::<Vec<_>>()) {
            continue;
        }
        if renew {
            std::fs::write(&path, now).expect("an output is written");
            continue;
        }
        let other = own.lines().zip(now.lines()).find(|(own, now)| !is_shown(&[(*own).to_owned()], &[now]));
        wrong.push(format!(
            "{name} is not what '{}' prints now; the first difference is {other:?}",
            kept.command
        ));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
