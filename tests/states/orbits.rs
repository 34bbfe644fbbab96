//! Ranks where initial conditions are numbers: by hand, and on drawn systems beside the derivatives of the outputs up to a high order, by power series with
//! derivatives along the unknowns in arithmetic of their own.

use palmistry::expression::Symbol;
use palmistry::sweep::RankPreparation;
use palmistry::{RankQuestion, System, answer_rank};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::sync::atomic::AtomicBool;

/// At least, at most and the number of unknowns. States that are drawn have the same rank.
fn rank(text: &str) -> (usize, usize, usize) {
    let mut system: System =
        format!("system \"s\" {text}").parse().unwrap_or_else(|error| panic!("{error:?} {text}"));
    let answer = answer_rank(&mut system, &RankQuestion { samples: 3, ..RankQuestion::default() }).unwrap();
    let generic = &answer.branches[0].generic;
    let ranks: Vec<usize> = answer.branches[0].full.rank_histogram.keys().copied().collect();
    if generic.at_least == generic.at_most {
        assert!(ranks.iter().all(|rank| *rank == generic.at_least), "{text}: {ranks:?} at drawn states");
    }
    (generic.at_least, generic.at_most, generic.dimension)
}

/// By hand: what a derivative of high order shows where those before it show nothing, and what none shows.
#[test]
fn ranks_from_numbers_by_hand() {
    let rows = [
        // S begins as t: a is told by the derivative of order n + 1
        ("state S param a unknown initial S = 0 drift f S' = 1 + a*S^2 output S", (1, 1, 1)),
        ("state S param a unknown initial S = 0 drift f S' = 1 + a*S^7 output S", (1, 1, 1)),
        ("state S param a, b unknown initial S = 0 drift f S' = 1 + a*S^5 + b*S^3 output S", (2, 2, 2)),
        // where it never leaves nought nothing is told
        ("state S param a unknown initial S = 0 drift f S' = a*S + S^2 output S", (0, 0, 1)),
        // y stays nought, so that its constants are not told; x tells its own
        (
            "state x, y param a, b, c unknown initial x = 1, y = 0 drift f x' = -a*x + y y' = b*y - c*y^2 output x",
            (1, 1, 3),
        ),
        // a product of constants alone
        ("state x, y param a, b unknown initial x = 0, y = 1 drift f x' = a*y*b y' = -y output x", (1, 1, 2)),
        // a known input tells what comes with it, from rest too
        ("state x param a, b unknown initial x = 0 drift f x' = -a*x input g x' = b output x", (2, 2, 2)),
        // a square that begins at nought: x = k t, of which the square is seen
        ("state x param k unknown initial x = 0 drift f x' = k output x^2", (1, 1, 1)),
        // an amount in a unit that nobody knows, from a known one
        ("state x param k, s unknown initial x = 1 drift f x' = -k*x output s*x", (2, 2, 2)),
    ];
    for (text, expected) in rows {
        assert_eq!(rank(text), expected, "{text}");
    }
    // claims follow
    let system: System =
        "system \"s\" state S param a unknown initial S = 0 drift f S' = 1 + a*S^2 output S \
                          claim 1: rank = 1 claim 2: observable(a) claim 3 expect refuted: rank = 0"
            .parse()
            .unwrap();
    for outcome in palmistry::prove(&system) {
        assert!(outcome.ok, "{} {:?}", outcome.statement, outcome.verdict);
    }
}

const PRIME: u64 = (1 << 31) - 1;
/// So many derivatives of the output.
const ORDERS: usize = 32;

fn power(base: u64, mut exponent: u64) -> u64 {
    let (mut base, mut found) = (base, 1);
    while exponent > 0 {
        if exponent % 2 == 1 {
            found = found * base % PRIME;
        }
        base = base * base % PRIME;
        exponent /= 2;
    }
    found
}

/// A coefficient and its derivatives along the unknowns.
type Dual = Vec<u64>;

fn product(a: &Dual, b: &Dual) -> Dual {
    (0..a.len())
        .map(|k| match k {
            0 => a[0] * b[0] % PRIME,
            _ => (a[0] * b[k] + a[k] * b[0]) % PRIME,
        })
        .collect()
}

/// A polynomial: coefficients and the powers of all variables, states first.
type Polynomial = Vec<(u64, Vec<u32>)>;

fn text_of(polynomial: &Polynomial, names: &[String]) -> String {
    let term = |(coefficient, powers): &(u64, Vec<u32>)| {
        let factors = names.iter().zip(powers).filter(|(_, power)| **power > 0);
        let factors: String = factors.map(|(name, power)| format!("*{name}^{power}")).collect();
        format!("{coefficient}{factors}")
    };
    polynomial.iter().map(term).collect::<Vec<_>>().join(" + ")
}

/// What is known of a variable at the beginning.
#[derive(Clone, Copy)]
enum Begin {
    /// This number, and nobody asks for it.
    Known(u64),
    /// This number, and it is asked for.
    At(u64),
    /// Any number, and it is asked for.
    Any,
}

/// The rank of the gradients of the output's Taylor coefficients by what is asked for, of as many of them as tell all that any does.
fn by_series(rates: &[Polynomial], output: &Polynomial, begin: &[Begin], rng: &mut ChaCha8Rng) -> usize {
    by_coefficients(ORDERS, rates, output, begin, rng)
}

/// The same of so many coefficients.
fn by_coefficients(
    orders: usize,
    rates: &[Polynomial],
    output: &Polynomial,
    begin: &[Begin],
    rng: &mut ChaCha8Rng,
) -> usize {
    let states = rates.len();
    let wanted = begin.iter().filter(|begin| !matches!(begin, Begin::Known(_))).count();
    let zero = vec![0; 1 + wanted];
    // by variable, by order
    let mut asked = 0;
    let mut series: Vec<Vec<Dual>> = Vec::new();
    for begin in begin {
        let mut dual = zero.clone();
        dual[0] = match begin {
            Begin::Known(value) | Begin::At(value) => *value,
            Begin::Any => rng.random_range(2..PRIME),
        };
        if !matches!(begin, Begin::Known(_)) {
            asked += 1;
            dual[asked] = 1;
        }
        series.push(vec![dual]);
    }
    // the k-th coefficient of a product of series
    let coefficient = |series: &[Vec<Dual>], polynomial: &Polynomial, k: usize| -> Dual {
        let mut sum = zero.clone();
        for (factor, powers) in polynomial {
            let mut all: Vec<Dual> = vec![zero.clone(); k + 1];
            all[0][0] = *factor;
            for (variable, power) in powers.iter().enumerate() {
                for _ in 0..*power {
                    let mut next = vec![zero.clone(); k + 1];
                    for (i, a) in all.iter().enumerate() {
                        for (j, b) in series[variable].iter().enumerate().take(k + 1 - i) {
                            let part = product(a, b);
                            next[i + j]
                                .iter_mut()
                                .zip(part)
                                .for_each(|(sum, part)| *sum = (*sum + part) % PRIME);
                        }
                    }
                    all = next;
                }
            }
            sum.iter_mut().zip(&all[k]).for_each(|(sum, part)| *sum = (*sum + part) % PRIME);
        }
        sum
    };
    let mut rows: Vec<Vec<u64>> = Vec::new();
    for k in 0..orders {
        rows.push(coefficient(&series, output, k)[1..].to_vec());
        let inverse = power(k as u64 + 1, PRIME - 2);
        let next: Vec<Dual> = rates
            .iter()
            .map(|rate| {
                coefficient(&series, rate, k).into_iter().map(|part| part * inverse % PRIME).collect()
            })
            .collect();
        series[..states].iter_mut().zip(next).for_each(|(series, next)| series.push(next));
    }
    let mut rank = 0;
    for column in 0..wanted {
        let Some(pivot) = (rank..rows.len()).find(|row| rows[*row][column] != 0) else { continue };
        rows.swap(rank, pivot);
        let inverse = power(rows[rank][column], PRIME - 2);
        let own = rows[rank].clone();
        for row in &mut rows[rank + 1..] {
            let factor = row[column] * inverse % PRIME;
            row.iter_mut()
                .zip(&own)
                .for_each(|(entry, own)| *entry = (*entry + (PRIME - factor) * own) % PRIME);
        }
        rank += 1;
    }
    rank
}

struct Drawn {
    text: String,
    rates: Vec<Polynomial>,
    output: Polynomial,
    initial: Vec<u64>,
    constants: usize,
}

/// A polynomial system with one output and numbers from which it may begin; the text ends behind the constants. None where the output is a constant.
fn drawn(rng: &mut ChaCha8Rng) -> Option<Drawn> {
    let (states, constants) = (rng.random_range(1..=3), rng.random_range(1..=3));
    let names: Vec<String> = (0..states)
        .map(|place| format!("x{place}"))
        .chain((0..constants).map(|place| format!("k{place}")))
        .collect();
    let mut polynomial = |terms: usize, with_constants: bool| -> Polynomial {
        (0..terms)
            .map(|_| {
                let mut powers = vec![0; states + constants];
                for _ in 0..rng.random_range(0..=2) {
                    powers[rng.random_range(0..states)] += 1;
                }
                if with_constants && rng.random_bool(0.7) {
                    powers[states + rng.random_range(0..constants)] += 1;
                }
                (rng.random_range(1..=3), powers)
            })
            .collect()
    };
    let rates: Vec<Polynomial> = (0..states).map(|place| polynomial(1 + place % 2, true)).collect();
    let output = polynomial(1, false);
    if output[0].1.iter().all(|power| *power == 0) {
        return None;
    }
    let initial: Vec<u64> = (0..states).map(|_| [0, 0, 1, 2][rng.random_range(0..4)]).collect();
    let rate = |(name, rate): (&String, &Polynomial)| format!("\n  {name}' = {}", text_of(rate, &names));
    let equations: String = names.iter().zip(&rates).map(rate).collect();
    let text = format!(
        "state {}\nparam {} unknown\ndrift f{equations}\noutput {}\n",
        names[..states].join(", "),
        names[states..].join(", "),
        text_of(&output, &names)
    );
    Some(Drawn { text, rates, output, initial, constants })
}

/// Drawn polynomial systems from numbers: what is said to be known is what many derivatives show, and most of them are decided.
#[test]
fn drawn_systems_from_numbers() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let (mut decided, mut low, mut late, mut all) = (0, 0, 0, 0);
    for _ in 0..400 {
        let Some(drawn) = drawn(&mut rng) else { continue };
        all += 1;
        let equation = |(place, value): (usize, &u64)| format!("x{place} = {value}");
        let initial: Vec<String> = drawn.initial.iter().enumerate().map(equation).collect();
        let text = format!("{}initial {}", drawn.text, initial.join(", "));
        let (at_least, at_most, _) = rank(&text);
        let begin = drawn.initial.iter().map(|value| Begin::Known(*value));
        let begin: Vec<Begin> = begin.chain(vec![Begin::Any; drawn.constants]).collect();
        let shown = by_series(&drawn.rates, &drawn.output, &begin, &mut rng);
        assert!(at_least <= shown && shown <= at_most, "{text}\nfrom {at_least} to {at_most}, and {shown}");
        if at_least == at_most {
            decided += 1;
            low += usize::from(shown < drawn.constants);
            late += usize::from(shown > 0);
        }
    }
    println!("{decided} of {all} decided, {low} below full rank, {late} above nought");
    // where all of an orbit is special, as where two amounts begin at nought and grow with each other, nothing is said
    assert!(decided * 100 >= all * 98 && low >= 80 && late >= 80, "{decided} of {all}, {low} {late}");
}

/// The same where all states are asked for too, at those states at which some of them are nought.
#[test]
fn drawn_systems_on_sets() {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let (mut decided, mut low, mut all) = (0, 0, 0);
    for _ in 0..400 {
        let Some(drawn) = drawn(&mut rng) else { continue };
        let noughts: Vec<usize> =
            (0..drawn.initial.len()).filter(|place| drawn.initial[*place] == 0).collect();
        if noughts.is_empty() {
            continue;
        }
        all += 1;
        let mut system: System = format!("system \"s\" {}", drawn.text).parse().unwrap();
        let conditions = noughts.iter().map(|place| format!("x{place} = 0")).collect();
        let question = RankQuestion { samples: 3, conditions, ..RankQuestion::default() };
        let answer = answer_rank(&mut system, &question).unwrap();
        let generic = &answer.branches[0].generic;
        let ranks: Vec<usize> = answer.branches[0].full.rank_histogram.keys().copied().collect();
        let begin = (0..drawn.initial.len()).map(|place| match noughts.contains(&place) {
            true => Begin::At(0),
            false => Begin::Any,
        });
        let begin: Vec<Begin> = begin.chain(vec![Begin::Any; drawn.constants]).collect();
        let shown = by_series(&drawn.rates, &drawn.output, &begin, &mut rng);
        let text = format!("{}\n{noughts:?} are nought", drawn.text);
        let (at_least, at_most) = (generic.at_least, generic.at_most);
        assert!(at_least <= shown && shown <= at_most, "{text}\nfrom {at_least} to {at_most}, and {shown}");
        assert!(ranks.iter().all(|rank| *rank == shown), "{text}: {ranks:?} at drawn states, and {shown}");
        decided += usize::from(at_least == at_most);
        low += usize::from(at_least == at_most && shown < begin.len());
    }
    println!("{decided} of {all} decided, {low} below full rank");
    assert!(decided * 100 >= all * 80 && low >= 80, "{decided} of {all}, {low}");
}

/// States that are handed over with noughts among their coordinates: by the derivatives that suffice at almost all states these tell less than by all.
#[test]
fn states_with_noughts_that_are_handed_over() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let (mut higher, mut all) = (0, 0);
    for _ in 0..300 {
        let Some(drawn) = drawn(&mut rng) else { continue };
        let mut system: System = format!("system \"s\" {}", drawn.text).parse().unwrap();
        let constants: Vec<u64> = (0..drawn.constants).map(|_| rng.random_range(1..=5)).collect();
        let begin = drawn.initial.iter().chain(&constants).map(|value| Begin::At(*value)).collect::<Vec<_>>();
        let shown = by_series(&drawn.rates, &drawn.output, &begin, &mut rng);
        let question = RankQuestion::default();
        let Ok(prepared) = RankPreparation::new(&mut system, &question) else { continue };
        let Ok(given) = prepared.at_given_states(&mut system) else { continue };
        let value = |symbol: &Symbol| -> f64 {
            let name = system.symbol_name(*symbol);
            let place: usize = name[1..].parse().unwrap();
            let list = if name.starts_with('x') { &drawn.initial } else { &constants };
            list[place] as f64
        };
        let values: Vec<[f64; 1]> = given.coordinates().iter().map(|symbol| [value(symbol)]).collect();
        let slices: Vec<&[f64]> = values.iter().map(<[f64; 1]>::as_slice).collect();
        let rows = given.decide(&slices, &AtomicBool::new(false)).unwrap().unwrap();
        let Some(found) = rows[0].rank else { continue };
        all += 1;
        assert_eq!(found, shown, "{}\nat {:?} {constants:?}", drawn.text, drawn.initial);
        // at almost all states no derivative beyond these tells anything
        let few = by_coefficients(begin.len(), &drawn.rates, &drawn.output, &begin, &mut rng);
        higher += usize::from(few < shown);
    }
    println!("{all} states, at {higher} of them derivatives of higher order raise the rank");
    assert!(all > 200 && higher >= 5, "{all} {higher}");
}
