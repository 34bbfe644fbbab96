//! What all commands print alike: JSON, progress, errors, and files that are whole or not there.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use miette::Report;
use palmistry::ReadError;
use serde_json::{Value, json};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// Set when the user asks to stop.
pub(crate) static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// From now on an interrupt asks long work to stop and keep what it has; a second one ends the program.
pub(crate) fn stop_on_interrupt() {
    let handler = || {
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
        eprintln!("stopping; what is done so far is kept (interrupt again to leave at once)");
    };
    // without a handler an interrupt simply ends the program: nothing worth failing for
    let _ = ctrlc::set_handler(handler);
}

/// Prints a value to standard output. A reader that has gone away is no error of ours.
pub(crate) fn print_json(value: &Value) {
    print_text(&serde_json::to_string_pretty(value).unwrap_or_default());
}

/// Prints a line to standard output.
pub(crate) fn print_text(text: &str) {
    let _ = writeln!(std::io::stdout().lock(), "{text}");
}

/// An error as JSON, with the place where it points into a file.
pub(crate) fn error_json(report: &Report) -> Value {
    let mut error = json!({ "message": report.to_string() });
    if let Some(help) = report.help() {
        error["help"] = json!(help.to_string());
    }
    if let Some(read) = report.downcast_ref::<ReadError>() {
        let (line, column) = read.line_and_column();
        error["file"] = json!(read.source_code.name());
        error["line"] = json!(line);
        error["column"] = json!(column);
    }
    json!({ "error": error })
}

/// A progress bar on standard error, shown only where that is a terminal.
pub(crate) fn progress(length: u64, what: &'static str) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(length), ProgressDrawTarget::stderr());
    let template = "{msg:>28} [{bar:40}] {pos}/{len} {elapsed}";
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style.progress_chars("=> "));
    }
    bar.set_message(what);
    bar
}

/// A progress bar for a fraction between zero and one, in parts of ten thousand; its message says the rest.
pub(crate) fn fraction_bar(what: &'static str) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(10_000), ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template("{prefix:>12} [{bar:40}] {msg} {elapsed}") {
        bar.set_style(style.progress_chars("=> "));
    }
    bar.set_prefix(what);
    bar
}

/// All proof files that the paths name: files as they are, folders with everything below them, in order of name.
pub(crate) fn proof_files(paths: &[PathBuf]) -> miette::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for path in paths {
        if path.is_dir() {
            let before = files.len();
            collect(path, &mut files)
                .map_err(|e| super::Unusable::report(format!("cannot read {}: {e}", path.display()), ""))?;
            if files.len() == before {
                let message = format!("there is no .proof file below {}", path.display());
                return Err(super::Unusable::report(message, "name a file, or a folder that has some"));
            }
        } else {
            files.push(path.clone());
        }
    }
    Ok(files)
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> std::io::Result<()> {
    let mut entries: Vec<PathBuf> =
        std::fs::read_dir(folder)?.map(|entry| entry.map(|e| e.path())).collect::<Result<_, _>>()?;
    entries.sort();
    for entry in entries {
        if entry.is_dir() && !entry.is_symlink() {
            collect(&entry, files)?;
        } else if entry.extension().is_some_and(|e| e == "proof") {
            files.push(entry);
        }
    }
    Ok(())
}

/// Writes a file aside and moves it into place, so that it is whole or not there.
pub(crate) fn write_whole(path: &Path, text: &str) -> miette::Result<()> {
    let complain =
        |e: std::io::Error| super::Unusable::report(format!("cannot write {}: {e}", path.display()), "");
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder).map_err(complain)?;
    let mut file = tempfile::Builder::new()
        .prefix(".palmistry-")
        .permissions(readable())
        .tempfile_in(folder)
        .map_err(complain)?;
    file.write_all(text.as_bytes()).map_err(complain)?;
    file.persist(path).map_err(|e| complain(e.error))?;
    Ok(())
}

#[cfg(unix)]
fn readable() -> std::fs::Permissions {
    use std::os::unix::fs::PermissionsExt;
    std::fs::Permissions::from_mode(0o644)
}

#[cfg(not(unix))]
fn readable() -> std::fs::Permissions {
    std::env::temp_dir()
        .metadata()
        .map(|m| m.permissions())
        .unwrap_or_else(|_| unreachable!("a temporary folder"))
}
