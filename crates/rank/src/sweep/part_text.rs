//! A part of a sweep as JSON that is whole or refused.
//!
//! It contains no times, so that whoever sweeps the same states writes the same to the last byte.

use super::counts::{SweepCounts, WorstState};
use super::part::{BranchCounts, RankPart};
use super::unobservable::{UnseenDirections, UnseenExample, UnseenKind};
use dashu::integer::{IBig, UBig};
use dashu::rational::RBig;
use palmistry_io::parts::{Bits, CONTRADICTS, PartError, seal, unseal};
use palmistry_math::number::NumberType;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// What the text of a part begins with; another number where its fields mean something else.
const FORMAT: &str = "palmistry rank part 1";

impl RankPart {
    /// As JSON, with a checksum; nothing where it is not whole.
    pub fn text(&self) -> Option<String> {
        if self.is_whole() { seal(FORMAT, WrittenPart::of(self)) } else { None }
    }

    /// Reads a part.
    ///
    /// # Errors
    /// The text is something else, or was cut or changed.
    pub fn read(text: &str) -> Result<RankPart, PartError> {
        let part = unseal::<WrittenPart>(FORMAT, text)?.read();
        if part.is_consistent() { Ok(part) } else { Err(CONTRADICTS) }
    }

    fn is_consistent(&self) -> bool {
        let range = self.range();
        let looked_at = range.end.checked_sub(range.start);
        let sum = |mut list: &mut dyn Iterator<Item = &u64>| {
            Iterator::try_fold(&mut list, 0u64, |sum, count| sum.checked_add(*count))
        };
        let consistent = |counts: &SweepCounts| {
            let has = |worst: Option<WorstState>| worst.is_none_or(|worst| range.contains(&worst.index));
            let kinds = counts.unobservable.0.iter().all(|(names, kind)| {
                let of = |example: &UnseenExample| {
                    range.contains(&example.index) && example.vector.len() == names.len()
                };
                kind.example.as_ref().is_none_or(of)
            });
            let all = Some(counts.samples);
            let poles = sum(&mut counts.poles.values());
            let seen = poles.and_then(|poles| counts.samples.checked_add(poles));
            (seen == looked_at || seen == Some(0))
                && sum(&mut counts.ranks.values()) == all
                && sum(&mut counts.number_types.values()) == all
                && sum(&mut counts.computed.values()) <= all
                && counts.certified <= counts.samples
                && counts.disagreements <= counts.samples
                && has(counts.worst)
                && has(counts.worst_streamed)
                && kinds
        };
        let branches = self.branches.iter();
        let mut all = branches.flat_map(|branch| [Some(&branch.full), branch.rows.as_ref()]).flatten();
        looked_at.is_some() && range.end <= self.states && all.all(consistent)
    }
}

/// A rational number of any length, as its text.
#[derive(Clone)]
struct Rational(RBig);

impl Serialize for Rational {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.0.to_string())
    }
}

impl<'de> Deserialize<'de> for Rational {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = Cow::<str>::deserialize(deserializer)?;
        rational(&text).map(Rational).ok_or_else(|| D::Error::custom("a number is written as '-3/2'"))
    }
}

fn rational(text: &str) -> Option<RBig> {
    let (sign, digits) = match text.strip_prefix('-') {
        Some(rest) => (-1, rest),
        None => (1, text),
    };
    let (top, bottom) = digits.split_once('/').unwrap_or((digits, "1"));
    let whole = |part: &str| -> Option<UBig> {
        let plain = !part.is_empty() && part.bytes().all(|b| b.is_ascii_digit());
        if plain { UBig::from_str_radix(part, 10).ok() } else { None }
    };
    let (top, bottom) = (whole(top)?, whole(bottom)?);
    (!bottom.is_zero()).then(|| RBig::from_parts(IBig::from(sign) * IBig::from(top), bottom))
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenPart {
    question: Bits,
    rows: Bits,
    states: u64,
    first: u64,
    last: u64,
    branches: Vec<WrittenBranch>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenBranch {
    full: WrittenCounts,
    own_rows: Option<WrittenCounts>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenCounts {
    samples: u64,
    certified: u64,
    computed_differs: u64,
    decided_by: Vec<(NumberType, u64)>,
    ranks: BTreeMap<usize, u64>,
    computed_ranks: BTreeMap<usize, u64>,
    poles: BTreeMap<String, u64>,
    worst: Option<(u64, Bits)>,
    worst_streamed: Option<(u64, Bits)>,
    unobservable: Vec<WrittenKind>,
    smallest_gap: Option<Bits>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenKind {
    states: Vec<String>,
    count: u64,
    example: Option<WrittenExample>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenExample {
    index: u64,
    text: String,
    vector: Vec<Rational>,
    exact: bool,
}

impl WrittenPart {
    fn of(part: &RankPart) -> WrittenPart {
        let branch = |branch: &BranchCounts| WrittenBranch {
            full: WrittenCounts::of(&branch.full),
            own_rows: branch.rows.as_ref().map(WrittenCounts::of),
        };
        WrittenPart {
            question: Bits(part.asked),
            rows: Bits(part.prepared),
            states: part.states,
            first: part.first,
            last: part.last,
            branches: part.branches.iter().map(branch).collect(),
        }
    }

    fn read(self) -> RankPart {
        let branch = |branch: WrittenBranch| BranchCounts {
            full: branch.full.read(),
            rows: branch.own_rows.map(WrittenCounts::read),
        };
        RankPart {
            asked: self.question.0,
            prepared: self.rows.0,
            states: self.states,
            first: self.first,
            last: self.last,
            branches: self.branches.into_iter().map(branch).collect(),
        }
    }
}

impl WrittenCounts {
    fn of(counts: &SweepCounts) -> WrittenCounts {
        let worst = |worst: WorstState| (worst.index, Bits(worst.condition.to_bits()));
        let example = |example: &UnseenExample| WrittenExample {
            index: example.index,
            text: example.text.clone(),
            vector: example.vector.iter().cloned().map(Rational).collect(),
            exact: example.exact,
        };
        let kind = |(states, kind): (&Vec<String>, &UnseenKind)| WrittenKind {
            states: states.clone(),
            count: kind.count,
            example: kind.example.as_ref().map(example),
        };
        WrittenCounts {
            samples: counts.samples,
            certified: counts.certified,
            computed_differs: counts.disagreements,
            decided_by: counts
                .number_types
                .iter()
                .map(|(number_type, count)| (*number_type, *count))
                .collect(),
            ranks: counts.ranks.clone(),
            computed_ranks: counts.computed.clone(),
            poles: counts.poles.clone(),
            worst: counts.worst.map(worst),
            worst_streamed: counts.worst_streamed.map(worst),
            unobservable: counts.unobservable.0.iter().map(kind).collect(),
            smallest_gap: counts.smallest_gap.map(|gap| Bits(gap.to_bits())),
        }
    }

    fn read(self) -> SweepCounts {
        let worst = |(index, Bits(bits)): (u64, Bits)| WorstState { index, condition: f64::from_bits(bits) };
        let example = |example: WrittenExample| UnseenExample {
            index: example.index,
            text: example.text,
            vector: example.vector.into_iter().map(|Rational(value)| value).collect(),
            exact: example.exact,
        };
        let kind = |kind: WrittenKind| {
            (kind.states, UnseenKind { count: kind.count, example: kind.example.map(example) })
        };
        SweepCounts {
            samples: self.samples,
            certified: self.certified,
            disagreements: self.computed_differs,
            number_types: self.decided_by.into_iter().collect(),
            ranks: self.ranks,
            computed: self.computed_ranks,
            poles: self.poles,
            worst: self.worst.map(worst),
            worst_streamed: self.worst_streamed.map(worst),
            unobservable: UnseenDirections(self.unobservable.into_iter().map(kind).collect()),
            smallest_gap: self.smallest_gap.map(|Bits(bits)| f64::from_bits(bits)),
            interrupted: false,
            seconds: None,
        }
    }
}
