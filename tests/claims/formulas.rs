//! Formulas of every proof file: each statement is set, as XML that is well formed and as LaTeX whose brackets come in pairs.

use crate::common::{folder, json, palmistry, write};
use palmistry::System;
use palmistry::report::{definition_mathml, formula_mathml, statement_latex};
use serde_json::json;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/proofs");

/// Every begun element is ended, in order; `&` begins only what XML knows.
fn well_formed(text: &str) {
    let mut open = Vec::new();
    let mut parts = text.split('<');
    assert_eq!(parts.next(), Some(""), "{text}");
    for part in parts {
        let (tag, words) = part.split_once('>').unwrap_or_else(|| panic!("{part:?} in {text}"));
        for entity in words.split('&').skip(1) {
            assert!(["lt;", "gt;", "amp;"].iter().any(|known| entity.starts_with(known)), "{text}");
        }
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name), "{text}");
        } else if !tag.ends_with('/') {
            open.push(tag.split(' ').next().unwrap());
        }
    }
    assert!(open.is_empty(), "{text}");
}

/// As many `{` as `}`, never more ended than begun; the same of \left and \right.
fn balanced(latex: &str) {
    for (begin, end) in [("{", "}"), ("\\left", "\\right"), ("\\begin", "\\end")] {
        assert_eq!(latex.matches(begin).count(), latex.matches(end).count(), "{latex}");
    }
}

#[test]
fn every_statement_of_every_file_is_set() {
    let mut statements = 0;
    for folder in std::fs::read_dir(FOLDER).unwrap() {
        for entry in std::fs::read_dir(folder.unwrap().path()).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_none_or(|extension| extension != "proof") {
                continue;
            }
            let system = System::read(&path).unwrap();
            for claim in &system.claims {
                for statement in claim.body.statements() {
                    let text = &system.source[statement.span.clone()];
                    let formula = formula_mathml(text).unwrap_or_else(|| panic!("{text}"));
                    well_formed(&formula);
                    assert!(!formula.contains("<math></math>"), "{text}");
                    balanced(&statement_latex(text).unwrap());
                    statements += 1;
                }
                let definitions = system.explanations(&claim.body).definitions;
                // those that are too long to be written down are named with their size
                for (name, text) in
                    definitions.into_iter().filter(|(_, text)| !text.starts_with("(an expression of"))
                {
                    well_formed(
                        &definition_mathml(&name, &text, &system.looks)
                            .unwrap_or_else(|| panic!("{name} = {text}")),
                    );
                }
            }
        }
    }
    assert!(statements > 700, "{statements}");
}

#[test]
fn prove_and_eval_give_latex() {
    let folder = folder();
    let text = "system \"one\"\nstate x, omega0\nclaim 1: (x + omega0)^2/2 = x^2/2 + x*omega0 + omega0^2/2\n\
                erratum 2: printed x + x = 3*x  corrected x + x = 2*x\ndefinition 3: \"words\"\n";
    let file = write(&folder, "one.proof", text);
    let file = file.to_str().unwrap();
    let found = json(&palmistry(&["prove", file, "--json", "--latex"]));
    let expected = "\\frac{\\left(x + \\omega_{0}\\right)^{2}}{2} = \\frac{x^{2}}{2} + x\\omega_{0} + \\frac{\\omega_{0}^{2}}{2}";
    assert_eq!(found["claims"][0]["latex"], json!(expected));
    assert_eq!(found["claims"][1]["latex"], json!("x + x = 2x"));
    assert_eq!(found["claims"][1]["printed"]["latex"], json!("x + x = 3x"));
    assert_eq!(found["claims"][2]["latex"], json!(null));
    let plain = json(&palmistry(&["prove", file, "--json"]));
    assert!(plain["claims"][0].get("latex").is_none());
    let text = String::from_utf8(palmistry(&["prove", file, "--latex"]).stdout).unwrap();
    assert!(text.contains(&format!("latex      {expected}\n")), "{text}");
    let point = ["eval", file, "x/omega0", "--at", "x=1,omega0=4", "--latex"];
    let text = String::from_utf8(palmistry(&point).stdout).unwrap();
    assert_eq!(text, "\\frac{x}{\\omega_{0}}\n0.25000000000000000000\n");
    let found = json(&palmistry(&[&point[..], &["--json"]].concat()));
    assert_eq!(found["latex"], json!("\\frac{x}{\\omega_{0}}"));
}
