//! Circular palms: section 4.7, held against bodies that roll and slide between arcs of circles.

use crate::mechanics::drawn::Dice;
use crate::mechanics::sheet::{OpenSheet, check_error};
use dashu::rational::RBig;
use palmistry::System;
use palmistry::mechanics::linear::{difference, dot, scaled, sum};
use palmistry::mechanics::*;
use std::collections::HashMap;
use std::path::Path;

/// A motion between circular palms, with everything that went into it.
struct Circular {
    body: PlanarBody,
    palms: PalmMotion,
    radii: [Real; 2],
    inertia: Inertia,
    found: PlanarDynamics,
}

fn forms(radii: &[Real; 2]) -> [Palm<Real>; 2] {
    radii.clone().map(|radius| Palm::Circular { radius })
}

/// Draws motions between hollow (sign 1) or bulging palms until both push and neither contact rests on the body.
fn motions(seed: u64, sign: i64, count: usize) -> Vec<Circular> {
    let mut dice = Dice::new(seed);
    let mut all = Vec::new();
    for _ in 0..40 * count {
        let (body, palms) = (dice.planar_body(), dice.palms());
        let (phi0, omega0) = (dice.real(0, 6283), dice.real(-2000, 2000));
        let radii = [0, 1].map(|_| Real::whole(sign) * dice.real(3000, 6000));
        let inertia = Inertia {
            mass: dice.real(200, 3000),
            gyration: dice.real(300, 700),
            palms: [dice.real(200, 800), dice.real(200, 800)],
            gravity: Real::from_rational(&(RBig::from(-981) / RBig::from(100))),
        };
        let found =
            planar_dynamics_on(&body, &palms, &forms(&radii), [&phi0, &omega0], &inertia).expect("a motion");
        let pushed = found.forces.iter().all(Real::is_positive)
            && found.motion.s.iter().all(|s| s.value.is_positive());
        if pushed {
            all.push(Circular { body, palms, radii, inertia, found });
        }
        if all.len() == count {
            return all;
        }
    }
    panic!("too few motions keep contact");
}

/// The numbers of a motion under the names of section 4.7, where angles of palm 2 count from the X axis.
fn named(motion: &Circular) -> HashMap<String, RBig> {
    let Circular { palms, inertia, found, radii, .. } = motion;
    let (one, two) = (&palms.phi1, &palms.phi2);
    let list = [
        ("r1", found.motion.r[0].value.clone()),
        ("r2", found.motion.r[1].value.clone()),
        ("beta1", &found.motion.s[0].value / &radii[0]),
        ("beta2", &found.motion.s[1].value / &radii[1]),
        ("b1", radii[0].clone()),
        ("b2", radii[1].clone()),
        ("omega0", found.motion.phi0.first.clone()),
        ("phi1", one.value.clone()),
        ("omega1", one.rate.clone()),
        ("alpha1", one.acceleration.clone()),
        ("phi2", &one.value + &two.value),
        ("omega2", &one.rate + &two.rate),
        ("alpha2", &one.acceleration + &two.acceleration),
        ("rho", inertia.gyration.clone()),
        ("m", inertia.mass.clone()),
        ("g", inertia.gravity.clone()),
        ("I1", inertia.palms[0].clone()),
        ("I2", inertia.palms[1].clone()),
        ("tau1", found.torques[0].clone()),
        ("tau2", found.torques[1].clone()),
    ];
    list.into_iter().map(|(name, value)| (name.to_owned(), value.to_rational().unwrap())).collect()
}

/// The rates of `circular_palms_rank.proof`, hollow and bulging, are those of bodies that are moved by Newton's laws; and the
/// form that is printed for the rate of `r_1` is not.
#[test]
fn the_rates_of_section_4_7_move_a_real_body() {
    let mut worst = 0.0f64;
    for motion in motions(47, 1, 10).into_iter().chain(motions(48, -1, 6)) {
        let moving = &motion.found.motion;
        check_error(&moving.error);
        let system = System::read(Path::new("proofs/moll2002/circular_palms_rank.proof")).unwrap();
        let mut sheet = OpenSheet::new(system, &named(&motion));
        let rates = [
            ("omega0", moving.phi0.second.clone()),
            ("beta1", &moving.s[0].first / &motion.radii[0]),
            ("beta2", &moving.s[1].first / &motion.radii[1]),
            ("r1", moving.r[0].first.clone()),
            ("r2", moving.r[1].first.clone()),
        ];
        for (name, rate) in &rates {
            let along = format!("L(f, {name}) + tau1*L(g1, {name}) + tau2*L(g2, {name})");
            sheet.holds(name, &along, &format!("({})", rate.to_rational().unwrap()));
        }
        let (d1, rate) = (moving.d[0].value.to_rational().unwrap(), rates[3].1.to_rational().unwrap());
        sheet.fails(
            "'most of the differential equations remain the same'",
            &format!("({rate})"),
            &format!("-({d1})*(omega1 - omega0)"),
        );
        worst = worst.max(sheet.worst);
    }
    println!("greatest difference {worst:e}");
}

/// The one constraint, from positions that are differenced alone: `n . (c' + omega0 x (c_i - c) - omega_i x c_i) = 0`; and both
/// contacts lie on the circles that 4.81 and 4.82 name, and on the body, whose every other point is on the palms' free side.
#[test]
fn contacts_touch_circles_and_keep_the_one_constraint() {
    let small = Real::power_of_two(-130);
    let turned = |v: &[Real; 2]| [-&v[1], v[0].clone()];
    for (seed, sign) in [(51, 1), (52, -1)] {
        for motion in motions(seed, sign, 5) {
            let Circular { body, palms, radii, found, .. } = &motion;
            let (placement, moving) = (&found.placement, &found.motion);
            let velocity = moving.centre.each_ref().map(|x| x.first.clone());
            let rates = [palms.phi1.rate.clone(), &palms.phi1.rate + &palms.phi2.rate];
            let angles = [palms.phi1.value.clone(), &palms.phi1.value + &palms.phi2.value];
            for i in 0..2 {
                let contact = &placement.contacts[i];
                let arm = difference(&contact.world, &placement.centre);
                let entering = difference(
                    &sum(&velocity, &scaled(&moving.phi0.first, &turned(&arm))),
                    &scaled(&rates[i], &turned(&contact.world)),
                );
                assert!(dot(&contact.normal, &entering).abs() < small);
                // 4.81, 4.82: the middle of the circle is where the palm's normal at the joint ends
                let (sine, cosine) = angles[i].sin_cos();
                let up = if i == 0 { [-&sine, cosine] } else { [sine, -&cosine] };
                let middle = scaled(&radii[i], &up);
                let spoke = difference(&contact.world, &middle);
                assert!((dot(&spoke, &spoke) - &radii[i] * &radii[i]).abs() < small);
                let seen = sum(&spoke, &scaled(&radii[i], &contact.normal));
                assert!(dot(&seen, &seen) < small);
                // the body is within a hollow circle and outside a bulging one
                let turn = moving.phi0.value.sin_cos();
                for k in 0..48 {
                    let (s, c) = (Real::whole(k) / Real::whole(7)).sin_cos();
                    let x = body.point(&[c, s]);
                    let x = [&turn.1 * &x[0] - &turn.0 * &x[1], &turn.0 * &x[0] + &turn.1 * &x[1]];
                    let spoke = difference(&sum(&placement.centre, &x), &middle);
                    let room = &radii[i] * &radii[i] - dot(&spoke, &spoke);
                    assert!((Real::whole(sign) * room) > -&small);
                }
            }
        }
    }
}

/// Flat palms are the limit: at ten times the radius a motion is ten times nearer to that between flat palms.
#[test]
fn flat_palms_are_the_limit_of_large_circles() {
    let motion = motions(49, 1, 1).remove(0);
    let (phi0, omega0) = (&motion.found.motion.phi0.value, &motion.found.motion.phi0.first);
    let flat = planar_dynamics(&motion.body, &motion.palms, phi0, omega0, &motion.inertia).unwrap();
    let distance = |radius: i64| {
        let radii = [Real::whole(radius), Real::whole(-radius)];
        let found =
            planar_dynamics_on(&motion.body, &motion.palms, &forms(&radii), [phi0, omega0], &motion.inertia);
        let found = found.unwrap();
        let pairs = [
            (&found.motion.s[0].value, &flat.motion.s[0].value),
            (&found.motion.s[1].first, &flat.motion.s[1].first),
            (&found.motion.phi0.second, &flat.motion.phi0.second),
            (&found.forces[0], &flat.forces[0]),
            (&found.torques[1], &flat.torques[1]),
        ];
        pairs.map(|(bent, straight)| (bent - straight).abs().to_f64())
    };
    let [near, nearer, nearest] = [10_000, 100_000, 1_000_000_000].map(distance);
    for k in 0..5 {
        let ratio = near[k] / nearer[k];
        assert!((9.9..10.1).contains(&ratio), "quantity {k}: {} and {}", near[k], nearer[k]);
        assert!(nearest[k] < 1e-6 && nearest[k] > 0.0, "quantity {k}: {}", nearest[k]);
    }
}
