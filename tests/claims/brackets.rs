//! The Lie bracket of two fields, held to what defines it and to examples done by hand; and rows of one entry, which are
//! numbers where a number is meant.

use palmistry::system::Value;
use palmistry::{System, decide_all};
use std::path::Path;

fn system(text: &str) -> System {
    System::parse("test.proof", text, Path::new("")).unwrap_or_else(|error| panic!("{error}: {text}"))
}

/// The verdicts of all claims.
fn words(text: &str) -> Vec<&'static str> {
    decide_all(&system(text), 1, &false.into(), &|_| ()).iter().map(|outcome| outcome.word()).collect()
}

/// What is refused, and why.
fn refusal(text: &str) -> String {
    let error = System::parse("test.proof", text, Path::new("")).unwrap_err();
    format!("{} ({})", error.message, error.help.unwrap_or_default())
}

/// Three systems with three fields each: polynomials, a car (Isidori, Nonlinear Control Systems, 3rd edition, 1995, has it
/// among the examples of chapter 1), and fields with roots, logarithms and parameters.
const SYSTEMS: [&str; 3] = [
    "system \"p\" state x, y, z field f x' = y*z y' = x^2 z' = 3 field g x' = x*y y' = -z^3 z' = x + y + z \
     field h x' = y others' = 0 let e = x*y^2 + z^3*x - y let k = z*y\n",
    "system \"car\" state x, y, theta angle theta param v field f x' = v*cos(theta) y' = v*sin(theta) others' = 0 \
     field g theta' = 1 others' = 0 field h x' = y*sin(theta) y' = x theta' = x*y \
     let e = x*cos(theta) + y^2 let k = x*y*sin(theta)\n",
    "system \"r\" state x, y, z param a, b field f x' = sqrt(y) y' = a*log(x) z' = x*y field g x' = exp(z) y' = x/z z' = b \
     field h x' = a*x y' = y^2 others' = 0 let e = sqrt(x) + y*z let k = x*y/z\n",
];

/// `L_[f,g] e = L_f L_g e - L_g L_f e`: the operator on the right is the definition, and needs no components.
#[test]
fn the_derivative_along_a_bracket_is_the_commutator() {
    for base in SYSTEMS {
        for (f, g) in [("f", "g"), ("g", "h"), ("h", "f")] {
            let text = format!(
                "{base} claim 1: L(bracket({f}, {g}), e) = L({f}, {g}, e) - L({g}, {f}, e)\n\
                 claim 2: L(bracket({f}, {g}), [e, k]) = L({f}, {g}, [e, k]) - L({g}, {f}, [e, k])\n\
                 claim 3: L(bracket({f}, {g}), e) = d(e)*bracket({f}, {g})\n\
                 claim 4: bracket({f}, {g}) = -bracket({g}, {f})\n\
                 claim 5: L({f}, bracket({f}, {g}), {g}, e) = \
                   L({f}, {f}, {g}, {g}, e) - L({f}, {g}, {f}, {g}, e)\n\
                 claim 6 expect refuted: L(bracket({f}, {g}), e) = L({g}, {f}, e) - L({f}, {g}, e)\n"
            );
            assert_eq!(words(&text), ["proved", "proved", "proved", "proved", "proved", "refuted"], "{text}");
        }
    }
}

/// Jacobi's identity, Leibniz's rule, and that a field commutes with itself.
#[test]
fn brackets_are_a_lie_algebra() {
    for base in SYSTEMS {
        let text = format!(
            "{base} claim 1: bracket(f, bracket(g, h)) + bracket(g, bracket(h, f)) + bracket(h, bracket(f, g)) = [0; 0; 0]\n\
             claim 2: L(bracket(f, g), e*k) = e*L(bracket(f, g), k) + k*L(bracket(f, g), e)\n\
             claim 3: bracket(f, f) = [0; 0; 0]\n\
             claim 4: L(bracket(bracket(f, g), h), e) = L(bracket(f, g), h, e) - L(h, bracket(f, g), e)\n"
        );
        assert_eq!(words(&text), ["proved", "proved", "proved", "proved"], "{text}");
    }
}

/// By hand, from `[f, g] = (dg) f - (df) g`: of linear fields `Ax` and `Bx` it is `(BA - AB) x`; and the car, driven and
/// turned, moves sideways: `(dg) f = 0`, `(df) g = (-v sin, v cos, 0)`, so that `[f, g] = (v sin, -v cos, 0)`.
#[test]
fn brackets_done_by_hand() {
    let text = "system \"linear\" state x, y param a, b, c, d, p, q, r, s\n\
         field f x' = a*x + b*y y' = c*x + d*y field g x' = p*x + q*y y' = r*x + s*y\n\
         let A = [a, b; c, d] let B = [p, q; r, s]\n\
         claim 1: bracket(f, g) = (B*A - A*B)*[x; y]\n\
         claim 2 expect refuted: bracket(f, g) = (A*B - B*A)*[x; y]\n";
    assert_eq!(words(text), ["proved", "refuted"]);
    let text = format!(
        "{}claim 1: bracket(f, g) = [v*sin(theta); -v*cos(theta); 0]\nclaim 2: bracket(f, g, y) = -v*cos(theta)\n\
         claim 3: rank([bracket(f, g), [v*cos(theta); v*sin(theta); 0], [0; 0; 1]]) = 3\n\
         claim 4: bracket(f, g, theta, x) = [0; v*sin(theta)]\n\
         claim 5: L(bracket(f, g), x)^2 + L(bracket(f, g), y)^2 = v^2\n",
        SYSTEMS[1]
    );
    assert_eq!(words(&text), ["proved"; 5]);
    // x' = 1 and y' = x: [f, g] = (0, 1), in two numbers that anybody sees
    let text = "system \"s\" state x, y field f x' = 1 others' = 0 field g y' = x others' = 0 claim 1: bracket(f, g) = [0; 1]";
    assert_eq!(words(text), ["proved"]);
}

/// A bracket exists where both fields have derivatives, and a claim says so.
#[test]
fn a_bracket_keeps_the_domain_of_its_fields() {
    let text = "system \"s\" state x, y field f x' = sqrt(y) others' = 0 field g y' = 0*log(x) others' = 0\n\
                claim 1: L(bracket(f, g), x) = 0 claim 2: L(bracket(f, g), y) = 0 claim 3: bracket(f, g) = [0; 0]";
    let outcomes = decide_all(&system(text), 1, &false.into(), &|_| ());
    for outcome in &outcomes {
        assert_eq!(outcome.word(), "proved");
        assert!(!outcome.domain.is_empty(), "{}", outcome.id);
    }
    let text =
        "system \"s\" state x field f x' = log(-1 - x^2) field g x' = x^2 claim 1: L(bracket(f, g), x) = 1";
    assert_eq!(words(text), ["undecided"]);
}

#[test]
fn what_is_no_field_has_no_bracket() {
    let base = "system \"s\" state x, y param a field f x' = y y' = x field g x' = x y' = a let e = x ";
    for (text, part) in [
        ("claim 1: L(bracket(f, e), x) = 0", "'e' is no field"),
        ("claim 1: L(bracket(f, gg), x) = 0", "perhaps you meant 'g'"),
        ("claim 1: L(bracket(f), x) = 0", "'bracket' takes two fields"),
        ("claim 1: L(bracket(f, g, x), x) = 0", "'bracket' takes two fields"),
        ("claim 1: bracket(f) = [0; 0]", "'bracket' takes two fields"),
        ("claim 1: bracket(f, x + y) = [0; 0]", "expected the name of a field"),
        ("claim 1: L(f + g, x) = 0", "or the bracket of two"),
        ("claim 1: bracket(f, g, 2) = 0", "expected the name of a state"),
        ("claim 1: bracket(f, g) = 0", "a matrix of 2 by 1 cannot equal a number"),
        ("claim 1: L(brackett(f, g), x) = 0", "expected the name of a field"),
    ] {
        let found = refusal(&format!("{base}{text}"));
        assert!(found.contains(part), "{text}: {found}");
    }
    let deep = (0..20).fold("f".to_owned(), |inner, _| format!("bracket({inner}, g)"));
    assert!(refusal(&format!("{base}claim 1: L({deep}, x) = 0")).contains("more than 8 deep"));
    // a definition may have the name, as in the thesis's files
    assert_eq!(words(&format!("{base}let bracket = x*y claim 1: L(f, bracket) = y^2 + x^2")), ["proved"]);
}

/// Imported fields have brackets too, with all that they move, and what is explained of them can be read again here.
#[test]
fn brackets_of_imported_fields() {
    let folder = tempfile::tempdir().unwrap();
    let inner = "system \"in\" state x, y, w field f x' = y y' = w w' = 1 field g w' = x others' = 0 let c = bracket(f, g)";
    std::fs::write(folder.path().join("in.proof"), inner).unwrap();
    let text = "system \"out\" use i = \"in.proof\" state x, w\n\
                claim 1: L(bracket(i.f, i.g), w) = L(i.f, i.g, w) - L(i.g, i.f, w)\n\
                claim 2: bracket(i.f, i.g) = [0; y]\n claim 3: i.c = [0; -x; y]\n";
    let system = System::parse("out.proof", text, folder.path()).unwrap();
    let outcomes = decide_all(&system, 1, &false.into(), &|_| ());
    assert_eq!(outcomes.iter().map(|one| one.word()).collect::<Vec<_>>(), ["proved"; 3]);
    let explained = system.explanations(&system.claims[2].body);
    assert_eq!(explained.definitions, [("i.c".to_owned(), "bracket(i.f, i.g, x, y, w)".to_owned())]);
    assert_eq!(explained.fields.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), ["i.f", "i.g"]);
    let again = system.clone().evaluate_text("bracket(i.f, i.g, x, y, w)").unwrap();
    assert_eq!(Some(&again), system.definition("i.c"));
}

/// `d(e, x)` is a number where a number is meant, and a row of one entry where a matrix is.
#[test]
fn a_row_of_one_entry_is_a_number_where_one_is_meant() {
    let base = "system \"s\" state x, y param a angle phi_ ".replace("angle phi_", "");
    let base =
        format!("{base} drift f x' = y y' = 0 output x let e = x^3 + x*y sample x in [1, 2] y in [1, 2]\n");
    let claims = [
        "d(e, y) = x",
        "x = d(e, y)",
        "d(e, x) = 3*x^2 + y",
        "d(e, x) = [3*x^2 + y]",
        "d(e, x) - y = 3*x^2",
        "y + d(e, x) = 3*x^2 + 2*y",
        "d(e, x)*a = a*(3*x^2 + y)",
        "d(e, y)*[1, 2; 3, 4] = [x, 2*x; 3*x, 4*x]",
        "[1; 2]*d(e, y) = [x; 2*x]",
        "d(e, y)*[1, 2] = [x, 2*x]",
        "[1, 2; 3, 4]*d(e, y) = [x, 2*x; 3*x, 4*x]",
        "a/d(e, y) = a/x",
        "[1, a]/d(e, y) = [1/x, a/x]",
        "d(e, y)/d(x^2, x) = 1/2",
        "d(e, y)^2 = x^2",
        "sin(d(e, y)) = sin(x)",
        "d(d(e, y), x) = 1",
        "L(f, d(e, x)) = 6*x*y",
        "pole(1/d(e, y), x) = 1",
        "d(e, x) > 0 where x > 0, y > 0",
        "d(e, y) <= 2 on sample",
        "d(x^2, x) at {x = 3} = 6",
        "d(x^2, x) at {x = 3} = 6 within 1e-3",
        "x = 0 where d(e, y) = 0",
        "0 < d(e, y) < 3 where x in [1, 2]",
        "[d(e, x); d(e, y)] = [3*x^2 + y; x]",
        "[d(e, x), 1; 0, d(e, y)]*[0; 1] = [1; x]",
        "d(e) = [d(e, x), d(e, y)]",
        "rank([d(e, x)]) = 1",
        "rank(d(e, x)) = 1",
        "transpose(d(e, y)) = [x]",
        "det(d(e, y)) = x",
        "[1, 2]*[x; y] + 1 = x + 2*y + 1",
        "[x, y]*[x; y] = x^2 + y^2",
        "dot(d(e, y), d(x, x)) = x",
    ];
    for claim in claims {
        let found = words(&format!("{base}claim 1: {claim}"));
        assert!(["proved", "holds by definition"].contains(&found[0]), "{claim}: {found:?}");
    }
    for claim in ["d(e, y) = x + 1", "d(e, x) + d(e, y) = 3*x^2", "d(e, y) < 0 where x > 0"] {
        assert_eq!(words(&format!("{base}claim 1 expect refuted: {claim}")), ["refuted"], "{claim}");
    }
    for (claim, part) in [
        ("d(e, x, y) = x", "a matrix of 1 by 2 cannot equal a number"),
        ("d(e, x, y) + 1 = [x, y]", "cannot be added"),
        ("[1, 2]*[1, 2] = 1", "cannot be multiplied"),
        ("1/d(e, x, y) = 1", "cannot be divided"),
        ("d(e, y) + [1, 2] = [1, 2]", "cannot be added"),
        ("sin([x, y]) = 1", "expected a number"),
    ] {
        let found = refusal(&format!("{base}claim 1: {claim}"));
        assert!(found.contains(part), "{claim}: {found}");
    }
    // a name keeps what it is: a matrix, which a sweep of ranks takes for rows
    let system = system("system \"s\" state x drift f x' = x output x let rows = d(x^2, x)");
    assert!(matches!(system.definition("rows"), Some(Value::Matrix(_))));
}
