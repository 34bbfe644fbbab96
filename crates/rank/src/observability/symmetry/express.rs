//! A function of the old coordinates as a polynomial of low degree in observable functions, by linear equations at random points
//! modulo a prime: `L_f (x^2 + y^2) = 2 (x u + y v)`. That it is that function is proved elsewhere.

use super::modular::{Echelon, Residues, in_integers};
use palmistry_lang::System;
use palmistry_math::expression::{Graph, NodeId, Program, draw_residues, expand_angles};
use palmistry_math::number::PrimeField;
use rand_chacha::ChaCha8Rng;

/// What a polynomial may be made of: the function of the old coordinates, and the name that it has in the new system.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ingredient {
    pub old: NodeId,
    pub new: NodeId,
    /// A sine, whose square is left out: it is one less that of the cosine.
    pub is_sine: bool,
}

/// No more unknown coefficients than this are solved for at once.
const MOST_UNKNOWNS: usize = 300;
const HIGHEST_DEGREE: usize = 3;
/// How often a point is drawn anew because it is a pole.
const ATTEMPTS: usize = 40;

/// The polynomial of least degree in the ingredients that a function is, in the new names.
pub(super) fn as_polynomial(
    system: &mut System,
    function: NodeId,
    ingredients: &[Ingredient],
    rng: &mut ChaCha8Rng,
) -> Option<NodeId> {
    if system.graph.constant_value(function).is_some() {
        return Some(function);
    }
    let is_angle = &system.angle_test();
    let mut nodes: Vec<NodeId> = ingredients.iter().map(|ingredient| ingredient.old).collect();
    nodes.push(function);
    let nodes = expand_angles(&mut system.graph, &nodes, is_angle);
    let program = Program::with_unknown_functions(&system.graph, &nodes, is_angle);
    if program.bare_angle().is_some() || program.unknown_function(&system.graph).is_some() {
        return None;
    }
    let residues = Residues(PrimeField::random(rng));
    let mut products: Vec<Vec<usize>> = vec![Vec::new()];
    let mut all = products.clone();
    for _ in 1..=HIGHEST_DEGREE {
        products = longer(&products, ingredients);
        all.extend(products.iter().cloned());
        if all.len() > MOST_UNKNOWNS {
            return None;
        }
        if let Some(coefficients) = solution(&program, residues, &all, rng) {
            return Some(combination(&mut system.graph, ingredients, &all, &coefficients));
        }
    }
    None
}

/// All products with one factor more, each once.
fn longer(products: &[Vec<usize>], ingredients: &[Ingredient]) -> Vec<Vec<usize>> {
    let next = |product: &Vec<usize>| {
        let begin = product.last().copied().unwrap_or(0);
        let allowed = |at: &usize| !(ingredients[*at].is_sine && product.last() == Some(at));
        (begin..ingredients.len())
            .filter(allowed)
            .map(|at| [product.as_slice(), &[at]].concat())
            .collect::<Vec<_>>()
    };
    products.iter().flat_map(next).collect()
}

/// The coefficients of the products, and last that of the function, with which all of them add up to nought.
fn solution(
    program: &Program,
    residues: Residues,
    products: &[Vec<usize>],
    rng: &mut ChaCha8Rng,
) -> Option<Vec<i64>> {
    let loaded = program.load(residues.0).ok()?;
    let (mut echelon, mut idle) = (Echelon::new(residues, products.len() + 1), 0);
    while idle < 3 && echelon.rank() <= products.len() {
        let values = (0..ATTEMPTS).find_map(|_| {
            let inputs = draw_residues(program, &residues.0, rng);
            loaded.run(&inputs, &mut Vec::new()).ok()
        })?;
        let product =
            |list: &Vec<usize>| list.iter().fold(residues.one(), |all, at| residues.mul(all, values[*at]));
        let row = products.iter().map(product).chain(values.last().copied()).collect();
        idle = if echelon.add(row) { 0 } else { idle + 1 };
    }
    let (_, basis) = echelon.kernel();
    let found = basis.iter().filter(|vector| vector.last().is_some_and(|last| *last != 0));
    found.filter_map(|vector| in_integers(residues, vector)).next()
}

fn combination(
    graph: &mut Graph,
    ingredients: &[Ingredient],
    products: &[Vec<usize>],
    coefficients: &[i64],
) -> NodeId {
    let of_function = coefficients.last().copied().unwrap_or(1);
    let mut sum = graph.integer(0);
    for (product, coefficient) in products.iter().zip(coefficients).filter(|(_, c)| **c != 0) {
        let share = dashu::rational::RBig::from(-coefficient) / dashu::rational::RBig::from(of_function);
        let mut term = graph.rational(share);
        for at in product {
            term = graph.mul(term, ingredients[*at].new);
        }
        sum = graph.add(sum, term);
    }
    sum
}
