//! A question about some coordinates alone.
//!
//! Full rank is proved where all of some factors are different from zero, and with them all of those of one minor of
//! several. Factors that have no coordinate in common can be examined separately: the set on which the whole is proved is
//! then a product of sets of fewer dimensions, and its volume the product of theirs. What a search costs grows with the
//! power of the dimension.

use super::boxes::Chart;
use super::collector::{Collector, Ranges};
use super::factor::Factor;
use super::slots::Slots;
use super::tape::Tape;
use palmistry_math::expression::{Graph, NodeId};

/// A minor, as a product of factors.
#[derive(Clone, Debug, PartialEq)]
pub struct FactoredMinor {
    /// The rows beside the unit rows, by name, and by their places among all rows.
    pub rows: Vec<String>,
    pub(super) places: Vec<usize>,
    /// The factors, by their places: where the rows are defined the minor is zero where one of these is.
    pub(super) factors: Vec<usize>,
    /// What has to be different from zero besides, for the rows to be defined.
    pub(super) below: Vec<usize>,
}

/// One of several minors, or what of it belongs to one part.
#[derive(Clone, Debug)]
pub(super) struct Alternative {
    /// Its place among the minors.
    pub minor: usize,
    /// Its factors, by their places in the part.
    pub factors: Vec<usize>,
    /// What has to be different from zero besides, for the factors to say what they say.
    pub below: Vec<usize>,
}

impl Alternative {
    /// All that has to be different from zero.
    pub fn all(&self) -> impl Iterator<Item = &usize> {
        self.factors.iter().chain(&self.below)
    }
}

/// Some coordinates, and what has to be different from zero.
pub(super) struct Part {
    pub chart: Chart,
    pub factors: Vec<Factor>,
    /// Factors without which the system, or a row, is not defined.
    pub guards: Vec<usize>,
    /// Factors that are asked of all minors, and a minor that has each of them.
    pub common: Vec<usize>,
    pub common_of: Vec<usize>,
    /// Of these, one has to be different from zero; there is no such condition where there are none.
    pub alternatives: Vec<Alternative>,
    /// Where there is no such condition: the minor that has nothing but what is asked of all.
    pub minor_of_all: Option<usize>,
    /// What sampled states keep away from.
    pub avoid: Vec<Tape>,
}

impl Part {
    /// The number of its coordinates, of the factors that are asked of all minors, and of the minors.
    pub fn shape(&self) -> (usize, usize, usize) {
        (self.chart.coordinates().len(), self.common.len(), self.alternatives.len())
    }
}

/// What has to be different from zero, before it is divided into parts.
pub(super) struct Demand<'a> {
    pub guards: &'a [usize],
    pub minors: &'a [FactoredMinor],
    pub avoid: &'a [NodeId],
    /// Factors of at most this many coordinates are required of all minors, even if only one has them: little is lost,
    /// and the others can be examined separately.
    pub asked_of_all: usize,
}

impl Demand<'_> {
    /// What every minor needs to be defined, and the factors that are asked of all.
    fn in_common(&self, size: impl Fn(usize) -> usize) -> (Vec<usize>, Vec<usize>) {
        let of_all = |list: fn(&FactoredMinor) -> &Vec<usize>| -> Vec<usize> {
            let Some((first, rest)) = self.minors.split_first() else { return Vec::new() };
            list(first).iter().copied().filter(|f| rest.iter().all(|minor| list(minor).contains(f))).collect()
        };
        let mut guards = self.guards.to_vec();
        guards.extend(of_all(|minor| &minor.below));
        let mut common = of_all(|minor| &minor.factors);
        let small = self.minors.iter().flat_map(|minor| minor.factors.iter().copied());
        common.extend(small.filter(|factor| (1..=self.asked_of_all).contains(&size(*factor))));
        for list in [&mut guards, &mut common] {
            list.sort_unstable();
            list.dedup();
        }
        common.retain(|factor| !guards.contains(factor));
        (guards, common)
    }

    /// Divides the demand into parts that have no coordinate in common.
    ///
    /// # Errors
    /// In words: a symbol has neither range nor value.
    pub fn parts(&self, graph: &Graph, collector: &Collector, ranges: &Ranges) -> Result<Vec<Part>, String> {
        let of_factor = |factor: &usize| ranges.coordinates_of(graph, collector.node(*factor));
        let (guards, common) = self.in_common(|factor| of_factor(&factor).len());
        let own = |list: &[usize]| -> Vec<usize> {
            list.iter().copied().filter(|f| !guards.contains(f) && !common.contains(f)).collect()
        };
        let mut alternatives: Vec<Alternative> = (self.minors.iter().enumerate())
            .map(|(minor, m)| Alternative { minor, factors: own(&m.factors), below: own(&m.below) })
            .collect();
        let minor_of_all = alternatives.iter().find(|own| own.all().next().is_none()).map(|own| own.minor);
        if minor_of_all.is_some() {
            alternatives.clear(); // one minor has nothing but what all have
        }
        let mut groups = Groups::new(ranges.free.len());
        for factor in guards.iter().chain(&common) {
            groups.join(&of_factor(factor));
        }
        let of_alternatives: Vec<usize> =
            alternatives.iter().flat_map(Alternative::all).flat_map(of_factor).collect();
        groups.join(&of_alternatives);
        for node in self.avoid {
            groups.join(&ranges.coordinates_of(graph, *node));
        }
        let home = |coordinates: &[usize]| coordinates.first().map(|first| groups.of[*first]);
        let alternatives_home = home(&of_alternatives);

        let used = guards.iter().chain(&common).chain(alternatives.iter().flat_map(Alternative::all));
        let mut homes: Vec<Option<usize>> = used.map(|factor| home(&of_factor(factor))).collect();
        homes.extend(self.avoid.iter().map(|node| home(&ranges.coordinates_of(graph, *node))));
        if homes.is_empty() {
            homes.push(None); // nothing is asked
        }
        homes.sort_unstable();
        homes.dedup();
        let mut parts = Vec::new();
        for this in homes {
            let here = |factor: &&usize| home(&of_factor(factor)) == this;
            let guards: Vec<usize> = guards.iter().filter(here).copied().collect();
            let common: Vec<usize> = common.iter().filter(here).copied().collect();
            let mine = !alternatives.is_empty() && alternatives_home == this;
            let alternatives: &[Alternative] = if mine { &alternatives } else { &[] };
            let of_them = alternatives.iter().flat_map(Alternative::all);
            let mut needed: Vec<usize> = guards.iter().chain(&common).chain(of_them).copied().collect();
            needed.sort_unstable();
            needed.dedup();
            let moved = |list: &[usize]| -> Vec<usize> {
                list.iter().filter_map(|factor| needed.binary_search(factor).ok()).collect()
            };
            let ranges = ranges.only(|coordinate| Some(groups.of[coordinate]) == this);
            let mut slots = Slots::default();
            let factors = collector.factors(graph, &needed, &ranges, &mut slots)?;
            let avoided = self.avoid.iter().filter(|node| match this {
                Some(_) => !ranges.coordinates_of(graph, **node).is_empty(),
                None => false,
            });
            let avoid =
                avoided.map(|node| ranges.tape(graph, *node, &mut slots)).collect::<Result<_, _>>()?;
            let moved_alternative = |own: &Alternative| Alternative {
                minor: own.minor,
                factors: moved(&own.factors),
                below: moved(&own.below),
            };
            parts.push(Part {
                chart: Chart::new(ranges.free, slots),
                factors,
                guards: moved(&guards),
                common: moved(&common),
                common_of: common
                    .iter()
                    .map(|f| self.minors.iter().position(|minor| minor.factors.contains(f)).unwrap_or(0))
                    .collect(),
                alternatives: alternatives.iter().map(moved_alternative).collect(),
                minor_of_all,
                avoid,
            });
        }
        Ok(parts)
    }
}

/// Coordinates that belong together, by the least of each group.
struct Groups {
    of: Vec<usize>,
}

impl Groups {
    fn new(count: usize) -> Self {
        Groups { of: (0..count).collect() }
    }

    fn join(&mut self, members: &[usize]) {
        let groups: Vec<usize> = members.iter().map(|member| self.of[*member]).collect();
        if let Some(least) = groups.iter().min().copied() {
            self.of.iter_mut().filter(|group| groups.contains(group)).for_each(|group| *group = least);
        }
    }
}
