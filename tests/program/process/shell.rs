//! What somebody meets first: help, completions, the words beside a value.

use crate::common::{folder, write};
use crate::process::{finish, program, words};
use std::process::Output;

fn out(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("a text")
}

#[test]
fn without_a_command_it_prints_its_help() {
    let bare = finish(&mut program(&[]));
    assert_eq!(bare.status.code(), Some(0), "{}", words(&bare));
    assert!(bare.stderr.is_empty(), "{}", words(&bare));
    assert_eq!(out(&bare), out(&finish(&mut program(&["--help"]))));
    let text = out(&bare);
    for command in ["verify", "prove", "check", "rank", "eval", "completions", "Exit status: 0"] {
        assert!(text.contains(command), "{command} in {text}");
    }
}

/// Each example is a command line that is understood: its options exist, and so do its commands.
#[test]
fn the_help_of_each_command_has_examples_that_are_understood() {
    let text = out(&finish(&mut program(&["--help"])));
    let commands = text.split("Commands:").nth(1).unwrap().split("Options:").next().unwrap();
    let names: Vec<&str> = commands
        .lines()
        .filter(|line| line.starts_with("  ") && !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next())
        .filter(|name| *name != "help")
        .collect();
    assert!(names.len() > 8, "{names:?}");
    for name in names {
        let help = out(&finish(program(&[name, "--help"]).env("COLUMNS", "200")));
        let examples: Vec<&str> = help
            .split_once("Example")
            .map(|(_, rest)| rest)
            .unwrap_or_else(|| panic!("{name} has no examples"))
            .lines()
            .map(str::trim)
            .filter(|line| line.starts_with("palmistry "))
            .collect();
        assert!(!examples.is_empty(), "{name}");
        for example in examples {
            // options are those of the command
            for option in example.split_whitespace().filter(|word| word.starts_with("--")) {
                assert!(help.contains(option), "{example}");
            }
            assert!(example.contains(name), "{example}");
        }
    }
}

#[test]
fn shells_get_scripts_that_they_can_read() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let output = finish(&mut program(&["completions", shell]));
        assert_eq!(output.status.code(), Some(0), "{}", words(&output));
        let script = out(&output);
        assert!(
            script.contains("palmistry") && script.contains("certify") && script.contains("only"),
            "{shell}"
        );
    }
    let folder = folder();
    let script = write(&folder, "palmistry.bash", finish(&mut program(&["completions", "bash"])).stdout);
    let read = std::process::Command::new("bash").args(["-n", script.to_str().unwrap()]).status();
    assert!(read.expect("there is a bash").success());
    assert_eq!(finish(&mut program(&["completions", "tcsh"])).status.code(), Some(2));
}

/// The words go to standard error: what reads the value reads the value alone.
#[test]
fn a_value_is_said_to_be_certain_and_how() {
    let folder = folder();
    let file = write(&folder, "a.proof", "system \"s\"\nstate x\nclaim 1: x = x\n");
    let eval = |expression: &str, more: &[&str]| {
        let run = [&["eval", file.to_str().unwrap(), expression, "--at", "x=2"], more].concat();
        let output = finish(&mut program(&run));
        (out(&output), String::from_utf8(output.stderr).unwrap())
    };
    let (value, how) = eval("x/3", &[]);
    assert_eq!(value, "0.66666666666666666667\n");
    assert!(how.contains("20 digits, certain: rounded from the exact value, which is 2/3"), "{how}");
    let (value, how) = eval("sin(x)", &["--digits", "40"]);
    // mpmath 1.3: sin(2)
    assert_eq!(value, "0.9092974268256816953960198659117448427023\n");
    let bits: u32 = how.split("enclosures of ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!(how.contains("40 digits, certain") && bits >= 133, "{how}");
    let width: f64 = how.split("width ").nth(1).unwrap().split(',').next().unwrap().parse().unwrap();
    assert!(width > 0.0 && width < 1e-40, "{how}");
    let (_, how) = eval("sin(x)", &["--digits", "10", "--verdict", "computed"]);
    assert!(how.contains("computed") && !how.contains("certain"), "{how}");
}
