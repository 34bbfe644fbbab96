//! The robot of section 6.2 on uneven ground: against another program, the thesis's equations 6.3 to 6.12, the constraint of `proofs/`, and the work of its motor.

use crate::mechanics::sheet::OpenSheet;
use dashu::rational::RBig;
use palmistry::System;
use palmistry::mechanics::terrain::*;
use palmistry::number::{rational_from_f64, rational_to_f64};
use std::collections::HashMap;
use std::f64::consts::TAU;
use std::path::Path;

const ROBOT: Robot = Robot { wheels: [[1.0, -1.0], [-1.0, -1.0]], mass: 2.0, gyration: 0.7, gravity: -9.81 };

fn ground() -> Ground {
    let wave = |amplitude, wavelength, phase| GroundWave { amplitude, wavelength, phase };
    Ground { waves: vec![wave(0.15, 4.8, 0.4), wave(0.06, 2.2, 1.1)] }
}

fn every(step: f64, count: usize) -> Vec<f64> {
    (0..count).map(|i| step * i as f64).collect()
}

/// By a program in Python that differentiates places by differences of the fourth order over 1 ms, from which it has seven digits of the forces: at 0 s, 2.5 s and 6 s the directions of
/// the forces against the robot, how fast they turn, the forces, the velocity in the robot's frame, the rate and the angle, and where wheels 1 and 2 are.
#[test]
fn a_drive_is_that_of_another_program() {
    let expected = [
        [
            0.16648933271249866,
            -0.2233521733777035,
            -0.6814950608802217,
            -0.46939639759332097,
            1.0967448913618707,
            8.181091190021741,
            10.68616219294672,
            0.7913114570983283,
            -0.02913992456902029,
            0.19486117797577288,
            0.08654626148967015,
            0.0,
            -1.99251441878214,
        ],
        [
            -0.13352523343030714,
            0.05200709059032216,
            -0.21903415815801902,
            -0.4156390861259803,
            -2.990516559667107,
            10.117754226004548,
            8.292264761501048,
            1.0834584931483746,
            -0.04076906671942232,
            -0.09235975029760664,
            -0.09108693276351554,
            2.4837155234629487,
            0.4920066179213924,
        ],
        [
            -0.050159468202846086,
            0.19528480060941228,
            0.2425236963905329,
            0.3791804454248241,
            4.0477037882261735,
            8.964004523152598,
            11.333379315011634,
            1.1225899707512856,
            0.0737092556002391,
            -0.12384769314407092,
            0.10706340432183481,
            5.919946607328735,
            3.9313982348422862,
        ],
    ];
    let drive = ROBOT.drive(&ground(), 1.0, 0.0, &[0.0, 2.5, 6.0]);
    assert_eq!(drive.end, RobotEnd::Completed);
    for (at, expected) in drive.moments.iter().zip(expected) {
        let (sine, cosine) = at.phi0.sin_cos();
        let [vx, vy] = at.velocity;
        let [f0, f1, f2] = at.forces;
        let found = [
            at.inclinations[0] - at.phi0,
            at.inclinations[1] - at.phi0,
            at.turning[0] - at.omega,
            at.turning[1] - at.omega,
            f0,
            f1,
            f2,
            cosine * vx + sine * vy,
            cosine * vy - sine * vx,
            at.omega,
            at.phi0,
            at.places[0][0],
            at.places[1][0],
        ];
        for (place, (found, expected)) in found.iter().zip(expected).enumerate() {
            assert!((found - expected).abs() < 2e-6, "{} s, {place}: {found} for {expected}", at.time);
        }
    }
}

/// How the tangent turns by arc length, in 1/m.
fn bend(ground: &Ground, x: f64) -> f64 {
    let (mut slope, mut bend) = (0.0, 0.0);
    for wave in &ground.waves {
        let number = TAU / wave.wavelength;
        slope += wave.amplitude * number * (number * x + wave.phase).cos();
        bend -= wave.amplitude * number * number * (number * x + wave.phase).sin();
    }
    bend / (1.0 + slope * slope).powf(1.5)
}

fn point(numbers: &[(&str, f64)]) -> HashMap<String, RBig> {
    numbers.iter().map(|(name, value)| ((*name).to_owned(), rational_from_f64(*value).unwrap())).collect()
}

/// What the thesis says of such a drive, as `chapter6_robot.proof` has it: from the place of wheel 1, three angles, the speed and two curvatures follow the
/// velocity, the rates and accelerations (6.6, 6.7, 6.9, 6.12), and with the forces Newton's and Euler's laws (6.3, 6.4); and the constraint of `robot.proof`.
#[test]
fn equations_6_3_to_6_12_hold_along_drives() {
    let ground = ground();
    let mut worst: f64 = 0.0;
    for (robot, speed) in [
        (ROBOT, 1.0),
        (Robot { wheels: [[-0.8, -1.1], [1.3, -0.7]], mass: 1.3, gyration: 0.9, gravity: -9.81 }, -0.8),
    ] {
        let drive = robot.drive(&ground, speed, 0.3, &every(0.77, 4));
        assert_eq!((drive.end, drive.moments.len()), (RobotEnd::Completed, 4));
        for at in &drive.moments {
            let [[l1, h1], [l2, h2]] = robot.wheels;
            let [f0, f1, f2] = at.forces;
            let rods = [("l1", l1), ("h1", h1), ("l2", l2), ("h2", h2), ("g", robot.gravity)];
            let thesis = [
                ("x", at.places[0][0]),
                ("y", at.places[0][1]),
                ("phi0", at.phi0),
                ("phi1", at.inclinations[0]),
                ("phi2", at.inclinations[1]),
                ("v1", speed),
                ("v1_rate", 0.0),
                ("bend1", bend(&ground, at.places[0][0])),
                ("bend2", bend(&ground, at.places[1][0])),
                ("m", robot.mass),
                ("rho", robot.gyration),
                ("f0", f0),
                ("f1", f1),
                ("f2", f2),
            ];
            let system = System::read(Path::new("proofs/moll2002/chapter6_robot.proof")).unwrap();
            let mut sheet = OpenSheet::new(system, &point(&[&rods[..], &thesis[..]].concat()));
            let mut compare = |text: &str, expected: &[f64]| {
                let found = sheet.value(text);
                assert_eq!(found.len(), expected.len(), "{text}");
                for (found, expected) in found.iter().zip(expected) {
                    let apart = (rational_to_f64(found) - expected).abs();
                    worst = worst.max(apart);
                    assert!(apart < 1e-11, "{text} at {} s: {apart:e}", at.time);
                }
            };
            compare("centre", &at.centre);
            compare("x2", &at.places[1]);
            compare("velocity", &at.velocity);
            compare("[omega, v2, alpha]", &[at.omega, at.speeds[1], at.alpha]);
            compare("a", &at.acceleration);
            compare("force - m*a", &[0.0; 2]);
            compare("torque - m*rho^2*alpha", &[0.0]);

            let (sine, cosine) = at.phi0.sin_cos();
            let [vx, vy] = at.velocity;
            let own = [
                ("ux", cosine * vx + sine * vy),
                ("uy", cosine * vy - sine * vx),
                ("omega", at.omega),
                ("phi0", at.phi0),
                ("beta1", at.inclinations[0] - at.phi0),
                ("beta2", at.inclinations[1] - at.phi0),
                ("rate1", at.turning[0] - at.omega),
                ("rate2", at.turning[1] - at.omega),
                ("one_over_m", 1.0 / robot.mass),
                ("rho2", robot.gyration.powi(2)),
                ("f0", f0),
                ("f1", f1),
                ("f2", f2),
            ];
            let system = System::read(Path::new("proofs/moll2002/constraint/robot.proof")).unwrap();
            let mut sheet = OpenSheet::new(system, &point(&[&rods[..], &own[..]].concat()));
            for found in sheet.value("[y1, y2, y1_1, y2_1]") {
                let left = rational_to_f64(&found).abs();
                worst = worst.max(left);
                assert!(left < 1e-11, "the constraint at {} s: {left:e}", at.time);
            }
        }
    }
    println!("worst {worst:e}");
}

/// Only motor and gravity do work: the energy grows by what the motor pulls along the ground, by Simpson's rule. Wheel 1 keeps its speed along the ground, and both wheels their distance.
#[test]
fn the_motor_does_all_the_work() {
    let drive = ROBOT.drive(&ground(), 1.0, 0.0, &every(0.01, 401));
    let energy = |at: &RobotMoment| {
        let square = at.velocity[0].powi(2) + at.velocity[1].powi(2) + (0.7 * at.omega).powi(2);
        2.0 * (0.5 * square + 9.81 * at.centre[1])
    };
    let moments = &drive.moments;
    let work: f64 = moments
        .windows(3)
        .step_by(2)
        .map(|three| 0.01 / 3.0 * (three[0].forces[0] + 4.0 * three[1].forces[0] + three[2].forces[0]))
        .sum();
    let gained = energy(&moments[400]) - energy(&moments[0]);
    assert!(gained.abs() > 0.1 && (gained - work).abs() < 1e-6, "{gained} by {work}");
    for at in moments {
        let [[x1, y1], [x2, y2]] = at.places;
        assert!(((x2 - x1).hypot(y2 - y1) - 2.0).abs() < 1e-12);
        assert!((ground().at(x1).0 - y1).abs() < 1e-14 && (ground().at(x2).0 - y2).abs() < 1e-14);
    }
    // the length of the way by many small chords
    let chords: f64 = (0..400_000)
        .map(|i| {
            let x = |i: i32| moments[400].places[0][0] * f64::from(i) / 400_000.0;
            (x(i + 1) - x(i)).hypot(ground().at(x(i + 1)).0 - ground().at(x(i)).0)
        })
        .sum();
    assert!((chords - 4.0).abs() < 1e-9, "{chords}");
}

/// On a crest a body without attraction flies: with the ground's bend b, gravity cannot hold it where b v^2 exceeds it. Two wheels that are ten times closer than the wave
/// is long go like one. And a wheel that would have to reach over the end of the other's flank finds no ground.
#[test]
fn a_drive_ends_where_wheels_would_be_pulled() {
    let ground = Ground { waves: vec![GroundWave { amplitude: 0.2, wavelength: 10.0, phase: 0.0 }] };
    let robot = Robot { wheels: [[0.2, -0.05], [-0.2, -0.05]], mass: 1.0, gyration: 0.1, gravity: -9.81 };
    // at the crest b = 0.2 (2 pi/10)^2
    let critical = (9.81 / (0.2 * (TAU / 10.0_f64).powi(2))).sqrt();
    let whole = |part: f64| robot.drive(&ground, part * critical, 0.0, &every(0.002 / critical, 5000));
    assert_eq!(whole(0.9).end, RobotEnd::Completed);
    let RobotEnd::Lifts { time, .. } = whole(1.1).end else { panic!("it flies") };
    let x = whole(1.1).moments.last().unwrap().places[0][0];
    assert!(time > 0.0 && (1.0..3.0).contains(&x), "{x}");
}
