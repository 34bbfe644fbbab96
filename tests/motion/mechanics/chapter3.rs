//! The geometry of two-point contact, and the quasistatic motion: chapter 3 and appendix A.1.

use crate::mechanics::drawn::{Dice, Instance, instances};
use crate::mechanics::sheet::{Sheet, check_error};
use palmistry::mechanics::linear::{Vector, difference, dot, scaled, solve, sum};
use palmistry::mechanics::*;

/// The generalized contact support functions, by their definitions 3.3 to 3.6: the vector from contact 2 to
/// contact 1 in the body's frame, on the outward normal and on the clockwise tangent at either contact.
fn generalized(placement: &Placement) -> Vec<Real> {
    let [a, b] = &placement.contacts;
    let between = difference(&a.body, &b.body);
    let on = |n: &Vector<2>| [dot(&between, n), dot(&between, &[n[1].clone(), -&n[0]])];
    [on(&a.outward), on(&b.outward)].into_iter().flatten().collect()
}

/// Where the lines along the two palm normals at the contacts meet.
fn centre_of_rotation(placement: &Placement) -> Vector<2> {
    let [a, b] = &placement.contacts;
    let rows = [0, 1].map(|i: usize| [a.normal[i].clone(), -&b.normal[i]]);
    let [along, _] = solve(rows, difference(&b.world, &a.world));
    sum(&a.world, &scaled(&along, &a.normal))
}

/// Writes down what chapter 3 speaks of. Primes (`_p`) are derivatives by the curve parameter theta with phi2
/// held fixed, dots (`_t`) by time, `_0` by phi0.
fn chapter_3(body: &PlanarBody, palms: &PalmMotion, placement: &Placement, motion: &PlanarMotion) -> Sheet {
    let mut sheet = Sheet::default();
    let phi0 = &motion.phi0;
    let still = |swing: &Swing| Swing { rate: Real::zero(), acceleration: Real::zero(), ..swing.clone() };
    let fixed = PalmMotion { phi1: still(&palms.phi1), phi2: still(&palms.phi2) };
    let turn = |angle: &Real| place(body, &fixed.angles(&phi0.value + angle, &Real::zero()));
    // theta = phi1 - phi0 - pi/2 runs against phi0
    let by_theta = differentiate(|angle| generalized(&turn(&-angle)), &Real::zero());
    let in_time =
        Swing { value: phi0.value.clone(), rate: phi0.first.clone(), acceleration: phi0.second.clone() };
    let by_time =
        differentiate(|time| generalized(&place(body, &palms.angles(in_time.at(time), time))), &Real::zero());
    let by_phi0 = |quantity: fn(&Placement) -> Vector<2>| {
        let found = differentiate(|angle| quantity(&turn(angle)).to_vec(), &Real::zero());
        check_error(&found.error);
        found.vector::<2>(0)
    };
    for error in [&by_theta.error, &by_time.error, &motion.error] {
        check_error(error);
    }
    for (k, name) in ["rt1", "dt1", "rt2", "dt2"].iter().enumerate() {
        sheet
            .number(name, &by_time.all[k].value)
            .number(&format!("{name}_t"), &by_time.all[k].first)
            .number(&format!("{name}_p"), &by_theta.all[k].first);
    }
    for i in 0..2 {
        let (n, contact) = (i + 1, &placement.contacts[i]);
        for (name, moving) in [("s", &motion.s[i]), ("r", &motion.r[i]), ("d", &motion.d[i])] {
            sheet.number(&format!("{name}{n}"), &moving.value).number(&format!("{name}{n}_t"), &moving.first);
        }
        sheet
            .number(&format!("v{n}"), &radius_of_curvature(body, &contact.outward))
            .vector(&format!("x{n}"), &contact.body)
            .vector(&format!("x{n}_t"), &motion.body[i].each_ref().map(|x| x.first.clone()))
            .vector(&format!("c{n}"), &contact.world);
    }
    let [centre, centre_0, centre_00] = by_phi0(|placement| placement.centre.clone());
    let [rotation, rotation_0, _] = by_phi0(centre_of_rotation);
    sheet.vector("cm", &centre).vector("cm_0", &centre_0).vector("cm_00", &centre_00);
    sheet.vector("cm_t", &motion.centre.each_ref().map(|x| x.first.clone()));
    sheet.vector("cr", &rotation).vector("cr_0", &rotation_0);
    sheet.number("phi0", &phi0.value).number("phi0_t", &phi0.first);
    sheet.number("phi1", &palms.phi1.value).number("phi1_t", &palms.phi1.rate);
    sheet.number("phi2", &palms.phi2.value).number("phi2_t", &palms.phi2.rate);
    sheet.define(
        "let phi12 = phi1 + phi2\nlet phi12_t = phi1_t + phi2_t
         let theta = phi1 - phi0 - pi/2\nlet theta_t = phi1_t - phi0_t
         let n1 = [cos(theta); sin(theta)]\nlet t1 = [sin(theta); -cos(theta)]
         let n2 = [cos(theta + phi2 - pi); sin(theta + phi2 - pi)]
         let t2 = [sin(theta + phi2 - pi); -cos(theta + phi2 - pi)]
         let nb1 = [-sin(phi1); cos(phi1)]\nlet tb1 = [cos(phi1); sin(phi1)]
         let nb2 = [sin(phi12); -cos(phi12)]\nlet tb2 = [-cos(phi12); -sin(phi12)]
         let R0 = [cos(phi0), -sin(phi0); sin(phi0), cos(phi0)]
         let R0_0 = [-sin(phi0), -cos(phi0); cos(phi0), -sin(phi0)]
         let J = [0, -1; 1, 0]
         let q1 = (s2 - s1*cos(phi2))/sin(phi2)\nlet q2 = (s1 - s2*cos(phi2))/sin(phi2)",
    );
    sheet
}

/// What holds of any motion in two-point contact.
const GEOMETRY: &[(&str, &str, &str)] = &[
    ("3.1, palm 1", "[nb1, tb1]", "-R0*[n1, t1]"),
    ("3.1, palm 2", "[nb2, tb2]", "-R0*[n2, t2]"),
    ("3.3", "rt1", "dot(x1 - x2, n1)"),
    ("3.4", "dt1", "dot(x1 - x2, t1)"),
    ("3.5", "rt2", "dot(x1 - x2, n2)"),
    ("3.6", "dt2", "dot(x1 - x2, t2)"),
    ("3.7", "[rt1; dt1; rt2; dt2]", "[s2*sin(phi2); s2*cos(phi2) - s1; -s1*sin(phi2); s1*cos(phi2) - s2]"),
    ("3.8", "s1*tb1", "cm + R0*x1"),
    ("3.9", "-s2*tb2", "cm + R0*x2"),
    ("3.10", "R0*(x1 - x2)", "s1*tb1 + s2*tb2"),
    ("3.15", "v1", "-(rt2_p + dt2)/sin(phi2)"),
    ("3.16", "v2", "-(rt1_p + dt1)/sin(phi2)"),
    ("3.17", "-(r1*nb1 + d1*tb1) + (r2*nb2 + d2*tb2)", "s1*tb1 + s2*tb2"),
    ("3.18", "d1", "(r1*cos(phi2) + r2)/sin(phi2) - s1"),
    ("3.19", "d2", "-(r2*cos(phi2) + r1)/sin(phi2) + s2"),
    ("below 3.19, r' = -d", "[r1_t; r2_t]", "[-d1*theta_t; -d2*(theta_t + phi2_t)]"),
    ("below A.24, d' = r - v", "[d1_t; d2_t]", "[(r1 - v1)*theta_t; (r2 - v2)*(theta_t + phi2_t)]"),
    ("below 3.1, x' = -v t", "[x1_t, x2_t]", "[-v1*theta_t*t1, -v2*(theta_t + phi2_t)*t2]"),
    ("3.20, 3.21", "[c1 + q1*nb1, c2 + q2*nb2]", "[cr, cr]"),
    ("below 3.21", "[q1; q2]", "[-dt2/sin(phi2); -dt1/sin(phi2)]"),
    ("3.22", "cm", "-rt2*tb1/sin(phi2) - R0*x1"),
    ("3.23", "cr", "-(rt2*tb1 + dt2*nb1)/sin(phi2)"),
    ("3.24", "cm_0", "-dt2*tb1/sin(phi2) - R0_0*x1"),
    ("3.25", "cr_0", "-(v1*nb2 - v2*nb1 - rt2*nb1 + dt2*tb1)/sin(phi2)"),
    ("3.26", "cm_0", "J*(cm - cr)"),
    ("below 3.27", "cm_00", "J*(cm_0 - cr_0)"),
    // section 3.2 has the first term alone, which is the motion while the palms stand still
    ("3.26, palms moving", "cm_t", "phi0_t*J*(cm - cr) + phi1_t*J*cr - phi2_t*s2*tb1/sin(phi2)"),
    ("3.29", "v1", "-(rt2_t + (theta_t + phi2_t)*dt2)/(theta_t*sin(phi2))"),
    ("3.30", "v2", "-(rt1_t + theta_t*dt1)/((theta_t + phi2_t)*sin(phi2))"),
    ("3.32, 3.33", "dot(R0*x1, [1; 0])", "r1*sin(phi1) - d1*cos(phi1)"),
    ("A.1", "rt1_p", "-v2*sin(phi2) - dt1"),
    ("A.2", "rt1_t", "-v2*(theta_t + phi2_t)*sin(phi2) - theta_t*dt1"),
    ("A.3", "rt2_p", "-v1*sin(phi2) - dt2"),
    ("A.4", "rt2_t", "-v1*theta_t*sin(phi2) - (theta_t + phi2_t)*dt2"),
    ("A.9", "cm_0", "rt2_p*tb1/sin(phi2) - R0_0*x1 + v1*tb1"),
    ("A.12", "cr_0", "(rt2_p*tb1 + dt2_p*nb1)/sin(phi2)"),
    ("A.13", "cr_0", "(-(v1*sin(phi2) + dt2)*tb1 + (v1*cos(phi2) + v2 + rt2)*nb1)/sin(phi2)"),
    ("A.14", "cr_0", "(-v1*nb2 + v2*nb1 + rt2*nb1 - dt2*tb1)/sin(phi2)"),
    ("A.15", "cm - cr", "dt2*nb1/sin(phi2) - R0*x1"),
];

/// What holds where the body is also at rest at every moment.
const BALANCE: &[(&str, &str, &str)] = &[
    ("3.26, at rest", "dot(cm - cr, [1; 0])", "0"),
    ("3.27", "dot(R0*x1, [1; 0])", "-dt2*sin(phi1)/sin(phi2)"),
    (
        "3.34",
        "phi0_t",
        "(rt2_t*cos(phi1) - dt2_t*sin(phi1) + dt2*phi2_t*sin(phi12)/sin(phi2))\
      /(r1*sin(phi12) + (r2 + rt2)*sin(phi1) + dt2*cos(phi1))",
    ),
    ("3.35", "r1_t", "-d1*(phi1_t - phi0_t)"),
    ("3.36", "r2_t", "-d2*(phi12_t - phi0_t)"),
    (
        "A.20",
        "(r1_t + d1*phi1_t)*sin(phi1) + (r1*phi1_t - d1_t)*cos(phi1)",
        "(-dt2_t*sin(phi1) - dt2*phi1_t*cos(phi1) + dt2*phi2_t*sin(phi1)*cot(phi2))/sin(phi2)",
    ),
    (
        "A.21",
        "(r1_t + d1*phi1_t)*sin(phi1) + (r1*phi1_t - d1_t)*cos(phi1)",
        "d1*(phi1_t - theta_t)*sin(phi1) + r1*(phi1_t - theta_t)*cos(phi1)\
       - (rt2_t + (theta_t + phi2_t)*dt2)/sin(phi2)*cos(phi1)",
    ),
    (
        "A.23",
        "(r1_t + d1*phi1_t)*sin(phi1) + (r1*phi1_t - d1_t)*cos(phi1)",
        "phi0_t*(d1*sin(phi1) + r1*cos(phi1) + dt2*cos(phi1)/sin(phi2))\
       - (rt2_t + (phi1_t + phi2_t)*dt2)/sin(phi2)*cos(phi1)",
    ),
];

#[test]
fn the_geometry_of_chapter_3_holds_for_a_real_body() {
    let mut worst = 0.0f64;
    for instance in instances(3, 12) {
        let Instance { body, palms, found, .. } = &instance;
        let mut sheet = chapter_3(body, palms, &found.placement, &found.motion).open();
        for (label, left, right) in GEOMETRY {
            sheet.holds(label, left, right);
        }
        sheet.fails("section 3.2, 'if we move the palms'", "cm_t", "phi0_t*J*(cm - cr)");
        sheet.fails("section 3.3, x' as printed", "x1_t", "theta_t*v1*t1");
        worst = worst.max(sheet.worst);
    }
    println!("greatest difference {worst:e}");
}

/// 3.34: a body that rests at the least potential energy turns as the thesis says when the palms move.
#[test]
fn the_quasistatic_motion_of_chapter_3_is_that_of_a_body_at_rest() {
    let mut dice = Dice::new(34);
    let (mut worst, mut found) = (0.0f64, 0);
    for _ in 0..40 {
        let (body, palms) = (dice.planar_body(), dice.palms());
        let Some(phi0) = lowest_pose(&body, &palms.phi1.value, &palms.phi2.value) else { continue };
        let Some((placement, motion)) = follow(&body, &palms, &phi0) else { continue };
        let theta_rate = &palms.phi1.rate - &motion.phi0.first;
        let resting =
            [&theta_rate, &(&theta_rate + &palms.phi2.rate)].map(|rate| rate.abs() < Real::power_of_two(-4));
        if resting.contains(&true) || motion.s.iter().any(|s| !s.value.is_positive()) {
            continue; // 3.29 and 3.30 divide by these rates
        }
        let mut sheet = chapter_3(&body, &palms, &placement, &motion).open();
        for (label, left, right) in GEOMETRY.iter().chain(BALANCE) {
            sheet.holds(label, left, right);
        }
        worst = worst.max(sheet.worst);
        found += 1;
        if found == 10 {
            break;
        }
    }
    assert_eq!(found, 10);
    println!("greatest difference {worst:e}");
}
