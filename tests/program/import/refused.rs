//! What cannot be read is named with its line, and with what to do.

use palmistry::import::{ForeignFormat, ImportQuestion, import};

/// The message, the line, what is marked, and the advice.
fn refused(name: &str, text: &str) -> (String, usize, String, String) {
    let why = match import(name, text, &ImportQuestion::default()) {
        Ok(imported) => panic!("{text}\nis read as\n{}", imported.text),
        Err(why) => why,
    };
    let (line, _) = why.line_and_column();
    let (at, length) = (why.span.offset(), why.span.len());
    let marked = why.source_code.inner()[at..at + length].to_owned();
    (why.message, line, marked, why.help.unwrap_or_default())
}

#[test]
fn what_cannot_be_read_is_named_with_its_place() {
    let sbml = |inside: &str| {
        format!(
            "<sbml xmlns=\"http://www.sbml.org/sbml/level3/version1/core\" level=\"3\" version=\"1\">\n<model>\n{inside}\n</model>\n</sbml>"
        )
    };
    let species = "<listOfCompartments><compartment id=\"c\"/></listOfCompartments>\n<listOfSpecies><species id=\"S\" compartment=\"c\"/></listOfSpecies>\n";
    let math = |inside: &str| format!("<math xmlns=\"http://www.w3.org/1998/Math/MathML\">{inside}</math>");
    let rule = |inside: &str| {
        sbml(&format!(
            "{species}<listOfRules>\n<rateRule variable=\"S\">\n{}</rateRule></listOfRules>",
            math(inside)
        ))
    };
    for (name, text, message, line, marked) in [
        (
            "a.jl",
            "ode = @ODEmodel(\n  x'(t) = a * x(t) b,\n  y(t) = x(t))".to_owned(),
            "expected ',' or ')', and 'b' stands there",
            2,
            "b",
        ),
        ("a.jl", "@ODEmodel(x'(t) = t*x(t),\n y(t) = x(t))".to_owned(), "time stands by itself: 't'", 1, "t"),
        ("a.jl", "@ODEmodel(x'(t) = x(t),\n x'(t) = 2)".to_owned(), "'x' has two equations", 2, "x'(t)"),
        (
            "a.jl",
            "@ODEmodel(x'(t) = foo(x(t)),\n y(t) = x(t))".to_owned(),
            "the function 'foo' has no counterpart in proof files",
            1,
            "foo(x(t))",
        ),
        (
            "a.jl",
            "@ODEmodel(x'(t) = y(t),\n y(t) = x(t))".to_owned(),
            "'y' is an output, and stands on a right side",
            1,
            "y(t)",
        ),
        (
            "a.jl",
            "a = @ODEmodel(x'(t) = 1, y(t) = x(t))\nb = @ODEmodel(x'(t) = 2, y(t) = x(t))".to_owned(),
            "the file has 2 models",
            2,
            "@ODEmodel",
        ),
        (
            "a.jl",
            "@variables t x(t)\nD = Differential(t)\neqs = [D(x) ~ k*x]".to_owned(),
            "'k' is declared neither as a parameter nor as a variable",
            3,
            "k",
        ),
        ("a.jl", "x = 1\n".to_owned(), "the file has no model that can be read", 1, "x"),
        (
            "a.py",
            "import sympy as sym\nfor i in range(3):\n  pass\n".to_owned(),
            "'for' is not read: nothing of a script is run",
            2,
            "for",
        ),
        (
            "a.py",
            "import sympy as sym\nz = sym.Symbol('z')\nx = [z]\nf = [z*k]\nh = [z]\np = []\n".to_owned(),
            "nothing says what 'k' is",
            4,
            "k",
        ),
        (
            "a.py",
            "import sympy as sym\nz = sym.Symbol('z')\nx = [z]\nf = [z^2]\nh = [z]\n".to_owned(),
            "'^' is no power in Python",
            4,
            "^",
        ),
        (
            "a.py",
            "import sympy as sym\nk, n = sym.symbols('n n')\nx = [k]\np = [n]\nf = [k]\nh = [k]\n".to_owned(),
            "x, p, u and w have the symbol 'n' twice",
            4,
            "n",
        ),
        (
            "a.m",
            "syms x1 k\nx = x1;\nx(k) = 1;\n".to_owned(),
            "an element of something is assigned to: that is not read",
            3,
            "x(k)",
        ),
        (
            "a.m",
            "syms x1 x2\nx = [x1; x2];\nf = [x1];\nh = x1;\n".to_owned(),
            "2 states, and 1 rates",
            3,
            "x1",
        ),
        (
            "a.m",
            "syms x1\nx = x1;\nf = mod(x1, 2);\nh = x1;\n".to_owned(),
            "the function 'mod' has no counterpart in proof files",
            3,
            "mod(x1, 2)",
        ),
        (
            "a.m",
            "syms z k\nx = z; p = k; f = k*z; h = z;\nsave('one', 'x', 'p', 'f', 'h');\np = [];\nsave('two', 'x', 'p', 'f', 'h');\n".to_owned(),
            "the file saves a second model, 'two'",
            5,
            "save",
        ),
        ("a.txt", "x' = E*x\n".to_owned(), "'E' may be Euler's number or a name", 1, "E"),
        (
            "a.txt",
            "[x, y]\n".to_owned(),
            "a vector of 2 rates, and nothing says of which states",
            1,
            "[x, y]",
        ),
        ("a.txt", "x' = x\ny = y + 1\nx2' = y".to_owned(), "'y' is defined by itself", 2, "y + 1"),
        (
            "a.txt",
            "x' = Piecewise((1/x, x > 1), (0, True))".to_owned(),
            "the cases cannot be written as one expression: this one does not exist everywhere",
            1,
            "1/x",
        ),
        (
            "a.txt",
            "x' = Piecewise((1, x == 1), (0, True))".to_owned(),
            "cases by '==' are not read",
            1,
            "x == 1",
        ),
        (
            "a.xml",
            "<sbml level=\"1\"><model/></sbml>".to_owned(),
            "SBML of level '1' is not read",
            1,
            "<sbml level=\"1\">",
        ),
        (
            "a.xml",
            sbml("<listOfEvents>\n<event id=\"dose\"/></listOfEvents>"),
            "the event 'dose' is not read",
            4,
            "<event id=\"dose\"/>",
        ),
        (
            "a.xml",
            sbml(&format!(
                "{species}<listOfRules>\n<algebraicRule>{}</algebraicRule></listOfRules>",
                math("<ci>S</ci>")
            )),
            "algebraic rules are not read",
            6,
            "<algebraicRule>",
        ),
        (
            "a.xml",
            rule(
                "<apply><csymbol definitionURL=\"http://www.sbml.org/sbml/symbols/delay\"/><ci>S</ci><cn>1</cn></apply>",
            ),
            "delays are not read",
            7,
            "<csymbol definitionURL=\"http://www.sbml.org/sbml/symbols/delay\"/>",
        ),
        (
            "a.xml",
            rule("<apply><factorial/><ci>S</ci></apply>"),
            "the function 'factorial' has no counterpart in proof files",
            7,
            "<apply>",
        ),
        ("a.xml", rule("<ci>k</ci>"), "nothing says what 'k' is", 7, "<ci>k</ci>"),
        (
            "a.xml",
            rule("<piecewise><piece><cn>1</cn><apply><gt/><ci>S</ci><cn>0</cn></apply></piece></piecewise>"),
            "nothing is said of what is so elsewhere",
            7,
            "<piecewise>",
        ),
        (
            "a.xml",
            "<sbml>\n <model>\n</sbml>".to_owned(),
            "this is no XML that can be read: expected 'model' tag, not 'sbml' at 3:1",
            3,
            "<",
        ),
        (
            "a.xml",
            sbml(&format!(
                "{species}<listOfReactions>\n<reaction id=\"r\"><listOfReactants><speciesReference species=\"S\" stoichiometry=\"1\"/></listOfReactants></reaction></listOfReactions>"
            )),
            "the reaction 'r' has no kinetic law",
            6,
            "<reaction id=\"r\">",
        ),
    ] {
        let (said, at, what, help) = refused(name, &text);
        assert_eq!((said.as_str(), at, what.as_str()), (message, line, marked), "{text}");
        assert!(help.len() > 10, "{text}: no advice but '{help}'");
    }
}

/// Whatever is too large or too deep is refused, and soon.
#[test]
fn what_is_made_to_hurt_is_refused() {
    let deep = |open: &str, close: &str| format!("{}x{}", open.repeat(100_000), close.repeat(100_000));
    let doubled: String = (0..60).map(|i| format!("v{} = v{i} + v{i}\n", i + 1)).collect();
    let functions: String = (0..60)
        .map(|i| {
            format!(
                "<functionDefinition id=\"g{}\"><math><lambda><bvar><ci>s</ci></bvar><apply><plus/><apply><ci>g{i}</ci><ci>s</ci></apply><apply><ci>g{i}</ci><ci>s</ci></apply></apply></lambda></math></functionDefinition>",
                i + 1
            )
        })
        .collect();
    let cases = [
        ("a.txt", format!("x' = {}\n", deep("(", ")"))),
        ("a.txt", format!("x' = {}x\n", "-".repeat(100_000))),
        ("a.txt", format!("x' = {}1\n", "x**".repeat(100_000))),
        ("a.txt", format!("x' = {}\n", deep("sin(", ")"))),
        ("a.txt", format!("x' = x{}\n", "(t)".repeat(100_000))),
        ("a.txt", format!("x' = {}x\n", "x + ".repeat(5_000))),
        ("a.txt", format!("x' = v60*x\nv0 = x\n{doubled}")),
        ("a.txt", "x' = 1e99999*x".to_owned()),
        ("a.txt", "x' = x**(10**1000)".to_owned()),
        ("a.m", format!("syms x1\nx = [x1];\n{}f = x1; h = x1;\n", "x = [x; x];\n".repeat(60))),
        ("a.m", "syms x1\nx = x1;\nf = zeros(1e9, 1e9);\nh = x1;\n".to_owned()),
        ("a.m", format!("syms x1\nx = x1;\nf = {};\nh = x1;\n", deep("[", "]"))),
        (
            "a.m",
            format!(
                "syms x1\nx = x1;\nf(1) = x1;\n{}f(1) = f(1) + f(1);\n{}h = x1;\n",
                "for i = 1:100\n".repeat(8),
                "end\n".repeat(8)
            ),
        ),
        (
            "a.m",
            format!(
                "syms x1\nx = x1;\nf = x1;\n{}{}h = x1;\n",
                "for i = 1:2\n".repeat(1000),
                "end\n".repeat(1000)
            ),
        ),
        (
            "a.m",
            format!(
                "syms x1\nx = x1;\n{}a = 1;\n{}f = x1; h = x1;\n",
                "for i = 1:19999\n".repeat(7),
                "end\n".repeat(7)
            ),
        ),
        (
            "a.m",
            format!("syms x1\nx = x1;\nv = 1;\n{}f = zeros(v, 1);\nh = x1;\n", "v = v + v;\n".repeat(90)),
        ),
        (
            "a.m",
            "syms x1\nx = x1;\nv = 1;\nfor i = 1:19000\nv = v + 1;\nend\nf = zeros(v, 2);\nh = x1;\n"
                .to_owned(),
        ),
        (
            "a.m",
            "syms x1\nx = x1;\nf(1) = x1;\nfor i = 1:19000\nf(1) = sin(f(1));\nend\nh = x1;\n".to_owned(),
        ),
        ("a.m", "syms x1\nx = x1;\nf(1e18) = x1;\nh = x1;\n".to_owned()),
        ("a.m", "syms x1\nx = x1;\nfor i = -9e18:9e18\nend\nf = x1; h = x1;\n".to_owned()),
        ("a.m", "syms x1\nx = x1;\nfor i = 1:3\nf = x1; h = x1;\n".to_owned()),
        ("a.py", "import sympy as sym\nx = sym.symbols('x0:999999999999')\n".to_owned()),
        ("a.jl", format!("@ODEmodel(x'(t) = {}x(t), y(t) = x(t))", "2*(".repeat(1000))),
        ("a.xml", format!("<sbml level=\"3\">{}</sbml>", deep("<a>", "</a>"))),
        (
            "a.xml",
            format!(
                "<sbml level=\"2\"><model><listOfFunctionDefinitions>{functions}</listOfFunctionDefinitions></model></sbml>"
            ),
        ),
        (
            "a.xml",
            "<!DOCTYPE a [<!ENTITY b \"bbbbbbbb\"><!ENTITY c \"&b;&b;&b;&b;\">]><sbml level=\"3\">&c;</sbml>"
                .to_owned(),
        ),
    ];
    let mut read = 0;
    for (name, text) in cases {
        for format in ForeignFormat::ALL.map(Some).into_iter().chain([None]) {
            let question = ImportQuestion { format, ..ImportQuestion::default() };
            read += usize::from(import(name, &text, &question).is_ok());
        }
    }
    // sums that are long, and definitions of definitions, are no more than that
    assert!(read <= 12, "{read} are read");
}
