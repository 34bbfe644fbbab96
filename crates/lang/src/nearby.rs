//! The file that was meant where there is none of a name.

use super::error::nearest;
use palmistry_io::file::files_in;
use palmistry_io::foreign::{shown, shown_path};
use std::ffi::OsStr;
use std::path::Path;

/// Of more files in a folder none is looked for.
const MOST_FILES: usize = 2000;

/// What may be meant by the name of a file that is not there: a file of the same folder, with the folder as it was given.
pub fn nearest_file(path: &Path) -> Option<String> {
    let near = nearest_name(path)?;
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    Some(folder.map_or_else(|| shown(&near).into_owned(), |folder| shown_path(&folder.join(&near))))
}

/// The same, its name alone.
pub(super) fn nearest_name(path: &Path) -> Option<String> {
    let wanted = path.file_name()?.to_str()?;
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let files = files_in(folder.unwrap_or(Path::new("."))).ok().filter(|files| files.len() <= MOST_FILES)?;
    let names = || files.iter().filter_map(|file| file.file_name()?.to_str());
    // in other letters, without its extension, or with what an editor puts behind a file
    let same = |name: &&str| name.eq_ignore_ascii_case(wanted);
    let stem = |name: &&str| Path::new(name).file_stem().is_some_and(|stem| stem == wanted);
    let begins = |name: &&str| {
        let rest = wanted.strip_prefix(*name);
        rest.is_some_and(|rest| rest.starts_with([':', '#', ',', ' ']))
    };
    let found = names().find(same).or_else(|| names().find(stem)).or_else(|| names().find(begins));
    // ends of names are alike without being meant
    let (stem, end) = (Path::new(wanted).file_stem()?.to_str()?, Path::new(wanted).extension());
    let stems = names().filter(|name| Path::new(name).extension() == end);
    let stems = stems.filter_map(|name| Path::new(name).file_stem()?.to_str());
    let slip = || nearest(stem, stems).and_then(|near| names().find(|name| *name == with_end(near, end)));
    let other_end = || names().find(|name| Path::new(name).file_stem().is_some_and(|own| own == stem));
    found.or_else(slip).or_else(other_end).map(str::to_owned)
}

/// A name with its end.
fn with_end(stem: &str, end: Option<&OsStr>) -> String {
    match end {
        Some(end) => format!("{stem}.{}", end.to_string_lossy()),
        None => stem.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::nearest_file;

    #[test]
    fn the_file_that_is_meant_is_found() {
        let folder = std::env::temp_dir().join(format!("palmistry-nearby-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        for name in ["tanks.proof", "beacons.proof", "run.csv"] {
            std::fs::write(folder.join(name), "").unwrap();
        }
        for (wanted, found) in [
            ("tanks", Some("tanks.proof")),
            ("Tanks.proof", Some("tanks.proof")),
            ("tanks.proof:8", Some("tanks.proof")),
            ("tank.proof", Some("tanks.proof")),
            ("run.cvs", Some("run.csv")),
            ("lanks.proof", Some("tanks.proof")),
            ("nofile.proof", None),
            ("nothing.like.it", None),
        ] {
            let near = nearest_file(&folder.join(wanted));
            let name = near.as_deref().and_then(|near| near.rsplit('/').next());
            assert_eq!(name, found, "{wanted}");
        }
        assert_eq!(nearest_file(&folder.join("no/such/folder")), None);
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
