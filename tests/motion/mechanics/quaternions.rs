//! Rotations as unit quaternions: section 5.4.

use crate::mechanics::drawn::Dice;
use crate::mechanics::sheet::{Sheet, check_error};
use palmistry::mechanics::linear::{Square, axial};
use palmistry::mechanics::*;

/// The unit quaternion of a rotation, from the angle and the axis: the trace is `1 + 2 cos`, the
/// antisymmetric part the sine times the axis. Not for half turns.
fn quaternion(turn: &Square<3>) -> [Real; 4] {
    let trace = &turn[0][0] + &turn[1][1] + &turn[2][2];
    let half_cosine = (Real::one() + trace).sqrt() / Real::whole(2);
    let [x, y, z] = axial(turn).map(|x| x / (Real::whole(2) * &half_cosine));
    [half_cosine, x, y, z]
}

#[test]
fn the_quaternions_of_section_5_4_turn_as_real_bodies_do() {
    let mut dice = Dice::new(54);
    let (mut worst, mut found) = (0.0f64, 0);
    for _ in 0..40 {
        let shape = dice.ellipsoid();
        let motion = dice.solid_motion(&shape);
        let rates = differentiate(|time| quaternion(&motion.frames(time).0).to_vec(), &Real::zero());
        if rates.all[0].value < Real::power_of_two(-3) {
            continue; // near a half turn
        }
        check_error(&rates.error);
        let tumbling = motion.observe();
        let mut sheet = Sheet::default();
        for (suffix, vector) in ["", "_t", "_tt"].iter().zip(rates.vector::<4>(0)) {
            for (k, component) in vector.iter().enumerate() {
                sheet.number(&format!("q{k}{suffix}"), component);
            }
            // the left factor of a product, 5.40, and the vector that it multiplies
            let [a, b, c, d] = [0, 1, 2, 3].map(|k| format!("q{k}{suffix}"));
            sheet.define(&format!(
                "let q{suffix} = [{a}; {b}; {c}; {d}]\nlet star{suffix} = [{a}; -{b}; -{c}; -{d}]
                 let Q{suffix} = [{a}, -{b}, -{c}, -{d}; {b}, {a}, -{d}, {c}; {c}, {d}, {a}, -{b}; {d}, -{c}, {b}, {a}]"
            ));
        }
        sheet.matrix("R0", &tumbling.turn[0]);
        sheet
            .vector("w", &angular_velocity(&tumbling.turn))
            .vector("alpha", &angular_acceleration(&tumbling.turn));
        // left products with e_x, e_y, e_z as quaternions, applied to q*
        sheet.define(
            "let ex = [0, -1, 0, 0; 1, 0, 0, 0; 0, 0, 0, -1; 0, 0, 1, 0]
             let ey = [0, 0, -1, 0; 0, 0, 0, 1; 1, 0, 0, 0; 0, -1, 0, 0]
             let ez = [0, 0, 0, -1; 0, 0, -1, 0; 0, 1, 0, 0; 1, 0, 0, 0]
             let w_dot = w_at_00*ex + w_at_10*ey + w_at_20*ez
             let half = sqrt(q1^2 + q2^2 + q3^2)\nlet u = [q1; q2; q3]/half
             let cosine = q0^2 - half^2\nlet sine = 2*q0*half
             let hat = [cross(u, [1; 0; 0]), cross(u, [0; 1; 0]), cross(u, [0; 0; 1])]
             let one = [1, 0, 0; 0, 1, 0; 0, 0, 1]
             let slow = -dot(q_t, q_t)
             let step = slow*[1, 0, 0, 0; 0, 1, 0, 0; 0, 0, 1, 0; 0, 0, 0, 1]
                      + (alpha_at_00*ex + alpha_at_10*ey + alpha_at_20*ez)/2",
        );
        let mut sheet = sheet.open();
        for (label, left, right) in [
            ("unit norm", "Q*star", "[1; 0; 0; 0]"),
            ("below 5.41, q v q*", "[Q*ex*star, Q*ey*star, Q*ez*star]", "[0, 0, 0; R0]"),
            ("below 5.41, R", "R0", "cosine*one + (1 - cosine)*u*transpose(u) + sine*hat"),
            ("omega_0 = 2 q' q*", "[0; w]", "2*Q_t*star"),
            ("q' = omega_0 q/2", "q_t", "w_dot*q/2"),
            ("alpha_0 = 2 (q'' q* + q' q'*)", "[0; alpha]", "2*(Q_tt*star + Q_t*star_t)"),
            ("q'' = (-|q'|^2, alpha_0/2) q", "q_tt", "step*q"),
            ("q0 q0' + q . q' = 0", "dot(q, q_t)", "0"),
        ] {
            sheet.holds(label, left, right);
        }
        worst = worst.max(sheet.worst);
        found += 1;
        if found == 6 {
            break;
        }
    }
    assert_eq!(found, 6);
    println!("greatest difference {worst:e}");
}
