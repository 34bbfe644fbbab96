//! Random bodies and motions, from a fixed seed.

use dashu::rational::RBig;
use palmistry::mechanics::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

pub struct Dice(ChaCha8Rng);

impl Dice {
    pub fn new(seed: u64) -> Self {
        Dice(ChaCha8Rng::seed_from_u64(seed))
    }

    /// A rational between two thousandths.
    pub fn rational(&mut self, low: i64, high: i64) -> RBig {
        RBig::from(self.0.random_range(low..=high)) / RBig::from(1000)
    }

    pub fn real(&mut self, low: i64, high: i64) -> Real {
        Real::from_rational(&self.rational(low, high))
    }

    /// An angle between two thousandths of a radian, with a rate and an acceleration.
    pub fn swing(&mut self, low: i64, high: i64) -> Swing {
        let (value, rate) = (self.real(low, high), self.real(-2000, 2000));
        Swing { value, rate, acceleration: self.real(-1000, 1000) }
    }

    /// Harmonics up to the fourth: 3 * 0.12 + 8 * 0.05 + 15 * 0.014 = 0.97 of the size, so that convexity is
    /// nearly used up where all are at their largest.
    pub fn planar_body(&mut self) -> PlanarBody {
        let sizes = [120, 60, 25, 7];
        let harmonics = sizes.map(|size| (self.rational(-size, size), self.rational(-size, size)));
        PlanarBody::new(&RBig::ONE, &harmonics).expect("a convex body")
    }

    /// Palms in the shape of a V, whose normals can carry a weight.
    pub fn palms(&mut self) -> PalmMotion {
        PalmMotion { phi1: self.swing(300, 900), phi2: self.swing(1300, 2000) }
    }

    pub fn ellipsoid(&mut self) -> SolidShape {
        let zero = || RBig::ZERO;
        SolidShape {
            axes: [self.rational(900, 950), self.rational(960, 1050), self.rational(1100, 1200)],
            centre: [0; 3].map(|_| self.rational(-100, 100)),
            quartic: [zero(), zero(), zero()],
            cubic: zero(),
        }
    }

    /// A body that is no ellipsoid.
    pub fn bumpy(&mut self) -> SolidShape {
        let ellipsoid = self.ellipsoid();
        SolidShape {
            quartic: [12, -15, 18].map(|q| self.rational(q, 20)),
            cubic: self.rational(50, 90),
            ..ellipsoid
        }
    }

    /// Three palms that rise in three directions, and a body turned at random.
    pub fn solid_motion(&mut self, shape: &SolidShape) -> SolidMotion {
        SolidMotion {
            solid: Solid::new(shape).expect("a convex body"),
            turn: [self.swing(0, 6000), self.swing(500, 2600), self.swing(0, 6000)],
            azimuths: [self.real(-300, 300), self.real(1800, 2400), self.real(3900, 4500)],
            palms: [0; 3].map(|_| self.swing(600, 1200)),
            spheres: [None, None, None],
        }
    }
}

/// A body that moves as Newton's laws ask, with everything that went into it.
pub struct Instance {
    pub body: PlanarBody,
    pub palms: PalmMotion,
    pub inertia: Inertia,
    pub found: PlanarDynamics,
}

/// Draws motions until both palms push, both contacts lie on their palms and neither rests on the body.
pub fn instances(seed: u64, count: usize) -> Vec<Instance> {
    let mut dice = Dice::new(seed);
    let mut all = Vec::new();
    for _ in 0..100 * count {
        let (body, palms) = (dice.planar_body(), dice.palms());
        let (phi0, omega0) = (dice.real(0, 6283), dice.real(-2000, 2000));
        let inertia = Inertia {
            mass: dice.real(200, 3000),
            gyration: dice.real(300, 700),
            palms: [dice.real(200, 800), dice.real(200, 800)],
            gravity: Real::from_rational(
                &(dashu::rational::RBig::from(-981) / dashu::rational::RBig::from(100)),
            ),
        };
        let found = planar_dynamics(&body, &palms, &phi0, &omega0, &inertia).expect("a motion");
        let omega12 = &palms.phi1.rate + &palms.phi2.rate;
        let apart = |a: &Real, b: &Real| (a - b).abs() > Real::power_of_two(-4);
        let pushed = found.forces.iter().all(Real::is_positive)
            && found.motion.s.iter().all(|s| s.value.is_positive());
        if pushed && apart(&palms.phi1.rate, &omega0) && apart(&omega12, &omega0) {
            all.push(Instance { body, palms, inertia, found });
        }
        if all.len() == count {
            return all;
        }
    }
    panic!("too few motions keep contact");
}
