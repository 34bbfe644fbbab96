//! Goals in one variable, decided completely: the zeros of all polynomials that are met cut the line into pieces on which each of them has
//! one sign, and premises and goal are looked at on each piece and at each zero. (A. Tarski's procedure in one variable; zeros by Sturm.)
//!
//! The variable is a symbol, the value of one function, the tangent of half an angle of which sines and cosines are met, or the root of
//! a linear expression in a symbol.

use super::reading::{LONGEST, Polynomials, Reading};
use super::{Known, Premises, Proposed};
use dashu::base::Sign;
use dashu::rational::RBig;
use palmistry_math::expression::{Graph, Guard, Input, Need, Symbol};
use palmistry_math::number::polynomial::Polynomial;
use palmistry_math::number::real_roots::{
    RealRoot, common, product, quotient, real_roots, sign_at, square_free,
};
use palmistry_math::number::{Fraction, rational_from_f64, rational_to_f64};
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// Zeros of polynomials of a higher degree, all together, are not looked for.
const HIGHEST: usize = 120;

/// What is known of a goal in one variable.
pub enum OnALine {
    /// It holds wherever the premises do.
    Holds,
    /// It fails in these places, in the order in which they are to be tried; nothing is known of others.
    Fails(Vec<FailingPlace>),
}

/// Where a goal fails.
pub enum FailingPlace {
    /// At all values of a symbol between two, or at one.
    Between(Proposed),
    /// At one irrational value.
    At(IrrationalPlace),
}

/// An irrational value of a symbol.
#[derive(Clone, Debug)]
pub struct IrrationalPlace {
    /// The symbol.
    pub symbol: Symbol,
    /// Its value.
    pub value: Irrational,
    /// Whether the two sides of the goal are equal there.
    pub touches: bool,
}

/// A number that is not rational.
#[derive(Clone, Debug)]
pub enum Irrational {
    /// A zero of a polynomial with integer coefficients, constant first.
    Zero {
        /// The coefficients.
        polynomial: Vec<RBig>,
        /// Which of its zeros.
        root: RealRoot,
    },
    /// So many half turns: to twelve digits and more; whether it is that is for exact arithmetic to find.
    HalfTurns(RBig),
}

/// What a number on the line stands for.
enum Variable {
    /// A symbol.
    Symbol(Symbol),
    /// The tangent of half of an angle.
    HalfAngle(Symbol),
    /// `root >= 0` with `symbol = (root^2 - shift)/factor`
    Root { symbol: Symbol, shift: RBig, factor: RBig },
    /// The value of a function, of which not all values need be taken.
    Value,
}

/// How the variables of a reading depend on the one of the line.
enum Substitution {
    /// One is it.
    Plain(usize),
    /// The cosine and the sine, where they are met.
    Circle { cosine: Option<usize>, sine: Option<usize> },
    /// The symbol, its root.
    Root { symbol: usize, root: usize, shift: RBig, factor: RBig },
}

/// Something that is a product of powers of polynomials above such a product, and what is needed of it.
struct Condition {
    /// The places of polynomials, and their powers.
    top: Vec<(usize, u32)>,
    bottom: Vec<(usize, u32)>,
    need: Need,
}

/// A line with all that is asked about on it.
struct Line {
    variable: Variable,
    /// Different polynomials; none of them vanishes everywhere.
    polynomials: Vec<Vec<RBig>>,
    /// Their signs at infinity on the circle, where an angle is half a turn.
    at_half_turn: Vec<Option<Sign>>,
    goal: Condition,
    premises: Vec<Condition>,
    /// Places of polynomials that vanish.
    equations: Vec<usize>,
}

/// The signs of all polynomials of a line at a place of it; `None` where one vanishes.
type Signs = Vec<Option<Sign>>;

/// Decides a goal; `None` where it is not one in one variable, or a premise cannot be read.
pub fn on_a_line(
    graph: &mut Graph,
    goal: Guard,
    premises: Premises<'_>,
    is_angle: &dyn Fn(Symbol) -> bool,
    known: Known<'_>,
) -> Option<OnALine> {
    let of_goal = graph.symbols_of([goal.node]);
    let near = |graph: &Graph, node| graph.symbols_of([node]).iter().all(|symbol| of_goal.contains(symbol));
    let assumed: Vec<Guard> =
        premises.assumed.iter().copied().filter(|guard| near(graph, guard.node)).collect();
    let equations: Vec<_> = premises.equations.iter().copied().filter(|node| near(graph, *node)).collect();
    let all = assumed.len() == premises.assumed.len() && equations.len() == premises.equations.len();
    let near = Premises { assumed: &assumed, equations: &equations };
    let line = Line::read(graph, goal, near, is_angle, known)?;
    let failing = line.failing()?;
    if failing.is_empty() {
        return Some(OnALine::Holds);
    }
    // what holds at a value of a function says nothing where that value is not taken; nor at a place that other premises exclude
    if !all || !equations.is_empty() {
        return None;
    }
    let places: Vec<FailingPlace> = failing.iter().filter_map(|piece| line.place(piece)).collect();
    (!places.is_empty()).then_some(OnALine::Fails(places))
}

/// Whether all premises hold somewhere; `None` where they are not about one variable, or one of them cannot be read.
pub fn somewhere(
    graph: &mut Graph,
    premises: Premises<'_>,
    is_angle: &dyn Fn(Symbol) -> bool,
    known: Known<'_>,
) -> Option<bool> {
    // what holds nowhere fails wherever the premises hold
    let never = Guard { node: graph.integer(-1), need: Need::NotNegative };
    let line = Line::read(graph, never, premises, is_angle, known)?;
    let is_somewhere = !line.failing()?.is_empty();
    (!is_somewhere || !matches!(line.variable, Variable::Value)).then_some(is_somewhere)
}

/// A piece of a line.
enum Piece {
    /// Between two numbers; infinity is left out.
    Between(Option<RBig>, Option<RBig>),
    /// A zero of this polynomial, and whether the goal is zero there.
    Zero(Vec<RBig>, RealRoot, bool),
    /// Where an angle is half a turn.
    HalfTurn,
}

impl Line {
    /// A goal and premises that are all about one variable.
    fn read(
        graph: &mut Graph,
        goal: Guard,
        premises: Premises<'_>,
        is_angle: &dyn Fn(Symbol) -> bool,
        known: Known<'_>,
    ) -> Option<Line> {
        let reading = Reading::new(graph, goal.node, premises, is_angle)?;
        let inputs = reading.inputs().to_vec();
        let read = reading.polynomials(graph, known)?;
        Line::new(&inputs, &read, goal, premises.assumed)
    }

    fn new(inputs: &[Input], read: &Polynomials, goal: Guard, assumed: &[Guard]) -> Option<Line> {
        let (variable, substitution) = variable(inputs, read)?;
        let mut line = Line {
            variable,
            polynomials: Vec::new(),
            at_half_turn: Vec::new(),
            goal: Condition { top: Vec::new(), bottom: Vec::new(), need: goal.need },
            premises: Vec::new(),
            equations: Vec::new(),
        };
        line.goal = line.condition(read, &read.goal, goal.need, &substitution)?;
        for (value, guard) in read.assumed.iter().zip(assumed) {
            let condition = line.condition(read, value, guard.need, &substitution)?;
            line.premises.push(condition);
        }
        let known = read.principal_values.iter().map(|(polynomial, strict)| (polynomial.clone(), *strict));
        for (polynomial, strict) in known.chain(ends(read)) {
            let need = if strict { Need::Positive } else { Need::NotNegative };
            let top = line.factor(&polynomial, &substitution)?;
            line.premises.push(Condition {
                top: top.map_or(Vec::new(), |place| vec![(place, 1)]),
                bottom: Vec::new(),
                need,
            });
        }
        if let Substitution::Root { root, .. } = &substitution {
            let place = line.factor(&Polynomial::variable(*root), &substitution)??;
            line.premises.push(Condition {
                top: vec![(place, 1)],
                bottom: Vec::new(),
                need: Need::NotNegative,
            });
        }
        for polynomial in &read.vanishing {
            // the square of a root is what it is the root of: that is put in
            if let Some(place) = line.factor(polynomial, &substitution)? {
                line.equations.push(place);
            }
        }
        Some(line)
    }

    /// A condition on a fraction; `None` where it cannot be read, or has zero as a factor.
    fn condition(
        &mut self,
        read: &Polynomials,
        value: &Fraction,
        need: Need,
        substitution: &Substitution,
    ) -> Option<Condition> {
        if matches!(need, Need::WithinOne | Need::InsideOne) {
            return None;
        }
        let mut side = |factors: &palmistry_math::number::Factors| {
            factors
                .iter()
                .map(|(place, power)| {
                    Some((self.factor(&read.fractions.factor(*place), substitution)??, *power))
                })
                .collect::<Option<Vec<_>>>()
        };
        Some(Condition { top: side(&value.top)?, bottom: side(&value.bottom)?, need })
    }

    /// The place of a polynomial in the variable of the line: nothing inside where it vanishes everywhere.
    fn factor(&mut self, polynomial: &Polynomial, substitution: &Substitution) -> Option<Option<usize>> {
        if polynomial.len() > LONGEST {
            return None;
        }
        let (values, half_turn) = put_in(polynomial, substitution)?;
        if values.is_empty() {
            return Some(None);
        }
        if let Some(place) = self.polynomials.iter().position(|known| *known == values) {
            return Some(Some(place));
        }
        self.polynomials.push(values);
        self.at_half_turn.push(half_turn);
        Some(Some(self.polynomials.len() - 1))
    }

    /// The pieces on which all premises hold and the goal does not: those with rational numbers first. `None` where something has no
    /// value at a place that no premise excludes, or degrees are too high.
    fn failing(&self) -> Option<Vec<Piece>> {
        let mut all = vec![RBig::ONE];
        for polynomial in &self.polynomials {
            let shared = common(&all, polynomial);
            let rest = if shared.len() > 1 { quotient(polynomial, &shared) } else { polynomial.clone() };
            all = product(&all, &rest);
            if all.len() > HIGHEST + 1 {
                return None;
            }
        }
        let all = square_free(&all);
        let mut roots = real_roots(&all);
        // an end that a zero shares with the next one, or that is a zero itself, has no room between them
        for k in 1..roots.len() {
            while roots[k - 1].high >= roots[k].low {
                roots[k - 1].halve(&all);
                roots[k].halve(&all);
            }
        }
        let simple: Vec<Vec<RBig>> =
            self.polynomials.iter().map(|polynomial| square_free(polynomial)).collect();
        let (mut wide, mut narrow) = (Vec::new(), Vec::new());
        for k in 0..=roots.len() {
            let low = k.checked_sub(1).map(|k| roots[k].high.clone());
            let high = roots.get(k).map(|root| root.low.clone());
            let signs = self.signs_at(&inside(low.as_ref(), high.as_ref()));
            if self.fails(&signs)? {
                wide.push(Piece::Between(low, high));
            }
        }
        for root in &roots {
            let sign = |(polynomial, simple): (&Vec<RBig>, &Vec<RBig>)| match root.exact() {
                Some(zero) => sign_at(polynomial, zero),
                // all zeros of it are among these, and simple ones of it without its multiple factors
                None if sign_at(simple, &root.low) != sign_at(simple, &root.high) => None,
                None => sign_at(polynomial, &root.low),
            };
            let signs: Signs = self.polynomials.iter().zip(&simple).map(sign).collect();
            if self.fails(&signs)? {
                // the shortest of those that vanish there
                let changing = simple.iter().filter(|p| sign_at(p, &root.low) != sign_at(p, &root.high));
                let shortest = changing.min_by_key(|p| p.len()).unwrap_or(&all);
                let touches = self.goal.top.iter().any(|(place, _)| signs[*place].is_none());
                let piece = Piece::Zero(shortest.clone(), root.clone(), touches);
                if root.exact().is_some() { wide.push(piece) } else { narrow.push(piece) }
            }
        }
        if matches!(self.variable, Variable::HalfAngle(_)) && self.fails(&self.at_half_turn)? {
            wide.push(Piece::HalfTurn);
        }
        wide.extend(narrow);
        Some(wide)
    }

    fn signs_at(&self, x: &RBig) -> Signs {
        self.polynomials.iter().map(|polynomial| sign_at(polynomial, x)).collect()
    }

    /// Whether all premises hold and the goal does not.
    fn fails(&self, signs: &Signs) -> Option<bool> {
        if self.equations.iter().any(|place| signs[*place].is_some()) {
            return Some(false);
        }
        let mut unknown = false;
        for premise in &self.premises {
            match premise.is_met(signs) {
                Some(true) => {}
                Some(false) => return Some(false),
                None => unknown = true,
            }
        }
        if unknown {
            return None;
        }
        self.goal.is_met(signs).map(|met| !met)
    }

    /// Where a piece is, if a state can be proposed there.
    fn place(&self, piece: &Piece) -> Option<FailingPlace> {
        let at =
            |symbol: Symbol, value: RBig| Some(FailingPlace::Between(vec![(symbol, value.clone(), value)]));
        match (&self.variable, piece) {
            (Variable::Value, _) => None,
            (Variable::Symbol(symbol), Piece::Between(low, high)) => {
                let (low, high) = about(low.as_ref(), high.as_ref());
                Some(FailingPlace::Between(vec![(*symbol, low, high)]))
            }
            (Variable::Symbol(symbol), Piece::Zero(polynomial, root, touches)) => match root.exact() {
                Some(zero) => at(*symbol, zero.clone()),
                None => {
                    let (polynomial, mut root) = (polynomial.clone(), root.clone());
                    root.narrow(&polynomial);
                    let value = Irrational::Zero { polynomial, root };
                    Some(FailingPlace::At(IrrationalPlace { symbol: *symbol, value, touches: *touches }))
                }
            },
            (Variable::Root { symbol, shift, factor }, piece) => {
                let root = match piece {
                    Piece::Between(low, high) => inside(low.as_ref(), high.as_ref()),
                    Piece::Zero(_, root, _) => root.exact()?.clone(),
                    Piece::HalfTurn => return None,
                };
                at(*symbol, (&root * &root - shift) / factor)
            }
            (Variable::HalfAngle(symbol), Piece::Between(low, high)) => {
                let (low, high) = about(low.as_ref(), high.as_ref());
                let angle = |tangent: &RBig| 2.0 * rational_to_f64(tangent).atan();
                let (low, high) = (angle(&low), angle(&high));
                // well inside, whatever the rounding
                let inset = (high - low) / 16.0;
                let ends = (rational_from_f64(low + inset)?, rational_from_f64(high - inset)?);
                (ends.0 < ends.1).then(|| FailingPlace::Between(vec![(*symbol, ends.0, ends.1)]))
            }
            (Variable::HalfAngle(symbol), Piece::Zero(polynomial, root, touches)) => {
                let mut root = root.clone();
                root.narrow(polynomial);
                let value = Irrational::HalfTurns(known_angle(2.0 * root.near().atan())?);
                Some(FailingPlace::At(IrrationalPlace { symbol: *symbol, value, touches: *touches }))
            }
            (Variable::HalfAngle(symbol), Piece::HalfTurn) => {
                let touches = self.goal.top.iter().any(|(place, _)| self.at_half_turn[*place].is_none());
                let value = Irrational::HalfTurns(RBig::ONE);
                Some(FailingPlace::At(IrrationalPlace { symbol: *symbol, value, touches }))
            }
            (_, Piece::HalfTurn) => None,
        }
    }
}

impl Condition {
    /// `None` where it has no value.
    fn is_met(&self, signs: &Signs) -> Option<bool> {
        if self.bottom.iter().any(|(place, _)| signs[*place].is_none()) {
            return None;
        }
        let mut sign = Ordering::Greater;
        for (place, power) in self.top.iter().chain(&self.bottom) {
            match signs[*place] {
                None => sign = Ordering::Equal,
                Some(Sign::Negative) if power % 2 == 1 => sign = sign.reverse(),
                Some(_) => {}
            }
        }
        Some(match self.need {
            Need::NotZero => sign.is_ne(),
            Need::Positive => sign.is_gt(),
            Need::NotNegative => sign.is_ge(),
            Need::WithinOne | Need::InsideOne => return None,
        })
    }
}

/// An angle near this one of which everybody knows sine and cosine, in half turns: a multiple of 15 degrees.
fn known_angle(near: f64) -> Option<RBig> {
    let parts = near * 12.0 / std::f64::consts::PI;
    let whole = parts.round();
    ((parts - whole).abs() < 1e-11).then(|| RBig::from(whole as i64) / RBig::from(12))
}

/// A number between two, or beyond the one that there is.
fn inside(low: Option<&RBig>, high: Option<&RBig>) -> RBig {
    match (low, high) {
        (Some(low), Some(high)) => (low + high) / RBig::from(2),
        (Some(low), None) => low + RBig::ONE,
        (None, Some(high)) => high - RBig::ONE,
        (None, None) => RBig::ZERO,
    }
}

/// Two numbers between which all others lie in a piece.
fn about(low: Option<&RBig>, high: Option<&RBig>) -> (RBig, RBig) {
    match (low, high) {
        (Some(low), Some(high)) => (low.clone(), high.clone()),
        (Some(low), None) => (low.clone(), low + RBig::from(2)),
        (None, Some(high)) => (high - RBig::from(2), high.clone()),
        (None, None) => (RBig::from(-1), RBig::ONE),
    }
}

/// What is known of variables by themselves, as polynomials that are not negative, and whether they are positive.
fn ends(read: &Polynomials) -> Vec<(Polynomial, bool)> {
    use dashu::integer::IBig;
    use palmistry_math::expression::Sign as Known;
    use palmistry_math::number::polynomial::Ring;
    let mut found = Vec::new();
    for (place, variable) in read.variables.iter().enumerate() {
        let x = Polynomial::variable(place);
        match variable.sign {
            Some(Known::Positive) => found.push((x.clone(), true)),
            Some(Known::Negative) => found.push((x.neg(), true)),
            Some(sign) if sign.is_upward() => found.push((x.clone(), false)),
            _ => {}
        }
        let number = |value: &RBig| Polynomial::integer(value.numerator());
        let scaled = |value: &RBig| x.mul(&Polynomial::integer(&IBig::from(value.denominator().clone())));
        if let Some(end) = &variable.low {
            found.extend(scaled(&end.value).map(|x| (x.add(&number(&end.value).neg()), end.strict)));
        }
        if let Some(end) = &variable.high {
            found.extend(scaled(&end.value).map(|x| (number(&end.value).add(&x.neg()), end.strict)));
        }
    }
    found
}

/// The one variable of a reading, and how its variables depend on it.
fn variable(inputs: &[Input], read: &Polynomials) -> Option<(Variable, Substitution)> {
    let place = |wanted: Input| inputs.iter().position(|input| *input == wanted);
    match inputs {
        [Input::Plain(symbol)] => Some((Variable::Symbol(*symbol), Substitution::Plain(0))),
        [Input::Opaque(_)] => Some((Variable::Value, Substitution::Plain(0))),
        [Input::Sine(symbol) | Input::Cosine(symbol), rest @ ..] => {
            let (sine, cosine) = (place(Input::Sine(*symbol)), place(Input::Cosine(*symbol)));
            let same = |input: &Input| *input == Input::Sine(*symbol) || *input == Input::Cosine(*symbol);
            (rest.iter().all(same))
                .then_some((Variable::HalfAngle(*symbol), Substitution::Circle { cosine, sine }))
        }
        [_, _] => {
            let [(root, top, bottom)] = &read.roots[..] else { return None };
            let symbol_place = 1 - root;
            let Input::Plain(symbol) = inputs[symbol_place] else { return None };
            let (top, bottom) = (in_one(top, symbol_place)?, in_one(bottom, symbol_place)?);
            let (shift, factor, [below]) = (top.first()?, top.get(1)?, &bottom[..]) else { return None };
            let (shift, factor) = (shift / below, factor / below);
            (top.len() == 2).then(|| {
                let variable = Variable::Root { symbol, shift: shift.clone(), factor: factor.clone() };
                (variable, Substitution::Root { symbol: symbol_place, root: *root, shift, factor })
            })
        }
        _ => None,
    }
}

/// A polynomial that has no other variable than this one, lowest coefficient first.
fn in_one(polynomial: &Polynomial, place: usize) -> Option<Vec<RBig>> {
    let mut values = vec![RBig::ZERO; usize::from(polynomial.degree_in(place)) + 1];
    for (exponents, value) in polynomial.terms() {
        let others = exponents.iter().enumerate().any(|(k, power)| k != place && *power > 0);
        if others {
            return None;
        }
        values[usize::from(exponents[place])] = RBig::from(value.clone());
    }
    Some(trimmed(values))
}

fn trimmed(mut values: Vec<RBig>) -> Vec<RBig> {
    while values.last().is_some_and(RBig::is_zero) {
        values.pop();
    }
    values
}

/// A polynomial in the variable of a line, lowest coefficient first, and its sign where an angle is half a turn. On a circle it is multiplied
/// by a power of `1 + t^2`, which is positive.
fn put_in(polynomial: &Polynomial, substitution: &Substitution) -> Option<(Vec<RBig>, Option<Sign>)> {
    let power = |base: &[RBig], n: usize| (0..n).fold(vec![RBig::ONE], |all, _| product(&all, base));
    let number = |values: &[i64]| values.iter().map(|value| RBig::from(*value)).collect::<Vec<_>>();
    let mut sum: BTreeMap<usize, RBig> = BTreeMap::new();
    let mut add = |values: Vec<RBig>, factor: &RBig| {
        for (k, value) in values.into_iter().enumerate() {
            *sum.entry(k).or_default() += value * factor;
        }
    };
    let mut half_turn = RBig::ZERO;
    match substitution {
        Substitution::Plain(place) => add(in_one(polynomial, *place)?, &RBig::ONE),
        Substitution::Circle { cosine, sine } => {
            let degree = polynomial.degree() as usize;
            for (exponents, value) in polynomial.terms() {
                let value = RBig::from(value.clone());
                let of = |place: &Option<usize>| place.map_or(0, |place| usize::from(exponents[place]));
                let (c, s) = (of(cosine), of(sine));
                if exponents.iter().map(|power| usize::from(*power)).sum::<usize>() != c + s {
                    return None;
                }
                let cosines = power(&number(&[1, 0, -1]), c);
                let sines = power(&number(&[0, 2]), s);
                let rest = power(&number(&[1, 0, 1]), degree - c - s);
                add(product(&product(&cosines, &sines), &rest), &value);
                if s == 0 {
                    half_turn += if c % 2 == 0 { value } else { -value };
                }
            }
        }
        Substitution::Root { symbol, root, shift, factor } => {
            // x = (r^2 - shift)/factor
            let x = [-(shift / factor), RBig::ZERO, RBig::ONE / factor];
            for (exponents, value) in polynomial.terms() {
                let of = |place: usize| usize::from(exponents[place]);
                let mut shifted = vec![RBig::ZERO; of(*root)];
                shifted.push(RBig::ONE);
                add(product(&power(&x, of(*symbol)), &shifted), &RBig::from(value.clone()));
            }
        }
    }
    let length = sum.keys().next_back().map_or(0, |last| last + 1);
    let mut values = vec![RBig::ZERO; length];
    sum.into_iter().for_each(|(k, value)| values[k] = value);
    Some((trimmed(values), (!half_turn.is_zero()).then(|| half_turn.sign())))
}
