//! Foreign files whose meaning is easily mistaken: what they mean is calculated by hand here, and what is written is compared with that.

mod common;

use common::{Values, value_of};
use palmistry_import::{ImportQuestion, import};

/// A number that is so by hand.
fn close(one: f64, other: f64) -> bool {
    (one - other).abs() <= 1e-12 * (1.0 + other.abs())
}

/// A file: its name, its text, values, and by hand the rates in order and the outputs.
type Case = (&'static str, &'static str, Values, &'static [(&'static str, f64)], &'static [f64]);

fn agree(cases: &[Case]) {
    for (name, text, values, rates, outputs) in cases {
        let read = import(name, text, &ImportQuestion::default())
            .unwrap_or_else(|why| panic!("{}; {}\n{text}", why.message, why.help.unwrap_or_default()));
        let states: Vec<&str> = read.model.states.iter().map(|state| state.name.as_str()).collect();
        let wanted: Vec<&str> = rates.iter().map(|(name, _)| *name).collect();
        assert_eq!(states, wanted, "{text}\n{}", read.text);
        for (state, (_, rate)) in read.model.states.iter().zip(*rates) {
            let own = value_of(&read, values, &state.rate);
            assert!(close(own, *rate), "{text}\n{}' is {own}, and by hand {rate}\n{}", state.name, read.text);
        }
        let measured: Vec<f64> =
            read.model.outputs.iter().map(|output| value_of(&read, values, &output.value)).collect();
        assert_eq!(measured.len(), outputs.len(), "{text}\n{}", read.text);
        for (own, output) in measured.iter().zip(*outputs) {
            assert!(close(*own, *output), "{text}\nan output is {own}, and by hand {output}\n{}", read.text);
        }
    }
}

#[test]
fn formulas_are_read_for_what_they_mean() {
    agree(&[
        // functions of time, and no constants of their names: cos(0) = 1, exp(0) = 1, sin(0) = 0
        (
            "a.txt",
            "x' = -k*x + cos(t)",
            &[("x", 3.0), ("k", 2.0), ("t", 0.0)],
            &[("x", -5.0), ("t", 1.0)],
            &[0.0],
        ),
        (
            "a.txt",
            "x' = sqrt(t)*x + exp(t)\noutputs: x*abs(t)",
            &[("x", 3.0), ("t", 4.0)],
            &[("x", 2.0 * 3.0 + 54.598150033144236), ("t", 1.0)],
            &[12.0, 4.0],
        ),
        // a condition of CasADi that is turned round: 2x above one, 3k elsewhere
        (
            "a.txt",
            "states: x\n@1=(!(x<=1)), ((@1?(2*x):0)+((!@1)?(3*k):0))",
            &[("x", 5.0), ("k", 7.0)],
            &[("x", 10.0)],
            &[],
        ),
        (
            "a.txt",
            "states: x\n@1=(!(x<=1)), ((@1?(2*x):0)+((!@1)?(3*k):0))",
            &[("x", 0.5), ("k", 7.0)],
            &[("x", 21.0)],
            &[],
        ),
        ("a.txt", "x' = −k·x × 2 ⋅ 3", &[("x", 5.0), ("k", 7.0)], &[("x", -210.0)], &[]),
        (
            "a.txt",
            "dI/dt = beta*S*I - g*I\ndS/dt = -beta*S*I\noutputs: I",
            &[("S", 2.0), ("I", 3.0), ("beta", 5.0), ("g", 7.0)],
            &[("I", 9.0), ("S", -30.0)],
            &[3.0],
        ),
        (
            "a.txt",
            "Derivative(x(t), (t, 1)) = -x(t) + u(t)\ninputs: u\noutputs: x",
            &[("x", 2.0), ("u", 5.0)],
            &[("x", 3.0)],
            &[2.0],
        ),
    ]);
}

/// Conditions of several parts, however they are joined; expressions as CasADi shows them.
#[test]
fn conditions_and_shared_parts_are_read_for_what_they_mean() {
    const WITHIN: Values = &[("x", 0.5), ("k", 7.0)];
    const BEYOND: Values = &[("x", 3.0), ("k", 7.0)];
    for text in [
        "x' = Piecewise((2*x, (x > 0) & (x < 1)), (3*k, True))\noutputs: x",
        "x' = Piecewise((3*k, (x <= 0) | (x >= 1)), (2*x, True))\noutputs: x",
        "x' = 2*x if x > 0 and x < 1 else 3*k\noutputs: x",
        "states: x\n@1=((x>0)&&(x<1)), ((@1?(2*x):0)+((!@1)?(3*k):0))\noutputs: x",
        "states: x\n@1=(x>0), @2=(x<1), ((@1&&@2)?(2*x):(3*k))\noutputs: x",
    ] {
        agree(&[
            ("a.txt", text, WITHIN, &[("x", 1.0)], &[0.5]),
            ("a.txt", text, BEYOND, &[("x", 21.0)], &[3.0]),
        ]);
    }
    for text in [
        "@ODEmodel(x'(t) = ifelse(x(t) > 0 && x(t) < 1, 2*x(t), 3*k), y(t) = x(t))",
        "@ODEmodel(x'(t) = ifelse((x(t) > 0) & (x(t) < 1) | (x(t) > 9), 2*x(t), 3*k), y(t) = x(t))",
        "@ODEmodel(x'(t) = (x(t) < 0 || x(t) > 1 ? 3*k : 2*x(t)), y(t) = x(t))",
    ] {
        agree(&[
            ("a.jl", text, WITHIN, &[("x", 1.0)], &[0.5]),
            ("a.jl", text, BEYOND, &[("x", 21.0)], &[3.0]),
        ]);
    }
    let sine = 2.0_f64.sin();
    let square: &'static [(&str, f64)] = Box::leak(Box::new([("x", sine * sine), ("y", 5.0)]));
    agree(&[
        ("a.txt", "states: x, y\nSX(@1=sin(x), [(@1*@1), y])", &[("x", 2.0), ("y", 5.0)], square, &[]),
        ("a.txt", "states: x\nSX((x*y))", &[("x", 2.0), ("y", 5.0)], &[("x", 10.0)], &[]),
        // time by its other name, and names of functions that a line names
        (
            "a.txt",
            "x' = -x + 2*time\noutputs: x",
            &[("x", 3.0), ("time", 4.0)],
            &[("x", 5.0), ("time", 1.0)],
            &[3.0, 4.0],
        ),
        (
            "a.txt",
            "x' = -x*exp + sec\nparameters: exp, sec\noutputs: x",
            &[("x", 3.0), ("exp", 4.0), ("sec", 7.0)],
            &[("x", -5.0)],
            &[3.0],
        ),
    ]);
}

#[test]
fn models_of_julia_are_read_for_what_they_mean() {
    agree(&[
        // lists that are put together, each as it is where the system is made
        (
            "a.jl",
            "@parameters k\n@variables t x(t) y(t)\nD = Differential(t)\neqs = [D(x) ~ -k*x]\nmore = [D(y) ~ -y]\neqs = [eqs; more]\n@named sys = ODESystem(collect(eqs), t)",
            &[("x", 2.0), ("y", 5.0), ("k", 3.0)],
            &[("x", -6.0), ("y", -5.0)],
            &[],
        ),
        (
            "a.jl",
            "@parameters k\n@variables t x(t) y(t)\nD = Differential(t)\neqs = [D(x) ~ -k*x]\nmore = [D(y) ~ -y]\n@named sys = ODESystem(vcat(eqs, more), t)",
            &[("x", 2.0), ("y", 5.0), ("k", 3.0)],
            &[("x", -6.0), ("y", -5.0)],
            &[],
        ),
        // the list that is made last, and values that are assigned below everything
        (
            "a.jl",
            "@parameters k\n@variables t x(t) y(t)\nD = Differential(t)\neqs = [D(y) ~ -y]\neqs = [D(x) ~ -k*x]\n@named sys = ODESystem(eqs, t)\nk = 2.0",
            &[("x", 2.0), ("k", 3.0)],
            &[("x", -6.0)],
            &[],
        ),
        // the base of a logarithm stands in front: log(2, 8) = 3
        ("a.jl", "@ODEmodel(x'(t) = log(2, x(t)), y(t) = x(t))", &[("x", 8.0)], &[("x", 3.0)], &[8.0]),
        // two ways to write one letter, and a letter with its mark in two ways
        (
            "a.jl",
            "@ODEmodel(x'(t) = -\u{b5}*x(t) + \u{3bc}*z(t), z'(t) = -k\u{e9}*z(t) + ke\u{301}, y(t) = \u{25b}*x(t)/\u{3b5})",
            &[("x", 2.0), ("z", 5.0), ("\u{3bc}", 3.0), ("k\u{e9}", 7.0), ("\u{3b5}", 11.0)],
            &[("x", 9.0), ("z", -28.0)],
            &[2.0],
        ),
        // time among the parameters, as older files have it
        (
            "a.jl",
            "@parameters t k\n@variables x(t) y(t)\nD = Differential(t)\neqs = [D(x) ~ -k*x + π, D(y) ~ x(t)*log(2, y)]\nmeasured_quantities = [z ~ x - y]",
            &[("x", 2.0), ("y", 8.0), ("k", 3.0)],
            &[("x", -6.0 + std::f64::consts::PI), ("y", 6.0)],
            &[-6.0],
        ),
        // a second derivative is a state of its own
        (
            "a.jl",
            "@parameters k c\n@variables t x(t)\nD = Differential(t)\neqs = [D(D(x)) ~ -k*x - c*D(x)]\nmeasured_quantities = [y ~ D(x)]",
            &[("x", 2.0), ("x_t", 5.0), ("k", 3.0), ("c", 7.0)],
            &[("x", 5.0), ("x_t", -41.0)],
            &[5.0],
        ),
        (
            "a.jl",
            "@parameters k\n@variables t x(t)\nD2 = Differential(t)^2\neqs = [D2(x) ~ -k*x]",
            &[("x", 2.0), ("x_t", 5.0), ("k", 3.0)],
            &[("x", 5.0), ("x_t", -6.0)],
            &[],
        ),
        // an observer has states, and is no list of outputs
        (
            "a.jl",
            "@parameters k L\n@variables t x(t) xh(t) y(t)\nD = Differential(t)\nplant = [D(x) ~ -k*x]\nobserver = [D(xh) ~ -k*xh + L*(x - xh)]\nmeasured_quantities = [y ~ x - xh]",
            &[("x", 2.0), ("xh", 5.0), ("k", 3.0), ("L", 7.0)],
            &[("x", -6.0), ("xh", -36.0)],
            &[-3.0],
        ),
        // the lists of the system, and no others
        (
            "a.jl",
            "@parameters k\n@variables t x(t) z(t)\nD = Differential(t)\na = [D(x) ~ -k*x]\nb = [D(z) ~ x]\nc = [D(z) ~ -z]\neqs = [a; b]\n@named sys = ODESystem(eqs, t)",
            &[("x", 2.0), ("z", 5.0), ("k", 3.0)],
            &[("x", -6.0), ("z", 2.0)],
            &[],
        ),
    ]);
}

#[test]
fn scripts_of_matlab_are_read_for_what_they_mean() {
    agree(&[
        // entry by entry: [k1*1 k2*2; k3*3 k4*4]*[x1; x2]
        (
            "a.m",
            "syms x1 x2 k1 k2 k3 k4\nx = [x1; x2]; p = [k1; k2; k3; k4];\nA = [k1 k2; k3 k4] .* [1 2; 3 4];\nf = A*x; h = x1;\n",
            &[("x1", 2.0), ("x2", 3.0), ("k1", 5.0), ("k2", 7.0), ("k3", 11.0), ("k4", 13.0)],
            &[("x1", 5.0 * 2.0 + 14.0 * 3.0), ("x2", 33.0 * 2.0 + 52.0 * 3.0)],
            &[2.0],
        ),
        // a row by a column is a matrix
        (
            "a.m",
            "syms x1 x2 k1 k2\nx = [x1; x2]; p = [k1; k2];\nf = [-k1*x1; -k2*x2]; h = [k1 k2] ./ x;\n",
            &[("x1", 2.0), ("x2", 4.0), ("k1", 8.0), ("k2", 12.0)],
            &[("x1", -16.0), ("x2", -48.0)],
            &[4.0, 6.0, 2.0, 3.0],
        ),
        // two symbols, and a number as a text
        (
            "a.m",
            "syms x1 x2\nx = [x1; x2]; k = sym('k', [2 1]); p = k;\nf = -k.*x*sym('1/2'); h = x(2);\n",
            &[("x1", 2.0), ("x2", 4.0), ("k1", 8.0), ("k2", 12.0)],
            &[("x1", -8.0), ("x2", -24.0)],
            &[4.0],
        ),
        // what is assigned behind the one that saves belongs to no model
        (
            "a.m",
            "syms x1 x2 k\nx = [x1; x2]; p = k; u = []; w = [];\nf = [-k*x1; k*x1]; h = x1;\nsave('m', 'x', 'p', 'h', 'f', 'u', 'w');\nh = x2; f = [x2; x1];\n",
            &[("x1", 2.0), ("x2", 4.0), ("k", 3.0)],
            &[("x1", -6.0), ("x2", 6.0)],
            &[2.0],
        ),
        // the longest side of two rows of three
        (
            "a.m",
            "syms x1 k\nx = x1; p = k;\nn = length(zeros(2, 3)); m = numel(zeros(2, 3));\nf = -k*x1*n + m; h = x1;\n",
            &[("x1", 2.0), ("k", 5.0)],
            &[("x1", -24.0)],
            &[2.0],
        ),
        // a function of rates, as MATLAB's solvers take them
        (
            "a.m",
            "function dx = rhs(t, x, p)\nk = p(1);\ndx = zeros(2, 1);\ndx(1) = -k*x(1)*t;\ndx(2) = k*x(1) - p(2)*x(2);\nend\n",
            &[("x1", 2.0), ("x2", 5.0), ("p1", 3.0), ("p2", 7.0), ("t", 11.0)],
            &[("x1", -66.0), ("x2", -29.0), ("t", 1.0)],
            &[11.0],
        ),
        // the first element of a number is that number
        (
            "a.m",
            "syms x1 S0\nx = x1; p = S0;\nS = S0*2;\nf = -x1*S(1); h = x1;\n",
            &[("x1", 2.0), ("S0", 5.0)],
            &[("x1", -20.0)],
            &[2.0],
        ),
    ]);
}

#[test]
fn scripts_of_python_are_read_for_what_they_mean() {
    const VALUES: Values = &[("x1", 2.0), ("x2", 5.0), ("k", 3.0), ("c", 7.0)];
    macro_rules! script {
        ($rest:expr) => {
            concat!("import sympy as sym\nimport numpy as np\nx1, x2, k, c = sym.symbols('x1 x2 k c')\np = [k, c]\n", $rest)
        };
    }
    agree(&[
        // lists that grow, one behind the other, several times
        (
            "a.py",
            script!("x = [x1]\nx.append(x2)\nh = [x1]\nh.extend([x2])\nf = [-k*x1]\nf.append(k*x1 - x2)\n"),
            VALUES,
            &[("x1", -6.0), ("x2", 1.0)],
            &[2.0, 5.0],
        ),
        (
            "a.py",
            script!("x = [x1, x2]\nh = [x1] + [x2]\nf = [-k*x1]*2\n"),
            VALUES,
            &[("x1", -6.0), ("x2", -6.0)],
            &[2.0, 5.0],
        ),
        // two names of one list
        (
            "a.py",
            script!("x = [x1, x2]\nr = [k*x1, c*x2]\nf = r\nr[0] = -5*x1\nh = [x1]\n"),
            VALUES,
            &[("x1", -10.0), ("x2", 35.0)],
            &[2.0],
        ),
        (
            "a.py",
            script!("x = [x1, x2]\na = b = k*x1\nf = [-a, b]\nh = [x[1]]\n"),
            VALUES,
            &[("x1", -6.0), ("x2", 6.0)],
            &[5.0],
        ),
        // a matrix of two rows
        (
            "a.py",
            script!(
                "x = sym.Matrix([x1, x2])\nA = sym.Matrix([[k, c], [1, 2]])\nf = A*x\nh = [A[0, 1]*x[0], A.T[0, 1]]\n"
            ),
            VALUES,
            &[("x1", 41.0), ("x2", 12.0)],
            &[14.0, 1.0],
        ),
        // arrays of numpy, entry by entry
        (
            "a.py",
            script!(
                "x = [x1, x2]\nA = np.array([[k, c], [1, 2]])*np.array([[x1, x2], [x2, x1]])\nf = [A[0, 0] + A[0, 1], A[1][0] + A[1, 1]]\nh = [x[-1]]\n"
            ),
            VALUES,
            &[("x1", 41.0), ("x2", 9.0)],
            &[5.0],
        ),
        // a list that was an element of another one, and is another list now
        (
            "a.py",
            script!("x = [x1, x2]\nrow = [x1]\nh = [row, [x2]]\nrow = [k*x1]\nrow.append(c*x2)\nf = row\n"),
            VALUES,
            &[("x1", 6.0), ("x2", 35.0)],
            &[2.0, 5.0],
        ),
        // numbers of SymPy
        (
            "a.py",
            script!(
                "x = [x1, x2]\nf = [sym.Rational('1/2')*x1 + sym.Integer(3), sym.S('1/5')*x2 + sym.Float('0.5', 20)]\nh = [x1*sym.S('2')]\n"
            ),
            VALUES,
            &[("x1", 4.0), ("x2", 1.5)],
            &[4.0],
        ),
        (
            "a.py",
            script!("x = [[x1], [x2]]\nf = [[sym.factor(k*x1)], [sym.S(2)*c]]\nh = [x[0][0]]\n"),
            VALUES,
            &[("x1", 6.0), ("x2", 14.0)],
            &[2.0],
        ),
    ]);
}

/// What is written means what was read: brackets stay, numbers can be read back, cases exist at the values of the file.
#[test]
fn what_is_written_is_what_was_read() {
    for (name, text, wanted) in [
        ("a.txt", "x' = Mul(Add(Add(Symbol('a'), Symbol('b'))), Symbol('x'))", "x' = (a + b)*x"),
        ("a.txt", "x' = -x**2e-9", "x' = -x^(2e-9)"),
        ("a.txt", "x' = Piecewise((2*x, x >= x), (0, True))", "x' = 2*x"),
        ("a.txt", "x' = Piecewise((2*x, x > x), (3*x, True))", "x' = 3*x"),
    ] {
        let read = import(name, text, &ImportQuestion::default()).unwrap();
        assert!(read.text.contains(wanted), "{text}\n{}", read.text);
    }
}

/// A case is written by `sign` only where its sides are equal on a thin set alone: `sign` has no value where its argument is zero.
#[test]
fn cases_have_values_on_all_but_thin_sets() {
    let flag = "a = Piecewise((1, x > 1), (0, True))\n";
    for (name, text, wanted) in [
        (
            "a.jl",
            "@ODEmodel(x'(t) = ifelse(max(x(t)-1,0) > 0, -k*x(t), -c), y(t) = x(t))".to_owned(),
            "x' = (-k*x - c)/2 + sign(x - 1)*(-k*x + c)/2",
        ),
        (
            "a.jl",
            "@ODEmodel(x'(t) = ifelse(B < max(B,A), -k*x(t), -c), y(t) = x(t))".to_owned(),
            "sign(A - B)",
        ),
        (
            "a.jl",
            "@ODEmodel(x'(t) = ifelse(A >= max(B,A), k, c*x(t)), y(t) = x(t))".to_owned(),
            "sign(A - B)",
        ),
        (
            "a.jl",
            "@ODEmodel(x'(t) = ifelse(min(x(t), B) < B, k, c*x(t)), y(t) = x(t))".to_owned(),
            "sign(B - x)",
        ),
        (
            "a.jl",
            "@ODEmodel(x'(t) = k*sign(max(x(t)-1,0)), y(t) = x(t))".to_owned(),
            "k*(1/2 + sign(x - 1)/2)",
        ),
        (
            "a.jl",
            "@ODEmodel(x'(t) = ifelse(abs(max(x(t)-1,0)) > 0, k, c*x(t)), y(t) = x(t))".to_owned(),
            "sign(x - 1)",
        ),
        // what is never less, and is equal on half of the space
        ("a.jl", "@ODEmodel(x'(t) = ifelse(max(x(t), 0) >= 0, k, c), y(t) = x(t))".to_owned(), "x' = k\n"),
        (
            "a.txt",
            format!("{flag}x' = Piecewise((k*x, a > 0), (c, True))\noutputs: x"),
            "x' = (k*x + c)/2 + sign(x - 1)*(k*x - c)/2",
        ),
        (
            "a.txt",
            format!("{flag}x' = Piecewise((k*x, a <= 0), (c, True))\noutputs: x"),
            "x' = (c + k*x)/2 + sign(x - 1)*(c - k*x)/2",
        ),
        (
            "a.txt",
            format!(
                "{flag}b = Piecewise((1, x < 3), (0, True))\nx' = Piecewise((k*x, a*b > 0), (c, True))\noutputs: x"
            ),
            "sign(a*b - 0.5)",
        ),
        (
            "a.txt",
            format!(
                "{flag}b = Piecewise((1, x < 3), (0, True))\nx' = Piecewise((k*x, a + b < 2), (c, True))\noutputs: x"
            ),
            "sign(1.5 - (a + b))",
        ),
        // equal on a thin set alone
        (
            "a.txt",
            "x' = Piecewise((k*x, max(x, 0) > c), (c, True))\noutputs: x".to_owned(),
            "sign(max(x, 0) - c)",
        ),
        ("a.txt", "x' = Piecewise((k*x, abs(x) > 0), (c, True))\noutputs: x".to_owned(), "sign(abs(x))"),
    ] {
        let read = import(name, &text, &ImportQuestion::default())
            .unwrap_or_else(|why| panic!("{}; {}\n{text}", why.message, why.help.unwrap_or_default()));
        assert!(read.text.contains(wanted), "{text}\n{}", read.text);
    }
}

/// Words that ask something of a model are no names: they are renamed, and what is written can be read.
#[test]
fn words_that_ask_are_renamed() {
    for word in
        ["observable", "unobservable", "identifiable", "unidentifiable", "solutions", "codistribution"]
    {
        let declared =
            format!("system \"a\"\n\nstate {word}\n\ndrift f\n  {word}' = -{word}\n\noutput {word}\n");
        let read = palmistry_lang::System::parse("a.proof", &declared, std::path::Path::new(""));
        assert!(read.is_err(), "'{word}' is a name: take it out of the list\n{declared}");
        let text = format!("{word}' = -k*{word}\noutputs: {word}");
        let read = import("a.txt", &text, &ImportQuestion::default()).unwrap();
        assert!(read.text.contains(&format!("state {word}_\n")), "{}", read.text);
        let text = format!("x' = -{word}*x\noutputs: x");
        let read = import("a.txt", &text, &ImportQuestion::default()).unwrap();
        assert!(read.text.contains(&format!("x' = -{word}_*x\n")), "{}", read.text);
    }
}

/// What is assumed is said.
#[test]
fn what_is_assumed_is_said() {
    for (name, text, remark) in [
        ("a.txt", "X' = -k*x\noutputs: X", "'x' is taken to be a parameter: the state is 'X'"),
        (
            "a.txt",
            "x' = -k*x + c\noutputs: x\nparameters: k",
            "known constants, not in the list of parameters: c",
        ),
        ("a.jl", "@ODEmodel(x'(t) = u(t), y(t) = u(t))", "outputs that are inputs, and measure no state: u"),
        (
            "a.jl",
            "@parameters k\n@variables t x(t) z(t)\nD = Differential(t)\na = [D(x) ~ -k*x]\nb = [D(z) ~ -z]",
            "several lists are read as one system: a, b",
        ),
        (
            "a.m",
            "function dx = lin(t, x)\ndx = -x;\nend\n",
            "used as a whole, and read as one number each: 'x'",
        ),
        (
            "a.m",
            "function dx = lin(t, x, k)\ndx = [-k*x(1); k*x(1) - x(2)];\nend\n",
            "used as a whole, and read as one number each: 'k'",
        ),
    ] {
        let read = import(name, text, &ImportQuestion::default()).unwrap();
        assert!(read.text.contains(remark), "{text}\n{}", read.text);
    }
}
