//! Identities between functions: what exponentials, sines, roots, logarithms and principal values satisfy.
//!
//! The zero test for rational expressions takes each value of a function for an unknown of its own. Here the expressions are first
//! rewritten over *generators*, real numbers with known relations: `exp(m/D)` for a monomial `m` and the common
//! denominator `D` of its factors; sine and cosine of `m/D`, a point of the circle; `2 cos(2 pi/N)` and roots of integers;
//! square roots of what is not negative; logarithms `log |b|`; `asin` and `atan`. Each step is an equation that holds
//! wherever all terms exist and the assumptions are met, and generators that are called free may satisfy more than is known:
//! what is zero whatever they are is zero for them as they are. So *zero* is a proof, and *not zero* says nothing.
//!
//! Arguments of functions are written out (`form`) and split into factors whose signs the assumptions give (`signs`);
//! `powers` and `circular` rewrite one function each; `test` is the zero test in what was adjoined, with its bound; and
//! `principal` shows sums of principal values to be zero by their sine, cosine and range. Denominators are not known
//! beforehand: where a finer one is met, the pass begins anew with it.
//!
//! Reference for the idea, without its algorithms: R. H. Risch, *Algebraic properties of the elementary functions of
//! analysis*, Amer. J. Math. 101 (1979).

mod circular;
mod differentials;
mod form;
mod generators;
mod independence;
mod normal;
mod original;
mod points;
mod powers;
mod principal;
mod signs;
mod test;

#[cfg(test)]
mod tests;

use super::domain::Guard;
use super::graph::{Graph, Node, NodeId, Symbol};
use crate::number::{Function, Turn};
use dashu::rational::RBig;
use form::Form;
use generators::{DEEPEST, Generators, Key};
#[doc(hidden)]
pub use normal::{normal_form, without_signs};
#[doc(hidden)]
pub use points::over_generators;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::{BTreeSet, HashMap, HashSet};
use test::Tested;

/// What the relations between functions show.
#[derive(Clone, Debug, PartialEq)]
pub enum Related {
    /// All expressions are zero wherever they exist and the assumptions hold, error probability below
    /// `2^log2_error`.
    Zero {
        /// Minus infinity where nothing had to be tested.
        log2_error: f64,
        /// The number of random points.
        points: usize,
        /// The bound on the degree.
        degree: f64,
        /// The relations that were used, as text.
        used: String,
    },
    /// Nothing is shown; the reason, as text.
    NotShown(String),
    /// The expressions contain no function with relations.
    NoFunctions,
}

/// Passes begin anew at most so often, and look at no more nodes.
const MOST_PASSES: usize = 24;
const MOST_NODES: usize = 20_000;
/// The assumptions are gone through so often.
const MOST_LESSONS: usize = 6;

/// Why a rewriting ends.
#[derive(Clone, Debug)]
enum Halt {
    /// A denominator was found that is finer than what was known.
    Again,
    /// The function stays an unknown.
    Stop(String),
}

/// One pass, and what is kept from pass to pass.
struct Adjunction<'g> {
    graph: &'g mut Graph,
    rng: ChaCha8Rng,
    generators: Generators,
    /// Expressions over generators by those that were given.
    images: HashMap<NodeId, NodeId>,
    /// Expressions over generators, written out.
    forms: HashMap<NodeId, Option<Form>>,
    /// Primitive forms that are nowhere negative (`true`) or nowhere positive (`false`).
    signs: HashMap<Form, bool>,
    /// Forms that are nowhere zero.
    nonzero: HashSet<Form>,
    /// Factors that were met: they are tried on other forms.
    factors: HashSet<Form>,
    /// Inverse functions of constants, as multiples of pi where they are.
    multiples: HashMap<(Function, Form), Option<RBig>>,
    used: BTreeSet<&'static str>,
    /// Why a function was left as an unknown.
    left: Option<String>,
    error: f64,
    points: usize,
    degree: f64,
}

/// Tests whether all of some expressions are zero wherever they and all that the assumptions mention exist, and all assumptions
/// hold; angles are written out already ([`expand_angles`](super::expand_angles)). The graph is left as it was.
pub fn zero_by_relations(
    graph: &mut Graph,
    roots: &[NodeId],
    assumptions: &[Guard],
    is_angle: impl Fn(Symbol) -> bool,
    rng: &mut impl Rng,
) -> Related {
    let needed = graph.reachable(roots.iter().copied());
    // sines and cosines of angles are known to the plain test, unless the angle is met outside of them
    let is_angle = |id: NodeId| graph.as_symbol(id).is_some_and(&is_angle);
    let is_known = |id: NodeId| match graph.node(id) {
        Node::Apply(Function::Sin | Function::Cos, argument) if is_angle(argument) => true,
        Node::Apply(..) => false,
        node => !node.operands().any(is_angle),
    };
    if needed.iter().all(|id| is_known(*id)) && !roots.iter().any(|root| is_angle(*root)) {
        return Related::NoFunctions;
    }
    if needed.len() > MOST_NODES {
        return Related::NotShown(format!("its functions are met in more than {MOST_NODES} operations"));
    }
    if graph.has_no_value(roots) || !needed.iter().any(|id| matches!(graph.node(*id), Node::Apply(..))) {
        return Related::NoFunctions;
    }
    let Some(turn) = Turn::new(1) else { return Related::NoFunctions };
    let extent = graph.extent();
    let found = Adjunction::new(graph, turn, rng.random()).passes(roots, assumptions);
    graph.shrink_to(&extent);
    found
}

impl<'g> Adjunction<'g> {
    fn new(graph: &'g mut Graph, turn: Turn, seed: u64) -> Self {
        Adjunction {
            rng: ChaCha8Rng::seed_from_u64(seed),
            generators: Generators::new(turn),
            images: HashMap::new(),
            forms: HashMap::new(),
            signs: HashMap::new(),
            nonzero: HashSet::new(),
            factors: HashSet::new(),
            multiples: HashMap::new(),
            used: BTreeSet::new(),
            left: None,
            error: 0.0,
            points: 0,
            degree: 0.0,
            graph,
        }
    }

    fn passes(&mut self, roots: &[NodeId], assumptions: &[Guard]) -> Related {
        for _ in 0..MOST_PASSES {
            match self.pass(roots, assumptions) {
                Ok(found) => return found,
                Err(Halt::Stop(why)) => return Related::NotShown(why),
                Err(Halt::Again) => {}
            }
        }
        Related::NotShown("the arguments of its functions have too many denominators".to_owned())
    }

    /// Expressions over generators, with what the assumptions say.
    ///
    /// # Errors
    /// Where the pass has to begin anew.
    fn rewritten_all(&mut self, roots: &[NodeId], assumptions: &[Guard]) -> Result<Vec<NodeId>, Halt> {
        self.forms.clear();
        self.signs.clear();
        self.nonzero.clear();
        self.factors.clear();
        self.multiples.clear();
        self.used.clear();
        self.left = None;
        // one sign may follow from another
        let mut new = true;
        for _ in 0..MOST_LESSONS {
            if !std::mem::take(&mut new) {
                break;
            }
            self.images.clear();
            for assumption in assumptions {
                new |= self.learn(*assumption)?;
            }
        }
        self.images.clear();
        roots.iter().map(|root| self.rewritten(*root)).collect()
    }

    fn pass(&mut self, roots: &[NodeId], assumptions: &[Guard]) -> Result<Related, Halt> {
        let images = self.rewritten_all(roots, assumptions)?;
        let why = match self.tested(&images) {
            Tested::Zero(log2_error, points, degree) => {
                self.error += log2_error.exp2();
                self.points += points;
                self.degree = self.degree.max(degree);
                return Ok(self.zero());
            }
            Tested::NotShown(why) => why,
        };
        let mut values = true;
        for image in &images {
            values = values
                && (self.is_zero(&[*image])
                    || self.is_zero_sum_of_logarithms(*image)
                    || self.is_zero_sum_of_values(*image)?);
        }
        if values {
            if self.used.contains("inverse functions") {
                self.used.insert("the ranges of principal values");
            }
            return Ok(self.zero());
        }
        Ok(Related::NotShown(match self.left.take() {
            Some(left) => format!("{why} ({left})"),
            None => why,
        }))
    }

    fn zero(&self) -> Related {
        let used: Vec<&str> = self.used.iter().copied().collect();
        Related::Zero {
            log2_error: self.error.log2(),
            points: self.points,
            degree: self.degree,
            used: used.join(", "),
        }
    }

    /// An expression over generators.
    fn rewritten(&mut self, root: NodeId) -> Result<NodeId, Halt> {
        for id in self.graph.reachable([root]) {
            if self.images.contains_key(&id) {
                continue;
            }
            let image = match self.graph.node(id) {
                Node::Symbol(symbol) => self.node_of_key(Key::Symbol(symbol)),
                Node::Pi => self.node_of_key(Key::Pi),
                Node::Apply(function, argument) => {
                    let argument = self.images[&argument];
                    match self.applied(function, argument) {
                        Ok(image) => image,
                        Err(Halt::Again) => return Err(Halt::Again),
                        Err(Halt::Stop(why)) => {
                            self.left.get_or_insert(why);
                            self.node_of_key(Key::Opaque(function, argument))
                        }
                    }
                }
                node => {
                    let images = &self.images;
                    self.graph.rebuild(node, |operand| images[&operand])
                }
            };
            self.images.insert(id, image);
        }
        Ok(self.images[&root])
    }

    fn applied(&mut self, function: Function, argument: NodeId) -> Result<NodeId, Halt> {
        let too_long = || Halt::Stop(format!("the argument of {} is too long", function.name()));
        let form = self.form(argument).ok_or_else(too_long)?;
        if self.generators.depth(&form) >= DEEPEST {
            return Err(Halt::Stop(format!("functions are met more than {DEEPEST} deep")));
        }
        self.used.insert(match function {
            Function::Exp => "exponentials",
            Function::Log => "logarithms",
            Function::Sqrt => "square roots",
            Function::Sin | Function::Cos => "sines and cosines",
            Function::Asin | Function::Acos | Function::Atan => "inverse functions",
        });
        match function {
            Function::Exp => self.exponential(&form),
            Function::Log => self.logarithm(&form).ok_or_else(too_long),
            Function::Sqrt => self.root(&form),
            Function::Sin => Ok(self.circular(&form)?.0),
            Function::Cos => Ok(self.circular(&form)?.1),
            Function::Asin | Function::Acos | Function::Atan => self.inverse(function, &form),
        }
    }
}
