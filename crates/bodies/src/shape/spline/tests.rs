use super::*;
use crate::shape::SupportSeries;

const COEFFICIENTS: [f64; 11] = [1.2, 0.1, -0.5, 1.4, -0.9, -0.3, 0.2, -1.0, 0.2, -0.3, 0.1];

fn spline() -> SupportSpline {
    SupportSpline::of_coefficients(&COEFFICIENTS).unwrap()
}

/// The greatest projection of a fine polygon, and each derivative against differences of the one before, across all knots.
#[test]
fn the_support_is_the_greatest_projection_and_its_derivatives_are_its_own() {
    let spline = spline();
    assert_eq!(spline.coefficients(), COEFFICIENTS);
    assert!(spline.least_turning().0 > 0.0);
    for i in 0..200 {
        let angle = 0.0314 * f64::from(i) + 0.01;
        let [normal, _] = frame(angle);
        let points = spline.pieces.iter().flat_map(|cubic| {
            (0..2000).map(move |t| dot(derivatives(cubic, f64::from(t) / 2000.0)[0], normal))
        });
        let [reach, slope, second, _] = spline.support(angle);
        assert!((0.0..1e-6).contains(&(reach - points.fold(f64::MIN, f64::max) + 1e-15)), "{angle}");
        let [before, after] = [-1e-5, 1e-5].map(|by| spline.support(angle + by));
        assert!((slope - (after[0] - before[0]) / 2e-5).abs() < 1e-8);
        assert!((second - (after[1] - before[1]) / 2e-5).abs() < 1e-3);
    }
    // away from the knots the third is that of the second
    let smooth = (0..200).filter(|i| {
        let angle = 0.0314 * f64::from(*i) + 0.01;
        let [before, at, after] = [-1e-5, 0.0, 1e-5].map(|by| spline.support(angle + by));
        (at[3] - (after[2] - before[2]) / 2e-5).abs() < 1e-4 * (1.0 + at[3].abs())
    });
    assert!(smooth.count() > 190);
}

#[test]
fn the_basis_is_the_derivative_by_the_coefficients() {
    let spline = spline();
    for angle in [0.3, 1.9, 3.3, 4.4, 6.0] {
        for (place, basis) in spline.basis(angle).iter().enumerate() {
            let moved = |by: f64| {
                let mut moved = COEFFICIENTS;
                moved[place] += by;
                SupportSpline::of_coefficients(&moved).unwrap().support(angle)
            };
            let (up, down) = (moved(1e-6), moved(-1e-6));
            for times in 0..3 {
                let slope = (up[times] - down[times]) / 2e-6;
                assert!((slope - basis[times]).abs() < 1e-6 * (1.0 + slope.abs()), "{angle} {place} {times}");
            }
        }
    }
}

/// One more point changes nothing; perimeter and area are those of the Fourier polynomial through many of its radii, and so are their derivatives.
#[test]
fn a_point_more_changes_nothing_and_sizes_are_those_of_the_series() {
    let spline = spline();
    let more = spline.with_point_on(2).unwrap();
    assert_eq!(more.points().len(), 5);
    for i in 0..60 {
        let angle = 0.1 * f64::from(i);
        assert!((spline.support(angle)[0] - more.support(angle)[0]).abs() < 1e-14);
    }
    let series = |spline: &SupportSpline| {
        const N: usize = 4096;
        let radii: Vec<f64> = (0..N).map(|i| spline.support(TAU * i as f64 / N as f64)[0]).collect();
        let coefficient = |k: usize, wave: fn(f64) -> f64| {
            let at = |i: usize| TAU * i as f64 / N as f64;
            radii.iter().enumerate().map(|(i, r)| r * wave(k as f64 * at(i))).sum::<f64>() / N as f64
        };
        let harmonics = (1..200).map(|k| [2.0 * coefficient(k, f64::cos), 2.0 * coefficient(k, f64::sin)]);
        SupportSeries { mean: coefficient(0, f64::cos), harmonics: harmonics.collect() }
    };
    let own = series(&spline);
    assert!((own.perimeter() - spline.perimeter()).abs() < 1e-9);
    assert!((own.area() - spline.area()).abs() < 1e-7, "{} {}", own.area(), spline.area());
    for (place, [perimeter, area]) in
        (0..11).map(|place| (place, spline.integrated().map(|by| by[place]))).step_by(3)
    {
        let moved = |by: f64| {
            let mut moved = COEFFICIENTS;
            moved[place] += by;
            SupportSpline::of_coefficients(&moved).unwrap()
        };
        let (up, down) = (moved(1e-5), moved(-1e-5));
        assert!(((up.perimeter() - down.perimeter()) / 2e-5 - perimeter).abs() < 1e-5);
        assert!(((up.area() - down.area()) / 2e-5 - area).abs() < 1e-5);
    }
}

#[test]
fn what_is_no_spline_is_none() {
    for broken in [&[][..], &[1.0; 5], &[1.0; 7], &[f64::NAN; 8]] {
        assert!(SupportSpline::of_coefficients(broken).is_none());
    }
}
