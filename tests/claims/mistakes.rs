//! What people write by the habits of other languages: each mistake has an advice of its own.

use palmistry::System;
use std::path::Path;

const RIGHT: &str = "system \"s\"\nstate phi, omega\nparam k = 2\nangle phi\ndrift f\n  phi' = omega\n  omega' = -k*sin(phi)\noutput phi\n";

/// A text of the right file, what stands in its place, and words of the advice.
const MISTAKES: [(&str, &str, &str); 119] = [
    ("-k*sin", "-k sin", "a product is written with '*', as in k*sin"),
    ("-k*sin", "-2 sin", "a product is written with '*', as in 2*sin"),
    ("-k*sin", "-2k*sin", "a product is written with '*'"),
    ("-k*sin(phi)", "-(k + 1)(k + 2)", "a product is written with '*'"),
    ("-k*sin(phi)", "-k(phi + 1)", "'k' is no function: a product is written with '*', as in k*(...)"),
    ("-k*sin(phi)", "-k*sin phi", "a function has its argument in brackets, as in sin(phi)"),
    ("-k*sin(phi)", "-k*sin^2(phi)", "a power of a function stands behind its brackets, as in sin(x)^2"),
    ("phi' = omega", "phi = omega", "a rate of change is written with a prime, as in phi' = ..."),
    ("omega' =", "omega_dot =", "a rate of change is written with a prime, as in omega' = ..."),
    ("omega' =", "omegadot =", "a rate of change is written with a prime, as in omega' = ..."),
    ("omega' =", "d(omega)/dt =", "a rate of change is written with a prime, as in omega' = ..."),
    ("omega' =", "domega/dt =", "a rate of change is written with a prime, as in omega' = ..."),
    ("omega' =", "omega' :=", "write '=' alone"),
    ("omega' =", "omega' ==", "an equation has one '='"),
    ("omega' =", "phi'' =", "a second derivative needs a state of its own, as in phi' = v"),
    ("omega' =", "omega\u{2032} =", "use the straight mark '"),
    ("omega' =", "omega\u{2019} =", "use the straight mark '"),
    ("-k*sin(phi)", "if omega > 0 then 1 else 2", "there is no 'if'"),
    ("-k*sin(phi)", "1 if omega > 0 else 2", "there is no 'if'"),
    ("-k*sin(phi)", "-k**2*phi", "a power is written with '^'"),
    ("-k*sin(phi)", "-k\u{b2}*phi", "a power is written with '^'"),
    ("-k*sin(phi)", "-k*|omega|", "an absolute value is written abs(x)"),
    ("-k*sin(phi)", "-k*\\sin(phi)", "without the backslash"),
    ("-k*sin(phi)", "-\\frac{k}{2}", "without the backslash"),
    ("-k*sin(phi)", "-k*sin(phi) // gravity", "a comment begins with '#'"),
    ("-k*sin(phi)", "-k*sin(phi) % gravity", "a comment begins with '#'"),
    ("-k*sin(phi)", "-k*sin(phi);", "an entry ends with its line"),
    ("-k*sin(phi)", "-k*e^phi", "Euler's number to a power is written exp(x)"),
    ("-k*sin(phi)", "-k*sin(phi) + u", "'known u(t)' for a signal"),
    ("-k*sin(phi)", "-k*{sin(phi)}", "brackets are ( and )"),
    ("-k*sin(phi)", "-0,5*phi", "a decimal point is written '.'"),
    ("-k*sin(phi)", "\u{2212}k*sin(phi)", "use the minus sign of the keyboard"),
    ("-k*sin(phi)", "-k\u{b7}sin(phi)", "a product is written with '*'"),
    ("-k*sin(phi)", "-k\u{d7}phi", "a product is written with '*'"),
    ("-k*sin(phi)", "-\u{221a}k", "a root is written sqrt(x)"),
    ("sin(phi)", "ln(k)", "it is called 'log'"),
    ("sin(phi)", "arctan(k)", "it is called 'atan'"),
    ("sin(phi)", "sgn(omega)", "it is called 'sign'"),
    ("sin(phi)", "sine(phi)", "perhaps you meant 'sin'"),
    ("omega' =", "d omega/dt =", "a rate of change is written with a prime, as in omega' = ..."),
    ("omega' =", "Derivative(omega, t) =", "a rate of change is written with a prime, as in omega' = ..."),
    ("omega' =", "omega' ->", "write '='"),
    ("omega' =", "omega_ddot =", "a second derivative needs a state of its own, as in omega' = v"),
    ("-k*sin(phi)", "-k*d(phi)/dt", "a derivative along the drift f is L(f, x)"),
    ("-k*sin(phi)", "-k*omega_dot", "the rate of 'omega' has no name"),
    ("-k*sin(phi)", "-k*sgn omega", "a function has its argument in brackets, as in sign(omega)"),
    ("-k*sin(phi)", "-k*sin^2 phi", "a power of a function stands behind its brackets, as in sin(phi)^2"),
    ("-k*sin(phi)", "-1e3k*phi", "a product is written with '*', as in 1e3*k"),
    ("output phi", "output phi\nclaim a: system is observable", "as in observable(x, y), or about the rank"),
    ("-k*sin(phi)", "-k*phi^1/2", "a root is written sqrt(x), or with a bracket, as in x^(1/2)"),
    ("-k*sin(phi)", "-k*sin(phi) + rand()", "nothing is random in a file"),
    ("k = 2", "k = 2 unknown : stiffness", "a unit stands before the word, as in param k = 2 : m/s unknown"),
    ("output phi", "output phi\nsample omega in [-1 to 1]", "the ends of a range have ',' between them"),
    ("\"s\"", "\u{201c}s\u{201d}", "straight quotation marks"),
    ("output phi", "output phi\nclaim a: L(f, phi) == omega", "an equation has one '='"),
    ("output phi", "output phi\nclaim a: L(f, phi) = 0 at omega = 0", "is written with 'where'"),
    ("output phi", "output phi\nsample omega in (-1, 1)", "a range has square brackets"),
    ("output phi", "output phi\nclaim a: k \u{2264} 2", "write '<='"),
    ("output phi", "output phi\nclaim a: rank = infinty", "perhaps you meant 'infinity'"),
    ("output phi", "outptu phi", "perhaps you meant 'output'"),
    ("\"s\"", "s", "a title stands in quotation marks, as in system \"s\""),
    ("drift f\n", "known u(t)\n", "write 'drift f' on the line before phi'"),
    ("output phi", "output y = phi", "let y = ..., and write output y"),
    ("output phi", "output phi\nclaim rank = 2", "as in claim a: rank = ..."),
    ("output phi", "output phi\nsample omega in -1..1", "a range has square brackets"),
    ("-k*sin(phi)", "-k*sin(phi)'", "a derivative along the drift f is L(f, x)"),
    ("-k*sin(phi)", "-k*pow(phi, 2)", "a power is written with '^'"),
    ("-k*sin(phi)", "-k*Sin(phi)", "small letters, 'sin'"),
    ("-k*sin(phi)", "-k*np.sin(phi)", "it is called 'sin' alone"),
    ("-k*sin(phi)", "-k*sin(phi) + w(t)", "'known w(t)' or 'unknown w(t)', and written w"),
    ("-k*sin(phi)", "-k*sin(phi) + t", "time has no name"),
    ("-k*sin(phi)", "-k*heaviside(phi)", "there is no 'if'"),
    ("-k*sin(phi)", "-k*phi)", "this bracket closes none"),
    ("-k*sin(phi)", "-k*sin(phi),", "leave ',' out"),
    ("phi' = omega\n", "phi' = omega;\n", "leave ';' out"),
    ("phi' = omega\n", "phi' <- omega\n", "write '=' alone"),
    ("phi' = omega\n", "\\dot{phi} = omega\n", "without the backslash"),
    ("state phi, omega", "state phi omega", "as in phi, omega"),
    ("state phi, omega", "states phi, omega", "perhaps you meant 'state'"),
    ("state phi, omega", "state: phi, omega", "leave ':' out behind 'state'"),
    ("state phi, omega", "state phi, omega = 0", "initial omega = ..."),
    ("state phi, omega", "state phi(t), omega(t)", "without (t)"),
    ("param k = 2", "parameter k = 2", "it is called 'param'"),
    ("param k = 2", "const k = 2", "it is called 'param'"),
    ("param k = 2", "k = 2", "as in param k = 2"),
    ("param k = 2", "param k := 2", "write '=' alone"),
    ("param k = 2", "param k [1, 2]", "sample k in [1, 2]"),
    ("output phi", "outputs phi", "perhaps you meant 'output'"),
    ("output phi", "measure phi", "output x"),
    ("output phi", "y = phi", "as in output x"),
    ("output phi", "output: phi", "leave ':' out behind 'output'"),
    ("output phi", "output y: phi", "let y = ..., and output y"),
    ("output phi", "output y: 2*phi", "let y = ..., and output y"),
    ("-k*sin(phi)", "-3!*sin(phi)", "there is no factorial"),
    ("-k*sin(phi)", "-2phi + omega", "as in 2*phi"),
    ("-k*sin(phi)", "-k phi + omega", "as in k*phi"),
    ("output phi", "output phi\nclaim a: everywhere = 3", "has no value of its own"),
    ("output phi", "output tank.level", "use tank = "),
    ("-k*sin(phi)", "-k*@phi", "leave '@' out"),
    ("-k*sin(phi)", "-k*phi % 2", "no remainder of a division"),
    ("output phi", "output phi\nclaim a: L(f phi) = omega", "as in (f, phi)"),
    ("output phi", "output phi\nuse other = \"nowhere.proof\"", "the folder of the file that imports"),
    ("drift f\n", "dynamics f\n", "it is called 'drift'"),
    ("drift f\n", "drift f:\n", "leave ':' out behind the name"),
    ("output phi", "output phi\nclaim observable(phi)", "as in claim a: observable"),
    ("output phi", "output phi\nclaim a: observable phi", "stand in brackets"),
    ("output phi", "output phi\nclaim a: phi > 0 and omega > 0", "each is a claim of its own"),
    ("output phi", "output phi\nclaim a: phi > 0 && omega > 0", "each is a claim of its own"),
    ("output phi", "output phi\nclaim a: phi ~ 0", "'within'"),
    ("output phi", "output phi\nclaim a: forall phi: phi^2 >= 0", "leave 'forall' out"),
    ("output phi", "output phi\nclaim a: rank = full", "the number of unknowns"),
    ("output phi", "output phi\nclaim a: identifiable(phi)", "write 'observable'"),
    ("output phi", "output phi\nsample phi = [-1, 1]", "as in phi in [-1, 1]"),
    ("output phi", "output phi\nsample phi from -1 to 1", "as in phi in [-1, 1]"),
    ("output phi", "output phi\nassume k = 2", "with 'param' or 'let'"),
    ("output phi", "output phi\ninitial phi(0) = 1", "initial phi = 1"),
    ("output phi", "output phi\ninput u(t)", "as in known u(t)"),
    ("output phi", "output phi\ninput u\n", "'known u(t)'"),
    ("output phi", "output phi\ndef e = omega^2", "it is called 'let'"),
];

#[test]
fn each_mistake_has_its_advice() {
    assert!(System::parse("s.proof", RIGHT, Path::new("")).is_ok());
    let mut wrong = Vec::new();
    for (right, mistake, advice) in MISTAKES {
        let text = RIGHT.replacen(right, mistake, 1);
        assert_ne!(text, RIGHT, "{right}");
        match System::parse("s.proof", &text, Path::new("")) {
            Ok(_) => wrong.push(format!("{mistake}: is none")),
            Err(error) if error.help.as_ref().is_some_and(|help| help.contains(advice)) => {}
            Err(error) => wrong.push(format!("{mistake}: {}, {:?}", error.message, error.help)),
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Names may be written with Greek letters: they are the names of these, and the constant pi is one.
#[test]
fn greek_letters_are_read_as_their_names() {
    let greek = RIGHT.replace("phi", "\u{3c6}").replace("omega", "\u{3c9}");
    let claims = "claim a: L(f, \u{3c6}) = omega\nclaim b: sin(\u{3c0}) = 0\nlet \u{394}x1 = 2*phi\nclaim c: Deltax1 = 2*\u{3d5}\n";
    let system = System::parse("s.proof", &format!("{greek}{claims}"), Path::new("")).unwrap();
    assert_eq!(system.column_names(), ["phi", "omega"]);
    let found = palmistry::decide_all(&system, 1, &false.into(), &|_| ());
    assert!(found.len() == 3 && found.iter().all(|outcome| outcome.ok), "{found:?}");
    let twice = System::parse("s.proof", "system \"s\" state phi, \u{3c6}", Path::new("")).unwrap_err();
    assert!(twice.message.contains("phi"), "{twice}");
}
