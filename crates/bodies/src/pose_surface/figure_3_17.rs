//! The thesis's own way to many stable poses with the same measurements (figure 3.17), beside bodies that have them by their symmetry (`stable.rs`): poses that are turned and
//! lifted by different heights.

use super::body::PoseBody;
use super::potential::{PalmPair, measurements, potential};
use super::stable::stable_poses;
use nalgebra::{DMatrix, DVector, Matrix4, Vector4};
use std::f64::consts::TAU;

const POSES: usize = 3;
const ORDER: usize = 8;

/// The harmonics of a body that is nearly `1 + e cos 3 a`: at each of its three stable poses the radii and slopes at both contacts are those of the same measurements in equilibrium, the
/// centre of mass lifted. Twelve linear equations for the coefficients, solved by the smallest harmonics.
fn lifted(e: f64, palms: PalmPair, phi0: f64, lifts: [f64; POSES]) -> Vec<[f64; 2]> {
    let columns: Vec<(usize, bool)> = (0..=ORDER).flat_map(|k| [(k, false), (k, true)]).collect();
    let basis = |(k, is_sine): (usize, bool), angle: f64| -> [f64; 2] {
        let (sine, cosine) = (k as f64 * angle).sin_cos();
        if is_sine { [sine, k as f64 * cosine] } else { [cosine, -(k as f64) * sine] }
    };
    let symmetric = |angle: f64| [1.0 + e * (3.0 * angle).cos(), -3.0 * e * (3.0 * angle).sin()];
    let (sine, cosine) = palms.phi2.sin_cos();
    let (a, b) = ((palms.phi1 + palms.phi2).sin(), palms.phi1.sin());
    let [first, second] = palms.normals(phi0).map(symmetric);
    let height = (a * first[0] + b * second[0]) / sine;
    // both measurements, the balance and the height by the radii and slopes at the contacts
    let by_contacts = Matrix4::from_row_slice(&[
        cosine / sine,
        1.0 / sine,
        1.0,
        0.0, //
        1.0 / sine,
        cosine / sine,
        0.0,
        -1.0, //
        0.0,
        0.0,
        a,
        b, //
        a / sine,
        b / sine,
        0.0,
        0.0,
    ]);
    let same = by_contacts * Vector4::new(first[0], second[0], first[1], second[1]);
    let mut matrix = DMatrix::zeros(4 * POSES, columns.len());
    let mut side = DVector::zeros(4 * POSES);
    let weight = |k: usize| 1.0 / (k * k).max(1) as f64;
    for (place, lift) in lifts.into_iter().enumerate() {
        let wanted = Vector4::new(same[0], same[1], 0.0, height + lift);
        let contact = by_contacts.lu().solve(&wanted).unwrap();
        let normals = palms.normals(phi0 + TAU * place as f64 / POSES as f64);
        for (row, (angle, by)) in [(0, 0), (1, 0), (0, 1), (1, 1)].into_iter().enumerate() {
            side[4 * place + row] = contact[row] - symmetric(normals[angle])[by];
            for (column, one) in columns.iter().enumerate() {
                matrix[(4 * place + row, column)] = weight(one.0) * basis(*one, normals[angle])[by];
            }
        }
    }
    let found = matrix.try_svd(true, true, f64::EPSILON, 1000).unwrap().solve(&side, 1e-12).unwrap();
    let mut harmonics = vec![[0.0; 2]; ORDER + 1];
    for (value, (k, is_sine)) in found.iter().zip(columns) {
        harmonics[k][usize::from(is_sine)] += weight(k) * value;
    }
    harmonics[0][0] += 1.0;
    harmonics[3][0] += e;
    harmonics
}

#[test]
fn poses_that_are_lifted_have_the_same_measurements() {
    let palms = PalmPair::new(0.6, 1.6);
    let e = 0.6 / 8.0;
    let symmetric = PoseBody::parse(&format!("harmonics:1,0,0,{e},0"), None).unwrap();
    let first = stable_poses(&symmetric, palms)[0];
    let lifts = [0.0, 0.015, -0.015];
    let harmonics = lifted(e, palms, first.phi0, lifts);
    let list: Vec<String> = harmonics[2..].iter().flatten().map(f64::to_string).collect();
    // the first harmonic about the centre of mass is where it lies, the other way round
    let text = format!("harmonics:{},{}", harmonics[0][0], list.join(","));
    let body = PoseBody::parse(&text, Some([-harmonics[1][0], -harmonics[1][1]])).unwrap();
    let found = stable_poses(&body, palms);
    let expected = measurements(&symmetric, palms, first.phi0);
    for (place, lift) in lifts.into_iter().enumerate() {
        let phi0 = first.phi0 + TAU * place as f64 / POSES as f64;
        let off = |at: f64| (at - phi0).rem_euclid(TAU).min((phi0 - at).rem_euclid(TAU));
        let pose = found.iter().min_by(|a, b| off(a.phi0).total_cmp(&off(b.phi0))).unwrap();
        assert!(off(pose.phi0) < 1e-9 && pose.stiffness > 0.0, "{pose:?}");
        let read = measurements(&body, palms, phi0);
        assert!((read[0] - expected[0]).abs() + (read[1] - expected[1]).abs() < 1e-12, "{read:?}");
        assert!((potential(&body, palms, phi0)[0] - first.height - lift).abs() < 1e-12);
    }
}
