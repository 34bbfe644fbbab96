//! Between what a symbol lies, where inequalities say so: `x > 1`, `2*y <= pi`.

use dashu::rational::RBig;
use palmistry_math::expression::{Graph, Guard, Need, Node, NodeId, Program, Sign, Symbol};
use palmistry_math::number::{Enclosure, Enclosures, Interval, rational_to_f64};
use std::collections::{BTreeMap, HashMap};

/// The bits to which a bound such as `pi/3` is enclosed.
const BITS: usize = 128;
/// Longer inequalities are not looked at for bounds.
const LONGEST: usize = 200;

/// One end.
#[derive(Clone, Debug, PartialEq)]
pub struct Bound {
    /// An expression without symbols.
    pub value: NodeId,
    /// Its value, where that is rational.
    pub exact: Option<RBig>,
    /// Doubles between which it lies.
    pub enclosed: Interval,
    /// Whether it is not reached itself.
    pub strict: bool,
}

/// Where one symbol lies.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SymbolBounds {
    /// The least value.
    pub low: Option<Bound>,
    /// The greatest value.
    pub high: Option<Bound>,
}

/// Where symbols lie.
pub type Bounds = BTreeMap<Symbol, SymbolBounds>;

impl SymbolBounds {
    /// All of it, and perhaps a little more.
    pub fn interval(&self) -> Interval {
        let low = self.low.as_ref().map_or(f64::NEG_INFINITY, |bound| bound.enclosed.low());
        let high = self.high.as_ref().map_or(f64::INFINITY, |bound| bound.enclosed.high());
        Interval::new(low, high.max(low))
    }

    /// The sign that the ends determine.
    fn sign(&self) -> Option<Sign> {
        let end = |bound: &Option<Bound>, upward: bool| {
            let bound = bound.as_ref()?;
            let (low, high) = (bound.enclosed.low(), bound.enclosed.high());
            let (inner, outer) = if upward { (low, low) } else { (-high, -high) };
            match bound.exact.as_ref().map(RBig::is_zero) {
                Some(true) => Some(Sign::new(upward, bound.strict)),
                _ if inner > 0.0 => Some(Sign::new(upward, true)),
                _ if outer >= 0.0 => Some(Sign::new(upward, false)),
                _ => None,
            }
        };
        let (low, high) = (end(&self.low, true), end(&self.high, false));
        low.filter(|sign| sign.is_strict()).or(high.filter(|sign| sign.is_strict())).or(low).or(high)
    }
}

/// The bounds that some inequalities set to symbols of their own.
pub fn bounds(graph: &mut Graph, assumed: &[Guard]) -> Bounds {
    let mut found = Bounds::new();
    for guard in assumed {
        let strict = match guard.need {
            Need::Positive => true,
            Need::NotNegative => false,
            Need::NotZero | Need::WithinOne | Need::InsideOne => continue,
        };
        let Some((symbol, Line { slope, rest })) = line(graph, guard.node) else { continue };
        // slope x + rest > 0
        let scale = graph.rational(RBig::from(-1) / &slope);
        let value = graph.mul(scale, rest);
        let Some(bound) = Bound::new(graph, value, strict) else { continue };
        let range = found.entry(symbol).or_default();
        let (known, is_low) =
            if slope > RBig::ZERO { (&mut range.low, true) } else { (&mut range.high, false) };
        if known.as_ref().is_none_or(|known| bound.is_tighter(known, is_low)) {
            *known = Some(bound);
        }
    }
    found
}

impl Bound {
    fn new(graph: &Graph, value: NodeId, strict: bool) -> Option<Bound> {
        // what cancels as numbers may be there as symbols, as in tan(atan(k)) - k
        if !graph.symbols_of([value]).is_empty() {
            return None;
        }
        let exact = graph.constant_value(value).cloned();
        let enclosed = match &exact {
            Some(exact) => around(&Enclosures::new(BITS), exact)?,
            None => {
                let program = Program::plain(graph, &[value]);
                let found = program.load(Enclosures::new(BITS)).ok()?.run(&[], &mut Vec::new()).ok()?;
                to_interval(&found[0])
            }
        };
        Some(Bound { value, exact, enclosed, strict })
    }

    fn is_tighter(&self, known: &Bound, is_low: bool) -> bool {
        match (&self.exact, &known.exact) {
            (Some(a), Some(b)) if a == b => self.strict && !known.strict,
            (Some(a), Some(b)) => (a > b) == is_low,
            _ if is_low => self.enclosed.low() > known.enclosed.low(),
            _ => self.enclosed.high() < known.enclosed.high(),
        }
    }
}

/// Doubles around a rational number.
fn around(enclosures: &Enclosures, value: &RBig) -> Option<Interval> {
    use palmistry_math::number::Arithmetic;
    let near = rational_to_f64(value);
    if palmistry_math::number::rational_from_f64(near).as_ref() == Some(value) {
        return Some(Interval::point(near));
    }
    enclosures.rational(value).ok().map(|enclosed| to_interval(&enclosed))
}

/// Doubles around an enclosure.
fn to_interval(value: &Enclosure) -> Interval {
    let (low, high) = (rational_to_f64(&value.low()), rational_to_f64(&value.high()));
    Interval::new(low.next_down(), high.next_up())
}

/// A line in one symbol: `slope symbol + rest`, the rest without symbols.
#[derive(Clone)]
struct Line {
    slope: RBig,
    rest: NodeId,
}

/// The symbol in which an expression is a line that is not level, and the line.
fn line(graph: &mut Graph, root: NodeId) -> Option<(Symbol, Line)> {
    let needed = graph.reachable([root]);
    let mut symbols = needed.iter().filter_map(|id| graph.as_symbol(*id));
    let symbol = symbols.next()?;
    if symbols.next().is_some() || needed.len() > LONGEST {
        return None;
    }
    let mut known: HashMap<NodeId, Line> = HashMap::new();
    for id in needed {
        let of = |operand: NodeId| known.get(&operand).cloned();
        let found = match graph.node(id) {
            Node::Symbol(_) => Some(Line { slope: RBig::ONE, rest: graph.integer(0) }),
            Node::Add(a, b) => of(a)
                .zip(of(b))
                .map(|(a, b)| Line { slope: a.slope + b.slope, rest: graph.add(a.rest, b.rest) }),
            Node::Sub(a, b) => of(a)
                .zip(of(b))
                .map(|(a, b)| Line { slope: a.slope - b.slope, rest: graph.sub(a.rest, b.rest) }),
            Node::Neg(a) => of(a).map(|a| Line { slope: -a.slope, rest: graph.neg(a.rest) }),
            Node::Mul(a, b) => of(a).zip(of(b)).and_then(|(a, b)| product(graph, a, b)),
            Node::Div(a, b) => of(a).zip(of(b)).and_then(|(a, b)| {
                let divisor = graph.constant_value(b.rest);
                let divisor = divisor.filter(|c| b.slope.is_zero() && !c.is_zero()).cloned()?;
                let inverse = graph.rational(RBig::ONE / &divisor);
                Some(Line { slope: a.slope / divisor, rest: graph.mul(a.rest, inverse) })
            }),
            Node::Constant(_) | Node::Pi => Some(Line { slope: RBig::ZERO, rest: id }),
            Node::Power(a, _) | Node::Apply(_, a) => {
                of(a).filter(|a| a.slope.is_zero()).map(|_| Line { slope: RBig::ZERO, rest: id })
            }
        };
        if let Some(found) = found {
            known.insert(id, found);
        }
    }
    let line = known.remove(&root)?;
    (!line.slope.is_zero()).then_some((symbol, line))
}

/// A product of two lines one of which is a number, rational where the other one is not.
fn product(graph: &mut Graph, a: Line, b: Line) -> Option<Line> {
    let (line, factor) = if b.slope.is_zero() { (a, b) } else { (b, a) };
    if !factor.slope.is_zero() {
        return None;
    }
    let slope = match graph.constant_value(factor.rest) {
        Some(number) => line.slope * number,
        None if line.slope.is_zero() => RBig::ZERO,
        None => return None,
    };
    Some(Line { slope, rest: graph.mul(line.rest, factor.rest) })
}

/// Signs of expressions that follow from inequalities: of symbols by their bounds, of others by name.
pub fn known_signs(graph: &mut Graph, assumed: &[Guard], bounds: &Bounds) -> HashMap<NodeId, Sign> {
    let mut known = HashMap::new();
    for guard in assumed {
        let sign = match guard.need {
            Need::Positive => Sign::Positive,
            Need::NotNegative => Sign::NotNegative,
            Need::NotZero | Need::WithinOne | Need::InsideOne => continue,
        };
        let mut note = |node: NodeId, sign: Sign| {
            if sign.is_strict() || !known.contains_key(&node) {
                known.insert(node, sign);
            }
        };
        note(guard.node, sign);
        note(graph.neg(guard.node), sign.negated());
        if let Node::Sub(a, b) = graph.node(guard.node) {
            note(graph.sub(b, a), sign.negated());
        }
    }
    for (symbol, range) in bounds {
        if let Some(sign) = range.sign() {
            known.insert(graph.symbol(*symbol), sign);
        }
    }
    known
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_read_off_lines_and_the_tighter_one_counts() {
        let mut graph = Graph::default();
        let x = graph.intern("x");
        let node = graph.symbol(x);
        let (one, three) = (graph.integer(1), graph.integer(3));
        let pi = graph.pi();
        let above_one = graph.sub(node, one);
        let below = graph.mul(three, node);
        let below_a_third_of_pi = graph.sub(pi, below);
        let assumed = [
            Guard { node, need: Need::Positive },
            Guard { node: above_one, need: Need::Positive },
            Guard { node: below_a_third_of_pi, need: Need::NotNegative },
        ];
        let found = bounds(&mut graph, &assumed);
        let range = &found[&x];
        let low = range.low.as_ref().unwrap();
        assert_eq!((low.exact.clone(), low.strict), (Some(RBig::ONE), true));
        let high = range.high.as_ref().unwrap();
        assert!(high.enclosed.contains(std::f64::consts::FRAC_PI_3) && high.enclosed.width() < 1e-15);
        assert_eq!(known_signs(&mut graph, &assumed, &found)[&node], Sign::Positive);
        let square = graph.power(node, 2);
        assert_eq!(bounds(&mut graph, &[Guard { node: square, need: Need::Positive }]), Bounds::new());
    }
}
