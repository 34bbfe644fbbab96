//! Ranks of systems in which functions are met that are not rational: full and short ones whose rank is found by hand, identities that
//! are hidden in the outputs, and parts of the state space on which the rank is another one. No verdict may be wrong, and of
//! these none is open.

use palmistry::{RankQuestion, System, answer_rank, decide_all};
use std::path::Path;

fn system(text: &str) -> System {
    System::parse("model.proof", text, Path::new("")).unwrap_or_else(|error| panic!("{error}: {text}"))
}

/// The verdicts on some claims about a model.
fn words(model: &str, claims: &[String]) -> Vec<&'static str> {
    let claims: Vec<String> =
        claims.iter().enumerate().map(|(place, claim)| format!("claim c{place}: {claim}\n")).collect();
    let text = format!("system \"model\"\n{model}\n{}", claims.concat());
    decide_all(&system(&text), 1, &false.into(), &|_| ()).iter().map(|outcome| outcome.word()).collect()
}

/// That a model has a rank and no other.
fn has_rank(model: &str, rank: usize) {
    let claims: Vec<String> = (rank.saturating_sub(1)..=rank + 1).map(|n| format!("rank = {n}")).collect();
    for (claim, word) in claims.iter().zip(words(model, &claims)) {
        let expected = if *claim == format!("rank = {rank}") { "proved" } else { "refuted" };
        assert_eq!(word, expected, "{claim} of {model}");
    }
}

/// Each unknown follows from the outputs' derivatives by hand: the first names the argument of the function, further ones what
/// is in it.
#[test]
fn full_ranks_are_proved() {
    for (model, rank) in [
        ("state x, k drift f x' = -exp(k*x) k' = 0 output x", 2),
        ("state x, k, a drift f x' = -a*exp(-k/x) k' = 0 a' = 0 output x", 3),
        ("state x, y drift f x' = y y' = -log(x) output x", 2),
        ("state x, a, b drift f x' = -a*log(x + b) a' = 0 b' = 0 output x", 3),
        ("state h1, h2, c drift f h1' = -c*sqrt(h1) h2' = c*sqrt(h1) - sqrt(h2) c'=0 output h2", 3),
        ("state x, a, b drift f x' = -a*tanh(b*x) a' = 0 b' = 0 output x", 3),
        ("state x, n, k drift f x' = -k*x^n n' = 0 k' = 0 output x", 3),
        ("state x, n, K, V drift f x' = -V*x^n/(K^n + x^n) n'=0 K'=0 V'=0 output x", 4),
        ("state c, T, E, k param R drift f c' = -k*exp(-E/(R*T))*c T' = -T E'=0 k'=0 output c, T", 4),
        ("state x, y drift f x' = y y' = -x*abs(x) output x", 2),
        ("state x, y, k drift f x' = y y' = -k*y*abs(y) k'=0 output x", 3),
        ("state x, y drift f x' = y y' = -min(x, y) output x", 2),
        ("state x, y drift f x' = y y' = -max(x, y)  output x", 2),
        ("state x, y drift f x' = -y y' = x + x*y output atan2(y, x)", 2),
        ("state x, a drift f x' = -sinh(a*x) a'=0 output x", 2),
        ("state x, v, m drift f x' = v v' = -m*sin(x) - v*abs(v) m'=0 output x", 3),
        ("state x, w, b drift f x' = -x + 1/(1+exp(-w*x-b)) w'=0 b'=0 output x", 3),
    ] {
        has_rank(model, rank);
    }
}

/// The parameters stand together in every derivative: `exp(a + b)`, `a b`, `K^n`, and so on; or an identity hides that a word is
/// constant.
#[test]
fn short_ranks_are_proved() {
    for (model, rank) in [
        ("state x, a, b drift f x' = -exp(a + b)*x a'=0 b'=0 output x", 2),
        ("state x, a, b drift f x' = -a*b*log(x) a'=0 b'=0 output x", 2),
        ("state x, a, b drift f x' = -log(a*b)*x a'=0 b'=0 output x", 2),
        ("state x, a, b drift f x' = -sqrt(a)*sqrt(b)*x a'=0 b'=0 output x", 2),
        ("state x, a, b drift f x' = -sqrt(a*b)*x a'=0 b'=0 output x", 2),
        ("state x, a, b drift f x' = -tanh(a+b)*x a'=0 b'=0 output x", 2),
        ("state x, n, k drift f x' = -x*k^n n'=0 k'=0 output x", 2),
        ("state x, n, K drift f x' = -x/(1+K^n) n'=0 K'=0 output x", 2),
        ("state c, E, k param R, T drift f c' = -k*exp(-E/(R*T))*c E'=0 k'=0 output c", 2),
        ("state c, T, E, R, k drift f c' = -k*exp(-E/(R*T))*c T'=-T E'=0 R'=0 k'=0 output c, T", 4),
        ("state x, a, b drift f x' = -abs(a*b)*x a'=0 b'=0 output x", 2),
        ("state x, a, b drift f x' = -min(a, b)*x a'=0 b'=0 output x", 2),
        ("state x, a, b drift f x' = -max(a,b)*x a'=0 b'=0 output x", 2),
        ("state x, y, a drift f x' = a*y y' = -a*x a'=0 output atan2(y,x)", 2),
        ("state x, k drift f x'=0 k'=0 output exp(x)*exp(k) - exp(x+k), x", 1),
        ("state x, y drift f x'=0 y'=0 output log(x*y)-log(x)-log(y), x + y", 1),
        ("state x, y drift f x'=0 y'=0 output sin(x*y)^2 + cos(x*y)^2, x*y", 1),
        ("state x, y drift f x'=0 y'=0 output sqrt(x^2)-abs(x), y", 1),
        ("state x, y drift f x'=0 y'=0 output tanh(x) - (exp(x)-exp(-x))/(exp(x)+exp(-x)), y", 1),
        ("state x, y drift f x'=0 y'=0 output min(x,y)+max(x,y)-x-y, y", 1),
        ("state x, a, n drift f x' = -x*a^n*exp(-n*log(a)) a'=0 n'=0 output x", 1),
        ("state x, a, n drift f x' = -x*(a^n)^2*a^(-n) a'=0 n'=0 output x", 2),
        ("state x, n, K, V drift f x' = -V*(x/K)^n n'=0 K'=0 V'=0 output x", 3),
        ("state x, a drift f x' = -x*(cosh(a)^2 - sinh(a)^2) a'=0 output x", 1),
    ] {
        has_rank(model, rank);
    }
}

/// By hand: on each part of the states the signs say what the functions are.
#[test]
fn ranks_differ_from_part_to_part() {
    let model = "state x drift f x' = 0 output x + sqrt(x^2)";
    let claims =
        ["rank = 1", "rank = 0", "rank = 1 where x > 0", "rank = 0 where x < 0", "rank = 0 where x > 0"];
    let claims: Vec<String> = claims.iter().map(|claim| (*claim).to_owned()).collect();
    assert_eq!(words(model, &claims), ["refuted", "refuted", "proved", "proved", "refuted"]);
    for (model, claims) in MODELS {
        let asked: Vec<String> = claims.iter().map(|(claim, _)| (*claim).to_owned()).collect();
        for ((claim, expected), word) in claims.iter().zip(words(model, &asked)) {
            assert_eq!(word, *expected, "{claim} of {model}");
        }
    }
}

/// What is claimed of a model, and the verdict.
type Model = (&'static str, &'static [(&'static str, &'static str)]);

const MODELS: &[Model] = &[
    (
        "state x, y, z drift f x'=0 y'=0 z'=0 output sqrt(x*y)*sqrt(y*z)*sqrt(x*z) - x*y*z",
        &[
            ("rank = 0", "refuted"),
            ("rank = 1", "refuted"),
            ("rank = 0 where x > 0", "proved"),
            ("rank = 1 where x < 0", "proved"),
        ],
    ),
    (
        "state x drift f x'=0 output sqrt((x-1)/(x+1))*(x+1) - sqrt(x^2-1)",
        &[
            ("rank = 0", "refuted"),
            ("rank = 1", "refuted"),
            ("rank = 0 where x > 1", "proved"),
            ("rank = 1 where x < -1", "proved"),
        ],
    ),
    ("state x drift f x'=0 output sqrt(x-1)*sqrt(x+1) - sqrt(x^2-1)", &[("rank = 0", "proved")]),
    ("state x drift f x'=0 output log(x^2) - 2*log(abs(x))", &[("rank = 0", "proved")]),
    ("state x drift f x'=0 output atan(x) + atan(1/x)", &[("rank = 0", "proved"), ("rank = 1", "refuted")]),
    ("state x drift f x'=0 output exp(1)*x - exp(2)*x/exp(1)", &[("rank = 0", "proved")]),
    ("state x drift f x'=0 output pi*x - 4*atan(1)*x", &[("rank = 0", "proved")]),
    ("state x drift f x'=0 output x*(sqrt(2)+sqrt(3) - sqrt(5+2*sqrt(6)))", &[("rank = 0", "proved")]),
    ("state x drift f x'=0 output x*(exp(1) - 19/7)*(pi - 22/7)", &[("rank = 1", "proved")]),
    ("state x, y drift f x'=0 y'=0 output asin(x*y)", &[("rank = 1", "proved"), ("rank = 2", "refuted")]),
    ("state x drift f x'=0 output asin(x) + acos(x)", &[("rank = 0", "proved")]),
    ("state x, y drift f x'=y y'=0 output asin(x)", &[("rank = 2", "proved")]),
    (
        "state x, y drift f x'=0 y'=0 output abs(x) + abs(y), abs(x) - y",
        &[
            ("rank = 2", "refuted"),
            ("rank = 1", "refuted"),
            ("rank = 1 where x > 0, y < 0", "proved"),
            ("rank = 2 where y > 0", "proved"),
            ("rank = 1 where y < 0", "proved"),
        ],
    ),
    (
        "state x, k drift f x' = -max(x, 0)*k k'=0 output x",
        &[("rank = 2", "refuted"), ("rank = 2 where x > 0", "proved"), ("rank = 1 where x < 0", "proved")],
    ),
    (
        "state x, u drift f x' = min(max(u, -1), 1) u'=0 output x",
        &[
            ("rank = 2", "refuted"),
            ("rank = 2 where -1 < u < 1", "proved"),
            ("rank = 1 where u > 1", "proved"),
        ],
    ),
    ("state x, v, m drift f x' = v v' = -m*sign(v) m'=0 output x", &[("rank = 3", "proved")]),
    (
        "state x, y, z drift f x'=0 y'=0 z'=0 output abs(x*y*z), abs(x)*abs(y)*abs(z), x",
        &[("rank = 2", "proved")],
    ),
    (
        "state a, b, T param E1, E2 drift f a' = -exp(-E1/T)*a b' = -exp(-E2/T)*b T'=0 output a, b",
        &[("rank = 3", "proved")],
    ),
    ("state c, T, A, E drift f c' = -exp(A - E/T)*c T' = 1 A'=0 E'=0 output c, T", &[("rank = 4", "proved")]),
    ("state c, T, A, E drift f c' = -exp(A - E/T)*c T' = 0 A'=0 E'=0 output c, T", &[("rank = 3", "proved")]),
    ("state x, a drift f x' = -exp(a*exp(-x)) a'=0 output x", &[("rank = 2", "proved")]),
    ("state x, a, b drift f x' = -log(a*log(x) + b) a'=0 b'=0 output x", &[("rank = 3", "proved")]),
    (
        "state x, a, b drift f x' = -sqrt(a*x + b) a'=0 b'=0 output x",
        &[("rank = 3", "proved"), ("rank = 2", "refuted")],
    ),
    ("state x, a, b drift f x' = -sqrt(a*x^3 + b) a'=0 b'=0 output x", &[("rank = 3", "proved")]),
    (
        "state x, y drift f x'=0 y'=0 output x ",
        &[
            ("rank([exp(x), exp(x+y); 1, exp(y)]) = 1", "proved"),
            ("rank([exp(x), exp(x+y); 1, exp(y)]) = 2", "refuted"),
            ("rank([x, abs(x); 1, 1]) = 2", "refuted"),
            ("rank([x, abs(x); 1, 1]) = 1", "refuted"),
            ("rank([x, abs(x); 1, 1]) = 1 where x > 0", "proved"),
            ("rank([log(x), log(y); 1, 2]) = 2", "proved"),
            ("rank([log(x), 2*log(x); 1, 2]) = 1", "proved"),
            ("rank([tanh(x), sinh(x); 1, cosh(x)]) = 1", "proved"),
        ],
    ),
    (
        "state x, y, z drift f x'=0 y'=0 z'=0 output y*(exp(x)-1), x",
        &[("rank = 2", "proved"), ("rank = 1 where x = 0", "proved"), ("rank = 2 where x = 0", "refuted")],
    ),
    (
        "state x, y drift f x'=0 y'=0 output x*abs(y)",
        &[("rank = 1", "proved"), ("rank = 1 where x = 0", "proved"), ("rank = 0 where x = 0", "refuted")],
    ),
    ("state x, a, n drift f x' = x - a*x^n a'=0 n'=0 output x", &[("rank = 3", "proved")]),
    ("state m, a, b drift f m' = a*m^b a'=0 b'=0 output m^2", &[("rank = 3", "proved")]),
    (
        "state x, y, v, th angle th drift f x' = v*cos(th) y' = v*sin(th) v'=0 th'=0 output atan2(y, x)",
        &[("rank = 3", "proved"), ("rank = 4", "refuted")],
    ),
    ("state th, w angle th drift f th' = w w'=0 output exp(cos(th))", &[("rank = 2", "proved")]),
    ("state x, a drift f x' = -x^(1/4)*a a'=0 output x^(3/4)", &[("rank = 2", "proved")]),
    ("state x, a drift f x' = -(x+a)^(1/3) a'=0 output x", &[("rank = 2", "proved")]),
    ("state x, a drift f x' = -(x+a)^(1/3) a'=0 output x + a", &[("rank = 1", "proved")]),
];

/// The command's answer has a part for each sign, short ranks are certified at every state, with a direction.
#[test]
fn answers_are_given_part_by_part() {
    let answer = |text: &str| {
        let question = RankQuestion { samples: 40, ..RankQuestion::default() };
        answer_rank(&mut system(&format!("system \"model\"\n{text}")), &question).expect("an answer")
    };
    let found = answer("state x drift f x' = 0 output x + abs(x) sample x in [-2, 2]");
    let mut parts: Vec<_> = found
        .branches
        .iter()
        .map(|branch| {
            (branch.conditions.join(", "), branch.generic_rank, branch.is_final, branch.full.certified)
        })
        .collect();
    parts.sort();
    assert_eq!(parts, [("x < 0".to_owned(), 0, true, 40), ("x > 0".to_owned(), 1, true, 40)]);
    // of the other sign there is no state in the box, but an answer
    let found = answer("state x drift f x' = 0 output x + abs(x) sample x in [1, 2]");
    assert_eq!(found.left_out, ["x < 0"]);
    assert_eq!(found.branches.iter().map(|branch| branch.full.samples).sum::<u64>(), 40);
    // d/da + d/db is a motion that exp(a + b) does not show
    let found = answer(
        "state x, a, b drift f x' = -exp(a + b)*x a' = 0 b' = 0 output x sample x in [1, 2] a in [0, 1] b in [0, 1]",
    );
    let branch = &found.branches[0];
    assert_eq!((branch.generic_rank, branch.is_final, branch.full.certified), (2, true, 40));
    let direction = &branch.full.unobservable[0];
    assert_eq!((&direction.states, direction.count), (&vec!["a".to_owned(), "b".to_owned()], 40));
    assert_eq!(direction.vector.iter().map(ToString::to_string).collect::<Vec<_>>(), ["1", "-1"]);
}
