//! Random systems: states with a known initial condition, signals, parameters, angles, steps.

use super::super::dice::Dice;
use super::model::{Coordinate, Knowledge, Model};
use super::polynomial::Polynomial;
use dashu::rational::RBig;

pub const CLASSES: [&str; 7] =
    ["plain", "known at first", "signals", "numbers at first", "steps", "angles", "known and signals"];

/// A random system of a class.
pub fn model(class: &str, dice: &mut Dice) -> Model {
    let coordinates = coordinates(class, dice);
    let steps = class == "steps";
    let names = Model::names(&coordinates);
    let count = coordinates.len();
    let rate = |one: &Coordinate| !one.is_signal && (one.name.starts_with(['x', 'z']) || one.is_angle);
    let mut drift: Vec<Polynomial> = vec![Polynomial::default(); count];
    let moving: Vec<usize> = (0..count).filter(|place| rate(&coordinates[*place])).collect();
    for (number, place) in moving.iter().enumerate() {
        // chains show late what is unknown
        let next = moving.get(number + 1).filter(|next| !coordinates[**next].is_angle);
        drift[*place] = match (dice.below(5), next) {
            (0 | 1, Some(next)) => variable(&coordinates, *next),
            (2, _) if !steps => Polynomial::default(),
            _ => polynomial(&coordinates, dice, 2),
        };
    }
    let mut fields = vec![drift];
    let signals: Vec<usize> = (0..count).filter(|place| coordinates[*place].is_signal).collect();
    if !steps {
        for signal in &signals {
            let mut field = vec![Polynomial::default(); count];
            field[*signal] = Polynomial::constant(RBig::ONE, names.len());
            fields.push(field);
        }
    }
    let input = !steps && class == "plain" && dice.once_in(3);
    if input {
        let mut field = vec![Polynomial::default(); count];
        field[dice.one_of(&moving)] = polynomial(&coordinates, dice, 1);
        fields.push(field);
    }
    let mut outputs = vec![match dice.below(3) {
        0 if !coordinates[moving[0]].is_angle => variable(&coordinates, moving[0]),
        _ => polynomial(&coordinates, dice, 2),
    }];
    if dice.once_in(3) {
        outputs.push(polynomial(&coordinates, dice, 2));
    }
    let mut model = Model { coordinates, fields, outputs, steps, text: String::new() };
    if steps {
        // what no rate is written for stays
        for place in 0..count {
            if !moving.contains(&place) {
                model.fields[0][place] = variable(&model.coordinates, place);
            }
        }
    }
    model.text = text(&model, &moving, input);
    model
}

fn variable(coordinates: &[Coordinate], place: usize) -> Polynomial {
    Polynomial::variable(Model::variables(&coordinates[..place]), Model::variables(coordinates))
}

/// A sum of one to three short terms.
fn polynomial(coordinates: &[Coordinate], dice: &mut Dice, degree: usize) -> Polynomial {
    let all = Model::variables(coordinates);
    let mut sum = Polynomial::default();
    for _ in 0..1 + dice.below(3) {
        let mut term = Polynomial::constant(RBig::from(dice.factor()), all);
        for _ in 0..1 + dice.below(degree + 1) {
            term = term.times(&Polynomial::variable(dice.below(all), all));
        }
        sum = sum.plus(&term);
    }
    sum
}

fn coordinates(class: &str, dice: &mut Dice) -> Vec<Coordinate> {
    let one = |name: &str, knowledge| Coordinate {
        name: name.to_owned(),
        knowledge,
        is_angle: false,
        is_signal: false,
    };
    let mut found: Vec<Coordinate> = Vec::new();
    let known = match class {
        "known at first" | "known and signals" => 1 + dice.below(2),
        "steps" => dice.below(2),
        "numbers at first" => 1,
        _ => 0,
    };
    for place in 1..=known {
        let knowledge = match class {
            "numbers at first" => Knowledge::Number(dice.special()),
            _ => Knowledge::AtFirst,
        };
        found.push(one(&format!("z{place}"), knowledge));
    }
    for place in 1..=1 + dice.below(if known > 1 { 1 } else { 2 }) {
        found.push(one(&format!("x{place}"), Knowledge::Unknown));
    }
    if class == "angles" {
        found.push(Coordinate { is_angle: true, ..one("phi", Knowledge::Unknown) });
    }
    if dice.once_in(2) || class == "steps" {
        found.push(one("a", Knowledge::Unknown));
    }
    if dice.once_in(6) {
        found.push(one("k", Knowledge::Always));
    }
    if matches!(class, "signals" | "known and signals") || class == "steps" && dice.once_in(2) {
        found.push(Coordinate { is_signal: true, ..one("u", Knowledge::Always) });
    }
    found
}

fn text(model: &Model, moving: &[usize], input: bool) -> String {
    let names = Model::names(&model.coordinates);
    let name = |place: &usize| model.coordinates[*place].name.clone();
    let mut text = String::from("system \"drawn\"\n");
    let list: Vec<String> = moving.iter().map(name).collect();
    text.push_str(&format!("state {}\n", list.join(", ")));
    for one in &model.coordinates {
        match (one.name.as_str(), one.is_angle) {
            ("a", _) => text.push_str("param a unknown\n"),
            ("k", _) => text.push_str("param k\n"),
            ("u", _) => text.push_str("known u(t)\n"),
            (name, true) => text.push_str(&format!("angle {name}\n")),
            _ => {}
        }
    }
    let sign = if model.steps { "+" } else { "'" };
    text.push_str("drift f\n");
    for place in moving {
        text.push_str(&format!("  {}{sign} = {}\n", name(place), model.fields[0][*place].text(&names)));
    }
    if let Some(field) = model.fields.last().filter(|_| input) {
        text.push_str("input g\n");
        for place in moving {
            text.push_str(&format!("  {}' = {}\n", name(place), field[*place].text(&names)));
        }
    }
    let outputs: Vec<String> = model.outputs.iter().map(|output| output.text(&names)).collect();
    text.push_str(&format!("output {}\n", outputs.join(", ")));
    for one in &model.coordinates {
        match &one.knowledge {
            Knowledge::AtFirst => text.push_str(&format!("initial {} known\n", one.name)),
            Knowledge::Number(value) => text.push_str(&format!("initial {} = {value}\n", one.name)),
            _ => {}
        }
    }
    text
}
