//! Matrices of expressions over generators at random points: what is needed for an upper bound on their rank, and whether it is
//! sharp.
//!
//! A minor that is zero as an expression over generators is zero wherever all terms exist and the assumptions hold, since the
//! true values satisfy all equations of the generators. So the rank over generators, found at random points modulo primes, is
//! an upper bound at every such state. Where the generators satisfy no other equations ([`GeneratorPoints::independent`]) it is
//! the rank at almost all states of every component of the domain.

use super::Adjunction;
use crate::expression::zero_test::failure_bound;
use crate::expression::{Graph, Guard, NodeId, Program, Symbol};
use crate::number::polynomial::Size;
use crate::number::{Extension, PrimeField, Refusal, Turn};
use rand::{Rng, RngExt};

/// How often a point is drawn for one round.
const ATTEMPTS: usize = 16;

/// What is known of a matrix over generators beside its values.
#[derive(Clone, Debug)]
pub struct GeneratorPoints {
    /// The probability that a minor that is not zero was zero at all points, as a power of two.
    pub log2_error: f64,
    /// Whether the generators that are no constants are shown to satisfy no equation but the known ones, on any component of
    /// the domain.
    pub independent: bool,
    /// Whether all relations between its constants are known too: at most one of them is no algebraic number.
    pub constants_known: bool,
    /// Expressions that are known up to their sign only, each of them nowhere zero where everything has derivatives.
    pub open_signs: Vec<NodeId>,
    /// Whether there are such expressions, whether or not they can be written down.
    pub signs_are_open: bool,
}

/// Evaluates a matrix of so many columns over generators at random points; `visit` is given the ring and the entries, row by row,
/// and says whether it could use them (where not, because it would have divided by a divisor of zero, another point is drawn).
/// Angles are written out already. The graph keeps what is needed to write the open signs.
///
/// # Errors
/// In words: the functions are too many or too deep, or no point was found.
pub fn over_generators(
    graph: &mut Graph,
    entries: &[NodeId],
    columns: usize,
    assumptions: &[Guard],
    rng: &mut impl Rng,
    visit: &mut dyn FnMut(&Extension, &[Vec<u64>]) -> bool,
) -> Result<GeneratorPoints, String> {
    let turn = Turn::new(1).ok_or("no turn is divided")?;
    let extent = graph.extent();
    let found = Adjunction::new(graph, turn, rng.random()).matrix(entries, columns, assumptions, visit);
    if found.as_ref().is_ok_and(|found| found.open_signs.is_empty()) {
        graph.shrink_to(&extent);
    }
    found
}

impl Adjunction<'_> {
    fn matrix(
        &mut self,
        entries: &[NodeId],
        columns: usize,
        assumptions: &[Guard],
        visit: &mut dyn FnMut(&Extension, &[Vec<u64>]) -> bool,
    ) -> Result<GeneratorPoints, String> {
        let images = self.images_of(entries, assumptions)?;
        let standing = self.standing(&images);
        let open_signs = standing.open.iter().filter_map(|form| self.original(form)).collect();
        let known = GeneratorPoints {
            log2_error: f64::NEG_INFINITY,
            independent: standing.independent,
            constants_known: standing.constants_known,
            open_signs,
            signs_are_open: !standing.open.is_empty(),
        };
        if !standing.open.is_empty() {
            // of each branch by itself more is known, and its elements are shorter
            return Ok(known);
        }
        let roots = self.roots_below(&images);
        self.is_short(&roots)?;
        let program = self.program(&images);
        let size = self.size_of_minors(&program, &roots, columns).map_err(|refusal| refusal.to_string())?;
        let (rounds, log2_error) =
            failure_bound(size).ok_or_else(|| format!("the degree of a minor may be {:.1e}", size.degree))?;
        // each round draws several points, any of which may mislead
        let each = log2_error / rounds as f64 + (ATTEMPTS as f64).log2();
        let rounds = (-100.0 / each).ceil();
        for _ in 0..rounds as usize {
            let mut used = false;
            for _ in 0..ATTEMPTS {
                let field = PrimeField::random(&mut self.rng);
                if let Some((ring, values)) = self.point(&program, &roots, field)
                    && visit(&ring, &values)
                {
                    used = true;
                    break;
                }
            }
            if !used {
                return Err("no random point could be evaluated".to_owned());
            }
        }
        Ok(GeneratorPoints { log2_error: rounds * each, ..known })
    }

    /// A bound on the numerator of any minor: each row over its own denominator, each minor at most as long as all rows.
    fn size_of_minors(
        &mut self,
        program: &Program,
        roots: &[super::test::Root],
        columns: usize,
    ) -> Result<Size, Refusal> {
        let entries = self.sizes(program, roots)?;
        let mut rows: Vec<Size> = entries
            .chunks(columns.max(1))
            .map(|row| {
                row.iter().fold(Size::default(), |sum, (top, bottom)| Size {
                    degree: sum.degree + top.degree.max(bottom.degree),
                    bits: sum.bits + top.bits.max(bottom.bits),
                })
            })
            .collect();
        let kept = rows.len().min(columns);
        let factorial: f64 = (1..=kept).map(|k| (k as f64).log2()).sum();
        rows.sort_by(|a, b| b.degree.total_cmp(&a.degree));
        let degree = rows.iter().take(kept).map(|row| row.degree).sum();
        rows.sort_by(|a, b| b.bits.total_cmp(&a.bits));
        let bits = rows.iter().take(kept).map(|row| row.bits).sum::<f64>() + factorial;
        Ok(Size { degree, bits: bits + self.weight_of_turn() })
    }

    /// The symbol of which a generator is made, if it is one of those that were given.
    pub(super) fn given_symbol(&self, variable: u32) -> Option<Symbol> {
        match self.generators.key(variable) {
            super::Key::Symbol(symbol) => Some(*symbol),
            _ => None,
        }
    }
}
