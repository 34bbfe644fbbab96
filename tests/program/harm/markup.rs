//! Markup, control characters and ends of lines in every field: none of it acts, whatever shows it.

use super::text;
use crate::common::{folder, palmistry, write};
use palmistry::experiment::{Experiment, Scene, Studied};
use palmistry::report::{Observed, observe_page};

const MARKUP: &str =
    "<img src=x onerror=alert(1)><script>alert(2)</script> [a](javascript:b) | *c* `d` </style>";

/// Pages and Markdown of a paper with markup wherever a file may have text.
#[test]
fn markup_is_letters_wherever_it_stands() {
    let folder = folder();
    write(
        &folder,
        "paper.toml",
        format!(
            "title = '{MARKUP}'\nauthors = ['A{MARKUP}', 'B{MARKUP}']\nyear = 1999\nsource = '{MARKUP}'\n[equations]\n'4{MARKUP}' = 2\n'4' = 9\n"
        ),
    );
    let quoted = MARKUP.replace('"', "'");
    write(
        &folder,
        "a.proof",
        format!(
            "# {quoted}\nsystem \"{quoted}\" cite \"{quoted}\"\nstate x, v\nparam k = 2\ndrift f\n  x' = v\n  v' = -k*x\noutput x\n\
             sample\n  x in [-1, 1]\n  v in [-1, 1]\nset \"{quoted}\": v = 0\n\
             map \"m{quoted}\": x in [-1, 1], v in [0, 2] \"{quoted}\"\nline \"l{quoted}\": v to 0\n\
             claim 4.1: x + x = 2*x \"{quoted}\"\nerratum 4.2: printed \"{quoted}\" as x = 2*x corrected x = x \"{quoted}\"\n\
             erratum 4.5: printed x = 2*x corrected x = x \"{quoted}\"\nclaim 4.6 expect undecided: x = x \"{quoted}\"\n\
             definition 4.3: \"{quoted}\"\nundecided 4.4: \"{quoted}\"\n"
        ),
    );
    let out = folder.path().join("out");
    let output = palmistry(&["verify", folder.path().to_str().unwrap(), "--out", out.to_str().unwrap()]);
    let page = std::fs::read_to_string(out.join("page.html"))
        .or_else(|_| std::fs::read_to_string(out.join("index.html")));
    let page = page.unwrap_or_else(|_| panic!("{}", text(&output)));
    for harm in ["<img", "<script>alert"] {
        assert!(!page.contains(harm), "{harm}: {}", page.split(harm).next().unwrap().len());
    }
    assert!(page.contains("Content-Security-Policy") && page.contains("default-src 'none'"));
    assert_eq!(page.matches("<script").count(), page.matches("</script>").count());
    assert_eq!((page.matches("</style>").count(), page.contains("&lt;img src=x")), (1, true));
    // in Markdown: outside of code no element, no link, no cell of a table
    let errata = std::fs::read_to_string(out.join("errata.md")).unwrap();
    let mut fence: Option<&str> = None;
    for line in errata.lines() {
        match fence {
            Some(end) if line == end => fence = None,
            Some(_) => {}
            // formulas are typeset: behind their fence stands what they are
            None if line.starts_with("```") => fence = Some(line.strip_suffix("math").unwrap_or(line)),
            None => {
                assert!(!line.contains("<img") && !line.contains("<script"), "{line}");
                assert!(!line.replace("\\]", "").contains("]("), "{line}");
                assert!(!line.contains(" | *c*"), "{line}");
            }
        }
    }
    assert!(fence.is_none() && errata.contains("&lt;img src=x"));
}

/// The same of a scene with names of its own, in its page and its pictures.
#[test]
fn a_scene_has_no_markup_either() {
    let folder = folder();
    let model = write(
        &folder,
        "m.proof",
        "system \"<b>m</b>\"\nstate x\nparam k = 1\ndrift f\n  x' = -k*x\noutput x\nclaim 1: x = x\n",
    );
    let scene = format!(
        "title = '{MARKUP}'\nmodel = '{}'\nduration = 1\nsamples = 21\n[start]\nx = 1\n[observer]\nmethods = [\"trust-region\"]\nestimate = [\"x\"]\nguess_off = 0.1\nwindow = 10\n",
        model.display()
    );
    let scene = Scene::parse("s.toml", &scene).unwrap_or_else(|why| panic!("{why}"));
    let experiment = Experiment::new(scene, None).unwrap_or_else(|why| panic!("{why}"));
    let answers = experiment.run(&false.into(), &|_| {}).unwrap();
    let studied = &Studied::default();
    let page =
        observe_page(&Observed { experiment: &experiment, answers: &answers, studied, interrupted: false });
    assert!(page.contains("&lt;img") && !page.contains("<img") && !page.contains("<script>alert"));
    assert!(page.contains("Content-Security-Policy"));
}

/// The columns of a recording, CSV or Parquet, with markup and codes of terminals as names: in pages of what fits, of faults, and in messages.
#[test]
fn columns_of_recordings_act_nowhere() {
    let folder = folder();
    write(
        &folder,
        "m.proof",
        "system \"m\"\nstate x\nparam k = 1\ndrift f\n  x' = -k*x\noutput x\nclaim 1: x = x\n",
    );
    let harm = format!("{}\\u001b[2J\\nconfirmed", MARKUP.replace('"', "'"));
    let scene = |name: &str| {
        format!(
            "title = \"t\"\nmodel = \"m.proof\"\nduration = 1\nsamples = 41\n[start]\nx = 1\n[columns]\nx = \"{name}\"\n\
             [data]\non_fault = \"skip\"\n[observer]\nmethods = [\"trust-region\"]\nestimate = [\"x\"]\nguess_off = 0.1\nwindow = 10\n"
        )
    };
    let harmful = write(&folder, "harmful.toml", scene(&harm));
    let other = write(&folder, "other.toml", scene("nowhere"));
    let run = |arguments: &[&str]| {
        let output = palmistry(arguments);
        let said = text(&output);
        assert!(!said.contains(|c: char| c.is_control() && c != '\n'), "{arguments:?}: {said:?}");
        assert!(
            !said.lines().any(|line| line.trim_start().starts_with("confirmed")),
            "{arguments:?}: {said}"
        );
        (output, said)
    };
    for name in ["x.csv", "x.parquet"] {
        let file = folder.path().join(name);
        let file = file.to_str().unwrap();
        run(&["observe", harmful.to_str().unwrap(), "--record", file]);
        if name == "x.csv" {
            let table = std::fs::read_to_string(file).unwrap();
            let last = table.lines().nth(20).unwrap();
            let broken = format!("{},<b>oops\u{1b}[2J", last.split(',').next().unwrap());
            std::fs::write(file, table.replacen(last, &broken, 1)).unwrap();
        }
        let out = folder.path().join(format!("out of {name}"));
        let run_of = ["observe", harmful.to_str().unwrap(), "--data", file, "--out", out.to_str().unwrap()];
        let (output, said) = run(&run_of);
        assert!(output.status.code().is_some_and(|code| code != 2), "{said}");
        let page = std::fs::read_to_string(out.join("index.html")).unwrap_or_else(|_| panic!("{said}"));
        for act in ["<img", "<script>alert", "<b>oops", "\u{1b}"] {
            assert!(!page.contains(act), "{act}: {}", page.split(act).next().unwrap().len());
        }
        // the names of what is there are in the message that misses another one
        let (output, said) = run(&["observe", other.to_str().unwrap(), "--data", file]);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains("nowhere") && said.contains("img src=x"), "{said}");
    }
}

/// Names and titles with the codes of terminals, ends of lines and marks of direction: nothing that is printed has any of them.
#[test]
fn nothing_acts_on_a_terminal() {
    let folder = folder();
    let harm = "\u{1b}]0;owned\u{7}\u{1b}[2J\u{9b}31m\u{7f}\u{200b}\u{feff}";
    let proof = write(
        &folder,
        "a.proof",
        format!(
            "system \"t{harm}\n  confirmed proved a.proof 1\" cite \"c{harm}\"\nstate x\noutput x\nclaim 1: x = 2*x \"r{harm}\n  ok proved 7\"\n\
             undecided 2: \"why{harm}\"\n# {harm}\n"
        ),
    );
    let forged = folder.path().join("b\n  ok       proved 9.9\n\u{1b}[2J.proof");
    std::fs::write(&forged, "system \"b\"\nstate x\nclaim 1: x = 2*x\n").unwrap();
    let broken = folder.path().join("c\n1 file can be read\u{1b}[8m.proof");
    std::fs::write(&broken, format!("system \"b\"\nstate x\nclaim {harm}: x\n")).unwrap();
    let scene = write(
        &folder,
        "s.toml",
        "title = \"a\\u001b[2J\\nconfirmed\"\nmodel = \"a\\u001b[2J\\nconfirmed.proof\"\nduration = 1\nsamples = 5\n[start]\nx = 1\n[observer]\nmethods = [\"trust-region\"]\nestimate = [\"x\"]\n",
    );
    let table =
        write(&folder, "d.csv", "time,\"a\u{1b}[2J\nconfirmed\",\"a\u{1b}[2J\nconfirmed\"\n0,1,1\n1,2,2\n");
    write(
        &folder,
        "paper.toml",
        "title = \"t\\u001b[2J\\n  confirmed\"\nauthors = [\"\\u202eA\\nconfirmed\"]\nsource = \"\\u009b2J\"\n",
    );
    let path = |path: &std::path::Path| path.to_str().unwrap().to_owned();
    let junit = folder.path().join("junit.xml");
    for arguments in [
        vec!["prove".to_owned(), path(&proof), "--junit".to_owned(), path(&junit)],
        vec!["prove".to_owned(), path(&proof), "--json".to_owned()],
        vec!["prove".to_owned(), path(&forged)],
        vec!["rank".to_owned(), path(&proof)],
        vec!["check".to_owned(), path(&broken)],
        vec!["check".to_owned(), path(&broken), "--json".to_owned()],
        vec!["observe".to_owned(), path(&scene)],
        vec!["observe".to_owned(), path(&scene), "--data".to_owned(), path(&table)],
        vec!["verify".to_owned(), path(folder.path())],
        vec!["check".to_owned(), "no\n1 file can be read\u{1b}[2J.proof".to_owned()],
    ] {
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let said = text(&palmistry(&arguments));
        let hidden =
            |c: char| c.is_control() && c != '\n' || ['\u{200b}', '\u{feff}', '\u{202e}'].contains(&c);
        assert!(!said.contains(hidden), "{arguments:?}: {said:?}");
        for line in said.lines() {
            let forged = ["confirmed", "ok       proved 9.9", "1 file can be read", "ok proved 7"];
            assert!(
                !forged.iter().any(|words| line.trim_start().starts_with(words)),
                "{arguments:?}: {said}"
            );
        }
    }
    let xml = std::fs::read_to_string(&junit).unwrap();
    assert!(!xml.contains(|c: char| c.is_control() && c != '\n'), "{xml:?}");
}
