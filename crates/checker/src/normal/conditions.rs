//! Equations that follow from others: conditions are solved, part by part of the set on which they hold, and the rest is divided out.

use super::super::claim::ListedClaim;
use super::super::doubt::{Effort, Missing};
use super::super::listing::{Listing, Step};
use super::super::witness::{Requirement, RequirementKind, Sides, SidesRelation};
use super::polynomial::IntegerPolynomial;
use super::{Atom, Normal, Part, Quotient, Stop, Term, with_divisors};
use dashu::rational::RBig;
use palmistry_math::number::{Function, Refusal};
use std::collections::{BTreeMap, BTreeSet};

/// Conditions are solved in no more parts.
const MOST_PARTS: usize = 64;

/// Slopes of slopes are asked for zeros no deeper.
const DEEPEST_SLOPE: usize = 8;

/// Equations of a listing, and what is assumed of the states at which they hold.
#[derive(Clone, Copy, Debug)]
pub struct Equations<'l> {
    pub listing: &'l Listing,
    pub sides: &'l [Sides],
    pub conditions: &'l [Sides],
    pub requirements: &'l [Requirement],
}

impl<'l> Equations<'l> {
    /// What a claim assumes.
    pub fn without_sides(claim: &'l ListedClaim) -> Self {
        Equations {
            listing: &claim.listing,
            sides: &[],
            conditions: &claim.conditions,
            requirements: &claim.requirements,
        }
    }
}

/// Whether the states are an open part of those at which equations hold: closed inequalities may leave parts of fewer dimensions, on which nothing is generic.
pub(super) fn are_open(states: Equations<'_>) -> bool {
    let is_open = |relation| !matches!(relation, SidesRelation::AtMost | SidesRelation::AtLeast);
    let needs = |kind| {
        matches!(kind, RequirementKind::NotZero | RequirementKind::Positive | RequirementKind::InsideOne)
    };
    states.conditions.iter().all(|condition| is_open(condition.relation))
        && states.requirements.iter().all(|requirement| needs(requirement.kind))
}

/// Whether something holds on each part of the set on which conditions hold, of which there is one at least: of no state nothing is generic. `false` where the set is not open among the solutions of its equations, or these are not solved.
///
/// # Errors
/// Where it takes too much work, or an operation has no value.
pub(super) fn on_each_part(
    states: Equations<'_>,
    effort: &Effort,
    holds: impl Fn(&mut Normal<'_>, &Part) -> Result<bool, Stop>,
) -> Result<bool, Missing> {
    if !are_open(states) {
        return Ok(false);
    }
    with_divisors(effort, |normal| {
        let mut solved = Vec::new();
        if !normal.solve(states, &mut solved)? || solved.is_empty() {
            return Ok(false);
        }
        for part in solved {
            normal.set(part.clone());
            if !holds(normal, &part)? {
                return Ok(false);
            }
        }
        Ok(true)
    })
}

/// Whether both sides are equal at all states at which they exist, the conditions hold and the requirements are met. `false` says nothing.
///
/// # Errors
/// Where it takes too much work, or an operation has no value.
pub fn follow(equations: Equations<'_>, effort: &Effort) -> Result<bool, Missing> {
    if equations.sides.is_empty()
        || equations.sides.iter().any(|sides| sides.relation != SidesRelation::Equal)
    {
        return Ok(false);
    }
    with_divisors(effort, |normal| {
        let mut parts = 0;
        normal.follow_on(equations, Part::default(), &mut parts)
    })
}

/// How a factor that is zero can be solved.
pub(super) enum Solution {
    Symbol(String, Quotient),
    Angle(Term, [i32; 2]),
}

/// What is known on a part of the states.
struct Known {
    /// Differences of the sides.
    sides: Vec<Quotient>,
    /// Differences of conditions that are equations, those that are zero left out; with the argument, where it is a sine or a cosine that vanishes.
    zero: Vec<(Quotient, Option<(Function, Quotient)>)>,
    /// Factors that are zero nowhere.
    not_zero: BTreeSet<u32>,
}

/// What has to be done on a part of the set.
enum Narrowing {
    /// There is no state on it.
    Empty,
    /// What is known on it, polynomials that are zero there, and the narrower parts into which it falls where one of them can be solved.
    Into(Known, Vec<IntegerPolynomial>, Option<Vec<Part>>),
}

impl Normal<'_> {
    /// Shows the sides equal on a part of the set, or on all parts into which it falls.
    fn follow_on(&mut self, equations: Equations<'_>, part: Part, parts: &mut usize) -> Result<bool, Stop> {
        *parts += 1;
        if *parts > MOST_PARTS {
            return Err(Missing::Effort.into());
        }
        match self.narrowed(equations, part)? {
            Narrowing::Empty => Ok(true),
            Narrowing::Into(known, open, narrower) => {
                if self.are_divided(&known.sides, &open)? {
                    return Ok(true);
                }
                let Some(narrower) = narrower else { return Ok(false) };
                for part in narrower {
                    if !self.follow_on(equations, part, parts)? {
                        return Ok(false);
                    }
                }
                Ok(true)
            }
        }
    }

    /// Solves all conditions: the parts of the set, on each of which symbols and angles that are left can have any values of an open set. `false` where a condition cannot be solved.
    pub(super) fn solve(&mut self, states: Equations<'_>, solved: &mut Vec<Part>) -> Result<bool, Stop> {
        let (mut open, mut parts) = (vec![Part::default()], 0);
        while let Some(part) = open.pop() {
            parts += 1;
            if parts > MOST_PARTS {
                return Err(Missing::Effort.into());
            }
            match self.narrowed(states, part.clone())? {
                Narrowing::Empty => {}
                Narrowing::Into(_, _, Some(narrower)) => open.extend(narrower),
                Narrowing::Into(_, left, None) if left.is_empty() => solved.push(part),
                Narrowing::Into(..) => return Ok(false),
            }
        }
        Ok(true)
    }

    /// Goes on with what is known on a part.
    pub(super) fn set(&mut self, part: Part) {
        self.part = part;
    }

    fn narrowed(&mut self, equations: Equations<'_>, part: Part) -> Result<Narrowing, Stop> {
        self.part = part.clone();
        // where something has no value there is no state
        let Some(known) = self.known(equations)? else { return Ok(Narrowing::Empty) };
        let mut best: Option<Vec<Solution>> = None;
        let mut open = Vec::new();
        for (zero, circular) in &known.zero {
            let of_positive_power = zero.powers.iter().filter(|(_, power)| **power > 0);
            let factors = of_positive_power.map(|(factor, _)| *factor);
            let factors: Vec<u32> = factors.filter(|factor| !known.not_zero.contains(factor)).collect();
            if factors.is_empty() {
                return Ok(Narrowing::Empty);
            }
            let turned = match circular {
                Some((function, argument)) => self.turned_solutions(*function, argument)?,
                None => None,
            };
            let is_turned = turned.is_some();
            let mut solutions = Some(turned.unwrap_or_default());
            for factor in factors.iter().filter(|_| !is_turned) {
                let found = self.solutions(*factor, &known.not_zero, 0)?;
                solutions = solutions.zip(found).map(|(all, found)| all.into_iter().chain(found).collect());
            }
            if let Some(solutions) = solutions
                && best.as_ref().is_none_or(|best| best.len() > solutions.len())
            {
                best = Some(solutions);
            }
            open.push(self.field.expanded(&factors.into_iter().map(|factor| (factor, 1)).collect(), 1)?);
        }
        let Some(best) = best else { return Ok(Narrowing::Into(known, open, None)) };
        let mut all = Vec::new();
        for solution in best {
            let mut narrower = part.clone();
            match solution {
                Solution::Symbol(name, value) => {
                    // what was solved before may hold this symbol
                    let Some(variable) = self.known.get(&Atom::Symbol(name.clone())).copied() else {
                        return Ok(Narrowing::Into(known, open, None));
                    };
                    for other in narrower.symbols.values_mut() {
                        let Some(replaced) = self.replaced(other, variable, &value)? else {
                            return Ok(Narrowing::Into(known, open, None));
                        };
                        *other = replaced;
                    }
                    narrower.symbols.insert(name, value);
                }
                Solution::Angle(term, pair) => narrower.angles.push((term, pair)),
            }
            all.push(narrower);
        }
        Ok(Narrowing::Into(known, open, Some(all)))
    }

    /// A quotient with another one in the place of a variable; nothing where something else holds the variable.
    pub(super) fn replaced(
        &mut self,
        quotient: &Quotient,
        variable: u32,
        by: &Quotient,
    ) -> Result<Option<Quotient>, Stop> {
        let mut product = Quotient::from(quotient.number.clone());
        for (factor, power) in &quotient.powers {
            let polynomial = self.field.factor(*factor).clone();
            if polynomial.variables().iter().any(|inner| *inner != variable && self.depends(*inner, variable))
            {
                return Ok(None);
            }
            let mut terms = Vec::new();
            for (exponent, part) in polynomial.parts(variable) {
                let part = self.field.quotient(part);
                let Some(power) = self.field.power(by, exponent as i32)? else { return Ok(None) };
                terms.push(self.field.times(&part, &power)?);
            }
            let value = self.field.sum(&terms)?;
            let Some(value) = self.field.power(&value, *power)? else { return Ok(None) };
            product = self.field.times(&product, &value)?;
        }
        Ok(Some(product))
    }

    /// What is known on the part that is set; `None` where something has no value, so that there is no state.
    fn known(&mut self, equations: Equations<'_>) -> Result<Option<Known>, Stop> {
        let pairs: Vec<Sides> = equations.sides.iter().chain(equations.conditions).copied().collect();
        let wanted: Vec<usize> = pairs.iter().flat_map(|sides| [sides.left, sides.right]).collect();
        let mut values = BTreeMap::new();
        match self.forms(equations.listing, &wanted, &mut values) {
            Err(Stop::Missing(Missing::Refused { refusal: Refusal::DivisionByZero, .. })) => return Ok(None),
            other => other?,
        }
        let mut not_zero = BTreeSet::new();
        for value in values.values() {
            // what something is divided by
            not_zero.extend(value.powers.iter().filter(|(_, power)| **power < 0).map(|(factor, _)| *factor));
        }
        let mut differences = Vec::new();
        for sides in &pairs {
            let of = |place: usize| values.get(&place).cloned().ok_or(Missing::Place { place });
            differences.push(self.field.sum(&[of(sides.left)?, of(sides.right)?.neg()])?);
        }
        let (mut zero, mut is_empty) = (Vec::new(), false);
        let conditions = differences.split_off(equations.sides.len());
        for (condition, difference) in equations.conditions.iter().zip(conditions) {
            match condition.relation {
                SidesRelation::Equal if difference.is_zero() => {}
                SidesRelation::Equal => {
                    zero.push((difference, circular(equations.listing, *condition, &values)));
                }
                SidesRelation::NotEqual | SidesRelation::Less | SidesRelation::Greater => {
                    is_empty |= difference.is_zero();
                    not_zero.extend(difference.powers.keys().copied());
                }
                SidesRelation::AtMost | SidesRelation::AtLeast => {}
            }
        }
        for requirement in equations.requirements {
            if !matches!(requirement.kind, RequirementKind::NotZero | RequirementKind::Positive) {
                continue;
            }
            match self.forms(equations.listing, &[requirement.step], &mut values) {
                Ok(()) => {}
                Err(Stop::Missing(Missing::Refused { refusal: Refusal::DivisionByZero, .. })) => {
                    return Ok(None);
                }
                Err(other) => return Err(other),
            }
            let Some(value) = values.get(&requirement.step) else { continue };
            is_empty |= value.is_zero();
            not_zero.extend(value.powers.keys().copied());
        }
        Ok((!is_empty).then_some(Known { sides: differences, zero, not_zero }))
    }

    /// A symbol by the others where the sine or cosine of an argument vanishes: two half turns and any number of whole ones.
    fn turned_solutions(
        &mut self,
        function: Function,
        argument: &Quotient,
    ) -> Result<Option<Vec<Solution>>, Stop> {
        let above = self.field.expanded(&argument.powers, 1)?;
        if argument.powers.values().any(|power| *power < 0) {
            return Ok(None);
        }
        for variable in above.variables() {
            let Some(Atom::Symbol(name)) = self.atom_of(variable).cloned() else { continue };
            let parts = above.parts(variable);
            let slope = parts.get(&1).and_then(IntegerPolynomial::number).filter(|slope| !slope.is_zero());
            let others = above.variables().into_iter().filter(|other| *other != variable);
            let (Some(slope), false) = (slope, others.into_iter().any(|other| self.depends(other, variable)))
            else {
                continue;
            };
            if parts.keys().any(|exponent| *exponent > 1) {
                continue;
            }
            let pi = self.atom(Atom::Pi, None);
            let turns = self.atom(Atom::Turns(name.clone()), None);
            let two = Quotient::from(RBig::from(2));
            let rounds = self.field.times(&self.field.times(&pi, &turns)?, &two)?;
            let rest = self.field.quotient(parts.get(&0).cloned().unwrap_or_default());
            let rest = self.field.times(&rest, &Quotient::from(argument.number.clone()))?;
            let below = Quotient::from(RBig::ONE / (&argument.number * RBig::from(slope)));
            let mut all = Vec::new();
            for half in 0..2 {
                // in half turns: none and one for a sine, a half more for a cosine
                let halves = RBig::from(half)
                    + if function == Function::Cos { RBig::ONE / RBig::from(2) } else { RBig::ZERO };
                let turned = self.field.times(&pi, &Quotient::from(halves))?;
                let value = self.field.sum(&[turned, rounds.clone(), rest.neg()])?;
                all.push(Solution::Symbol(name.clone(), self.field.times(&value, &below)?));
            }
            return Ok(Some(all));
        }
        Ok(None)
    }

    /// All ways in which a factor is zero, where they are known: a symbol by the others, or quarter turns; of slopes of slopes to a depth.
    pub(super) fn solutions(
        &mut self,
        factor: u32,
        not_zero: &BTreeSet<u32>,
        depth: usize,
    ) -> Result<Option<Vec<Solution>>, Stop> {
        let polynomial = self.field.factor(factor).clone();
        if let [(monomial, _)] = polynomial.terms()
            && let [(variable, 1)] = *monomial.powers()
        {
            match self.atoms.get(variable as usize) {
                Some(Atom::Sine(term)) => {
                    let turned = |cosine| Solution::Angle(term.clone(), [cosine, 0]);
                    return Ok(Some(vec![turned(1), turned(-1)]));
                }
                Some(Atom::Cosine(term)) => {
                    let turned = |sine| Solution::Angle(term.clone(), [0, sine]);
                    return Ok(Some(vec![turned(1), turned(-1)]));
                }
                _ => {}
            }
        }
        let variables = polynomial.variables();
        let mut best = None;
        if depth > DEEPEST_SLOPE {
            return Ok(None);
        }
        for variable in &variables {
            self.field.effort.spend((polynomial.terms().len() + variables.len()) as u64)?;
            let Some(Atom::Symbol(name)) = self.atoms.get(*variable as usize) else { continue };
            let name = name.clone();
            if variables.iter().any(|other| other != variable && self.depends(*other, *variable)) {
                continue;
            }
            let mut parts = polynomial.parts(*variable);
            if parts.keys().any(|exponent| *exponent > 1) {
                continue;
            }
            let [rest, slope] = [0, 1].map(|exponent| parts.remove(&exponent).unwrap_or_default());
            let slope = self.field.quotient(slope);
            let rest = self.field.quotient(rest);
            let below = self.field.power(&slope, -1)?.ok_or(Missing::Effort)?;
            let mut all = vec![Solution::Symbol(name, self.field.times(&rest.neg(), &below)?)];
            // where the slope vanishes the rest has to, which is asked of those parts by themselves
            let unknown = slope.powers.keys().copied().filter(|factor| !not_zero.contains(factor));
            let mut is_solved = true;
            for factor in unknown.collect::<Vec<_>>() {
                match self.solutions(factor, not_zero, depth + 1)? {
                    Some(parts) => all.extend(parts),
                    None => is_solved = false,
                }
            }
            if is_solved && best.as_ref().is_none_or(|best: &Vec<Solution>| best.len() > all.len()) {
                best = Some(all);
            }
        }
        Ok(best)
    }

    /// Whether all numerators are sums of multiples of polynomials that are zero.
    fn are_divided(&mut self, differences: &[Quotient], zero: &[IntegerPolynomial]) -> Result<bool, Missing> {
        for difference in differences {
            if difference.is_zero() {
                continue;
            }
            let above = self.field.expanded(&difference.powers, 1)?;
            if zero.is_empty() || !above.remainder(zero, self.field.effort)?.is_zero() {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

/// The argument of a condition that says that a sine or a cosine is zero.
fn circular(
    listing: &Listing,
    condition: Sides,
    values: &BTreeMap<usize, Quotient>,
) -> Option<(Function, Quotient)> {
    let is_zero = |place: usize| values.get(&place).is_some_and(Quotient::is_zero);
    let (place, zero) = match is_zero(condition.right) {
        true => (condition.left, condition.right),
        false => (condition.right, condition.left),
    };
    let Some(Step::Apply(function @ (Function::Sin | Function::Cos), argument)) =
        listing.steps().get(place).filter(|_| is_zero(zero))
    else {
        return None;
    };
    Some((*function, values.get(argument)?.clone()))
}
