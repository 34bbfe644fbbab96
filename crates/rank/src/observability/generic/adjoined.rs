//! Residues in which functions have values: not their own, but random ones.
//!
//! Modulo a prime there is no exponential. Along a flow a function `y = exp(u)` is known by its differential equation
//! `y' = u' y`, and any initial value lies on a leaf `y = c exp(u)` that the flow does not leave. What is found with a random
//! initial value is therefore what holds for almost all `c`, and an upper bound for `c = 1`; the expressions are
//! written so that it is the same where that can be shown. A square root is a true one, where one is asked for: its argument has to be a square.

use dashu::rational::RBig;
use palmistry_math::number::{Arithmetic, Function, PrimeField, Refusal};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::cell::RefCell;

/// What has been drawn so far.
struct Drawn {
    rng: ChaCha8Rng,
    /// The cosine that belongs to the sine that was drawn last.
    cosine: Option<u64>,
    /// How many roots were taken.
    roots: u32,
}

/// A field of residues with random values of functions.
pub(super) struct Adjoined {
    field: PrimeField,
    drawn: RefCell<Drawn>,
    /// Whether the n-th root is the negative one, by bits; `None` where roots are any numbers.
    signs: Option<u64>,
}

/// Pi is transcendental: no polynomial with rational coefficients distinguishes it from an unknown. It has one value in a field, so
/// that a state given in terms of pi has the value that its equations have.
pub(super) fn pi_in(field: PrimeField) -> u64 {
    field.draw(&mut ChaCha8Rng::seed_from_u64(field.modulus()))
}

impl Adjoined {
    pub fn new(field: PrimeField, seed: u64, signs: Option<u64>) -> Self {
        let drawn = Drawn { rng: ChaCha8Rng::seed_from_u64(seed), cosine: None, roots: 0 };
        Adjoined { field, drawn: RefCell::new(drawn), signs }
    }
}

impl Arithmetic for Adjoined {
    type Number = u64;

    fn rational(&self, value: &RBig) -> Result<u64, Refusal> {
        self.field.rational(value)
    }
    fn pi(&self) -> Result<u64, Refusal> {
        Ok(pi_in(self.field))
    }
    fn add(&self, a: &u64, b: &u64) -> Result<u64, Refusal> {
        self.field.add(a, b)
    }
    fn sub(&self, a: &u64, b: &u64) -> Result<u64, Refusal> {
        self.field.sub(a, b)
    }
    fn mul(&self, a: &u64, b: &u64) -> Result<u64, Refusal> {
        self.field.mul(a, b)
    }
    fn div(&self, a: &u64, b: &u64) -> Result<u64, Refusal> {
        self.field.div(a, b)
    }
    fn neg(&self, a: &u64) -> Result<u64, Refusal> {
        self.field.neg(a)
    }
    fn is_zero(&self, a: &u64) -> Option<bool> {
        self.field.is_zero(a)
    }

    /// A series asks for the cosine of an argument right after its sine.
    fn apply(&self, function: Function, a: &u64) -> Result<u64, Refusal> {
        let drawn = &mut *self.drawn.borrow_mut();
        match function {
            Function::Sin => {
                let (sine, cosine) = self.field.draw_unit(&mut drawn.rng);
                drawn.cosine = Some(cosine);
                Ok(sine)
            }
            Function::Cos => drawn.cosine.take().ok_or(Refusal::NoExactValue(function)),
            Function::Sqrt => match self.signs {
                Some(signs) => {
                    let root = self.field.square_root(*a).ok_or(Refusal::OutsideDomain(function))?;
                    let negative = signs >> drawn.roots & 1 == 1;
                    drawn.roots += 1;
                    if negative { self.field.neg(&root) } else { Ok(root) }
                }
                None => Ok(self.field.draw(&mut drawn.rng)),
            },
            _ => Ok(self.field.draw(&mut drawn.rng)),
        }
    }
}
