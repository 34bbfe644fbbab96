//! Three-point contact and the dynamics in space: sections 5.1 to 5.3.

use crate::mechanics::drawn::Dice;
use crate::mechanics::sheet::{Sheet, check_error};
use palmistry::mechanics::linear::{Vector, dot, transposed};
use palmistry::mechanics::*;

fn moving(sheet: &mut Sheet, name: &str, value: &MovingVector) {
    for (suffix, vector) in ["", "_t", "_tt"].iter().zip(value) {
        sheet.vector(&format!("{name}{suffix}"), vector);
    }
}

/// Writes down what chapter 5 speaks of; `_t` is a derivative by time. The tangents `t_i1`, `t_i2` are
/// written out from 5.1 and 5.2, with the sines and cosines of the surface parameters taken from the normal
/// by 5.3.
fn chapter_5(solid: &Solid, tumbling: &Tumbling) -> Sheet {
    check_error(&tumbling.error);
    let mut sheet = Sheet::default();
    moving(&mut sheet, "cm", &tumbling.centre);
    sheet.matrix("R0", &tumbling.turn[0]).matrix("R0_t", &tumbling.turn[1]);
    sheet
        .vector("w0", &angular_velocity(&tumbling.turn))
        .vector("alpha0", &angular_acceleration(&tumbling.turn));
    for (i, contact) in tumbling.contacts.iter().enumerate() {
        let n = i + 1;
        moving(&mut sheet, &format!("c{n}"), &contact.world);
        moving(&mut sheet, &format!("b{n}"), &contact.body);
        moving(&mut sheet, &format!("n{n}"), &contact.outward);
        moving(&mut sheet, &format!("s{n}"), &contact.sensed);
        let columns = contact.palm.each_ref().map(transposed);
        sheet.matrix(&format!("R{n}"), &columns[0]);
        sheet.vector(&format!("w{n}"), &angular_velocity(&columns));
        sheet.vector(&format!("nb{n}"), &contact.palm[0][2]);
        for (suffix, slope) in ["by1", "by2"].iter().zip(support_slopes(solid, &contact.outward[0])) {
            sheet.number(&format!("r{n}_{suffix}"), &slope);
        }
        sheet.define(&numbered(
            "let theta_#2 = asin(dot([0; 0; 1], n#))\nlet cos_#2 = sqrt(1 - dot([0; 0; 1], n#)^2)
             let t_#1 = [-dot([0; 1; 0], n#); dot([1; 0; 0], n#); 0]/cos_#2
             let t_#2 = [0; 0; 1]/cos_#2 - n#*dot([0; 0; 1], n#)/cos_#2
             let theta_#1_t = dot(t_#1, n#_t)/cos_#2\nlet theta_#2_t = dot([0; 0; 1], n#_t)/cos_#2
             let r# = dot(b#, n#)\nlet d# = dot(b#, t_#1)\nlet e# = dot(b#, t_#2)
             let r#_t = dot(b#_t, n#) + dot(b#, n#_t)
             let speed_# = sqrt(dot(b#_t, b#_t))\nlet speed_#_t = dot(b#_t, b#_tt)/speed_#
             let T_# = b#_t/speed_#\nlet U_# = n#\nlet V_# = cross(U_#, T_#)
             let T_#_t = b#_tt/speed_# - b#_t*speed_#_t/speed_#^2
             let V_#_t = cross(n#_t, T_#) + cross(U_#, T_#_t)
             let bend_# = T_#_t/speed_#
             let kappa_g_# = dot(bend_#, V_#)\nlet kappa_n_# = dot(bend_#, U_#)
             let tau_g_# = dot(V_#_t, U_#)/speed_#",
            n,
        ));
    }
    sheet.define(
        "let zero = [0; 0; 0]\nlet B = [transpose(nb1); transpose(nb2); transpose(nb3)]*R0
         let hat0 = [cross(w0, [1; 0; 0]), cross(w0, [0; 1; 0]), cross(w0, [0; 0; 1])]",
    );
    for (i, j) in [(1, 1), (1, 2), (1, 3), (2, 1), (2, 2), (2, 3), (3, 1), (3, 2), (3, 3)] {
        sheet.define(&format!("let q{j}{i} = dot(nb{j}, c{i}_t - c{j}_t - cross(w0, c{i} - c{j}))"));
    }
    sheet.define("let Q = [q11, q12, q13; q21, q22, q23; q31, q32, q33]");
    sheet
}

/// The derivatives of the radius function by the two surface parameters, where the outward normal is `n`.
fn support_slopes(solid: &Solid, n: &Vector<3>) -> [Real; 2] {
    let level = (&n[0] * &n[0] + &n[1] * &n[1]).sqrt();
    let along = |angle: &Real| {
        let (s, c) = angle.sin_cos();
        let turned = [&c * &n[0] - &s * &n[1], &s * &n[0] + &c * &n[1], n[2].clone()];
        let (z, rho) = (&c * &n[2] + &s * &level, &c * &level - &s * &n[2]);
        let raised = [&n[0] * &rho / &level, &n[1] * &rho / &level, z];
        vec![dot(&solid.point(&turned), &turned), dot(&solid.point(&raised), &raised)]
    };
    let found = differentiate(along, &Real::zero());
    check_error(&found.error);
    [found.all[0].first.clone(), found.all[1].first.clone()]
}

/// Puts a contact's number in the place of each `#`.
fn numbered(text: &str, number: usize) -> String {
    text.replace('#', &number.to_string())
}

/// What holds at each contact of any motion.
const AT_EACH_CONTACT: &[(&str, &str, &str)] = &[
    ("5.3", "n#", "[cos(theta_#2)*dot([0; 1; 0], t_#1); -cos(theta_#2)*dot([1; 0; 0], t_#1); sin(theta_#2)]"),
    ("5.1 to 5.3, right-handed", "cross(t_#1, t_#2)", "n#"),
    ("5.4", "r#_by1", "d#*cos_#2"),
    ("5.5", "r#_by2", "e#"),
    ("above 5.6", "c#", "R#*s#"),
    ("above 5.6, the third component", "dot([0; 0; 1], s#)", "0"),
    ("5.6", "c#", "cm + R0*b#"),
    ("5.7", "c#_t", "cm_t + cross(w0, R0*b#) + R0*b#_t"),
    ("5.10", "nb#", "-R0*n#"),
    ("5.11", "dot(nb#, R0*b#_t)", "0"),
    ("5.16", "r#_t", "d#*cos_#2*theta_#1_t + e#*theta_#2_t"),
    ("5.17", "b#", "r#*n# + d#*t_#1 + e#*t_#2"),
    ("5.21", "n#_t", "theta_#1_t*cos_#2*t_#1 + theta_#2_t*t_#2"),
    ("5.22", "cross(w#, nb#)", "-cross(w0, R0*n#) - R0*n#_t"),
    ("5.22, solved", "n#_t", "transpose(R0)*cross(w0 - w#, nb#)"),
    (
        "5.23",
        "[theta_#1_t; theta_#2_t]",
        "[transpose(t_#1)/cos_#2; transpose(t_#2)]*transpose(R0)*cross(w0 - w#, nb#)",
    ),
    ("5.24", "c#_tt", "cm_tt + cross(alpha0, R0*b#) + cross(w0, cross(w0, R0*b#) + 2*R0*b#_t) + R0*b#_tt"),
    ("below 5.24", "dot(b#_tt, n#)", "-dot(b#_t, n#_t)"),
    (
        "5.25",
        "dot(cross(nb#, w0 + w#), R0*b#_t)",
        "dot(nb#, c#_tt - cm_tt - cross(alpha0, R0*b#) - cross(w0, cross(w0, R0*b#)))",
    ),
    ("5.26", "T_#_t", "speed_#*(kappa_g_#*V_# + kappa_n_#*U_#)"),
    ("5.27", "V_#_t", "speed_#*(-kappa_g_#*T_# + tau_g_#*U_#)"),
    ("5.28", "n#_t", "speed_#*(-kappa_n_#*T_# - tau_g_#*V_#)"),
    ("5.29", "b#_tt", "speed_#_t*T_# + speed_#^2*(kappa_g_#*V_# + kappa_n_#*U_#)"),
    ("5.30, with the square of the speed", "kappa_n_#*speed_#^2", "-dot(b#_t, n#_t)"),
];

/// What holds of all contacts together.
const TOGETHER: &[(&str, &str, &str)] = &[
    ("5.8", "c1_t - c2_t", "cross(w0, R0*(b1 - b2)) + R0*(b1_t - b2_t)"),
    ("5.9", "c2_t - c3_t", "cross(w0, c2 - c3) + R0*(b2_t - b3_t)"),
    ("5.12", "dot(nb2, R0*b1_t)", "q21"),
    ("5.13", "dot(nb3, R0*b1_t)", "q31"),
    ("5.15", "[b1_t, b2_t, b3_t]", "inverse(B)*Q"),
    ("5.18", "c1 - c2", "R0*(r1*n1 + d1*t_11 + e1*t_12 - r2*n2 - d2*t_21 - e2*t_22)"),
    (
        "5.19",
        "[t_11, t_12, -t_21, -t_22, zero, zero; t_11, t_12, zero, zero, -t_31, -t_32]*[d1; e1; d2; e2; d3; e3]",
        "[transpose(R0)*(c1 - c2) - r1*n1 + r2*n2; transpose(R0)*(c1 - c3) - r1*n1 + r3*n3]",
    ),
    ("5.38", "R0_t", "hat0*R0"),
];

#[test]
fn the_contact_geometry_of_chapter_5_holds_for_real_bodies() {
    let mut dice = Dice::new(5);
    let mut worst = 0.0f64;
    for k in 0..6 {
        let shape = if k % 2 == 0 { dice.ellipsoid() } else { dice.bumpy() };
        let motion = dice.solid_motion(&shape);
        let mut sheet = chapter_5(&motion.solid, &motion.observe()).open();
        for (label, left, right) in AT_EACH_CONTACT {
            for n in 1..=3 {
                sheet.holds(&format!("{label}, contact {n}"), &numbered(left, n), &numbered(right, n));
            }
        }
        for (label, left, right) in TOGETHER {
            sheet.holds(label, left, right);
        }
        // print: a curve's normal curvature is not its acceleration along the normal unless its speed is one
        sheet.fails("5.30 as printed", "kappa_n_1", "dot(b1_tt, n1)");
        // print: + d_j t_j1 + e_j t_j2 after - r_j n_j
        sheet.fails(
            "5.18 as printed",
            "c1 - c2",
            "R0*(r1*n1 + d1*t_11 + e1*t_12 - r2*n2 + d2*t_21 + e2*t_22)",
        );
        worst = worst.max(sheet.worst);
    }
    println!("greatest difference {worst:e}");
}

/// 5.31 to 5.36: the laws of motion as the thesis writes them, for bodies whose accelerations were found from
/// the momentum and the angular momentum of their particles.
#[test]
fn the_dynamics_of_chapter_5_hold_for_real_bodies() {
    let mut dice = Dice::new(53);
    let (mut worst, mut found) = (0.0f64, 0);
    for k in 0..400 {
        let shape = if k % 2 == found % 2 { dice.ellipsoid() } else { dice.bumpy() };
        let motion = dice.solid_motion(&shape);
        let inertia = SolidInertia {
            mass: dice.real(200, 3000),
            second_moments: [0; 3].map(|_| dice.real(50, 500)),
            palms: [0; 3].map(|_| dice.real(200, 800)),
            gravity: dice.real(-9810, -9810),
        };
        let SolidDynamics { tumbling, forces, torques } = solid_dynamics(&motion, &inertia);
        let on_palm = tumbling.contacts.iter().all(|contact| contact.sensed[0][1].is_positive());
        if !on_palm || !forces.iter().all(Real::is_positive) {
            continue;
        }
        let mut sheet = chapter_5(&motion.solid, &tumbling);
        sheet.number("m", &inertia.mass).number("g", &inertia.gravity);
        let [x, y, z] = &inertia.second_moments;
        for (name, moment) in ["Ix", "Iy", "Iz"].iter().zip([y + z, z + x, x + y]) {
            sheet.number(name, &moment);
        }
        for i in 0..3 {
            let n = i + 1;
            sheet
                .number(&format!("f{n}"), &forces[i])
                .number(&format!("tau{n}"), &torques[i])
                .number(&format!("I{n}"), &inertia.palms[i])
                .number(&format!("alpha{n}"), &motion.palms[i].acceleration);
        }
        sheet.define("let II = R0*[Ix, 0, 0; 0, Iy, 0; 0, 0, Iz]*transpose(R0)");
        let mut sheet = sheet.open();
        for n in 1..=3 {
            let label = |equation: &str| format!("{equation}, contact {n}");
            let mut holds = |equation: &str, left: &str, right: &str| {
                sheet.holds(&label(equation), &numbered(left, n), &numbered(right, n));
            };
            holds("5.31", "I#*alpha#", "tau# - f#*dot([0; 1; 0], s#)");
            holds("5.35", "cross(R0*b#, f#*nb#)", "-f#*R0*cross(b#, n#)");
        }
        sheet.holds("5.32", "m*cm_tt", "[0; 0; m*g] + f1*nb1 + f2*nb2 + f3*nb3");
        sheet.holds(
            "5.33",
            "II*alpha0 + cross(w0, II*w0)",
            "cross(R0*b1, f1*nb1) + cross(R0*b2, f2*nb2) + cross(R0*b3, f3*nb3)",
        );
        let part = |n| numbered("(tau# - I#*alpha#)/dot([0; 1; 0], s#)*R0*cross(b#, n#)", n);
        let right = format!("-inverse(II)*(cross(w0, II*w0) + {} + {} + {})", part(1), part(2), part(3));
        sheet.holds("5.36, 5.39", "alpha0", &right);
        worst = worst.max(sheet.worst);
        found += 1;
        if found == 6 {
            break;
        }
    }
    assert_eq!(found, 6);
    println!("greatest difference {worst:e}");
}
