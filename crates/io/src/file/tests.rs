//! Oracle: the file system itself, looked at before and after.

use super::*;

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

#[test]
fn a_byte_order_mark_is_no_part_of_a_text() {
    let folder = folder();
    let path = folder.path().join("text");
    std::fs::write(&path, "\u{feff}a\u{feff}").unwrap();
    assert_eq!(read_text(&path, 100).unwrap(), "a\u{feff}");
}

#[test]
fn a_file_is_read_up_to_its_bound_and_not_beyond() {
    let folder = folder();
    let path = folder.path().join("bytes");
    std::fs::write(&path, [7; 100]).unwrap();
    assert_eq!(read_bytes(&path, 100).unwrap(), [7; 100]);
    assert!(matches!(read_bytes(&path, 99), Err(ReadFailure::TooLong(99))));
    assert!(matches!(read_bytes(folder.path(), 99), Err(ReadFailure::Folder)));
}

#[test]
fn a_write_that_fails_leaves_the_file_as_it_was_and_nothing_beside_it() {
    let folder = folder();
    let path = folder.path().join("file");
    std::fs::write(&path, "before").unwrap();
    let failed = write_whole(&path, |file| {
        file.write_all(&[0; 100_000])?;
        Err(std::io::Error::other("no more"))
    });
    assert_eq!(failed.unwrap_err().to_string(), "no more");
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "before");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    write_whole(&path, |file| file.write_all(b"after")).unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "after");
}

#[cfg(unix)]
#[test]
fn devices_are_read_within_bounds_and_written_into() {
    use std::os::unix::fs::FileTypeExt;
    assert!(matches!(read_bytes(std::path::Path::new("/dev/zero"), 1 << 20), Err(ReadFailure::TooLong(_))));
    let null = std::path::Path::new("/dev/null");
    write_whole(null, |file| file.write_all(b"lost")).unwrap();
    assert!(std::fs::metadata(null).unwrap().file_type().is_char_device());
    let full = std::path::Path::new("/dev/full");
    assert!(write_whole(full, |file| file.write_all(b"lost")).is_err());
    assert!(std::fs::metadata(full).unwrap().file_type().is_char_device());
}

#[cfg(unix)]
#[test]
fn a_link_stays_and_what_it_points_to_is_replaced() {
    let folder = folder();
    let (target, link) = (folder.path().join("target"), folder.path().join("link"));
    std::os::unix::fs::symlink("target", &link).unwrap();
    for text in ["made", "replaced"] {
        write_whole(&link, |file| file.write_all(text.as_bytes())).unwrap();
        assert!(link.is_symlink());
        assert!(!target.is_symlink());
        assert_eq!(std::fs::read_to_string(&target).unwrap(), text);
    }
    let round = folder.path().join("round");
    std::os::unix::fs::symlink("round", &round).unwrap();
    assert!(write_whole(&round, |file| file.write_all(b"x")).is_err());
    assert!(round.is_symlink());
}
