//! A refutation, evaluated again at its witness.

use super::doubt::{Doubt, Effort, Finding, Missing};
use super::evaluation::{Difference, Evaluation};
use super::exact::{Exact, Form};
use super::listing::Listing;
use super::state::{ExactState, Ratio};
use dashu::integer::UBig;
use dashu::rational::RBig;
use palmistry_math::number::Arithmetic;
use serde::{Deserialize, Serialize};
use std::cmp::Ordering;

/// The relation that is claimed between the two sides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum SidesRelation {
    #[default]
    #[serde(rename = "=")]
    Equal,
    #[serde(rename = "!=")]
    NotEqual,
    #[serde(rename = "<")]
    Less,
    #[serde(rename = "<=")]
    AtMost,
    #[serde(rename = ">")]
    Greater,
    #[serde(rename = ">=")]
    AtLeast,
}

impl SidesRelation {
    fn is_equality(&self) -> bool {
        *self == SidesRelation::Equal
    }

    /// Whether it holds for two numbers in this order.
    fn admits(self, order: Ordering) -> bool {
        match self {
            SidesRelation::Equal => order.is_eq(),
            SidesRelation::NotEqual => order.is_ne(),
            SidesRelation::Less => order.is_lt(),
            SidesRelation::AtMost => order.is_le(),
            SidesRelation::Greater => order.is_gt(),
            SidesRelation::AtLeast => order.is_ge(),
        }
    }
}

/// The two sides of an equation or inequality, as places of a listing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sides {
    /// The step of the listing that is the left side.
    pub left: usize,
    /// How the sides are compared.
    #[serde(default, skip_serializing_if = "SidesRelation::is_equality")]
    pub relation: SidesRelation,
    /// The step that is the right side.
    pub right: usize,
}

impl Sides {
    /// Whether the relation holds; `None` where that is not known.
    pub(super) fn hold(self, values: &Evaluation<'_>) -> Result<Option<bool>, Missing> {
        let difference = values.difference(self.left, self.right)?;
        match (self.relation, difference) {
            (relation, Difference::Zero) => Ok(Some(relation.admits(Ordering::Equal))),
            (SidesRelation::Equal, Difference::NotZero) => Ok(Some(false)),
            (SidesRelation::NotEqual, Difference::NotZero) => Ok(Some(true)),
            (SidesRelation::Equal | SidesRelation::NotEqual, Difference::Unknown) => Ok(None),
            (relation, _) => Ok(values.order(self.left, self.right)?.map(|order| relation.admits(order))),
        }
    }
}

/// What a term needs to have a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RequirementKind {
    NotZero,
    Positive,
    NotNegative,
    /// Between minus one and one, both counted.
    WithinOne,
    /// The same, neither counted.
    InsideOne,
}

/// An operation, and what is required of its value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Requirement {
    /// What is required of the step.
    pub kind: RequirementKind,
    /// A step of the listing.
    pub step: usize,
}

/// The two sides as they were printed for people: exact, or decimals of which the last digit is rounded.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PrintedSides {
    /// The left side as it is printed.
    pub left: String,
    /// The right side as it is printed.
    pub right: String,
}

/// A state in exact numbers at which two sides differ.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Refutation {
    /// Sides, conditions and requirements, as they were read.
    pub listing: Listing,
    /// The witness: a value for every symbol of the listing.
    pub state: ExactState,
    /// The sides, as steps of the listing.
    pub sides: Sides,
    /// Where sides are claimed to be near each other: the tolerance.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub within: Option<usize>,
    /// What the statement assumes: equations that hold at the witness.
    pub conditions: Vec<Sides>,
    /// Where sides and conditions exist.
    pub requirements: Vec<Requirement>,
    /// The sides as they were printed.
    pub printed: PrintedSides,
}

impl Refutation {
    /// Evaluates it again.
    pub fn check(&self, effort: &Effort) -> Finding {
        match self.try_check(effort) {
            Ok(()) => Finding::Confirmed { times: 1 },
            Err(doubt) => Finding::NotConfirmed(doubt),
        }
    }

    fn try_check(&self, effort: &Effort) -> Result<(), Doubt> {
        let values = Evaluation::new(&self.listing, &self.state, effort)?;
        holds(&values, &self.conditions, &self.requirements)?;
        match self.within {
            None => match self.sides.hold(&values)? {
                Some(false) => {}
                Some(true) if self.sides.relation.is_equality() => return Err(Doubt::Equal),
                Some(true) => return Err(Doubt::Holds),
                None => return Err(Doubt::NotToldApart),
            },
            Some(tolerance) => match is_within(&values, self.sides, tolerance)? {
                Some(false) => {}
                Some(true) => return Err(Doubt::Equal),
                None => return Err(Doubt::ToleranceNotTold),
            },
        }
        // what is not within a negative tolerance may be equal
        let must_differ = self.sides.relation.is_equality() && self.within.is_none();
        if must_differ && self.printed.left == self.printed.right {
            return Err(Doubt::PrintedAlike);
        }
        let sides =
            [("left", self.sides.left, &self.printed.left), ("right", self.sides.right, &self.printed.right)];
        for (side, place, text) in sides {
            match Decimal::parse(text).map(|decimal| decimal.is(&values, place)).transpose()?.flatten() {
                Some(true) => {}
                Some(false) => return Err(Doubt::PrintedOtherwise(side)),
                None => return Err(Doubt::PrintNotShown(side)),
            }
        }
        Ok(())
    }
}

/// Whether all conditions hold exactly and all requirements are met.
pub(super) fn holds(
    values: &Evaluation<'_>,
    conditions: &[Sides],
    requirements: &[Requirement],
) -> Result<(), Doubt> {
    for (index, condition) in conditions.iter().enumerate() {
        match condition.hold(values)? {
            Some(true) => {}
            Some(false) => return Err(Doubt::ConditionNotMet(index)),
            None => return Err(Doubt::ConditionNotShown(index)),
        }
    }
    for (index, requirement) in requirements.iter().enumerate() {
        match requirement.is_met(values)? {
            Some(true) => {}
            Some(false) => return Err(Doubt::RequirementNotMet(index)),
            None => return Err(Doubt::RequirementNotShown(index)),
        }
    }
    Ok(())
}

impl Requirement {
    /// Whether it is met; `None` where that is not known.
    fn is_met(self, values: &Evaluation<'_>) -> Result<Option<bool>, Missing> {
        let enclosed = |precision| {
            let value = values.enclosed(self.step, precision)?;
            Ok(self.kind.between(&value.low(), &value.high()))
        };
        if let Some(told) = values.at_first_sight(enclosed) {
            return Ok(Some(told));
        }
        match values.rational(self.step) {
            Some(value) => Ok(self.kind.between(value, value)),
            // a sum of roots, say, may be zero and no rational on its way
            None if values.is_zero(self.step)? => Ok(self.kind.between(&RBig::ZERO, &RBig::ZERO)),
            None => values.climb(enclosed),
        }
    }
}

impl RequirementKind {
    /// Whether all values between two bounds meet it, or none does.
    fn between(self, low: &RBig, high: &RBig) -> Option<bool> {
        let (zero, one, minus) = (RBig::ZERO, RBig::ONE, RBig::from(-1));
        let (all, none) = match self {
            RequirementKind::NotZero => (*low > zero || *high < zero, low.is_zero() && high.is_zero()),
            RequirementKind::Positive => (*low > zero, *high <= zero),
            RequirementKind::NotNegative => (*low >= zero, *high < zero),
            RequirementKind::WithinOne => (*low >= minus && *high <= one, *low > one || *high < minus),
            RequirementKind::InsideOne => (*low > minus && *high < one, *low >= one || *high <= minus),
        };
        if all { Some(true) } else { none.then_some(false) }
    }
}

/// Whether two sides differ by no more than a tolerance; `None` where that is not known.
pub(super) fn is_within(
    values: &Evaluation<'_>,
    sides: Sides,
    tolerance: usize,
) -> Result<Option<bool>, Missing> {
    let magnitudes = |low: RBig, high: RBig| {
        let least = if low > RBig::ZERO { low.clone() } else { -high.clone() };
        (least, if -low.clone() > high { -low } else { high })
    };
    if let (Some(left), Some(right), Some(most)) =
        (values.rational(sides.left), values.rational(sides.right), values.rational(tolerance))
    {
        let difference = left - right;
        return Ok(Some(magnitudes(difference.clone(), difference).1 <= *most));
    }
    let told = values.climb(|precision| {
        let at = |place| values.enclosed(place, precision);
        let (left, right, most) = (at(sides.left)?, at(sides.right)?, at(tolerance)?);
        let (least, largest) = magnitudes(left.low() - right.high(), left.high() - right.low());
        Ok(if largest <= most.low() { Some(true) } else { (least > most.high()).then_some(false) })
    })?;
    if told.is_some() {
        return Ok(told);
    }
    // the difference may be the tolerance itself, which is not negative where it is near a magnitude, or both are zero
    let exact = Exact::new(Vec::new());
    let is_the_tolerance = |left: usize, right: usize| {
        let (left, right, most) =
            (values.exact(left).ok()?, values.exact(right).ok()?, values.exact(tolerance).ok()?);
        Some(exact.sub(&exact.sub(left, right).ok()?, most).ok()?.is_zero())
    };
    let equal = is_the_tolerance(sides.left, sides.right) == Some(true)
        || is_the_tolerance(sides.right, sides.left) == Some(true);
    let no_less_than_zero = values.exact(tolerance).is_ok_and(Form::is_zero)
        || values
            .climb(
                |precision| Ok((values.enclosed(tolerance, precision)?.low() >= RBig::ZERO).then_some(())),
            )?
            .is_some();
    Ok((equal && no_less_than_zero).then_some(true))
}

/// A printed number: its value, and by how much what it stands for may differ from it.
struct Decimal {
    value: RBig,
    slack: RBig,
}

/// Integers of more digits than this are rounded when they are printed, so that their last zeros say nothing.
const PRINTED_DIGITS: usize = 20;
/// Printed numbers are no longer.
const LONGEST_PRINT: usize = 4096;
/// Nor are their exponents greater: numbers of as many digits are written down in a moment.
const LARGEST_PRINTED_EXPONENT: u64 = 100_000;

impl Decimal {
    /// Reads an integer, a fraction, or a decimal with or without an exponent.
    fn parse(text: &str) -> Option<Decimal> {
        if text.len() > LONGEST_PRINT {
            return None;
        }
        let zeros = text.len() - text.trim_end_matches('0').len();
        if let Some(Ratio(value)) = Ratio::parse(text) {
            let rounded = text.trim_start_matches('-').len() > PRINTED_DIGITS && !text.contains('/');
            let slack = if rounded { half_of_place(zeros as i64) } else { RBig::ZERO };
            return Some(Decimal { value, slack });
        }
        let (mantissa, exponent) = text.split_once('e').unwrap_or((text, "0"));
        let exponent =
            exponent.parse::<i64>().ok().filter(|e| e.unsigned_abs() <= LARGEST_PRINTED_EXPONENT)?;
        let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let Ratio(digits) =
            Ratio::parse(&format!("{whole}{fraction}")).filter(|_| !fraction.contains(['-', '/']))?;
        let place = exponent - fraction.len() as i64;
        Some(Decimal { value: digits * power_of_ten(place), slack: half_of_place(place) })
    }

    /// Whether an operation has this value, up to the slack; `None` where that is not known.
    fn is(&self, values: &Evaluation<'_>, place: usize) -> Result<Option<bool>, Missing> {
        let (least, largest) = (&self.value - &self.slack, &self.value + &self.slack);
        let between = |low: &RBig, high: &RBig| {
            let (inside, outside) = (*low >= least && *high <= largest, *high < least || *low > largest);
            if inside { Some(true) } else { outside.then_some(false) }
        };
        if let Some(value) = values.rational(place) {
            return Ok(between(value, value));
        }
        values.climb(|precision| {
            let value = values.enclosed(place, precision)?;
            Ok(between(&value.low(), &value.high()))
        })
    }
}

fn power_of_ten(exponent: i64) -> RBig {
    let power = RBig::from(UBig::from(10u8).pow(exponent.unsigned_abs() as usize));
    if exponent < 0 { RBig::ONE / power } else { power }
}

/// Half a unit of a decimal place.
fn half_of_place(exponent: i64) -> RBig {
    power_of_ten(exponent) / RBig::from(2)
}
