//! Foreign files that cannot be read for what they mean are refused: at the right place, with what to write.

use palmistry_import::{ImportQuestion, import};

/// What has to be said, where (line and column), and a word of the advice.
type Case = (&'static str, &'static str, &'static str, (usize, usize), &'static str);

fn all_refused(cases: &[Case]) {
    for (name, text, message, place, advice) in cases {
        match import(name, text, &ImportQuestion::default()) {
            Ok(read) => panic!("{text}\nis read as\n{}", read.text),
            Err(why) => {
                let help = why.help.clone().unwrap_or_default();
                assert!(why.message.contains(message), "{text}\n{}", why.message);
                assert_eq!(why.line_and_column(), *place, "{text}\n{}", why.message);
                assert!(help.contains(advice), "{text}\n{}; {help}", why.message);
            }
        }
    }
}

#[test]
fn formulas() {
    all_refused(&[
        (
            "a.txt",
            "Eq(Derivative(x(t), t), -k*x(t) + u(t))",
            "'u' is a function of time, and has no equation",
            (1, 35),
            "inputs: u",
        ),
        (
            "a.txt",
            "[diff(x1(t), t) = -k*x1(t) + u(t),\ny(t) = x1(t)]",
            "'u' is a function of time",
            (1, 30),
            "inputs: u",
        ),
        ("a.txt", "x' = -k(t)*x", "'k' is a function of time", (1, 7), "a constant is written k"),
        (
            "a.txt",
            "Eq(Derivative(x(t), (t, 2)), -w*x(t))",
            "a second derivative",
            (1, 4),
            "x' = v and v' = ...",
        ),
        ("a.txt", "x'' = -x", "a second derivative", (1, 1), "x' = v"),
        ("a.txt", "d2x/dt2 = -x", "a second derivative", (1, 1), "x' = v"),
        (
            "a.txt",
            "dx/dt = -a*x + b*S(x - c)",
            "the function 'S' has no counterpart",
            (1, 18),
            "what can be read",
        ),
        ("a.txt", "S' = r*S(1 - S/K)", "'S' is no function", (1, 8), "S*(...)"),
        ("a.txt", "S' = -S(t - tau)", "delays are not read", (1, 7), "delays"),
        ("a.txt", "x' = -k*x²", "'²' is no power", (1, 10), "x^2"),
        ("a.txt", "x' = -e^(-x)", "'e' may be Euler's number", (1, 7), "exp"),
        // names of numbers and of functions, that are no parameters of those names
        ("a.txt", "x' = k*exp^(-x)", "'exp' is a function", (1, 8), "exp(...)"),
        ("a.txt", "x' = sin^2*x", "'sin' is a function", (1, 6), "parameters: sin"),
        ("a.txt", "x' = x + max*x", "'max' is a function", (1, 10), "max(...)"),
        ("a.txt", "x' = ℯ**(-x)", "'ℯ' may be Euler's number", (1, 6), "exp(1)"),
        ("a.txt", "x' = ⅈ*x", "'ⅈ' may be the imaginary unit", (1, 6), "complex"),
        ("a.txt", "x' = Pi*x", "'Pi' may be the number pi", (1, 6), "write pi"),
        ("a.txt", "x' = x*M_PI", "'M_PI' may be the number pi", (1, 8), "write pi"),
        ("a.txt", "x' = NaN*x", "'NaN' is no number", (1, 6), "what is meant"),
        ("a.txt", "x' = x\noutputs: Infinity*x", "'Infinity' is no number", (2, 10), "what is meant"),
        ("a.txt", "x' = -t*x + time", "both may be time", (1, 1), "parameters: time"),
        ("a.txt", "x' = Integer(2.7)*x", "cuts off", (1, 6), "Rational"),
        // conditions that are no such beside '&', and sides that are equal on an open set
        ("a.txt", "x' = 2*x if x > 0 & x < 1 else k", "this is no condition", (1, 17), "(x > 0) & (x < 1)"),
        (
            "a.txt",
            "x' = Piecewise((k*x, x + abs(x) > 0), (c, True))\noutputs: x",
            "equal on more than a thin set",
            (1, 17),
            "x > 1",
        ),
        ("a.txt", "x' = sign(x + abs(x))\noutputs: x", "equal on more than a thin set", (1, 6), "x > 1"),
        // what no proof file says stands where the expression does
        ("a.txt", "y = 2*x\nx' = -y + x^1001\noutputs: x", "no proof file", (2, 6), "x^1001"),
        ("a.txt", "x' = sqrt(-1)*x", "no proof file", (1, 6), "sqrt(-1)"),
        ("a.txt", "z = 1/0\nx' = -x*z", "divides by zero", (1, 7), "real and finite"),
        ("a.txt", "x' = x*I", "'I' may be the imaginary unit", (1, 8), "complex"),
        ("a.txt", "x' = -k*x + sinx", "'sinx' may be a function of 'x'", (1, 13), "sin(x)"),
        ("a.txt", "x' = 2x", "expected the end of the line", (1, 7), "'*'"),
        (
            "a.txt",
            "states: x1, x2\nf = [x2, -k*x1]\ng = [0, 1]\nh = [x1]",
            "nothing says what the vector 'g' is",
            (3, 1),
            "one of outputs h",
        ),
        ("a.txt", "x' = -k*x\noutputs: x, q", "'q' stands in no equation", (2, 13), "parameters: q"),
        ("a.txt", "x' = -k*x\noutputs: x\nknown: kk", "'kk' stands in no equation", (3, 8), "perhaps 'k'"),
        ("a.txt", "x' = -k*x\noutputs: x\nparameters: q", "'q' stands in no equation", (3, 13), "k, x"),
        ("a.txt", "x' = -k*x + u\ninputs: v\noutputs: x", "'v' stands in no equation", (2, 9), "u"),
    ]);
}

#[test]
fn models_of_julia() {
    all_refused(&[
        // nothing is run: what is assigned to a declared name is no longer the symbol, and equations that are changed are others
        (
            "a.jl",
            "@parameters k c\n@variables t x(t) y(t) r(t)\nD = Differential(t)\nr = k*x\neqs = [D(x) ~ -r, D(y) ~ r - c*y]",
            "'r' is declared, and something else is assigned",
            (4, 1),
            "r ~ ...",
        ),
        (
            "a.jl",
            "@parameters k c\n@variables t x(t) y(t) r(t)\nD = Differential(t)\nk = 2.0\neqs = [D(x) ~ -k*x]",
            "'k' is declared, and something else is assigned",
            (4, 1),
            "@parameters k = 2.0",
        ),
        (
            "a.jl",
            "@parameters k c\n@variables t x(t) y(t) r(t)\nD = Differential(t)\na = k = 2.0\neqs = [D(x) ~ -k*x]",
            "'k' is declared, and something else is assigned",
            (4, 5),
            "@parameters k = 2.0",
        ),
        (
            "a.jl",
            "@parameters k c\n@variables t x(t) y(t) r(t)\nD = Differential(t)\nk, c = 2.0, 3.0\neqs = [D(x) ~ -k*x]",
            "'k' is declared, and something else is assigned",
            (4, 1),
            "@parameters k = 2.0",
        ),
        (
            "a.jl",
            "@parameters k c\n@variables t x(t) y(t) r(t)\nD = Differential(t)\nk *= 2\neqs = [D(x) ~ -k*x]",
            "'k' is declared, and something else is assigned",
            (4, 1),
            "@parameters k = 2.0",
        ),
        (
            "a.jl",
            "@parameters k c\n@variables t x(t) y(t) r(t)\nD = Differential(t)\nq = k*x\neqs = [D(x) ~ -q]",
            "'q' is assigned to in the file",
            (5, 16),
            "in its place",
        ),
        (
            "a.jl",
            "@parameters k c\n@variables t x(t) y(t) r(t)\nD = Differential(t)\neqs = [D(x) ~ -k*x]\neqs = substitute(eqs, Dict(k => 2.0))\n@named sys = ODESystem(eqs, t)",
            "these equations are no list",
            (5, 7),
            "vcat(a, b)",
        ),
        (
            "a.jl",
            "@parameters k c\n@variables t x(t) y(t) r(t)\nD = Differential(t)\neqs = [D(x) ~ -k*x]\n@named sys = ODESystem(substitute(eqs, Dict(k => 2.0)), t)",
            "these equations are no list",
            (5, 24),
            "vcat(a, b)",
        ),
        (
            "a.jl",
            "@parameters k c\n@variables t x(t) y(t) r(t)\nD = Differential(t)\neqs = [D(x) ~ -k*x, D(y) ~ -y]\n@named sys = ODESystem(eqs[1:1], t)",
            "these equations are no list",
            (5, 24),
            "vcat(a, b)",
        ),
        (
            "a.jl",
            "@parameters k c\n@variables t x(t) y(t) r(t)\nD = Differential(t)\neqs = [D(x) ~ -k*x]\neqs = reverse(eqs)",
            "these equations are no list",
            (5, 7),
            "vcat(a, b)",
        ),
        (
            "a.jl",
            "@parameters k c\n@variables t x(t) y(t) r(t)\nD = Differential(t)\neqs = [D(x) ~ -k*x]\nmore = [D(y) ~ -y]\nappend!(eqs, more)\n@named sys = ODESystem(eqs, t)",
            "'eqs' are changed by 'append!'",
            (6, 9),
            "vcat(a, b)",
        ),
        (
            "a.jl",
            "@parameters k c\n@variables t x(t) y(t) r(t)\nD = Differential(t)\neqs = [D(x) ~ -k*x]\nother = eqs[1]\neqs[1] = other\n@named sys = ODESystem(eqs, t)",
            "'eqs' are changed by an assignment to an element",
            (6, 1),
            "vcat(a, b)",
        ),
        (
            "a.jl",
            "@parameters k c\n@variables t x(t) y(t) r(t)\nD = Differential(t)\neqs = [D(x) ~ -k*x]\nmeasured_quantities = [z ~ x]\nmeasured_quantities = substitute(measured_quantities, Dict(x => y))",
            "these equations are no list",
            (6, 23),
            "vcat(a, b)",
        ),
        (
            "a.jl",
            "@ODEmodel(x'(t) = -x(t) + sin(t), y(t) = x(t))",
            "time stands by itself",
            (1, 31),
            "time'(t) = 1",
        ),
        ("a.jl", "@ODEmodel(x'(t) = x(t - 1), y(t) = x(t))", "delays are not read", (1, 19), "delays"),
        ("a.jl", "@ODEmodel(x'(t) = π*x(t), y(t) = x(t))", "'π' is a number in Julia", (1, 19), "4*atan(1)"),
        ("a.jl", "@ODEmodel(x'(t) = im*x(t), y(t) = x(t))", "'im' is a number in Julia", (1, 19), "complex"),
        ("a.jl", "@ODEmodel(x'(t) = -x(t), y(t) = z(t))", "the output is 'z'", (1, 33), "formula"),
        (
            "a.jl",
            "inv(v) = v^2\nm = @ODEmodel(x'(t) = inv(x(t)), y(t) = x(t))",
            "'inv' is a function that the file defines",
            (2, 23),
            "formula",
        ),
        (
            "a.jl",
            "@parameters k\n@variables t x(t)\nD = Differential(t)\nS(v) = v\neqs = [D(x) ~ S(x)]",
            "'S' is a function that the file defines",
            (5, 15),
            "formula",
        ),
        (
            "a.jl",
            "@parameters k\n@variables t x(t)\nD = Differential(t)\neqs = [D(x) ~ -k*x(t - 1)]",
            "delays are not read",
            (4, 18),
            "delays",
        ),
        (
            "a.jl",
            "@parameters k\n@variables t S(t)\nD = Differential(t)\neqs = [D(S) ~ k*S(1 - S)]",
            "something else stands in its bracket",
            (4, 17),
            "S*(...)",
        ),
        (
            "a.jl",
            "@parameters k\n@variables t x(t)\nD = Differential(t)\neqs = [log(x) ~ -k*x]",
            "the left side is no derivative",
            (4, 8),
            "D(x)",
        ),
        (
            "a.jl",
            "@parameters k\n@variables t x(t) u(t)\nD = Differential(t)\neqs = [D(x) ~ -k*x + u]\nev = [[10.0] => [u ~ 3.0]]",
            "events are not read",
            (5, 20),
            "jumps",
        ),
        (
            "a.jl",
            "@parameters k\n@variables t x(t) z(t)\nD = Differential(t)\na = [D(x) ~ -k*x]\nb = [D(z) ~ -z]\n@named s1 = ODESystem(a, t)\n@named s2 = ODESystem(b, t)",
            "the file has 2 systems",
            (7, 13),
            "1 's1' of a, 2 's2' of b",
        ),
        (
            "a.jl",
            "@parameters k\n@variables t x(t)\nD = Differential(t)\neqs = [D(x) ~ -k*x]\npush!(eqs, D(x) ~ 3)",
            "an equation outside of a list",
            (5, 17),
            "lists",
        ),
    ]);
}

#[test]
fn scripts() {
    all_refused(&[
        // lists that are changed within expressions, and by other names
        (
            "a.py",
            "import sympy as sym\nfrom random import shuffle\nimport numpy as np\nx1, x2, a, b = sym.symbols('x1 x2 a b')\nx = [x1, x2]\np = [a, b]\nf = [a*x1, b*x2]\nh = [x1, x2]\nlast = h.pop()",
            "changed by 'pop' within an expression",
            (9, 8),
            "whole list",
        ),
        (
            "a.py",
            "import sympy as sym\nfrom random import shuffle\nimport numpy as np\nx1, x2, a, b = sym.symbols('x1 x2 a b')\nx = [x1, x2]\np = [a, b]\nf = [a*x1, b*x2]\nh = [x1]\nz = h.append(x2)",
            "changed by 'append' within an expression",
            (9, 5),
            "whole list",
        ),
        (
            "a.py",
            "import sympy as sym\nfrom random import shuffle\nimport numpy as np\nx1, x2, a, b = sym.symbols('x1 x2 a b')\nx = [x1, x2]\np = [a, b]\nf = [a*x1, b*x2]\nh = [x1]\nprint(h.pop())",
            "changed by 'pop' within a line",
            (9, 9),
            "whole list",
        ),
        (
            "a.py",
            "import sympy as sym\nfrom random import shuffle\nimport numpy as np\nx1, x2, a, b = sym.symbols('x1 x2 a b')\nx = [x1, x2]\np = [a, b]\nf = [[a*x1], [b*x2]]\nrow = [x1]\nh = [row, [x2]]\nrow[0] = x1*x2",
            "'row' is changed here, and is an element",
            (10, 1),
            "whole lists",
        ),
        (
            "a.py",
            "import sympy as sym\nfrom random import shuffle\nimport numpy as np\nx1, x2, a, b = sym.symbols('x1 x2 a b')\nx = [x1, x2]\np = [a, b]\nf = [[a*x1], [b*x2]]\nrow = [x1]\nother = row\nh = []\nh.append(row)\nother.append(x2)",
            "'other' is changed here, and is an element",
            (12, 1),
            "whole lists",
        ),
        (
            "a.py",
            "import sympy as sym\nfrom random import shuffle\nimport numpy as np\nx1, x2, a, b = sym.symbols('x1 x2 a b')\nx = [x1, x2]\np = [a, b]\nf = [[a*x1], [b]]\nr = f[0]\nr[0] = b\nh = [x1]",
            "'r' is changed here, and is an element",
            (9, 1),
            "whole lists",
        ),
        (
            "a.py",
            "import sympy as sym\nfrom random import shuffle\nimport numpy as np\nx1, x2, a, b = sym.symbols('x1 x2 a b')\nx = [x1, x2]\np = [a, b]\nf = [[a*x1], [b]]\nf[0].append(x2)\nh = [x1]",
            "changed by 'append' within an expression",
            (8, 1),
            "whole list",
        ),
        (
            "a.py",
            "import sympy as sym\nfrom random import shuffle\nimport numpy as np\nx1, x2, a, b = sym.symbols('x1 x2 a b')\nx = [x1, x2]\np = [a, b]\nf = [a*x1, b]\nshuffle(f)\nh = [x1]",
            "'f' may be changed by 'shuffle'",
            (8, 1),
            "whole list",
        ),
        (
            "a.py",
            "import sympy as sym\nfrom random import shuffle\nimport numpy as np\nx1, x2, a, b = sym.symbols('x1 x2 a b')\nx = [x1, x2]\np = [a, b]\nA = np.array([[a, b], [x1, x2]])\nr = A[0]\nA[0, 0] = x2\nf = [r[0], r[1]]\nh = [x1]",
            "'A' is changed here, and is an element",
            (9, 1),
            "whole lists",
        ),
        (
            "a.py",
            "import sympy as sym\nfrom random import shuffle\nimport numpy as np\nx1, x2, a, b = sym.symbols('x1 x2 a b')\nx = [x1, x2]\np = [a, b]\nf, h = [a*x1], [x1]\nh.append(x2)",
            "several lists are assigned to several names",
            (7, 8),
            "an assignment each",
        ),
        (
            "a.py",
            "import sympy as sym\nfrom random import shuffle\nimport numpy as np\nx1, x2, a, b = sym.symbols('x1 x2 a b')\nx = [x1, x2]\np = [a, b]\nf = [sym.Integer(2.7)*x1, b]\nh = [x1]",
            "cuts off",
            (7, 6),
            "Rational",
        ),
        (
            "a.py",
            "import sympy as sym\nfrom random import shuffle\nimport numpy as np\nx1, x2, a, b = sym.symbols('x1 x2 a b')\nx = [x1, x2]\np = [a, b]\nf = [sym.Float('2.7182818', 3)*x1, b]\nh = [x1]",
            "of so few digits",
            (7, 6),
            "all digits",
        ),
        // arguments as a whole, that may be matrices
        (
            "a.m",
            "function dx = lin(t, x, A, B)\ndx = A*x + B;\nend\n",
            "'x' and 'A' are used as a whole",
            (1, 1),
            "A(1)",
        ),
        (
            "a.m",
            "function dx = lin(t, x)\ndx = [1 -1]*x*[1;1];\nend\n",
            "'x' is used as a whole beside a matrix",
            (2, 6),
            "x(1)",
        ),
        (
            "a.m",
            "function dx = lin(t, x, A)\nC = 2*A;\ndx = C*[x(1); x(2)];\nend\n",
            "'C' is used as a whole beside a matrix",
            (3, 6),
            "p(1)",
        ),
        (
            "a.m",
            "syms x1 a\nx = x1; p = a;\nf = S(x1 - a); h = x1;\n",
            "the function 'S' has no counterpart",
            (3, 5),
            "what can be read",
        ),
        (
            "a.m",
            "syms x1 k\nx = x1; p = k; y = k;\nfor i = [1; 2; 3]\ny = y*i;\nend\nf = -x1*y; h = x1;\n",
            "a loop goes through columns",
            (3, 9),
            "1:3",
        ),
        (
            "a.m",
            "syms x1 k\nx = x1; p = k;\nf = -k*x1; h = x1;\neval('f = k;')\n",
            "'eval' is not read",
            (4, 1),
            "plain assignments",
        ),
        (
            "a.m",
            "function dx = rhs(t, x)\nA = [1 2; 3 4];\ndx = A*x;\nend\n",
            "'x' is used as a whole beside a matrix",
            (3, 6),
            "x(1)",
        ),
        (
            "a.m",
            "function dx = rhs(t, x)\ndx = [x(2); x(3)];\nend\n",
            "x(3) is used, and there are 2 rates",
            (1, 1),
            "each state",
        ),
        ("a.m", "syms x1 k t\nx = x1; p = k;\nf = -k*x1*sin(t); h = x1;\n", "'t' is time", (3, 15), "rate 1"),
        (
            "a.m",
            "syms x1 k\nk = 3;\nx = x1; p = k;\nf = -k*x1; h = x1;\n",
            "'k' has a value above",
            (3, 13),
            "symbols alone",
        ),
        (
            "a.py",
            "import sympy as sym\nx1, x2 = sym.symbols('x1 x2')\nx = [x1, x2]\nf = [x2, x1]\nh = [x1, x2]\nh.pop()\n",
            "'h' is changed by 'pop'",
            (6, 1),
            "at once",
        ),
        (
            "a.py",
            "import sympy as sym\nx1 = sym.symbols('x1')\nx = [x1]\nf = [x1]\nh = [x1]\nexec('h = []')\n",
            "'exec' is not read",
            (6, 1),
            "plain assignments",
        ),
        (
            "a.py",
            "import sympy as sym\nfrom mylib import S\nx1 = sym.symbols('x1')\nx = [x1]\nf = [S(x1)]\nh = [x1]\n",
            "'S' comes from 'mylib'",
            (5, 6),
            "formula",
        ),
        (
            "a.py",
            "import sympy as sym\nx1 = sym.symbols('x1')\nmu = sym.Function('mu')(x1)\nx = [x1]\nf = [mu*x1]\nh = [x1]\n",
            "'mu' is a function that nothing defines",
            (3, 6),
            "formula",
        ),
    ]);
}

/// What was asked for and is not there is said, whatever the format.
#[test]
fn questions() {
    let ask = |name: &str, text: &str, question: ImportQuestion| {
        import(name, text, &question).err().map(|why| why.message).unwrap_or_default()
    };
    let model = |name: &str| ImportQuestion { model: Some(name.to_owned()), ..ImportQuestion::default() };
    let twice =
        "ode = @ODEmodel(x'(t) = -a*x(t), y(t) = x(t))\node = @ODEmodel(x'(t) = -b*x(t), y(t) = x(t))";
    assert_eq!(ask("a.jl", twice, model("ode")), "the file has several models 'ode'");
    assert!(import("a.jl", twice, &model("2")).unwrap().text.contains("x' = -b*x"));
    let two = "@parameters k\n@variables t x(t) z(t)\nD = Differential(t)\na = [D(x) ~ -k*x]\nb = [D(z) ~ -z]\n@named s1 = ODESystem(a, t)\n@named s2 = ODESystem(b, t)";
    assert!(import("a.jl", two, &model("s2")).unwrap().text.contains("z' = -z"));
    assert!(!import("a.jl", two, &model("s2")).unwrap().text.contains("x' ="));
    assert_eq!(ask("a.txt", "x' = -k*x", model("3")), "the file has no model '3'");
    assert_eq!(ask("a.m", "syms x1\nx = x1; f = x1; h = x1;", model("3")), "the file has no model '3'");
    let outputs = ImportQuestion { outputs: vec!["q".to_owned()], ..ImportQuestion::default() };
    assert!(ask("a.txt", "x' = -k*x", outputs).contains("'q' stands in no equation"));
    let inputs = ImportQuestion { known_inputs: vec!["u".to_owned()], ..ImportQuestion::default() };
    assert!(import("a.txt", "x' = -k*x + u(t)", &inputs).unwrap().text.contains("known u(t)"));
}

/// Files of formats that are not read are named, with the way to bring them here.
#[test]
fn other_formats() {
    all_refused(&[
        (
            "a.mo",
            "model decay\n Real x(start = 1);\nequation\n der(x) = -k*x;\nend decay;",
            "this looks like Modelica",
            (1, 1),
            "x' = -k*x",
        ),
        ("a.ant", "J0: A -> B; k*A\nA = 10\nk = 0.1\n", "this looks like Antimony", (1, 1), "getSBMLString"),
        (
            "a.txt",
            "model m\n J0: A -> B; k*A;\n A = 10; k = 0.1\nend\n",
            "this looks like Antimony",
            (1, 1),
            "getSBMLString",
        ),
        (
            "a.bngl",
            "begin model\nbegin parameters\n k 1\nend parameters\nend model",
            "this looks like BioNetGen",
            (1, 1),
            "writeSBML",
        ),
        (
            "a.proof",
            "system \"a\"\nstate x\ndrift f\n  x' = -x\noutput x\n",
            "this looks like a proof file",
            (1, 1),
            "no import",
        ),
        ("a.cps", "<?xml version=\"1.0\"?><COPASI></COPASI>", "this looks like COPASI", (1, 1), "SBML"),
        ("a.yaml", "problems:\n- sbml_files: [m.xml]\n", "this looks like YAML", (1, 1), "parameter_file"),
        ("a.tex", "\\dot{x} = -k x", "this looks like LaTeX", (1, 1), "x' = -k*x"),
    ]);
}
