//! A listing at a state: exactly where that is possible, else by enclosures of more and more bits.

use super::doubt::{Doubt, Effort, Missing};
use super::exact::{Exact, Form};
use super::listing::{Expense, Listing, Step};
use super::state::{ExactCoordinate, ExactState};
use dashu::rational::RBig;
use palmistry_math::number::{Arithmetic, Enclosure, Enclosures, Function, Refusal};
use std::cell::OnceCell;
use std::cmp::Ordering;

/// The bits of enclosures, one after the other.
pub const PRECISIONS: [usize; 5] = [128, 256, 512, 1024, 2048];

/// Two values beside each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Difference {
    Zero,
    NotZero,
    /// Neither can be shown.
    Unknown,
}

type Values<N> = Vec<Result<N, Missing>>;

/// The values of all operations of a listing at one state.
pub struct Evaluation<'c> {
    listing: &'c Listing,
    state: &'c ExactState,
    effort: &'c Effort,
    /// Evaluated when it is first asked for: fractions can become long where a few bits suffice.
    exact: OnceCell<Values<Form>>,
    enclosed: [OnceCell<Values<Enclosure>>; PRECISIONS.len()],
}

impl<'c> Evaluation<'c> {
    /// Evaluates a listing.
    ///
    /// # Errors
    /// Where sine and cosine of an angle do not lie on the unit circle.
    pub fn new(listing: &'c Listing, state: &'c ExactState, effort: &'c Effort) -> Result<Self, Doubt> {
        if let Some((name, _)) = state.iter().find(|(_, value)| !value.is_on_the_circle()) {
            return Err(Doubt::NotOnTheCircle(name.clone()));
        }
        Ok(Evaluation { listing, state, effort, exact: OnceCell::new(), enclosed: Default::default() })
    }

    fn evaluate_exactly(&self) -> Values<Form> {
        let (mut circle, mut names) = (Vec::new(), Vec::new());
        for (name, value) in self.state {
            if let ExactCoordinate::Angle { sin, cos } = value {
                names.push(name);
                circle.push((sin.0.clone(), cos.0.clone()));
            }
        }
        let symbol = |place: usize, step: &Step, values: &[Result<Form, Missing>]| {
            let Step::Symbol(name) = step else { return None };
            Some(match self.state.get(name) {
                None => Err(Missing::Symbol { place }),
                Some(ExactCoordinate::Number(value)) => Ok(Form::from(value.0.clone())),
                Some(ExactCoordinate::Angle { .. }) => {
                    let known = names.iter().position(|known| *known == name);
                    known.map(Exact::angle).ok_or(Missing::Symbol { place })
                }
                Some(ExactCoordinate::Step(earlier)) => {
                    values.get(*earlier).cloned().unwrap_or(Err(Missing::Place { place }))
                }
            })
        };
        self.listing.run(
            &Exact::new(circle),
            Expense { effort: self.effort, of: Form::work, each: 1 },
            symbol,
        )
    }

    /// The exact value of an operation.
    ///
    /// # Errors
    /// Where there is no such operation, or it has no value that can be written down.
    pub fn exact(&self, place: usize) -> Result<&Form, Missing> {
        let values = self.exact.get_or_init(|| self.evaluate_exactly());
        values.get(place).ok_or(Missing::Place { place })?.as_ref().map_err(|why| *why)
    }

    /// The rational value of an operation, where it has one.
    pub fn rational(&self, place: usize) -> Option<&RBig> {
        self.exact(place).ok()?.rational()
    }

    /// An operation enclosed at one of [`PRECISIONS`], by its place among them.
    ///
    /// # Errors
    /// Where there is no such operation, or it has no value at this precision.
    pub fn enclosed(&self, place: usize, precision: usize) -> Result<&Enclosure, Missing> {
        let values = self.enclosed.get(precision).ok_or(Missing::Place { place })?;
        let values = values.get_or_init(|| self.enclose(PRECISIONS[precision]));
        values.get(place).ok_or(Missing::Place { place })?.as_ref().map_err(|why| *why)
    }

    fn enclose(&self, bits: usize) -> Values<Enclosure> {
        let arithmetic = Enclosures::new(bits);
        let known = |place: usize, step: &Step, values: &[Result<Enclosure, Missing>]| {
            let refused = |refusal| Missing::Refused { place, refusal };
            match self.exact.get().and_then(|values| values.get(place)) {
                // no enclosure is narrower than the number itself
                Some(Ok(form)) if form.rational().is_some() => {
                    return form.rational().map(|value| arithmetic.rational(value).map_err(refused));
                }
                Some(Err(why)) if why.is_certain() || *why == Missing::Effort => return Some(Err(*why)),
                _ => {}
            }
            if let Some(value) = self.on_the_circle(step) {
                return Some(arithmetic.rational(value).map_err(refused));
            }
            let Step::Symbol(name) = step else { return None };
            Some(match self.state.get(name) {
                None => Err(Missing::Symbol { place }),
                Some(ExactCoordinate::Number(value)) => arithmetic.rational(&value.0).map_err(refused),
                Some(ExactCoordinate::Angle { sin, cos }) => {
                    angle(&arithmetic, &sin.0, &cos.0).map_err(refused)
                }
                Some(ExactCoordinate::Step(earlier)) => {
                    values.get(*earlier).cloned().unwrap_or(Err(Missing::Place { place }))
                }
            })
        };
        self.listing.run(
            &arithmetic,
            Expense { effort: self.effort, of: |_| 0, each: bits as u64 / 8 },
            known,
        )
    }

    /// The sine or cosine of a symbol that is given by them.
    fn on_the_circle(&self, step: &Step) -> Option<&RBig> {
        let Step::Apply(function, angle) = step else { return None };
        let Step::Symbol(name) = self.listing.steps().get(*angle)? else { return None };
        match (function, self.state.get(name)?) {
            (Function::Sin, ExactCoordinate::Angle { sin, .. }) => Some(&sin.0),
            (Function::Cos, ExactCoordinate::Angle { cos, .. }) => Some(&cos.0),
            _ => None,
        }
    }

    /// The answer at the lowest precision, where exact values have not been asked for.
    pub fn at_first_sight<T>(&self, ask: impl Fn(usize) -> Result<Option<T>, Missing>) -> Option<T> {
        if self.exact.get().is_some() { None } else { ask(0).ok().flatten() }
    }

    /// Goes through the precisions until a question about enclosures has an answer; `None` where none of them has.
    ///
    /// # Errors
    /// Where it is certain that a value does not exist, or the last precision has none.
    pub fn climb<T>(
        &self,
        mut ask: impl FnMut(usize) -> Result<Option<T>, Missing>,
    ) -> Result<Option<T>, Missing> {
        let mut last = Ok(None);
        for precision in 0..PRECISIONS.len() {
            last = ask(precision);
            match &last {
                Ok(Some(_)) => return last,
                Err(why) if why.is_certain() || *why == Missing::Effort => return last,
                _ => {}
            }
        }
        last
    }

    /// Whether an operation has the value zero, exactly; also `false` where that is not known.
    ///
    /// # Errors
    /// Where it has no value.
    pub fn is_zero(&self, place: usize) -> Result<bool, Missing> {
        let exact = Exact::new(Vec::new());
        match self.exact(place) {
            Ok(form) => Ok(exact.is_zero(form) == Some(true)),
            Err(why) if why.is_certain() || why == Missing::Effort => Err(why),
            Err(_) => Ok(false),
        }
    }

    /// How two operations that differ compare; `None` where that is not known.
    ///
    /// # Errors
    /// Where one of them has no value.
    pub fn order(&self, left: usize, right: usize) -> Result<Option<Ordering>, Missing> {
        if let (Some(l), Some(r)) = (self.rational(left), self.rational(right)) {
            return Ok(Some(l.cmp(r)));
        }
        self.climb(|precision| {
            let (l, r) = (self.enclosed(left, precision)?, self.enclosed(right, precision)?);
            let (less, more) = (l.high() < r.low(), l.low() > r.high());
            Ok(if less { Some(Ordering::Less) } else { more.then_some(Ordering::Greater) })
        })
    }

    /// Whether two operations have the same value.
    ///
    /// # Errors
    /// Where one of them has no value.
    pub fn difference(&self, left: usize, right: usize) -> Result<Difference, Missing> {
        let exact = Exact::new(Vec::new());
        if let (Ok(l), Ok(r)) = (self.exact(left), self.exact(right))
            && let Ok(difference) = exact.sub(l, r)
            && let Some(zero) = exact.is_zero(&difference)
        {
            return Ok(if zero { Difference::Zero } else { Difference::NotZero });
        }
        let apart = self.climb(|precision| {
            let (l, r) = (self.enclosed(left, precision)?, self.enclosed(right, precision)?);
            Ok(Enclosures::common(l, r).is_none().then_some(Difference::NotZero))
        })?;
        Ok(apart.unwrap_or(Difference::Unknown))
    }
}

/// The angle between minus pi and pi of which sine and cosine are given: `2 atan(sin/(1 + cos))`.
fn angle(arithmetic: &Enclosures, sine: &RBig, cosine: &RBig) -> Result<Enclosure, Refusal> {
    if *cosine == RBig::from(-1) {
        return arithmetic.pi();
    }
    let half = arithmetic.rational(&(sine / (RBig::ONE + cosine)))?;
    arithmetic.mul(&arithmetic.rational(&RBig::from(2))?, &arithmetic.apply(Function::Atan, &half)?)
}
