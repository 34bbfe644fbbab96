//! Three palms with masses, and gravity that is not vertical: the observers need nothing but the system. The motion is that of geometry: three palms hold a body whose support function is told in
//! one pose alone, and Newton's and Euler's laws then say what they push with.

use nalgebra::{Matrix3, Vector2, Vector3};
use palmistry::System;
use palmistry::observer::*;
use std::path::Path;
use std::sync::atomic::AtomicBool;

static NEVER: AtomicBool = AtomicBool::new(false);

/// How the body is turned at time zero, and how far its contacts are from the hinges; that of palm 1 is the origin.
const TURN: f64 = 1.8;
const FROM_HINGES: [f64; 3] = [1.4, 1.5, 1.3];
const STARTS: [f64; 3] = [0.1, 2.2, 4.3];
const SWINGS: [[f64; 2]; 3] = [[0.020, 2.0], [0.016, 3.1], [0.012, 2.6]];
const MASS: f64 = 1.3;
const RHO2: f64 = 0.16;
const GRAVITY: [f64; 2] = [2.0, -9.0];
/// Inertia, mass and arm of each palm.
const PALMS: [[f64; 3]; 3] = [[0.5, 0.4, 0.9], [0.6, 0.3, 1.1], [0.4, 0.5, 0.8]];

fn palm(i: usize, t: f64) -> [f64; 3] {
    let ([a, w], start) = (SWINGS[i], STARTS[i]);
    [start + a * (w * t).sin(), a * w * (w * t).cos(), -a * w * w * (w * t).sin()]
}

fn along(angle: f64) -> Vector2<f64> {
    Vector2::new(angle.cos(), angle.sin())
}

fn cross(a: Vector2<f64>, b: Vector2<f64>) -> f64 {
    a.x * b.y - a.y * b.x
}

/// The support function about the centre of mass and its derivative.
fn support(angle: f64) -> (f64, f64) {
    let (s2, c2) = (2.0 * angle).sin_cos();
    let (s3, c3) = (3.0 * angle).sin_cos();
    (0.72 + 0.12 * c2 + 0.03 * s3 + 0.02 * c3, -0.24 * s2 + 0.09 * c3 - 0.06 * s3)
}

/// The normal of palm `i` towards the body, and what the body has there in its own frame: the support radius and its derivative.
fn facing(i: usize, t: f64, turn: f64) -> (Vector2<f64>, f64, f64) {
    let angle = palm(i, t)[0];
    let n = Vector2::new(-angle.sin(), angle.cos());
    let outward = angle - std::f64::consts::FRAC_PI_2;
    let (r, slope) = support(outward - turn);
    (n, r, slope)
}

/// Where the body has its contact with palm `i`, from the centre of mass.
fn arm(i: usize, t: f64, turn: f64) -> Vector2<f64> {
    let (n, r, slope) = facing(i, t, turn);
    // from the outward normal, a quarter of a turn on
    Vector2::new(n.y, -n.x) * slope - n * r
}

/// The pose `(x, y, phi)` at time zero, and where the hinges are then.
fn start() -> (Vector3<f64>, [Vector2<f64>; 3]) {
    let from_centre = [0, 1, 2].map(|i| arm(i, 0.0, TURN) - along(STARTS[i]) * FROM_HINGES[i]);
    let centre = -from_centre[0];
    (Vector3::new(centre.x, centre.y, TURN), from_centre.map(|hinge| centre + hinge))
}

/// The pose in which all three palms touch, by Newton's method.
fn pose(t: f64) -> Vector3<f64> {
    let (mut at, hinges) = start();
    for _ in 0..60 {
        let facing = [0, 1, 2].map(|i| facing(i, t, at.z));
        let gap = |i: usize| facing[i].0.dot(&(at.xy() - hinges[i])) - facing[i].1;
        let slopes = Matrix3::from_fn(|i, k| if k < 2 { facing[i].0[k] } else { facing[i].2 });
        at -= slopes.try_inverse().unwrap() * Vector3::from_fn(|i, _| gap(i));
    }
    at
}

/// The columns of a recording: `s`, `omega` and `tau` of each palm, with its angle; and the true unknowns at its start.
fn recording(times: &[f64]) -> (Signals, Vec<(&'static str, f64)>) {
    let mut columns: Vec<(String, Vec<f64>)> = ["phi{}", "omega{}", "omega{}'", "s{}", "tau{}"]
        .iter()
        .flat_map(|what| ["1", "2", "3"].map(|i| (what.replace("{}", i), Vec::new())))
        .collect();
    let mut truth = Vec::new();
    let hinges = start().1;
    for t in times {
        let h = 1e-3;
        let [a, b, c, d, e] = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|k| pose(t + k * h));
        let velocity = (a - b * 8.0 + d * 8.0 - e) / (12.0 * h);
        let acceleration = (-a + b * 16.0 - c * 30.0 + d * 16.0 - e) / (12.0 * h * h);
        let gravity = Vector2::from(GRAVITY);
        let contacts = [0, 1, 2].map(|i| c.xy() + arm(i, *t, c.z));
        let normals = [0, 1, 2].map(|i| facing(i, *t, c.z).0);
        let arms = [0, 1, 2].map(|i| cross(contacts[i] - c.xy(), normals[i]));
        let pushes = Matrix3::from_fn(|k, i| if k < 2 { normals[i][k] } else { arms[i] });
        let wanted = (acceleration.xy() - gravity) * MASS;
        let forces =
            pushes.try_inverse().unwrap() * Vector3::new(wanted.x, wanted.y, MASS * RHO2 * acceleration.z);
        for i in 0..3 {
            let [angle, rate, rate_of_rate] = palm(i, *t);
            let [inertia, mass, arm] = PALMS[i];
            let from_hinge = contacts[i] - hinges[i];
            let tangent = along(angle);
            assert!(from_hinge.dot(&normals[i]).abs() < 1e-9, "the contact is on the palm");
            let s = from_hinge.dot(&tangent);
            // about the hinge: the motor, the palm's weight and the body's push back turn the palm
            let tau = inertia * rate_of_rate + cross(from_hinge, normals[i] * forces[i])
                - cross(tangent * arm, gravity * mass);
            for (what, value) in [angle, rate, rate_of_rate, s, tau].into_iter().enumerate() {
                columns[3 * what + i].1.push(value);
            }
        }
        if truth.is_empty() {
            let names = ["x", "y", "vx", "vy", "omega0", "one_over_m", "rho2", "gx", "gy"];
            let values =
                [c.x, c.y, velocity.x, velocity.y, velocity.z, 1.0 / MASS, RHO2, GRAVITY[0], GRAVITY[1]];
            truth = names.into_iter().zip(values).collect();
        }
    }
    (Signals::new(times.to_vec(), columns).unwrap(), truth)
}

fn known() -> Vec<(String, f64)> {
    let mut known: Vec<(String, f64)> = vec![("third".to_owned(), 1.0)];
    for (i, [inertia, mass, arm]) in PALMS.into_iter().enumerate() {
        let named = [("I", inertia), ("mass", mass), ("arm", arm)];
        known.extend(named.map(|(name, value)| (format!("{name}{}", i + 1), value)));
    }
    for (i, hinge) in start().1.iter().enumerate().skip(1) {
        known.extend(
            [("x", hinge[0]), ("y", hinge[1])].map(|(axis, value)| (format!("hinge{}{axis}", i + 1), value)),
        );
    }
    known
}

/// From a guess 5 % off all nine unknowns come back: state, 1/m, radius of gyration, and which way gravity pulls.
#[test]
fn three_heavy_palms_tell_state_mass_and_gravity() {
    let times: Vec<f64> = (0..161).map(|i| 0.01 * f64::from(i)).collect();
    let (signals, truth) = recording(&times);
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("proofs/moll2002/constraint/regimes.proof");
    let system = System::read(&file).unwrap();
    let off = |place: usize| if place.is_multiple_of(2) { 1.05 } else { 0.95 };
    let guess = truth
        .iter()
        .enumerate()
        .map(|(place, (name, value))| ((*name).to_owned(), off(place) * value))
        .collect();
    let question =
        EstimateQuestion { guess, known: known().into_iter().collect(), ..EstimateQuestion::default() };
    let task = Task::new(&system, &question, &signals, &NEVER).unwrap();
    let update = &MovingWindow { steps: 60, ..MovingWindow::new(160) }.observe(&task).updates[0];
    assert_eq!(update.end, UpdateEnd::Converged, "{update:?}");
    for (found, (name, value)) in update.estimate.iter().zip(&truth) {
        assert!((found - value).abs() < 1e-5 * value.abs().max(1.0), "{name}: {found} for {value}");
    }
}
