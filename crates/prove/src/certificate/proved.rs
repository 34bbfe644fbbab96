//! What was proved, to be checked by others: the largest proved boxes, each with the rows of the minor by which it was
//! proved, beside rows and guards as they were written.

use super::boxes::Side;
use super::region::Region;
use super::rows::{HeldSymbol, RegionRow};
use dashu::integer::UBig;
use dashu::rational::RBig;
use palmistry_math::expression::Guard;

/// A box on which full rank is proved.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProvedBox {
    /// Low and high end for each of [`Region::ranges`], exactly.
    pub sides: Vec<[RBig; 2]>,
    /// The rows of the minor, by their places among [`Region::rows`], as many as there are states.
    pub rows: Vec<usize>,
}

/// A proved box of each of the first parts, by their places among those that are kept, and the number of halvings that led
/// to all of them.
struct Combination {
    depth: usize,
    places: Vec<usize>,
}

impl Region {
    /// The rows, as they were written.
    pub fn rows(&self) -> &[RegionRow] {
        &self.problem.written.rows
    }

    /// Whether these are the file's own rows, and not the differentials of Lie derivatives.
    pub fn is_of_own_rows(&self) -> bool {
        self.problem.order.is_none()
    }

    /// Where the rows and their system exist, as it was written.
    pub fn guards(&self) -> &[Guard] {
        &self.problem.written.guards
    }

    /// The symbols that are fixed.
    pub fn held(&self) -> &[HeldSymbol] {
        &self.problem.written.held
    }

    /// Keeps so many proved boxes of each part from now on.
    pub fn keep_boxes(&mut self, most: usize) {
        self.searches.searches.iter_mut().for_each(|search| search.most_kept = most);
    }

    /// How many boxes are proved: a box is one of each part.
    pub fn proved_box_count(&self) -> UBig {
        let searches = &self.searches.searches;
        if searches.is_empty() {
            return UBig::ZERO;
        }
        searches.iter().fold(UBig::ONE, |product, search| product * UBig::from(search.proved.boxes()))
    }

    /// The proved part of the volume, exactly.
    pub fn proved_exactly(&self) -> RBig {
        self.searches.exact()
    }

    /// The largest proved boxes, the largest first, as far as they were kept.
    pub fn proved_boxes(&self, most: usize) -> Vec<ProvedBox> {
        let searches = &self.searches.searches;
        if searches.is_empty() {
            return Vec::new();
        }
        let mut found = vec![Combination { depth: 0, places: Vec::new() }];
        for search in searches {
            let depth = |place: usize| -> usize {
                search.kept[place].sides.iter().map(|side| usize::from(side.depth)).sum()
            };
            let mut order: Vec<usize> = (0..search.kept.len()).collect();
            order.sort_by_key(|place| depth(*place)); // stable
            let mut next = Vec::new();
            for (before, combination) in found.iter().enumerate() {
                // of two sorted lists these are all pairs that can be among the first
                for place in order.iter().take(most / (before + 1)) {
                    let places = combination.places.iter().copied().chain([*place]).collect();
                    next.push(Combination { depth: combination.depth + depth(*place), places });
                }
            }
            next.sort_by_key(|combination| combination.depth); // stable
            next.truncate(most);
            found = next;
        }
        found.iter().filter_map(|combination| self.proved_box(&combination.places)).collect()
    }

    fn proved_box(&self, places: &[usize]) -> Option<ProvedBox> {
        let mut sides: Vec<[RBig; 2]> =
            self.ranges().iter().map(|range| range.exact_ends(Side::WHOLE)).collect();
        let mut minor = None;
        let parts = self.problem.parts.iter().zip(&self.searches.searches);
        for ((part, search), place) in parts.zip(places) {
            let cell = search.kept.get(*place)?;
            for (coordinate, side) in part.chart.coordinates().iter().zip(&cell.sides) {
                let at = self.ranges().iter().position(|range| range.symbol == coordinate.symbol)?;
                sides[at] = coordinate.exact_ends(*side);
            }
            minor = minor.or(cell.minor).or(part.minor_of_all);
        }
        let minor = self.problem.minors.get(minor?)?;
        let rows = self.problem.written.unit_rows.iter().chain(&minor.places).copied().collect();
        Some(ProvedBox { sides, rows })
    }
}
