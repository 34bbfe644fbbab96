//! Random bodies as in section 3.4 of the thesis.

use super::form::{BodyForm, CentreOfMass, FormError, Knots};
use super::shape::Shape;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// The interval from which section 3.4 draws the radii, in metres.
pub const RADII: [f64; 2] = [0.1, 2.5];

/// After this many draws the search for a convex spline ends.
pub const MOST_DRAWS: usize = 10_000;

/// A stream of closed splines whose three radii are drawn independently and uniformly from [`RADII`]. The same seed
/// gives the same stream.
#[derive(Clone, Debug)]
pub struct SplineDraws {
    random: ChaCha8Rng,
    knots: Knots,
}

/// A drawn body that is convex.
#[derive(Clone, Debug)]
pub struct DrawnSpline {
    pub form: BodyForm,
    pub shape: Shape,
    /// How many forms were drawn for it, itself included.
    pub draws: usize,
}

impl SplineDraws {
    /// The stream of a seed.
    pub fn new(seed: u64, knots: Knots) -> Self {
        SplineDraws { random: ChaCha8Rng::seed_from_u64(seed), knots }
    }

    /// The next form, convex or not: [`Shape::new`] says which.
    pub fn draw(&mut self) -> BodyForm {
        let [low, high] = RADII;
        let radii = [(); 3].map(|()| self.random.random_range(low..=high));
        BodyForm::Spline { radii, knots: self.knots }
    }

    /// Draws until a form is convex; its centre of mass is its centroid.
    ///
    /// # Errors
    /// Where none of [`MOST_DRAWS`] is, or where an area does not settle.
    pub fn until_convex(&mut self) -> Result<DrawnSpline, FormError> {
        for draws in 1..=MOST_DRAWS {
            let form = self.draw();
            match Shape::new(&form, CentreOfMass::Uniform) {
                Ok(shape) => return Ok(DrawnSpline { form, shape, draws }),
                Err(FormError::Dent { .. } | FormError::Loops(_)) => (),
                Err(other) => return Err(other),
            }
        }
        Err(FormError::NoConvexDraw(MOST_DRAWS))
    }
}
