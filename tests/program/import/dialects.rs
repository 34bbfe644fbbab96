//! Random expressions, written in each language with as few brackets as its precedences need, and with a value of their own.

use super::round_trip::{Both, close, compare};
use super::{Draws, of_text};

/// An expression with a value.
#[derive(Clone, Debug)]
enum Tree {
    /// Quarters, so that decimals are exact.
    Number(u64),
    Name(&'static str),
    Add(Box<Tree>, Box<Tree>),
    Sub(Box<Tree>, Box<Tree>),
    Mul(Box<Tree>, Box<Tree>),
    Div(Box<Tree>, Box<Tree>),
    Neg(Box<Tree>),
    Pow(Box<Tree>, i64),
    /// A power of a power, where languages differ.
    Tower(Box<Tree>, i64, i64),
    Call(&'static str, Box<Tree>),
}

const NAMES: [&str; 4] = ["x", "y", "a", "b"];

fn tree(draws: &mut Draws, depth: usize) -> Tree {
    let inner = |draws: &mut Draws| Box::new(tree(draws, depth - 1));
    match if depth == 0 { draws.below(3) } else { draws.below(12) } {
        0 => Tree::Number(1 + draws.below(16)),
        1 | 2 => Tree::Name(NAMES[draws.below(4) as usize]),
        3 => Tree::Add(inner(draws), inner(draws)),
        4 => Tree::Sub(inner(draws), inner(draws)),
        5 => Tree::Mul(inner(draws), inner(draws)),
        6 => Tree::Div(inner(draws), inner(draws)),
        7 => Tree::Neg(inner(draws)),
        8 => Tree::Pow(inner(draws), draws.below(5) as i64 - 2),
        9 => Tree::Tower(inner(draws), draws.below(3) as i64 + 1, draws.below(2) as i64 + 1),
        10 => Tree::Call("sin", inner(draws)),
        _ => Tree::Call("exp", Box::new(Tree::Call("cos", inner(draws)))),
    }
}

impl Tree {
    /// `x^(p^q)` where powers are taken from the right, `(x^p)^q` where they are taken from the left.
    fn value(&self, of: &dyn Fn(&str) -> f64, from_the_left: bool) -> f64 {
        let at = |tree: &Tree| tree.value(of, from_the_left);
        match self {
            Tree::Number(quarters) => *quarters as f64 / 4.0,
            Tree::Name(name) => of(name),
            Tree::Add(a, b) => at(a) + at(b),
            Tree::Sub(a, b) => at(a) - at(b),
            Tree::Mul(a, b) => at(a) * at(b),
            Tree::Div(a, b) => at(a) / at(b),
            Tree::Neg(a) => -at(a),
            Tree::Pow(a, n) => at(a).powi(*n as i32),
            Tree::Tower(a, p, q) if from_the_left => at(a).powi((p * q) as i32),
            Tree::Tower(a, p, q) => at(a).powi(p.pow(*q as u32) as i32),
            Tree::Call("sin", a) => at(a).sin(),
            Tree::Call("exp", a) => at(a).exp(),
            Tree::Call(_, a) => at(a).cos(),
        }
    }

    /// How strongly the text of it holds: sums, products, signs, powers, the rest.
    fn text(&self, language: &Language, draws: &mut Draws) -> (String, u8) {
        let put = |tree: &Tree, least: u8, draws: &mut Draws| {
            let (text, strength) = tree.text(language, draws);
            if strength < least { format!("({text})") } else { text }
        };
        let blank = if draws.below(2) == 0 { " " } else { "" };
        let power = language.power;
        match self {
            Tree::Number(quarters) => {
                let text = match draws.below(3) {
                    0 if quarters % 4 == 0 => format!("{}", quarters / 4),
                    1 => format!("{}e-2", quarters * 25),
                    _ => format!("{}", *quarters as f64 / 4.0),
                };
                (text, 5)
            }
            Tree::Name(name) => ((language.name)(name), 5),
            Tree::Add(a, b) => (format!("{}{blank}+{blank}{}", put(a, 1, draws), put(b, 2, draws)), 1),
            Tree::Sub(a, b) => (format!("{}{blank}-{blank}{}", put(a, 1, draws), put(b, 2, draws)), 1),
            Tree::Mul(a, b) => (format!("{}{blank}*{blank}{}", put(a, 2, draws), put(b, 3, draws)), 2),
            Tree::Div(a, b) => (format!("{}{blank}/{blank}{}", put(a, 2, draws), put(b, 3, draws)), 2),
            // a sign binds weaker than a power in all of them
            Tree::Neg(a) => (format!("-{}", put(a, 4, draws)), 1),
            Tree::Pow(a, n) => (format!("{}{power}{n}", put(a, 5, draws)), 4),
            Tree::Tower(a, p, q) => (format!("{}{power}{p}{power}{q}", put(a, 5, draws)), 4),
            Tree::Call(name, a) => (format!("{name}({})", put(a, 0, draws)), 5),
        }
    }

    /// MathML.
    fn markup(&self) -> String {
        let apply = |operator: &str, parts: &[&Tree]| {
            let parts: String = parts.iter().map(|part| part.markup()).collect();
            format!("<apply><{operator}/>{parts}</apply>")
        };
        let power =
            |base: String, n: i64| format!("<apply><power/>{base}<cn type=\"integer\"> {n} </cn></apply>");
        match self {
            Tree::Number(quarters) => format!("<cn type=\"rational\">{quarters}<sep/>4</cn>"),
            Tree::Name(name) => format!("<ci> {name} </ci>"),
            Tree::Add(a, b) => apply("plus", &[a, b]),
            Tree::Sub(a, b) => apply("minus", &[a, b]),
            Tree::Mul(a, b) => apply("times", &[a, b]),
            Tree::Div(a, b) => apply("divide", &[a, b]),
            Tree::Neg(a) => apply("minus", &[a]),
            Tree::Pow(a, n) => power(a.markup(), *n),
            Tree::Tower(a, p, q) => power(a.markup(), p.pow(*q as u32)),
            Tree::Call(name, a) => apply(name, &[a]),
        }
    }
}

/// A language: how a file of it says two rates, and how a name and a power are written in it.
struct Language {
    file: &'static str,
    whole: fn(&str, &str) -> String,
    name: fn(&str) -> String,
    power: &'static str,
    from_the_left: bool,
}

fn of_time(name: &str) -> String {
    if matches!(name, "x" | "y") { format!("{name}(t)") } else { name.to_owned() }
}

const LANGUAGES: [Language; 5] = [
    Language {
        file: "random.jl",
        whole: |f, g| format!("m = @ODEmodel(x'(t) = {f}, y'(t) = {g}, z(t) = x(t)*a*b)"),
        name: of_time,
        power: "^",
        from_the_left: false,
    },
    Language {
        file: "random.py",
        whole: |f, g| {
            format!(
                "import sympy as sym\nfrom sympy import sin, cos, exp\nx, y, a, b = sym.symbols('x y a b')\nX = 1\n\
                 f = [[{f}], [{g}]]\nx, p = [[x], [y]], [a, b]\nh = [x[0]]\n"
            )
            .replace("x, p = [[x], [y]], [a, b]\nh = [x[0]]\n", "h = [x*a*b]\nx = [[x], [y]]\np = [a, b]\n")
        },
        name: str::to_owned,
        power: "**",
        from_the_left: false,
    },
    Language {
        file: "random.m",
        whole: |f, g| {
            format!("syms x y a b\nf = [{f}; {g}]; % rates\nh = x*a*b;\nX = [x y];\nx = X.'; p = [a, b];\n")
        },
        name: str::to_owned,
        power: "^",
        from_the_left: true,
    },
    Language {
        file: "sympy.txt",
        whole: |f, g| format!("states: x, y\nparameters: a, b\noutputs: x*a*b\nMatrix([[{f}], [{g}]])\n"),
        name: of_time,
        power: "**",
        from_the_left: false,
    },
    Language {
        file: "lines.txt",
        whole: |f, g| format!("parameters: a, b\noutputs: x*a*b\ndx/dt = {f}\ny' = {g}\n"),
        name: str::to_owned,
        power: "^",
        from_the_left: false,
    },
];

const MODELS: usize = 60;

/// Whether all parts of a tree have tame values, so that rounding decides nothing.
fn is_tame(tree: &Tree, at: &dyn Fn(&str) -> f64, from_the_left: bool) -> bool {
    let inner = |tree: &Tree| is_tame(tree, at, from_the_left);
    let value = tree.value(at, from_the_left);
    value.is_finite()
        && value.abs() < 1e4
        && match tree {
            Tree::Number(_) | Tree::Name(_) => true,
            Tree::Add(a, b) | Tree::Sub(a, b) | Tree::Mul(a, b) => inner(a) && inner(b),
            Tree::Div(a, b) => inner(a) && inner(b) && b.value(at, from_the_left).abs() > 1e-4,
            Tree::Pow(a, _) => inner(a) && a.value(at, from_the_left).abs() > 1e-3,
            Tree::Neg(a) | Tree::Tower(a, ..) | Tree::Call(_, a) => inner(a),
        }
}

#[test]
fn expressions_mean_the_same_in_every_language() {
    let mut draws = Draws(11);
    for language in &LANGUAGES {
        let mut compared = 0;
        for _ in 0..MODELS {
            let trees = [tree(&mut draws, 4), tree(&mut draws, 4)];
            let texts = trees.each_ref().map(|tree| tree.text(language, &mut draws).0);
            // a number alone over zero is no model
            let imported = match palmistry::import::import(
                language.file,
                &(language.whole)(&texts[0], &texts[1]),
                &Default::default(),
            ) {
                Ok(imported) => imported,
                Err(why) => {
                    let never =
                        trees.iter().any(|tree| !tree.value(&|_| 1.1, language.from_the_left).is_finite());
                    assert!(never, "{:?}\n{texts:?}", miette::Report::new(why));
                    continue;
                }
            };
            let mut both = Both::new(&imported);
            for _ in 0..3 {
                let state = both.state(&mut draws);
                let given = NAMES.map(|name| both.given(&state, name));
                let at = |name: &str| {
                    let at = NAMES.iter().position(|own| *own == name).expect("a name");
                    given[at].unwrap_or(1.0)
                };
                for (name, tree) in ["x", "y"].into_iter().zip(&trees) {
                    if !is_tame(tree, &at, language.from_the_left) {
                        continue;
                    }
                    let expected = tree.value(&at, language.from_the_left);
                    let ours = both.rate(&state, name);
                    let ours = ours.unwrap_or_else(|| panic!("{name} has no value\n{}", imported.text));
                    // what cancels loses digits in doubles
                    assert!(
                        close(expected, ours) || (expected - ours).abs() < 1e-6,
                        "{}: {expected} expected, {ours} found\n{texts:?}\n{}",
                        language.file,
                        imported.text
                    );
                    compared += 1;
                }
            }
        }
        assert!(compared > 4 * MODELS, "{}: {compared} values", language.file);
    }
}

#[test]
fn markup_means_what_it_says() {
    let mut draws = Draws(5);
    let mut compared = 0;
    for _ in 0..MODELS {
        let trees = [tree(&mut draws, 4), tree(&mut draws, 4)];
        let rule = |name: &str, tree: &Tree| {
            format!(
                "<rateRule variable=\"{name}\"><math xmlns=\"http://www.w3.org/1998/Math/MathML\">{}</math></rateRule>",
                tree.markup()
            )
        };
        let parameters: String =
            NAMES.iter().map(|name| format!("<parameter id=\"{name}\" constant=\"false\"/>")).collect();
        let text = format!(
            "<?xml version=\"1.0\"?><sbml xmlns=\"http://www.sbml.org/sbml/level2/version4\" level=\"2\" version=\"4\"><model>\
             <listOfParameters>{parameters}</listOfParameters><listOfRules>{}{}</listOfRules></model></sbml>",
            rule("x", &trees[0]),
            rule("y", &trees[1])
        );
        let Ok(imported) = palmistry::import::import("random.xml", &text, &Default::default()) else {
            assert!(trees.iter().any(|tree| !tree.value(&|_| 1.1, false).is_finite()), "{text}");
            continue;
        };
        let mut both = Both::new(&imported);
        for _ in 0..3 {
            let state = both.state(&mut draws);
            let given = NAMES.map(|name| both.given(&state, name));
            let at =
                |name: &str| given[NAMES.iter().position(|own| *own == name).expect("a name")].unwrap_or(1.0);
            for (name, tree) in
                ["x", "y"].into_iter().zip(&trees).filter(|(_, tree)| is_tame(tree, &at, false))
            {
                let (expected, ours) = (tree.value(&at, false), both.rate(&state, name).expect("a value"));
                assert!(
                    close(expected, ours) || (expected - ours).abs() < 1e-6,
                    "{expected} {ours}\n{}",
                    imported.text
                );
                compared += 1;
            }
        }
    }
    assert!(compared > 4 * MODELS, "{compared} values");
}

/// Where languages differ, and what each of them has of its own.
#[test]
fn peculiarities_of_each_language() {
    let rate = |file: &str, text: &str| {
        let imported = of_text(file, text);
        assert!(compare(&imported, 5) > 0, "{text}");
        let line = imported
            .text
            .lines()
            .find(|line| line.trim_start().starts_with("x'"))
            .expect("a rate")
            .to_owned();
        line.split_once('=').expect("a rate").1.trim().to_owned()
    };
    let julia = |e: &str| rate("a.jl", &format!("@ODEmodel(x'(t) = {e}, y(t) = x(t))"));
    assert_eq!(julia("2x(t)^2 - 3(a + 1)x(t)".replace(")x(t)", ")*x(t)").as_str()), "2*x^2 - 3*(a + 1)*x");
    assert_eq!(julia("1/2a"), "1/(2*a)");
    assert_eq!(julia("2^3a"), "2^(3*a)");
    assert_eq!(julia("a/b//c"), "a/(b/c)");
    assert_eq!(julia("-x(t)^2"), "-x^2");
    // a half of it, and no root; the language takes neither without brackets
    assert_eq!(julia("x(t)^1/2"), "(x^1)/2");
    assert_eq!(julia("a*x(t)^2/3/x(t)"), "a*(x^2)/3/x");
    assert_eq!(julia("1_000.5 + 1f0 + 3//4*x(t)"), "1000.5 + 1 + 3/4*x");
    let printed = |e: &str| rate("a.txt", &format!("x' = {e}\noutputs: x\n"));
    assert_eq!(printed("-x**2**3"), "-x^(2^3)");
    assert_eq!(printed("(1./x)"), "1/x");
    assert_eq!(printed("sq((x+a))"), "(x + a)^2");
    assert_eq!(printed("Piecewise((x, x > 0), (-x, True))"), "abs(x)");
    assert_eq!(printed("Piecewise((a, a < b), (b, True))*x"), "min(a, b)*x");
    assert_eq!(printed("x if x < a else a"), "min(x, a)");
    assert_eq!(printed("Piecewise((a, x > 0), (b*x, True))"), "(a + b*x)/2 + sign(x)*(a - b*x)/2");
    assert_eq!(printed("log(x, 2) + cbrt(x) + 1.5e-7*x + pi"), "log(x)/log(2) + x^(1/3) + 1.5e-7*x + pi");
    let matlab = of_text(
        "a.m",
        "syms z1 z2 a b\nx = [z1 z2].';\nA = [a -b; b - 1, a\n];\nf = A*x ...\n + [2^3^2; -2^2];\nh = x(2); p = [a; b];\n",
    );
    assert!(matlab.text.contains("z1' = a*z1 - b*z2 + (2^3)^2"), "{}", matlab.text);
    assert!(matlab.text.contains("z2' = (b - 1)*z1 + a*z2 - 2^2"), "{}", matlab.text);
    assert_eq!(compare(&matlab, 5), 15);
}

/// Elements that are assigned to, loops that are gone through, numbers as Fortran writes them: against the same model without them.
#[test]
fn loops_and_elements_of_scripts() {
    let body = |text: &str| text.split_once("state").expect("a model").1.to_owned();
    let head = "syms x1 x2 x3 k d\nx = [x1; x2; x3]; p = [k; d]; h = x3;\n";
    let plain = |rates: &str| body(&of_text("a.m", &format!("{head}f = [{rates}];\n")).text);
    let loops = |lines: &str| {
        let imported = of_text("a.m", &format!("{head}{lines}"));
        assert!(compare(&imported, 5) > 0, "{lines}");
        body(&imported.text)
    };
    let chain = plain("-d*x1 + k; -d*x2 + k*x1; -d*x3 + k*x2");
    for lines in [
        "f(1) = -d*x1 + k;\nf(2) = -d*x2 + k*x1;\nf(3) = -d*x3 + k*x2;\n",
        "f(3,1) = -d*x3 + k*x2; f(1,1) = -d*x1 + k; f(2,1) = -d*x2 + k*x1;",
        "n = length(x); f = sym(zeros(n, 1));\nfor i = 1:n\n  f(i) = -d*x(i);\nend\nf(1) = f(1) + k;\nfor i = 2:n, f(i) = f(i) + k*x(i-1); end\n",
        "f = zeros(size(x, 1), 1);\nfor (i = numel(x):-1:1)\n  for j = [1]\n    f(i) = f(i) - d*x(i*j);\n  end\nend\nfor i = 1:0\n  f(1) = nonsense(x(end));\n for k = 1:3\n end\nend\nf(1) = f(1) + k; f(2) = f(2) + k*x1; f(3) = f(3) + k*x2;\n",
        "f = [0; 0; 0]; for i = [3 1 2]; f(i) = -d*x(i); end; f = f + [k; k*x1; k*x2];",
    ] {
        // a loop's variable is none of the model's; a sum may begin at the zero that stood there
        assert_eq!(loops(lines).replace("= 0 - ", "= -"), chain, "{lines}");
    }
    assert!(plain("0.9D0*x1; 1.5d-1*x2; 2e1*x3").contains("x1' = 0.9*x1\n  x2' = 0.15*x2\n  x3' = 20*x3"));
    // a matrix has its elements by rows and columns, and by one number in the order of its columns
    let matrix = "A = zeros(3, 3); A(2,1) = k; A(6) = k; A(1,1) = -d; A(5) = -d; A(3,3) = A(2,2);\nf = A*x + [k; 0; 0];\n";
    let of_matrix = of_text("a.m", &format!("{head}{matrix}"));
    let vector = of_text("a.m", &format!("{head}f = [-d*x1 + k; -d*x2 + k*x1; -d*x3 + k*x2];\n"));
    let (mut one, mut other) = (Both::new(&of_matrix), Both::new(&vector));
    let at = one.state(&mut Draws(7));
    let at_other = other.state(&mut Draws(7));
    for name in ["x1", "x2", "x3"] {
        let rates = one.rate(&at, name).zip(other.rate(&at_other, name));
        assert!(rates.is_some_and(|(one, other)| close(one, other)), "{name}: {}", of_matrix.text);
    }
    let python = "import sympy as sym\nx1, x2, k = sym.symbols('x1 x2 k')\nx = [[x1],[x2]]\np = [[k]]\nf = sym.zeros(2, 1)\nf[0] = -k*x1\nf[1, 0] = k*x1\nh = [x2]\n";
    assert!(of_text("a.py", python).text.contains("x1' = -k*x1\n  x2' = k*x1"));
}
