//! Files that mean harm: what a reviewer who opens a stranger's files must be safe from. Oracle: what is printed and written, byte by byte.

mod markup;
mod sizes;
#[cfg(unix)]
mod streams;

use crate::common::{folder, palmistry, write};
use std::process::Output;

fn text(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

/// The program has said something, with the status of an input that cannot be used, and has not panicked.
fn refused(arguments: &[&str]) -> String {
    let output = palmistry(arguments);
    let said = text(&output);
    assert_eq!(
        output.status.code(),
        Some(2),
        "{arguments:?}: {}",
        said.chars().take(2000).collect::<String>()
    );
    assert!(!said.contains("panicked"), "{said}");
    said
}

/// A mistake behind column 65535, before it, and in a line of megabytes, for each of the readers: it is marked, in few lines.
#[test]
fn a_mistake_far_to_the_right_is_shown_where_it_is() {
    let folder = folder();
    for length in [65_500, 65_536, 70_000, 1_500_000] {
        let pad = " ".repeat(length);
        for (verb, name, text, marked) in [
            ("check", "a.proof", format!("system \"a\"\nstate x\nclaim 1: x ={pad}nobody\n"), "nobody"),
            ("import", "a.xml", format!("<sbml level=\"3\">{pad}<a></b></sbml>"), "</b>"),
            ("import", "a.jl", format!("ode = @ODEmodel(x'(t) = a*x(t){pad}b, y(t) = x(t))"), "b, y"),
            ("import", "a.m", format!("syms a\nx = [a];{pad}f = [a;\n"), "f = [a"),
            ("import", "a.py", format!("import sympy as sym\nx = 1{pad}) + 2\n"), ") + 2"),
            ("import", "a.txt", format!("x' = -x +{pad}* 2\n"), "* 2"),
            ("observe", "a.toml", format!("title = \"a\"\nmodel ={pad}nothing\n"), "nothing"),
        ] {
            let path = write(&folder, name, text);
            let said = refused(&[verb, path.to_str().unwrap()]);
            assert!(said.contains(marked), "{verb} {name}: {said}");
            assert!(said.len() < 4000, "{verb} {name}: {}", said.len());
        }
        let path = write(&folder, "paper.toml", format!("title ={pad}nothing\n"));
        write(&folder, "x.proof", "system \"a\"\nstate x\nclaim 1: x = x\n");
        let said = refused(&["verify", path.parent().unwrap().to_str().unwrap()]);
        assert!(said.contains("nothing") && said.len() < 4000, "{said}");
    }
}

/// A name of a megabyte in a message is named by its beginning and its end.
#[test]
fn a_long_name_makes_a_short_message() {
    let folder = folder();
    let path =
        write(&folder, "a.proof", format!("system \"a\"\nstate x\nclaim 1: x = {}\n", "a".repeat(1 << 20)));
    assert!(refused(&["check", path.to_str().unwrap()]).len() < 8000);
}

/// What another file names is quoted only where it is a proof file.
#[test]
fn a_secret_is_not_quoted() {
    let folder = folder();
    write(&folder, "secret.env", "PASSWORD=hunter2\nTOKEN=abcdef\n");
    write(&folder, "secret.proof", "PASSWORD=hunter2\n");
    for secret in ["secret.env", "secret.proof"] {
        let scene = write(
            &folder,
            "scene.toml",
            format!(
                "title = \"a\"\nmodel = \"{secret}\"\nduration = 1\nsamples = 11\n[start]\nx = 1\n[observer]\nmethods = [\"trust-region\"]\nestimate = [\"x\"]\n"
            ),
        );
        let uses = write(
            &folder,
            "uses.proof",
            format!("system \"a\"\nuse b = \"{secret}\"\nstate x\nclaim 1: x = x\n"),
        );
        let refers = write(
            &folder,
            "refers.proof",
            format!("system \"a\"\nstate x\nclaim 1 restates 1 in \"{secret}\": x = x\n"),
        );
        write(&folder, "paper.toml", format!("title = \"a\"\norder = [\"{secret}\"]\n"));
        let said = [
            refused(&["observe", scene.to_str().unwrap()]),
            refused(&["check", uses.to_str().unwrap()]),
            refused(&["check", refers.to_str().unwrap()]),
            refused(&["verify", folder.path().to_str().unwrap()]),
        ];
        for said in said {
            assert!(
                !said.contains("hunter") && !said.contains("PASSWORD") && !said.contains("abcdef"),
                "{said}"
            );
        }
        // a scene that a paper names, too
        write(&folder, "paper.toml", format!("title = \"a\"\nscenes = [\"{secret}\"]\n"));
        let said = refused(&["verify", folder.path().to_str().unwrap()]);
        assert!(said.contains("no scene that can be read"), "{said}");
        assert!(!said.contains("hunter") && !said.contains("PASSWORD"), "{said}");
        for json in [["observe", "scene.toml"], ["check", "uses.proof"], ["verify", "."]] {
            let path = folder.path().join(json[1]);
            let said = refused(&[json[0], path.to_str().unwrap(), "--json"]);
            assert!(!said.contains("hunter") && !said.contains("PASSWORD"), "{said}");
        }
    }
}
