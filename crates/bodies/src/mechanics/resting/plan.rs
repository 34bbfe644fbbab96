//! The plan of figure 3.14: palms that trace the boundary of all palm angles at which both push.

use crate::mechanics::moving::{Course, Oscillation};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, PI, TAU};

/// The corners are rounded by the mean over a normal distribution of this standard deviation, in rounds.
const ROUNDING: f64 = 0.03;

/// So many oscillations of the rounded corners are taken: the next would be below 1e-14 rad.
const OSCILLATIONS: u32 = 64;

/// Why there is no such plan.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PlanError {
    #[error(
        "the margin is {0} rad; it has to be between 0 and pi/3 = 1.047, where nothing of the triangle is left"
    )]
    Margin(f64),
    #[error("there are {0} rounds; give a positive number")]
    Rounds(f64),
    #[error("the plan takes {0} s; give a positive duration")]
    Duration(f64),
}

/// The plan of figure 3.14 as courses of `phi1` and `phi2` over a time (seconds): from nearly closed palms, palm 2 opens to its limit while palm 1 is nearly horizontal,
/// palm 1 follows while palm 2 rests, both turn back together. `margin` (radians) is how far the triangle `phi1, phi2, pi - phi1 - phi2 > 0` is kept away from. A round turns a body by about half a
/// turn, two rounds touch every normal with either palm.
///
/// Sides take the same time. The thesis does not say how its palms pass the corners; here they are rounded, and the courses are analytic functions of time: nothing that is
/// integrated along them is spoilt by the plan's own corners.
///
/// # Errors
/// Where a number cannot be used.
pub fn plan_3_14(margin: f64, rounds: f64, duration: f64) -> Result<[Course; 2], PlanError> {
    if !(margin > 0.0 && margin < FRAC_PI_3) {
        return Err(PlanError::Margin(margin));
    }
    if !(rounds > 0.0 && rounds.is_finite()) {
        return Err(PlanError::Rounds(rounds));
    }
    if !(duration > 0.0 && duration.is_finite()) {
        return Err(PlanError::Duration(duration));
    }
    let far = PI - 2.0 * margin;
    let corners = [[margin, margin], [margin, far], [far, margin]];
    Ok([0, 1].map(|palm: usize| course(corners.map(|corner| corner[palm]), rounds / duration)))
}

/// A third of the period each from value to value and back to the first, rounded.
fn course(values: [f64; 3], frequency: f64) -> Course {
    let swings = (1..=OSCILLATIONS).map(|k| {
        let turning = TAU * f64::from(k);
        // the coefficient of exp(i turning u) of a function that is linear between u_j and u_j+1 with the slope m_j:
        // sum m_j (exp(-i turning u_j) - exp(-i turning u_j+1))/(i turning)^2
        let mut coefficient = [0.0; 2];
        for j in 0..3 {
            let slope = 3.0 * (values[(j + 1) % 3] - values[j]);
            let ends = [j as f64 / 3.0, (j + 1) as f64 / 3.0].map(|u| (turning * u).sin_cos());
            coefficient[0] -= slope * (ends[0].1 - ends[1].1) / (turning * turning);
            coefficient[1] += slope * (ends[0].0 - ends[1].0) / (turning * turning);
        }
        let damping = (-(turning * ROUNDING).powi(2) / 2.0).exp();
        let [real, imaginary] = coefficient;
        Oscillation {
            amplitude: 2.0 * damping * real.hypot(imaginary),
            frequency: f64::from(k) * frequency,
            phase: imaginary.atan2(real) + FRAC_PI_2,
        }
    });
    Course { start: values.iter().sum::<f64>() / 3.0, rate: 0.0, swings: swings.collect() }
}
