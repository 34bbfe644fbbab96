//! The manual pages: one for each command, each with what it is, what it does, and every option with its words.

use crate::common::{folder, palmistry};
use std::collections::BTreeSet;

/// The text of the section of a page, without the marks of fonts.
fn section<'p>(page: &'p str, name: &str) -> Option<&'p str> {
    let rest = page.split_once(&format!("\n.SH {name}\n"))?.1;
    Some(rest.split("\n.SH ").next().unwrap())
}

#[test]
fn every_command_has_a_page_with_words_for_everything() {
    let folder = folder();
    let pages = folder.path().join("man1");
    let run = palmistry(&["man", "--out", pages.to_str().unwrap()]);
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
    let help = String::from_utf8(palmistry(&["--help"]).stdout).unwrap();
    let commands = help.split("Commands:").nth(1).unwrap().split("Options:").next().unwrap();
    let mut expected: BTreeSet<String> = commands
        .lines()
        .filter(|line| line.starts_with("  ") && !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next())
        .filter(|name| *name != "help")
        .map(|name| format!("palmistry-{name}.1"))
        .collect();
    assert!(expected.len() > 12, "{expected:?}");
    expected.insert("palmistry.1".to_owned());
    let found: BTreeSet<String> = std::fs::read_dir(&pages)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    assert_eq!(found, expected);

    for name in found {
        let page = std::fs::read_to_string(pages.join(&name)).unwrap();
        let stem = name.trim_end_matches(".1");
        let title = section(&page, "NAME").unwrap_or_else(|| panic!("{name}: {page}")).trim();
        let (called, about) = title.split_once(" \\- ").unwrap_or_else(|| panic!("{name}: {title}"));
        assert_eq!(called.replace("\\-", "-"), stem);
        assert!(about.trim().len() > 20, "{name}: {about}");
        assert!(section(&page, "DESCRIPTION").is_some_and(|text| text.trim().len() > 20), "{name}");
        assert!(section(&page, "SYNOPSIS").is_some_and(|text| text.contains("palmistry")), "{name}");
        // an item is a line of its own behind '.TP', and its words are behind that
        let options = section(&page, "OPTIONS").unwrap_or_else(|| panic!("{name} has no options"));
        let items: Vec<&str> = options.split(".TP\n").skip(1).collect();
        assert!(!items.is_empty(), "{name}");
        for item in items {
            let (what, words) = item.split_once('\n').unwrap_or_else(|| panic!("{name}: {item}"));
            assert!(words.trim().len() > 3, "{name}: nothing is said of {what}");
        }
        // its examples, or where to begin
        assert!(page.contains("palmistry "), "{name}");
    }

    // without a folder the page of the program is printed
    let printed = String::from_utf8(palmistry(&["man"]).stdout).unwrap();
    let written = std::fs::read_to_string(pages.join("palmistry.1")).unwrap();
    assert_eq!(printed.trim_end(), written.trim_end());
    let listed = section(&written, "SUBCOMMANDS").expect("its commands");
    for command in expected.iter().filter_map(|name| name.strip_prefix("palmistry-")) {
        let name = command.trim_end_matches(".1");
        assert!(listed.contains(&format!("palmistry\\-{name}(1)")), "{name}: {listed}");
    }
}
