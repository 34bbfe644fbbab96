//! How many derivatives of each output determine all that any derivatives do.
//!
//! The first derivative `y_i^(h_i)` whose differential lies in the span of those below it is algebraic over these. Differentiated, the
//! equation that it satisfies is linear in `y_i^(h_i + 1)`, so that this and all further derivatives are *rational* in the
//! derivatives of all outputs up to their `h`. The field that these generate is therefore that of all derivatives.

use super::covectors::integers;
use super::echelon::Echelon;
use super::probe::{ATTEMPTS, Draw, Probe};
use palmistry_math::number::{PrimeField, Refusal};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// The derivatives that determine all that any derivatives do.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Orders {
    /// Of each output the order `h` of the first derivative that adds nothing to those below.
    pub last: Vec<usize>,
    /// Of each output the orders of the derivatives that make up the rank of the unknowns' columns.
    pub raised: Vec<Vec<usize>>,
    /// Unknowns, by their places, without which the others are functions of the outputs and of these.
    pub free: Vec<usize>,
}

impl Orders {
    /// With further derivatives of each output.
    pub(crate) fn and_further(&self, further: usize) -> Orders {
        Orders { last: self.last.iter().map(|last| last + further).collect(), ..self.clone() }
    }
}

impl Probe {
    /// The orders at a random point of a set that need not be invariant: there a derivative may add nothing and a later one may, so
    /// that orders up to one more than there are coordinates are looked at, or up to `told` of each output.
    ///
    /// # Errors
    /// In words, where the points were poles.
    pub(crate) fn orders_on_a_set(
        &self,
        told: Option<&[usize]>,
        rng: &mut ChaCha8Rng,
    ) -> Result<Orders, String> {
        let all = vec![self.equations.closed.len() + 1; self.equations.outputs];
        let mut refused = String::new();
        for _ in 0..ATTEMPTS {
            let field = PrimeField::random(rng);
            match self.orders_up_to(told.unwrap_or(&all), field, rng) {
                Ok(mut orders) if told.is_none() => {
                    // what is behind the last one that adds something adds nothing that is known
                    let last = orders.raised.iter().flatten().copied().max().unwrap_or(0) + 1;
                    let usual = self.orders_in(field, rng).map(|usual| usual.last.into_iter().max());
                    orders.last.fill(last.max(usual.ok().flatten().unwrap_or(0) + 1));
                    return Ok(orders);
                }
                Ok(orders) => return Ok(orders),
                Err(refusal) => refused = refusal.to_string(),
            }
        }
        Err(format!("{ATTEMPTS} random points were singularities: {refused}"))
    }

    fn orders_up_to(
        &self,
        last: &[usize],
        field: PrimeField,
        rng: &mut ChaCha8Rng,
    ) -> Result<Orders, Refusal> {
        let equations = &self.equations;
        let start = equations.draw(field, rng)?;
        let length = last.iter().max().map_or(1, |most| most + 1);
        let trajectory = equations.trajectory(field, &start, (rng.random(), None), length)?;
        let integers = integers(&field, length);
        let mut columns = Echelon::new(field, equations.columns.len());
        let mut raised = vec![Vec::new(); equations.outputs];
        let mut open: Vec<_> = trajectory.covectors.into_iter().take(equations.outputs).enumerate().collect();
        for k in 0..length {
            open.retain(|(output, _)| k <= last[*output]);
            for (output, covector) in &mut open {
                let value = covector.value();
                if columns.insert(equations.columns.iter().map(|place| value[*place]).collect()) {
                    raised[*output].push(k);
                }
                if k < last[*output] {
                    *covector = covector.next(&field, &trajectory.entries, &integers);
                }
            }
        }
        let free = (0..equations.columns.len()).filter(|column| !columns.begins_at(*column)).collect();
        Ok(Orders { last: last.to_vec(), raised, free })
    }

    /// The orders at a random point.
    ///
    /// # Errors
    /// In words, where the points were poles.
    pub(crate) fn orders(&self, rng: &mut ChaCha8Rng) -> Result<Orders, String> {
        let mut refused = String::new();
        for _ in 0..ATTEMPTS {
            let field = PrimeField::random(rng);
            match self.orders_in(field, rng) {
                Ok(orders) => return Ok(orders),
                Err(refusal) => refused = refusal.to_string(),
            }
        }
        Err(format!("{ATTEMPTS} random points were singularities: {refused}"))
    }

    fn orders_in(&self, field: PrimeField, rng: &mut ChaCha8Rng) -> Result<Orders, Refusal> {
        let equations = &self.equations;
        let start = equations.draw(field, rng)?;
        let draw = Draw { field, seed: rng.random(), signs: None };
        let most = equations.closed.len() + 1;
        let outputs = equations.outputs.max(1);
        let mut length = (most.div_ceil(outputs) + 2).min(most);
        loop {
            let trajectory = equations.trajectory(field, &start, (draw.seed, draw.signs), length)?;
            let integers = integers(&field, length);
            let mut closed = Echelon::new(field, equations.closed.len());
            let mut columns = Echelon::new(field, equations.columns.len());
            let count = equations.outputs;
            let (mut last, mut raised) = (vec![None; count], vec![Vec::new(); count]);
            let mut open: Vec<_> = trajectory.covectors.into_iter().enumerate().collect();
            for k in 0..length {
                let mut further = Vec::new();
                for (output, covector) in open {
                    let value = covector.value();
                    let part = |places: &[usize]| places.iter().map(|place| value[*place]).collect();
                    if columns.insert(part(&equations.columns)) {
                        raised[output].push(k);
                    }
                    if closed.insert(part(&equations.closed)) {
                        further.push((output, covector));
                    } else {
                        last[output] = Some(k);
                    }
                }
                open = further;
                if open.is_empty() {
                    break;
                }
                if k + 1 < length {
                    for (_, covector) in &mut open {
                        *covector = covector.next(&field, &trajectory.entries, &integers);
                    }
                }
            }
            if open.is_empty() || length >= most {
                let free =
                    (0..equations.columns.len()).filter(|column| !columns.begins_at(*column)).collect();
                let last = last.into_iter().map(|order| order.unwrap_or(most)).collect();
                return Ok(Orders { last, raised, free });
            }
            length = (2 * length).min(most);
        }
    }
}
