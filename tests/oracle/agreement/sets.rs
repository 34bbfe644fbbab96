//! Sets of states that conditions describe, and states of them.

use super::super::dice::Dice;
use super::model::{Knowledge, Model, State};
use super::polynomial::Polynomial;
use dashu::rational::RBig;

/// What a condition does to a state.
#[derive(Clone, Debug)]
enum Fix {
    Number(usize, RBig),
    Same(usize, usize),
    Turn(usize, [i64; 2]),
}

/// Conditions, all of them to be met.
#[derive(Clone, Debug)]
pub struct Set {
    /// As a proof file writes them.
    pub text: String,
    /// What vanishes on it.
    pub vanishing: Vec<Polynomial>,
    /// Each way to meet them.
    components: Vec<Vec<Fix>>,
}

impl Set {
    /// How many ways there are to meet the conditions.
    pub fn components(&self) -> usize {
        self.components.len()
    }

    /// Whether a state meets all of them.
    pub fn holds(&self, state: &State) -> bool {
        self.vanishing.iter().all(|one| one.at(state).is_zero())
    }

    /// All states.
    pub fn all() -> Set {
        Set { text: String::new(), vanishing: Vec::new(), components: vec![Vec::new()] }
    }

    /// One or two random conditions; a value that is given at the beginning is not given another time.
    pub fn drawn(model: &Model, dice: &mut Dice) -> Option<Set> {
        let first = one_condition(model, dice)?;
        if !dice.once_in(3) {
            return Some(first);
        }
        let second = one_condition(model, dice)?;
        let touched = |set: &Set| -> Vec<usize> {
            let of_fix = |fix: &Fix| match fix {
                Fix::Number(one, _) | Fix::Turn(one, _) => vec![*one],
                Fix::Same(one, other) => vec![*one, *other],
            };
            set.components.iter().flatten().flat_map(of_fix).collect()
        };
        if touched(&first).iter().any(|one| touched(&second).contains(one)) {
            return Some(first);
        }
        let both = |one: &Vec<Fix>| {
            let one = one.clone();
            second
                .components
                .iter()
                .map(move |other| [one.clone(), other.clone()].concat())
                .collect::<Vec<_>>()
        };
        Some(Set {
            text: format!("{}, {}", first.text, second.text),
            vanishing: [first.vanishing.clone(), second.vanishing.clone()].concat(),
            components: first.components.iter().flat_map(both).collect(),
        })
    }

    /// A state of one component: at random, or at numbers at which something may happen.
    pub fn state(&self, model: &Model, component: usize, special: bool, dice: &mut Dice) -> State {
        let mut state = State::new();
        for one in &model.coordinates {
            if one.is_angle {
                let turn = match special {
                    true => dice.one_of(&[[0, -1], [0, -1], [0, 1], [1, 0], [-1, 0]]).map(RBig::from),
                    false => on_the_circle(&generic(dice)),
                };
                state.extend(turn);
                continue;
            }
            state.push(match &one.knowledge {
                Knowledge::Number(value) => value.clone(),
                _ if special && !dice.once_in(4) => dice.special(),
                _ => generic(dice),
            });
        }
        for fix in &self.components[component] {
            match fix {
                Fix::Number(one, value) => state[model.place(*one)] = value.clone(),
                Fix::Same(one, other) => state[model.place(*one)] = state[model.place(*other)].clone(),
                Fix::Turn(one, turn) => {
                    let place = model.place(*one);
                    turn.iter().zip(place..).for_each(|(value, place)| state[place] = RBig::from(*value));
                }
            }
        }
        state
    }
}

/// A number that hardly ever satisfies an equation with small coefficients, alone or with others.
fn generic(dice: &mut Dice) -> RBig {
    let top = dice.between(101, 997) * dice.one_of(&[1i64, -1]);
    RBig::from(top) / RBig::from(dice.one_of(&[7i64, 11, 13, 17]))
}

/// Sine and cosine of the angle whose half has this tangent.
fn on_the_circle(t: &RBig) -> [RBig; 2] {
    let square = t * t;
    let bottom = RBig::ONE + &square;
    [(t + t) / &bottom, (RBig::ONE - square) / bottom]
}

fn one_condition(model: &Model, dice: &mut Dice) -> Option<Set> {
    let all = Model::variables(&model.coordinates);
    let variable = |coordinate: usize| Polynomial::variable(model.place(coordinate), all);
    let less = |value: &RBig| Polynomial::constant(-value.clone(), all);
    let name = |one: usize| model.coordinates[one].name.clone();
    let count = model.coordinates.len();
    let is_free = |one: &usize| !matches!(model.coordinates[*one].knowledge, Knowledge::Number(_));
    let angles: Vec<usize> = (0..count).filter(|one| model.coordinates[*one].is_angle).collect();
    let plain: Vec<usize> =
        (0..count).filter(|one| !model.coordinates[*one].is_angle && is_free(one)).collect();
    if !angles.is_empty() && dice.once_in(2) {
        let one = dice.one_of(&angles);
        let (sine, cosine) = (variable(one), Polynomial::variable(model.place(one) + 1, all));
        let angle = name(one);
        let off = |value: i64| cosine.plus(&less(&RBig::from(value)));
        let (text, vanishing, turns): (String, Vec<Polynomial>, Vec<[i64; 2]>) = match dice.below(6) {
            0 => (format!("sin({angle}) = 0"), vec![sine], vec![[0, 1], [0, -1]]),
            1 => (format!("cos({angle}) = 0"), vec![cosine.clone()], vec![[1, 0], [-1, 0]]),
            2 => (format!("cos({angle}) = -1"), vec![off(-1)], vec![[0, -1]]),
            3 => (format!("cos({angle}) = 1"), vec![off(1)], vec![[0, 1]]),
            4 => (format!("cos({angle}) = 1, sin({angle}) = 0"), vec![off(1), sine], vec![[0, 1]]),
            _ => {
                let one_off = sine.plus(&less(&RBig::ONE));
                (format!("cos({angle}) = 0, sin({angle}) = 1"), vec![cosine.clone(), one_off], vec![[1, 0]])
            }
        };
        let components = turns.into_iter().map(|turn| vec![Fix::Turn(one, turn)]).collect();
        return Some(Set { text, vanishing, components });
    }
    if plain.is_empty() {
        return None;
    }
    let (one, other) = (dice.one_of(&plain), dice.one_of(&plain));
    let value = dice.special();
    Some(match dice.below(5) {
        0 if one != other => Set {
            text: format!("{}*{} = 0", name(one), name(other)),
            vanishing: vec![variable(one).times(&variable(other))],
            components: vec![vec![Fix::Number(one, RBig::ZERO)], vec![Fix::Number(other, RBig::ZERO)]],
        },
        1 if one != other => Set {
            text: format!("{} = {}", name(one), name(other)),
            vanishing: vec![variable(one).plus(&variable(other).scaled(&RBig::from(-1)))],
            components: vec![vec![Fix::Same(one, other)]],
        },
        _ => Set {
            text: format!("{} = {value}", name(one)),
            vanishing: vec![variable(one).plus(&less(&value))],
            components: vec![vec![Fix::Number(one, value)]],
        },
    })
}
