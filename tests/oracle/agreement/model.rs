//! A system as the oracle has it: polynomials in coordinates, or in the sine and cosine of one that is an angle, and the ranks of
//! the differentials of all its Lie derivatives by the coordinates that are unknown.
//!
//! No rule of the library on when to stop stands here: Lie derivatives are taken along all words of fields to an order that is far beyond the number of
//! coordinates, of which those that are zero end; what has a known initial condition moves like everything else and is
//! left out of the columns at the very end.

use super::polynomial::{Basis, Polynomial};
use dashu::base::BitTest;
use dashu::rational::RBig;

/// What is known of a coordinate.
#[derive(Clone, Debug, PartialEq)]
pub enum Knowledge {
    Unknown,
    /// `initial z known`
    AtFirst,
    /// `initial z = 2`
    Number(RBig),
    /// A signal that is known all the time, or a parameter.
    Always,
}

/// What is known of a name.
#[derive(Clone, Debug)]
pub struct Coordinate {
    pub name: String,
    pub knowledge: Knowledge,
    pub is_angle: bool,
    pub is_signal: bool,
}

/// A system. Coordinates have a variable each; an angle has two, sine and cosine.
#[derive(Clone, Debug)]
pub struct Model {
    pub coordinates: Vec<Coordinate>,
    /// By fields and coordinates; in discrete time the one map.
    pub fields: Vec<Vec<Polynomial>>,
    pub outputs: Vec<Polynomial>,
    pub steps: bool,
    /// As a proof file has it, without claims.
    pub text: String,
}

/// A value for each variable, in their order.
pub type State = Vec<RBig>;

/// Lie derivatives are taken up to this order, while they are no more than these, of so many terms.
const LONGEST: usize = 9;
const MOST: usize = 260;
const MOST_TERMS: usize = 160;

/// The differentials of the Lie derivatives, by all coordinates; in discrete time there are none, since states are followed.
pub struct Differentials {
    rows: Vec<Vec<Polynomial>>,
    /// Whether no further one is other than zero, or all orders were taken.
    pub is_far: bool,
}

impl Model {
    /// How many variables there are.
    pub fn variables(coordinates: &[Coordinate]) -> usize {
        coordinates.iter().map(|one| if one.is_angle { 2 } else { 1 }).sum()
    }

    /// Where the variables of a coordinate begin.
    pub fn place(&self, coordinate: usize) -> usize {
        Model::variables(&self.coordinates[..coordinate])
    }

    /// The names of the variables.
    pub fn names(coordinates: &[Coordinate]) -> Vec<String> {
        let names = |one: &Coordinate| match one.is_angle {
            true => vec![format!("sin({})", one.name), format!("cos({})", one.name)],
            false => vec![one.name.clone()],
        };
        coordinates.iter().flat_map(names).collect()
    }

    pub fn unknowns(&self) -> Vec<usize> {
        let all = 0..self.coordinates.len();
        all.filter(|place| self.coordinates[*place].knowledge == Knowledge::Unknown).collect()
    }

    /// The derivative by a coordinate.
    fn slope(&self, of: &Polynomial, coordinate: usize) -> Polynomial {
        let place = self.place(coordinate);
        if !self.coordinates[coordinate].is_angle {
            return of.slope(place);
        }
        let all = Model::variables(&self.coordinates);
        let (sine, cosine) = (Polynomial::variable(place, all), Polynomial::variable(place + 1, all));
        let by_sine = of.slope(place).times(&cosine);
        by_sine.plus(&of.slope(place + 1).times(&sine).scaled(&RBig::from(-1)))
    }

    /// All differentials that are taken.
    pub fn differentials(&self) -> Differentials {
        let mut rows = Vec::new();
        let all = 0..self.coordinates.len();
        let row = |value: &Polynomial| all.clone().map(|one| self.slope(value, one)).collect::<Vec<_>>();
        let mut last: Vec<Polynomial> = self.outputs.clone();
        rows.extend(last.iter().map(row));
        let mut is_far = true;
        for _ in 0..if self.steps { 0 } else { LONGEST } {
            let mut longer: Vec<Polynomial> = Vec::new();
            for value in &last {
                let slopes = row(value);
                for field in &self.fields {
                    let parts = slopes.iter().zip(field).map(|(slope, rate)| slope.times(rate));
                    let sum = parts.fold(Polynomial::default(), |sum, part| sum.plus(&part));
                    if !sum.is_zero() && !longer.contains(&sum) {
                        longer.push(sum);
                    }
                }
            }
            if rows.len() + longer.len() > MOST || longer.iter().any(|value| value.len() > MOST_TERMS) {
                is_far = false;
                break;
            }
            rows.extend(longer.iter().map(row));
            last = longer;
        }
        Differentials { rows, is_far }
    }

    /// The span at a state, and whether the Lie derivatives were taken far beyond where one expects it to rest.
    pub fn span(&self, found: &Differentials, state: &State, later: &mut dyn FnMut() -> RBig) -> Basis {
        let mut basis = Basis::default();
        let unknowns = self.unknowns();
        let rows: Vec<Vec<RBig>> = match self.steps {
            true => self.followed(found, state, later),
            false => found.rows.iter().map(|row| row.iter().map(|entry| entry.at(state)).collect()).collect(),
        };
        for row in rows {
            if basis.len() == unknowns.len() {
                break;
            }
            basis.insert(unknowns.iter().map(|place| row[*place].clone()).collect());
        }
        basis
    }

    /// In discrete time: the derivatives of all outputs by the state at the beginning, step by step, with signals that are drawn.
    fn followed(
        &self,
        found: &Differentials,
        state: &State,
        later: &mut dyn FnMut() -> RBig,
    ) -> Vec<Vec<RBig>> {
        let count = self.coordinates.len();
        let mut state = state.clone();
        // d(now)/d(at first), a row for each coordinate
        let unit = |n: usize| (0..count).map(|m| RBig::from(u8::from(n == m))).collect::<Vec<_>>();
        let mut slopes: Vec<Vec<RBig>> = (0..count).map(unit).collect();
        let times = |row: &[RBig], slopes: &[Vec<RBig>]| -> Vec<RBig> {
            (0..count)
                .map(|column| {
                    let parts = row.iter().zip(slopes).map(|(factor, slope)| factor * &slope[column]);
                    parts.fold(RBig::ZERO, |sum, part| sum + part)
                })
                .collect()
        };
        let map = &self.fields[0];
        let mut rows = Vec::new();
        for _ in 0..2 * count + 1 {
            for row in &found.rows {
                let row: Vec<RBig> = row.iter().map(|entry| entry.at(&state)).collect();
                rows.push(times(&row, &slopes));
            }
            let jacobian = map
                .iter()
                .map(|after| (0..count).map(|one| self.slope(after, one).at(&state)).collect::<Vec<RBig>>());
            let next: Vec<Vec<RBig>> = jacobian.map(|row| times(&row, &slopes)).collect();
            let after: State = map.iter().map(|after| after.at(&state)).collect();
            (slopes, state) = (next, after);
            for place in (0..count).filter(|place| self.coordinates[*place].is_signal) {
                state[self.place(place)] = later();
                slopes[place] = vec![RBig::ZERO; count];
            }
            // numbers that have become too long tell no more than those before
            if state.iter().any(|value| value.numerator().bit_len() > 20_000) {
                break;
            }
        }
        rows
    }

    /// The column of an unknown as a row: what its own differential is.
    pub fn unit(&self, unknown: usize) -> Vec<RBig> {
        self.unknowns().iter().map(|other| RBig::from(u8::from(*other == unknown))).collect()
    }

    /// A state as the library prints it; none where a name is missing or a number is not rational.
    pub fn read(&self, words: &[(String, String)]) -> Option<State> {
        let mut state = State::new();
        for one in &self.coordinates {
            let (_, text) = words.iter().find(|(name, _)| *name == one.name)?;
            let number = |text: &str| text.trim().parse::<RBig>().ok();
            if !one.is_angle {
                state.push(number(text)?);
                continue;
            }
            let turn = |sine: i64, cosine: i64| [RBig::from(sine), RBig::from(cosine)];
            let both = match text.as_str() {
                "0" | "2*pi" | "-2*pi" => turn(0, 1),
                "pi" | "-pi" => turn(0, -1),
                "pi/2" | "-3*pi/2" => turn(1, 0),
                "-pi/2" | "3*pi/2" => turn(-1, 0),
                text => {
                    let (sine, cosine) = text.strip_prefix("sin = ")?.split_once(", cos = ")?;
                    [number(sine)?, number(cosine)?]
                }
            };
            state.extend(both);
        }
        Some(state)
    }
}

/// By hand: `z1' = z2, z2' = x, x' = 0` with output `z1`, both `z` with known initial conditions, shows `x` in its second derivative. In steps the
/// image of a zero map shows what is gone.
#[test]
fn by_hand() {
    let one = |name: &str, knowledge| Coordinate {
        name: name.to_owned(),
        knowledge,
        is_angle: false,
        is_signal: false,
    };
    let coordinates =
        vec![one("z1", Knowledge::AtFirst), one("z2", Knowledge::AtFirst), one("x", Knowledge::Unknown)];
    let [z1, z2, x] = [0, 1, 2].map(|place| Polynomial::variable(place, 3));
    let mut model = Model {
        coordinates,
        fields: vec![vec![z2.clone(), x.clone(), Polynomial::default()]],
        outputs: vec![z1.clone()],
        steps: false,
        text: String::new(),
    };
    let state: State = [0, 0, 0].map(RBig::from).to_vec();
    let rank = |model: &Model| model.span(&model.differentials(), &state, &mut || RBig::ONE).len();
    assert_eq!(rank(&model), 1);
    model.steps = true;
    assert_eq!(rank(&model), 1);
    model.fields[0][1] = z1;
    assert_eq!(rank(&model), 0);
}
