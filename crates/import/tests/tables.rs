//! Models of SBML and problems of PEtab whose meaning is easily mistaken: what they mean is calculated by hand here.

mod common;

use common::value_of;
use palmistry_import::{ImportQuestion, ImportedProblem, PetabFile, import, import_petab};

fn math(inside: &str) -> String {
    format!("<math xmlns=\"http://www.w3.org/1998/Math/MathML\">{inside}</math>")
}

/// A model of one compartment `c`, species, parameters and what else there is.
fn sbml(species: &str, parameters: &[(&str, &str)], rest: &str) -> String {
    let parameters: String = parameters
        .iter()
        .map(|(id, value)| format!("<parameter id=\"{id}\" value=\"{value}\" constant=\"true\"/>"))
        .collect();
    format!(
        "<sbml xmlns=\"http://www.sbml.org/sbml/level3/version1/core\" level=\"3\" version=\"1\"><model id=\"m\"><listOfCompartments><compartment id=\"c\" size=\"2\" spatialDimensions=\"3\"/></listOfCompartments><listOfSpecies>{species}</listOfSpecies><listOfParameters>{parameters}</listOfParameters>{rest}</model></sbml>"
    )
}

fn species(id: &str, start: &str, held: bool) -> String {
    format!(
        "<species id=\"{id}\" compartment=\"c\" {start} hasOnlySubstanceUnits=\"false\" boundaryCondition=\"{held}\" constant=\"false\"/>"
    )
}

fn rule(kind: &str, id: &str, inside: &str) -> String {
    format!("<listOfRules><{kind} variable=\"{id}\">{}</{kind}></listOfRules>", math(inside))
}

fn assignment(id: &str, inside: &str) -> String {
    format!(
        "<listOfInitialAssignments><initialAssignment symbol=\"{id}\">{}</initialAssignment></listOfInitialAssignments>",
        math(inside)
    )
}

/// A reaction that makes species, with a law.
fn makes(id: &str, law: &str) -> String {
    format!(
        "<listOfReactions><reaction id=\"r\" reversible=\"false\" fast=\"false\"><listOfProducts><speciesReference species=\"{id}\" stoichiometry=\"1\" constant=\"true\"/></listOfProducts><kineticLaw>{}</kineticLaw></reaction></listOfReactions>",
        math(law)
    )
}

const LAW: &str = "<apply><times/><ci>k</ci><ci>B</ci><ci>c</ci></apply>";

fn rates(text: &str, values: common::Values) -> Vec<(String, f64)> {
    let read = import("a.xml", text, &ImportQuestion::default())
        .unwrap_or_else(|why| panic!("{}; {}\n{text}", why.message, why.help.unwrap_or_default()));
    let of =
        |state: &palmistry_import::ForeignRate| (state.name.clone(), value_of(&read, values, &state.rate));
    read.model.states.iter().map(of).collect()
}

fn named(list: &[(&str, f64)]) -> Vec<(String, f64)> {
    list.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect()
}

/// A species that nothing changes is an amount: its concentration follows the size of its compartment.
#[test]
fn held_species_are_amounts() {
    let two =
        species("A", "initialConcentration=\"1\"", false) + &species("B", "initialConcentration=\"1\"", true);
    let grows = rule("rateRule", "c", "<apply><times/><ci>g</ci><ci>c</ci></apply>");
    let text = sbml(&two, &[("k", "1"), ("g", "0.5")], &(grows + &makes("A", LAW)));
    // A' = k B - A g, B' = -B g, c' = g c
    assert_eq!(
        rates(&text, &[("A", 2.0), ("B", 3.0), ("c", 4.0), ("k", 5.0), ("g", 0.5)]),
        named(&[("A", 14.0), ("B", -1.5), ("c", 2.0)])
    );

    let by_amount = species("A", "initialAmount=\"1\"", false).replace("Units=\"false\"", "Units=\"true\"")
        + &species("B", "initialAmount=\"3\"", true);
    let time =
        "<csymbol encoding=\"text\" definitionURL=\"http://www.sbml.org/sbml/symbols/time\">t</csymbol>";
    let assigned = rule("assignmentRule", "c", &format!("<apply><plus/><cn>1</cn>{time}</apply>"));
    let text = sbml(&by_amount, &[("k", "1")], &(assigned.clone() + &makes("A", LAW)));
    // B = 3/c, and A' = k B c = 3 k
    assert_eq!(rates(&text, &[("A", 2.0), ("time", 3.0), ("k", 5.0)]), named(&[("A", 15.0), ("time", 1.0)]));

    // by a concentration at the start nothing says the amount without the size at the start
    let text = sbml(
        &by_amount.replace("initialAmount=\"3\"", "initialConcentration=\"3\""),
        &[("k", "1")],
        &(assigned + &makes("A", LAW)),
    );
    let why = import("a.xml", &text, &ImportQuestion::default()).unwrap_err();
    assert!(
        why.message.contains("the amount of 'B' is held in a compartment whose size is assigned"),
        "{}",
        why.message
    );

    // 6 in a compartment of size 3, whatever its attribute says
    let two = species("A", "initialConcentration=\"1\"", false) + &species("B", "initialAmount=\"6\"", true);
    let text = sbml(&two, &[("k", "1")], &(assignment("c", "<cn>3</cn>") + &makes("A", LAW)));
    assert_eq!(rates(&text, &[("A", 1.0), ("k", 5.0)]), named(&[("A", 10.0)]));
}

/// A flag that is compared with a number is its own condition: `sign` of a flag has no value on half of the space.
#[test]
fn flags_are_their_conditions() {
    let x = species("x", "initialConcentration=\"1\"", false);
    let compare = |sign: &str, left: &str, right: &str| format!("<apply><{sign}/>{left}{right}</apply>");
    let either = |then: &str, condition: &str, otherwise: &str| {
        format!("<piecewise><piece>{then}{condition}</piece><otherwise>{otherwise}</otherwise></piecewise>")
    };
    let above = compare("gt", "<ci>x</ci>", "<cn>1</cn>");
    let flag = either("<cn>1</cn>", &above, "<cn>0</cn>");
    let on = "<parameter id=\"on\" constant=\"false\"/>";
    for (condition, wanted) in [
        (compare("gt", "<ci>on</ci>", "<cn>0</cn>"), "sign(x - 1)"),
        (compare("geq", "<ci>on</ci>", "<cn>1</cn>"), "sign(x - 1)"),
        (compare("eq", "<ci>on</ci>", "<cn>1</cn>"), "sign(x - 1)"),
        (
            compare("gt", "<apply><plus/><ci>on</ci><ci>on</ci></apply>", "<cn>0</cn>"),
            "sign(on_ + on_ - 0.5)",
        ),
    ] {
        let law = either("<apply><times/><ci>k</ci><ci>x</ci></apply>", &condition, "<ci>g</ci>");
        let text =
            sbml(&x, &[("k", "1"), ("g", "2")], &(rule("assignmentRule", "on", &flag) + &makes("x", &law)));
        let text = text.replace("</listOfParameters>", &format!("{on}</listOfParameters>"));
        let read = import("a.xml", &text, &ImportQuestion::default())
            .unwrap_or_else(|why| panic!("{}; {}\n{text}", why.message, why.help.unwrap_or_default()));
        assert!(read.text.contains(wanted) && !read.text.contains("sign(on_)"), "{condition}\n{}", read.text);
        for (x, value) in [(3.0, 15.0 / 2.0), (0.5, 3.5)] {
            let values: common::Values = if x > 1.0 {
                &[("x", 3.0), ("k", 5.0), ("g", 7.0), ("c", 2.0)]
            } else {
                &[("x", 0.5), ("k", 5.0), ("g", 7.0), ("c", 2.0)]
            };
            assert_eq!(rates(&text, values), named(&[("x", value)]), "{text}");
        }
    }
}

/// Level 3 has the functions of a model in any order; those that go round in a circle are refused.
#[test]
fn functions_stand_in_any_order() {
    let function = |id: &str, body: &str| {
        let lambda = format!("<lambda><bvar><ci>a</ci></bvar>{body}</lambda>");
        format!("<functionDefinition id=\"{id}\">{}</functionDefinition>", math(&lambda))
    };
    let of = |name: &str| format!("<apply><ci>{name}</ci><ci>a</ci></apply>");
    let x = species("x", "initialConcentration=\"1\"", false);
    let with = |functions: &str| {
        let law = "<apply><ci>first</ci><ci>x</ci></apply>";
        sbml(&x, &[], &makes("x", law)).replace(
            "<listOfCompartments>",
            &format!(
                "<listOfFunctionDefinitions>{functions}</listOfFunctionDefinitions><listOfCompartments>"
            ),
        )
    };
    let twice = "<apply><times/><cn>2</cn><ci>a</ci></apply>";
    let text = with(
        &(function("first", &of("second")) + &function("second", &of("third")) + &function("third", twice)),
    );
    // 2 x makes x in a compartment of size 2
    assert_eq!(rates(&text, &[("x", 3.0), ("c", 2.0)]), named(&[("x", 3.0)]));
    let text = with(&(function("first", &of("second")) + &function("second", &of("first"))));
    let why = import("a.xml", &text, &ImportQuestion::default()).unwrap_err();
    assert!(why.message.contains("nothing says what the function"), "{}", why.message);
}

/// Conditions of several parts, and equality of constants.
#[test]
fn conditions_are_read() {
    let compare = |sign: &str, left: &str, right: &str| format!("<apply><{sign}/>{left}{right}</apply>");
    let piece = |condition: &str| {
        format!(
            "<piecewise><piece><cn>2</cn>{condition}</piece><otherwise><cn>3</cn></otherwise></piecewise>"
        )
    };
    let (x, one, flag) = ("<ci>x</ci>", "<cn>1</cn>", "<ci>flag</ci>");
    let all = |list: &str| {
        format!("<apply><and/>{}{}{}</apply>", compare("gt", x, one), compare("lt", x, "<cn>5</cn>"), list)
    };
    let any = |list: &str| {
        format!("<apply><or/>{}{}{}</apply>", compare("lt", x, one), compare("gt", x, "<cn>5</cn>"), list)
    };
    let four = compare("gt", x, "<cn>4</cn>");
    for (condition, x, flag_is, value) in [
        (all(&four), 4.5, 1.0, 2.0),
        (all(&four), 3.0, 1.0, 3.0),
        (all(&four), 6.0, 1.0, 3.0),
        (any(&four), 4.5, 1.0, 2.0),
        (any(&four), 3.0, 1.0, 3.0),
        (any(&four), 0.5, 1.0, 2.0),
        // the flag is one in the file
        (compare("eq", flag, one), 3.0, 1.0, 2.0),
        (compare("neq", flag, one), 3.0, 1.0, 3.0),
        (compare("gt", flag, one), 3.0, 1.0, 3.0),
        (compare("geq", flag, one), 3.0, 1.0, 2.0),
        (compare("eq", flag, "<cn>2</cn>"), 3.0, 1.0, 3.0),
    ] {
        let text = sbml(
            "",
            &[("flag", "1")],
            &format!(
                "<listOfRules><rateRule variable=\"x\">{}</rateRule></listOfRules>",
                math(&piece(&condition))
            ),
        )
        .replace(
            "</listOfParameters>",
            "<parameter id=\"x\" value=\"3\" constant=\"false\"/></listOfParameters>",
        );
        let read = import("a.xml", &text, &ImportQuestion::default())
            .unwrap_or_else(|why| panic!("{}\n{text}", why.message));
        let names = |name: &str| match name {
            "x" => Some(x),
            "flag" => Some(flag_is),
            _ => None,
        };
        assert_eq!(read.model.states[0].rate.value(&names), Some(value), "{}", read.text);
        // and so it is written: not by a sign of zero
        assert!(
            !read.text.contains("sign(flag - 1)") && !read.text.contains("sign(1 - flag)"),
            "{}",
            read.text
        );
    }
}

#[test]
fn what_is_fixed_is_said() {
    let two = species("A", "initialConcentration=\"1\"", false) + &species("B", "initialAmount=\"6\"", true);
    let text = sbml(&two, &[("k", "1")], &(assignment("k", "<cn>3</cn>") + &makes("A", LAW)));
    let read = import("a.xml", &text, &ImportQuestion::default()).unwrap();
    assert!(read.text.contains("fixed by initial assignments, and not identified: k"), "{}", read.text);

    // a value that does not exist everywhere, by the name of a rule
    let log = rule("assignmentRule", "v", "<apply><ln/><ci>A</ci></apply>");
    let law = "<piecewise><piece><ci>v</ci><apply><gt/><ci>A</ci><cn>3</cn></apply></piece><otherwise><ci>A</ci></otherwise></piecewise>";
    let text = sbml(&two, &[("k", "1"), ("v", "0")], &(log + &makes("A", law)));
    let why = import("a.xml", &text, &ImportQuestion::default()).unwrap_err();
    assert!(why.message.contains("does not exist everywhere"), "{}", why.message);
}

/// A problem of an exponential decay, with its tables.
struct Problem {
    model: String,
    parameters: String,
    conditions: String,
    observables: String,
    measurements: String,
}

impl Default for Problem {
    fn default() -> Problem {
        Problem {
            model: sbml(
                &species("A", "initialAmount=\"6\"", false),
                &[("k", "1"), ("dose", "0")],
                &makes("A", "<apply><times/><cn>-1</cn><ci>k</ci><ci>A</ci><ci>c</ci></apply>"),
            ),
            parameters: "parameterId\tparameterScale\tlowerBound\tupperBound\tnominalValue\testimate\nk\tlog10\t1e-3\t1e3\t1\t1\n".to_owned(),
            conditions: "conditionId\nc1\n".to_owned(),
            observables: "observableId\tobservableFormula\tnoiseFormula\nobs\tA\t0.1\n".to_owned(),
            measurements: "observableId\tsimulationConditionId\tmeasurement\ttime\nobs\tc1\t1\t1\n".to_owned(),
        }
    }
}

impl Problem {
    fn read(&self) -> Result<ImportedProblem, String> {
        let text = "format_version: 1\nparameter_file: p.tsv\nproblems:\n- sbml_files: [m.xml]\n  condition_files: [c.tsv]\n  observable_files: [o.tsv]\n  measurement_files: [d.tsv]\n";
        let load = |name: &str| {
            let text = match name {
                "p.tsv" => &self.parameters,
                "m.xml" => &self.model,
                "c.tsv" => &self.conditions,
                "o.tsv" => &self.observables,
                _ => &self.measurements,
            };
            Ok(PetabFile { name: name.to_owned(), text: text.clone() })
        };
        import_petab("a.yaml", text, "m", &load).map_err(|why| {
            let (line, _) = why.line_and_column();
            format!("{}:{line} {}; {}", why.source_code.name(), why.message, why.help.unwrap_or_default())
        })
    }
}

#[test]
fn tables_of_petab_name_what_there_is() {
    let plain = Problem::default();
    plain.read().unwrap();
    let parameters = |from: &str, to: &str| Problem {
        parameters: plain.parameters.replace(from, to),
        ..Problem::default()
    };
    let observables = |from: &str, to: &str| Problem {
        observables: plain.observables.replace(from, to),
        ..Problem::default()
    };
    let conditions = |text: &str| Problem { conditions: text.to_owned(), ..Problem::default() };
    for (problem, wanted) in [
        (
            parameters("k\tlog10", "kk\tlog10"),
            "p.tsv:2 'kk' is nothing of the model, and stands in no other table; perhaps 'k' is meant",
        ),
        (
            parameters("1e-3", "0"),
            "p.tsv:2 the lower bound 0 of 'k' has no logarithm; a parameter on the scale log10 has bounds above zero",
        ),
        (observables("\tA\t", "\tA*q\t"), "o.tsv:2 'q' stands in a formula"),
        (observables("0.1", "sd_x"), "o.tsv:2 'sd_x' stands in a formula"),
        (
            observables("\tA\t", "\tobservableParameter1_obs*A\t"),
            "d.tsv:2 'obs' needs 1 observableParameters",
        ),
        (
            conditions("conditionId\tdoze\nc1\t1\n"),
            "c.tsv:2 'doze' is a column, and nothing of the model; perhaps 'dose' is meant",
        ),
        (conditions("conditionId\tdose\nc1\tq\n"), "c.tsv:2 'q' is no number, and no parameter"),
    ] {
        match problem.read() {
            Ok(read) => panic!("{wanted}\n{}", read.proof),
            Err(said) => assert!(said.starts_with(wanted) || said.contains(wanted), "{said}\n{wanted}"),
        }
    }
}

#[test]
fn problems_of_petab_are_read_for_what_they_mean() {
    let plain = Problem::default();
    // time in an observable is time
    let read =
        Problem { observables: plain.observables.replace("\tA\t", "\tA + 2*time\t"), ..Problem::default() }
            .read()
            .unwrap();
    assert!(read.proof.contains("time' = 1") && !read.proof.contains("param time"), "{}", read.proof);
    assert!(read.scene.contains("time = 0"), "{}", read.scene);
    // 6 in a compartment whose size a condition says
    let read =
        Problem { conditions: "conditionId\tc\nc1\t3\n".to_owned(), ..Problem::default() }.read().unwrap();
    assert!(read.scene.contains("A = \"6/c\""), "{}", read.scene);
    // 6 in a compartment whose size an assignment says
    let model = plain
        .model
        .replace("</listOfParameters>", &format!("</listOfParameters>{}", assignment("c", "<cn>3</cn>")));
    let read = Problem { model, ..Problem::default() }.read().unwrap();
    assert!(read.scene.contains("A = \"6/3\""), "{}", read.scene);
    // a value of a table comes before an initial assignment
    let model = plain
        .model
        .replace("</listOfParameters>", &format!("</listOfParameters>{}", assignment("k", "<cn>3</cn>")));
    let read = Problem { model, ..Problem::default() }.read().unwrap();
    assert!(read.proof.contains("param k unknown") && !read.proof.contains("let k"), "{}", read.proof);
    // a switch that is off in one condition and on in the other: its limit is between
    let switch = "<piecewise><piece><cn>2</cn><apply><gt/><ci>dose</ci><cn>0</cn></apply></piece><otherwise><cn>1</cn></otherwise></piecewise>";
    let model = plain.model.replace("<ci>k</ci>", &format!("<ci>k</ci>{switch}"));
    let conditions = "conditionId\tdose\nc1\t0\nc2\t5\n".to_owned();
    let read = Problem { model, conditions, ..Problem::default() }.read().unwrap();
    assert!(read.proof.contains("sign(dose - 2.5)"), "{}", read.proof);
}

/// Cells that say that they are empty, as programs write them; bounds between which nothing is left to estimate.
#[test]
fn tables_of_petab_are_read_as_their_writers_mean_them() {
    let plain = Problem::default();
    let measurements = "observableId\tpreequilibrationConditionId\tsimulationConditionId\tmeasurement\ttime\tobservableParameters\nobs\tnan\tc1\t1\t1\tNA\nobs\tNaN\tc1\t1\t2\tNone\n".to_owned();
    let read = Problem { measurements, ..Problem::default() }.read().unwrap();
    assert_eq!(read.counts[3..], [1, 2], "{}", read.measurements);
    let parameters = plain.parameters.replace("1e-3\t1e3\t1\t", "2\t2\t1\t");
    let read = Problem { parameters, ..Problem::default() }.read().unwrap();
    assert!(read.scene.contains("[known]\nk = 2.0"), "{}", read.scene);
    assert_eq!(read.counts[1], 0);
    assert!(
        read.remarks.iter().any(|one| one == "'k' is known: its bounds are both 2"),
        "{:?}",
        read.remarks
    );
}

/// A constant that begins by a state has in each experiment the value that this state has there at the start.
#[test]
fn constants_of_petab_may_begin_by_the_states() {
    let plain = Problem::default();
    let twice = "<apply><times/><cn>2</cn><ci>A</ci></apply>";
    let assigned = format!("</listOfParameters>{}", assignment("dose", twice));
    let model = plain.model.replace("</listOfParameters>", &assigned);
    let model = model.replace("<ci>k</ci>", "<ci>k</ci><ci>dose</ci>");
    // 6 in a compartment of the size 3; in the other conditions 5 and k
    let conditions = "conditionId\tA\nc1\t\nc2\t5\nc3\tk\n".to_owned();
    let measured = |extra: &str| format!("{}obs\tc2\t1\t1\nobs\tc3\t1\t1\n{extra}", plain.measurements);
    let read = Problem {
        model: model.clone(),
        conditions: conditions.clone(),
        measurements: measured(""),
        ..Problem::default()
    };
    let scene = read.read().unwrap().scene;
    for part in ["set = { A = 5.0, dose = \"2*5\" }", "set = { A = \"k\", dose = \"2*k\" }"] {
        assert!(scene.contains(part), "{part} in {scene}");
    }
    assert_eq!(scene.matches("dose = ").count(), 3, "{scene}");
    // the tables are asked first
    let conditions = "conditionId\tdose\nc1\t7\n".to_owned();
    let scene = Problem { model, conditions, ..Problem::default() }.read().unwrap().scene;
    assert!(scene.contains("set = { dose = 7.0 }"), "{scene}");
}

/// A package that is declared and not used changes nothing; one that is used is refused by its name.
#[test]
fn packages_of_sbml_are_refused_where_they_are_used() {
    let package = "http://www.sbml.org/sbml/level3/version1/comp/version1";
    let with = |inside: &str| {
        format!(
            "<sbml xmlns=\"http://www.sbml.org/sbml/level3/version1/core\" xmlns:comp=\"{package}\" level=\"3\" version=\"1\" comp:required=\"true\"><model>\n{inside}<listOfCompartments><compartment id=\"c\" size=\"1\"/></listOfCompartments><listOfParameters><parameter id=\"x\" value=\"1\"/></listOfParameters><listOfRules><rateRule variable=\"x\"><math xmlns=\"http://www.w3.org/1998/Math/MathML\"><ci>x</ci></math></rateRule></listOfRules></model></sbml>"
        )
    };
    import("a.xml", &with(""), &ImportQuestion::default()).unwrap();
    let used = with("<comp:listOfSubmodels><comp:submodel comp:id=\"a\"/></comp:listOfSubmodels>");
    let why = import("a.xml", &used, &ImportQuestion::default()).unwrap_err();
    assert!(why.message.contains("the package 'comp' changes what the model means"), "{}", why.message);
    assert_eq!(why.line_and_column().0, 2);
}

/// Starts that are made of other starts, each of it twice: what would come of it is counted before it is made.
#[test]
fn starts_of_petab_that_double_are_refused() {
    let plain = Problem::default();
    let name = |i: usize| format!("A{i}");
    let more: String = (0..40).map(|i| species(&name(i), "initialConcentration=\"1\"", false)).collect();
    let one = |id: &str, inside: &str| {
        format!("<initialAssignment symbol=\"{id}\">{}</initialAssignment>", math(inside))
    };
    let sum = |i: usize| format!("<apply><plus/><ci>{0}</ci><ci>{0}</ci></apply>", name(i + 1));
    let starts: String = (0..39).map(|i| one(&name(i), &sum(i))).collect();
    let dose = one("dose", "<ci>A0</ci>");
    let assigned =
        format!("</listOfParameters><listOfInitialAssignments>{starts}{dose}</listOfInitialAssignments>");
    let model = plain.model.replace("</listOfSpecies>", &format!("{more}</listOfSpecies>"));
    let model =
        model.replace("</listOfParameters>", &assigned).replace("<ci>k</ci>", "<ci>k</ci><ci>dose</ci>");
    let why = Problem { model, ..Problem::default() }.read().expect_err("2^39 names");
    assert!(why.contains("becomes too large"), "{why}");
}
