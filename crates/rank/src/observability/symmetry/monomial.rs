//! Polynomials in coordinates and in sines and cosines of angles, with integer coefficients.

use super::kernel::{KernelSource, Point};
use palmistry_math::expression::{Graph, NodeId, Symbol, SymbolFunction, SymbolInput};
use palmistry_math::number::Function;

/// A product of powers of variables, which are named by their places in [`KernelSource::variables`].
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Monomial {
    pub powers: Vec<(usize, u8)>,
    /// An angle itself, and not its sine or cosine: it has a derivative, and no value modulo a prime.
    pub angle: Option<Symbol>,
}

impl Monomial {
    pub fn variable(variable: usize) -> Monomial {
        Monomial { powers: vec![(variable, 1)], angle: None }
    }

    pub fn degree(&self) -> usize {
        self.powers.iter().map(|(_, power)| usize::from(*power)).sum::<usize>()
            + usize::from(self.angle.is_some())
    }

    pub fn value(&self, source: &KernelSource, point: &Point) -> u64 {
        let r = source.residues;
        self.powers
            .iter()
            .fold(r.one(), |product, (place, power)| r.mul(product, r.power(point.values[*place], *power)))
    }

    /// The partial derivative by a symbol, at a point.
    pub fn slope(&self, source: &KernelSource, point: &Point, symbol: Symbol) -> u64 {
        let r = source.residues;
        if let Some(angle) = self.angle {
            return if angle == symbol { r.one() } else { 0 };
        }
        let mut total = 0;
        for (at, (place, power)) in self.powers.iter().enumerate() {
            let SymbolInput { symbol: of, function } = source.variables[*place];
            if of != symbol {
                continue;
            }
            // the partner of a sine stands behind it
            let inner = match function {
                SymbolFunction::Itself => r.one(),
                SymbolFunction::Sine => point.values[place + 1],
                SymbolFunction::Cosine => r.neg(point.values[place - 1]),
            };
            let mut term = r.mul(inner, r.integer(i64::from(*power)));
            term = r.mul(term, r.power(point.values[*place], power - 1));
            for (other, (place, power)) in self.powers.iter().enumerate() {
                if other != at {
                    term = r.mul(term, r.power(point.values[*place], *power));
                }
            }
            total = r.add(total, term);
        }
        total
    }

    fn node(&self, graph: &mut Graph, variables: &[SymbolInput]) -> NodeId {
        let mut product = match self.angle {
            Some(angle) => graph.symbol(angle),
            None => graph.integer(1),
        };
        for (place, power) in &self.powers {
            let factor = variable_node(graph, variables[*place]);
            let factor = graph.power(factor, i32::from(*power));
            product = graph.mul(product, factor);
        }
        product
    }
}

fn variable_node(graph: &mut Graph, variable: SymbolInput) -> NodeId {
    let symbol = graph.symbol(variable.symbol);
    match variable.function {
        SymbolFunction::Itself => symbol,
        SymbolFunction::Sine => graph.apply(Function::Sin, symbol),
        SymbolFunction::Cosine => graph.apply(Function::Cos, symbol),
    }
}

/// All monomials of exactly one degree in some variables; a square of a sine is left out, since it is one less that of the
/// cosine.
pub(super) fn monomials(source: &KernelSource, variables: &[usize], degree: usize) -> Vec<Monomial> {
    let mut found = vec![Monomial::default()];
    for _ in 0..degree {
        let mut next = Vec::new();
        for monomial in &found {
            for variable in variables {
                let mut powers = monomial.powers.clone();
                match powers.last_mut() {
                    Some((last, _)) if *last > *variable => continue,
                    Some((last, power)) if last == variable => {
                        if source.variables[*variable].function == SymbolFunction::Sine {
                            continue;
                        }
                        *power += 1;
                    }
                    _ => powers.push((*variable, 1)),
                }
                next.push(Monomial { powers, angle: None });
            }
        }
        found = next;
    }
    found
}

/// How many monomials of up to a degree there are at the most.
pub(super) fn count(variables: usize, degree: usize) -> usize {
    (1..=degree).fold(1usize, |all, k| all.saturating_mul(variables + k) / k)
}

/// A sum of monomials with integer coefficients.
pub(super) type Polynomial = Vec<(Monomial, i64)>;

pub(super) fn value(polynomial: &Polynomial, source: &KernelSource, point: &Point) -> u64 {
    let r = source.residues;
    polynomial.iter().fold(0, |sum, (monomial, coefficient)| {
        r.add(sum, r.mul(r.integer(*coefficient), monomial.value(source, point)))
    })
}

/// As an expression that begins without a sign, where it can.
pub(super) fn polynomial_node(
    graph: &mut Graph,
    variables: &[SymbolInput],
    polynomial: &Polynomial,
) -> NodeId {
    let mut sum = graph.integer(0);
    let (positive, negative): (Vec<_>, Vec<_>) = polynomial.iter().partition(|(_, c)| *c > 0);
    for (monomial, coefficient) in positive {
        let node = monomial.node(graph, variables);
        let factor = graph.integer(*coefficient);
        let term = graph.mul(factor, node);
        sum = graph.add(sum, term);
    }
    for (monomial, coefficient) in negative {
        let node = monomial.node(graph, variables);
        let factor = graph.integer(coefficient.saturating_neg());
        let term = graph.mul(factor, node);
        sum = graph.sub(sum, term);
    }
    sum
}

/// In the notation of the language, a common factor outside brackets.
pub(super) fn polynomial_text(graph: &Graph, variables: &[SymbolInput], polynomial: &Polynomial) -> String {
    let common = common_factor(polynomial);
    let negative = polynomial.iter().all(|(_, coefficient)| *coefficient < 0);
    let rest: Vec<(Monomial, i64)> = polynomial
        .iter()
        .map(|(monomial, coefficient)| {
            let powers = monomial.powers.iter().map(|(place, power)| {
                let taken = common.powers.iter().find(|(of, _)| of == place).map_or(0, |(_, taken)| *taken);
                (*place, power - taken)
            });
            let powers = powers.filter(|(_, power)| *power > 0).collect();
            let sign = if negative { -1 } else { 1 };
            (Monomial { powers, angle: monomial.angle }, sign * coefficient)
        })
        .collect();
    let sum = sum_text(graph, variables, &rest);
    let front = monomial_text(graph, variables, &common);
    let sign = if negative { "-" } else { "" };
    match (common.powers.is_empty(), rest.len()) {
        (true, 1) => format!("{sign}{sum}"),
        (true, _) if negative => format!("-({sum})"),
        (true, _) => sum,
        (false, 1) if sum == "1" => format!("{sign}{front}"),
        (false, 1) => format!("{sign}{sum}*{front}"),
        (false, _) => format!("{sign}{front}*({sum})"),
    }
}

/// The product of powers that every term has.
fn common_factor(polynomial: &Polynomial) -> Monomial {
    let Some((first, _)) = polynomial.first() else { return Monomial::default() };
    let shared = |(place, power): &(usize, u8)| {
        let in_term = |(monomial, _): &(Monomial, i64)| {
            monomial.powers.iter().find(|(of, _)| of == place).map_or(0, |(_, power)| *power)
        };
        let least = polynomial.iter().map(in_term).min().unwrap_or(*power);
        (least > 0).then_some((*place, least))
    };
    Monomial { powers: first.powers.iter().filter_map(shared).collect(), angle: None }
}

/// Terms with a plus first.
fn sum_text(graph: &Graph, variables: &[SymbolInput], polynomial: &[(Monomial, i64)]) -> String {
    let (positive, negative): (Vec<_>, Vec<_>) = polynomial.iter().partition(|(_, c)| *c > 0);
    let mut text = String::new();
    for (monomial, coefficient) in positive.into_iter().chain(negative) {
        text.push_str(match (text.is_empty(), *coefficient < 0) {
            (true, true) => "-",
            (true, false) => "",
            (false, true) => " - ",
            (false, false) => " + ",
        });
        let factor = monomial_text(graph, variables, monomial);
        match (coefficient.unsigned_abs(), factor.as_str()) {
            (number, "1") => text.push_str(&number.to_string()),
            (1, factor) => text.push_str(factor),
            (number, factor) => text.push_str(&format!("{number}*{factor}")),
        }
    }
    text
}

/// Coordinates before sines and cosines.
fn monomial_text(graph: &Graph, variables: &[SymbolInput], monomial: &Monomial) -> String {
    let name = |variable: SymbolInput| {
        let symbol = graph.symbol_name(variable.symbol);
        match variable.function {
            SymbolFunction::Itself => symbol.to_owned(),
            SymbolFunction::Sine => format!("sin({symbol})"),
            SymbolFunction::Cosine => format!("cos({symbol})"),
        }
    };
    let mut powers = monomial.powers.clone();
    powers.sort_by_key(|(place, _)| variables[*place].function != SymbolFunction::Itself);
    let power = |(place, power): &(usize, u8)| match power {
        1 => name(variables[*place]),
        power => format!("{}^{power}", name(variables[*place])),
    };
    let factors = monomial.angle.map(|angle| graph.symbol_name(angle).to_owned());
    let factors: Vec<String> = factors.into_iter().chain(powers.iter().map(power)).collect();
    if factors.is_empty() { "1".to_owned() } else { factors.join("*") }
}

/// Whether a text is a sum, which needs brackets as a factor.
pub(super) fn in_brackets(text: String) -> String {
    let mut depth = 0;
    let is_sum = text.char_indices().any(|(at, sign)| {
        depth += i32::from(sign == '(') - i32::from(sign == ')');
        depth == 0 && (sign == '+' || sign == '-') && at > 0 && text.as_bytes()[at - 1] == b' '
    });
    if is_sum { format!("({text})") } else { text }
}
