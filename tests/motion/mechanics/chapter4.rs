//! The planar dynamics: the steps of sections 4.1 and 4.2, and the vector fields that come of them.

use crate::mechanics::drawn::{Instance, instances};
use crate::mechanics::sheet::{OpenSheet, Sheet, check_error};
use palmistry::System;
use palmistry::mechanics::linear::difference;
use palmistry::mechanics::*;
use std::collections::HashMap;

/// The numbers of an instance under the names of the thesis.
fn named(instance: &Instance) -> HashMap<String, dashu::rational::RBig> {
    let Instance { palms, inertia, found, .. } = instance;
    let motion = &found.motion;
    let list = [
        ("r1", &motion.r[0].value),
        ("r2", &motion.r[1].value),
        ("s1", &motion.s[0].value),
        ("s2", &motion.s[1].value),
        ("omega0", &motion.phi0.first),
        ("phi1", &palms.phi1.value),
        ("omega1", &palms.phi1.rate),
        ("alpha1", &palms.phi1.acceleration),
        ("phi2", &palms.phi2.value),
        ("omega2", &palms.phi2.rate),
        ("alpha2", &palms.phi2.acceleration),
        ("rho", &inertia.gyration),
        ("m", &inertia.mass),
        ("g", &inertia.gravity),
        ("I1", &inertia.palms[0]),
        ("I2", &inertia.palms[1]),
        ("tau1", &found.torques[0]),
        ("tau2", &found.torques[1]),
    ];
    list.into_iter().map(|(name, value)| (name.to_owned(), value.to_rational().unwrap())).collect()
}

/// 4.31 and 4.34: along `f + tau1 g1 + tau2 g2` the states change as those of a real body do.
#[test]
fn the_vector_fields_of_chapter_4_move_a_real_body() {
    let mut worst = 0.0f64;
    for instance in instances(4, 20) {
        let motion = &instance.found.motion;
        check_error(&motion.error);
        let system = System::read(std::path::Path::new("proofs/moll2002/general.proof")).unwrap();
        let mut sheet = OpenSheet::new(system, &named(&instance));
        let rates = [
            ("r1", &motion.r[0].first),
            ("r2", &motion.r[1].first),
            ("omega0", &motion.phi0.second),
            ("s1", &motion.s[0].first),
            ("s2", &motion.s[1].first),
            ("d1", &motion.d[0].first),
            ("d2", &motion.d[1].first),
        ];
        for (name, rate) in rates {
            let along = format!("L(f, {name}) + tau1*L(g1, {name}) + tau2*L(g2, {name})");
            let rate = rate.to_rational().unwrap();
            sheet.holds(name, &along, &format!("({rate})"));
        }
        for (name, value) in [("d1", &motion.d[0].value), ("d2", &motion.d[1].value)] {
            sheet.holds(name, name, &format!("({})", value.to_rational().unwrap()));
        }
        // the minus sign that 4.31 has too many before the first fraction of s2'
        let first = "(-omega0^2*r2 + g*cos(phi12))/(omega12 - omega0)";
        let rate = motion.s[1].first.to_rational().unwrap();
        sheet.fails(
            "4.31.s2 as printed",
            &format!("L(f, s2) + tau1*L(g1, s2) + tau2*L(g2, s2) - 2*{first}"),
            &format!("({rate})"),
        );
        worst = worst.max(sheet.worst);
    }
    println!("greatest difference {worst:e}");
}

/// The steps of section 4.1 and 4.2, each on its own.
#[test]
fn the_equations_of_motion_hold_for_a_real_body() {
    let mut worst = 0.0f64;
    for instance in instances(41, 12) {
        let Instance { body, found, .. } = &instance;
        let (motion, placement) = (&found.motion, &found.placement);
        let mut sheet = Sheet::default();
        for (name, value) in named(&instance) {
            sheet.number(&name, &Real::from_rational(&value));
        }
        for i in 0..2 {
            let contact = &placement.contacts[i];
            let n = i + 1;
            sheet
                .number(&format!("f{n}"), &found.forces[i])
                .number(&format!("torque{n}"), &(&found.forces[i] * placement.moment(i)))
                .number(&format!("v{n}"), &radius_of_curvature(body, &contact.outward))
                .number(&format!("dd{n}"), &motion.d[i].value)
                .number(&format!("s{n}_t"), &motion.s[i].first)
                .vector(&format!("n{n}"), &contact.normal)
                .vector(&format!("t{n}"), &contact.tangent)
                .vector(&format!("Rx{n}"), &difference(&contact.world, &placement.centre));
        }
        let second = motion.centre.each_ref().map(|x| x.second.clone());
        let first = motion.centre.each_ref().map(|x| x.first.clone());
        sheet.vector("a0", &second).vector("cm_t", &first).number("alpha0", &motion.phi0.second);
        sheet.define(
            "let d1 = dd1\nlet d2 = dd2\nlet omega12 = omega1 + omega2\nlet alpha12 = alpha1 + alpha2\n\
             let phi12 = phi1 + phi2\nlet J = [0, -1; 1, 0]",
        );
        let mut sheet = sheet.open();
        for (label, left, right) in [
            ("4.3", "torque1", "-f1*d1"),
            ("4.4", "torque2", "-f2*d2"),
            ("4.5", "m*a0", "[0; m*g] + f1*n1 + f2*n2"),
            ("4.6", "m*rho^2*alpha0", "-f1*d1 - f2*d2"),
            ("4.7", "I1*alpha1", "tau1 - f1*s1"),
            ("4.8", "I2*(alpha1 + alpha2)", "tau2 + f2*s2"),
            ("4.9", "a0", "-(I1*alpha1 - tau1)/(m*s1)*n1 + (I2*alpha12 - tau2)/(m*s2)*n2 + [0; g]"),
            ("4.10", "alpha0", "(I1*alpha1 - tau1)/(m*rho^2*s1)*d1 - (I2*alpha12 - tau2)/(m*rho^2*s2)*d2"),
            ("4.13", "s1_t*t1 + s1*omega1*n1", "cm_t + omega0*J*Rx1 + (omega1 - omega0)*v1*t1"),
            (
                "4.16",
                "2*s1_t*omega1 + s1*alpha1",
                "dot(a0, n1) - alpha0*d1 + omega0^2*r1 + (omega1^2 - omega0^2)*v1",
            ),
            (
                "4.17",
                "v1",
                "(2*s1_t*omega1 + s1*alpha1 - omega0^2*r1 - dot(a0, n1) + alpha0*d1)/(omega1^2 - omega0^2)",
            ),
            (
                "4.18",
                "v1",
                "-((-s1_t*sin(phi2) - s1*omega2*cos(phi2)) + (omega12 - omega0)*(s1*cos(phi2) - s2))\
                 /((omega1 - omega0)*sin(phi2))",
            ),
            (
                "4.22",
                "s1_t",
                "-(s1*alpha1 - omega0^2*r1 - dot(a0, n1) + alpha0*d1)/(omega1 - omega0)\
                 - (omega1 + omega0)/tan(phi2)*s1\
                 + (omega1 + omega0)*(omega12 - omega0)/((omega1 - omega0)*sin(phi2))*s2",
            ),
            (
                "4.23",
                "s2_t",
                "(-s2*alpha12 - omega0^2*r2 - dot(a0, n2) + alpha0*d2)/(omega12 - omega0)\
                 + (omega12 + omega0)/tan(phi2)*s2\
                 - (omega12 + omega0)*(omega1 - omega0)/((omega12 - omega0)*sin(phi2))*s1",
            ),
            (
                "4.29",
                "-dot(a0, n1) + alpha0*d1",
                "(I1*alpha1 - tau1)*(rho^2 + d1^2)/(m*rho^2*s1)\
                 + (I2*alpha12 - tau2)*(rho^2*cos(phi2) - d1*d2)/(m*rho^2*s2) - g*cos(phi1)",
            ),
            (
                "4.30",
                "-dot(a0, n2) + alpha0*d2",
                "-(I1*alpha1 - tau1)*(rho^2*cos(phi2) - d1*d2)/(m*rho^2*s1)\
                 - (I2*alpha12 - tau2)*(rho^2 + d2^2)/(m*rho^2*s2) + g*cos(phi12)",
            ),
        ] {
            sheet.holds(label, left, right);
        }
        worst = worst.max(sheet.worst);
    }
    println!("greatest difference {worst:e}");
}
