//! Bounds and fits against bodies whose volumes are known by hand.

use super::*;
use nalgebra::{Vector2, Vector3};
use std::f64::consts::PI;

/// The touch of an ellipsoid with the semi-axes 2.5, 2, 1 where it has a normal.
fn ellipsoid(normal: Vector3<f64>) -> SurfaceTouch {
    let axes = Vector3::new(2.5, 2.0, 1.0);
    let scaled = normal.component_mul(&axes);
    SurfaceTouch { point: scaled.component_mul(&axes) / scaled.norm(), normal }
}

/// Normals on a spiral around the sphere, evenly spread.
fn spiral(count: usize) -> impl Iterator<Item = Vector3<f64>> {
    (0..count).map(move |i| {
        let z = 1.0 - (2 * i + 1) as f64 / count as f64;
        let (sine, cosine) = (2.399_963_229_728_653 * i as f64).sin_cos();
        let rho = (1.0 - z * z).sqrt();
        Vector3::new(rho * cosine, rho * sine, z).normalize()
    })
}

fn six() -> Vec<Vector3<f64>> {
    [Vector3::x(), Vector3::y(), Vector3::z()].into_iter().flat_map(|axis| [axis, -axis]).collect()
}

fn bounded(outer: OuterBound) -> BoundedRegion {
    match outer {
        OuterBound::Bounded(region) => region,
        OuterBound::Unbounded { direction } => panic!("unbounded along {direction}"),
    }
}

/// By hand: a cube that is far from the origin, so that of half of the planes `w` is negative; all its faces' corners are coplanar fours.
#[test]
fn a_cube_is_exact() {
    let away = Vector3::new(5.0, -7.0, 3.0);
    let faces: Vec<SurfaceTouch> =
        six().into_iter().map(|normal| SurfaceTouch { point: normal + away, normal }).collect();
    let outer = bounded(half_space_intersection(&faces).unwrap());
    assert!(outer.volume.contains(8.0) && outer.volume.width() < 1e-13, "{}", outer.volume);
    assert_eq!((outer.surface.corners.len(), outer.surface.polygons.len()), (8, 6));
    assert!(outer.surface.polygons.iter().all(|polygon| polygon.len() == 4));
    assert!((outer.surface.volume() - 8.0).abs() < 1e-12);

    // all points of a grid, most of them within faces, edges or the inside
    let mut grid = Vec::new();
    for i in 0..27 {
        let point = Vector3::new(f64::from(i % 3), f64::from(i / 3 % 3), f64::from(i / 9));
        grid.extend([SurfaceTouch { point, normal: Vector3::x() }; 2]);
    }
    let inner = contact_hull(&grid).unwrap();
    assert_eq!((inner.volume.low(), inner.volume.high()), (8.0, 8.0));
    assert!((inner.surface.volume() - 8.0).abs() < 1e-14);
}

/// Normals have to span all directions with positive factors: all `w > 0` is not enough.
#[test]
fn what_is_unbounded_is_told_with_its_direction() {
    let open = |normals: &[Vector3<f64>]| {
        let touches: Vec<SurfaceTouch> =
            normals.iter().map(|normal| SurfaceTouch { point: *normal, normal: *normal }).collect();
        match half_space_intersection(&touches).unwrap() {
            OuterBound::Unbounded { direction } => {
                assert!((direction.norm() - 1.0).abs() < 1e-14);
                for normal in normals {
                    assert!(normal.dot(&direction) < 1e-15, "{normal} {direction}");
                }
                direction
            }
            OuterBound::Bounded(region) => panic!("{region:?}"),
        }
    };
    let five: Vec<Vector3<f64>> = six().into_iter().filter(|normal| normal.z < 0.5).collect();
    assert!(open(&five).z > 0.999);
    assert!(open(&six()[..4]).z.abs() > 0.999);
    open(&six()[..2]);
    open(&six()[..1]);
    // many normals, all on one side
    let one_side: Vec<Vector3<f64>> = spiral(200).filter(|normal| normal.z < 0.1 * normal.x).collect();
    open(&one_side);
    // a ring and one below: bounded by nothing above
    let ring: Vec<Vector3<f64>> =
        (0..7).map(|i| Vector3::new(f64::from(i).cos(), f64::from(i).sin(), 0.0)).collect();
    assert!(open(&[&ring[..], &[-Vector3::z()]].concat()).z > 0.999);
}

/// The volume of an ellipsoid is known, and that of the outer region is that of the hull of its corners, which is found in another way.
#[test]
fn an_ellipsoid_lies_between_its_bounds() {
    let truth = 4.0 / 3.0 * PI * 5.0;
    let mut last = f64::INFINITY;
    for count in [24, 120, 400] {
        let touches: Vec<SurfaceTouch> = spiral(count).map(ellipsoid).collect();
        let inner = contact_hull(&touches).unwrap();
        let outer = bounded(half_space_intersection(&touches).unwrap());
        assert!(
            inner.volume.width() < 1e-14 && outer.volume.width() < 1e-11,
            "{} {}",
            inner.volume,
            outer.volume
        );
        assert!(inner.volume.high() < truth && truth < outer.volume.low());
        assert!((inner.surface.volume() - inner.volume.mid()).abs() < 1e-12);
        let corners: Vec<SurfaceTouch> = outer
            .surface
            .corners
            .iter()
            .map(|point| SurfaceTouch { point: *point, normal: Vector3::x() })
            .collect();
        let again = contact_hull(&corners).unwrap().volume.mid();
        assert!((again - outer.volume.mid()).abs() < 1e-10, "{again} {}", outer.volume);
        // the least and the greatest radius of curvature are c^2/a and a^2/c
        let round = rounded_hull(&touches, 0.4).unwrap().volume;
        assert!(inner.volume.high() < round.low() && round.low() < truth && round.width() < 1e-9, "{round}");
        let gap = outer.volume.high() - inner.volume.low();
        assert!(gap < last / 3.0);
        last = gap;
    }
}

/// The intersection of balls is smaller than that of half-spaces where the body bends, and the smaller the nearer their radius is to its own.
#[test]
fn balls_leave_less_than_half_spaces() {
    let truth = 4.0 / 3.0 * PI * 5.0;
    let touches: Vec<SurfaceTouch> = spiral(24).map(ellipsoid).collect();
    let flat = bounded(half_space_intersection(&touches).unwrap());
    let mut last = flat.volume.low();
    for radius in [20.0, 10.0, 6.25] {
        let round = ball_intersection(&touches, radius).unwrap();
        assert!(round.volume.low() <= round.surface.volume() + 1e-9);
        assert!(truth < round.volume.high() && round.volume.high() < last, "{} {last}", round.volume);
        assert!(round.volume.width() < 1.05e-3 * round.volume.low());
        last = round.volume.low();
    }
    // by hand: a lens of two balls
    let lens = [1.0, -1.0]
        .map(|side| SurfaceTouch { point: Vector3::z() * (0.5 * side), normal: Vector3::z() * side });
    let (r, d) = (2.0f64, 3.0f64);
    let volume = PI * (4.0 * r + d) * (2.0 * r - d).powi(2) / 12.0;
    let found = ball_intersection(&lens, r).unwrap().volume;
    assert!(found.contains(volume) && found.width() < 1.1e-3 * volume, "{found} {volume}");
}

/// A ball that a plane cuts: a cap by Archimedes, `pi h^2 (3 r - h)/3`; and a half-space alone is unbounded.
#[test]
fn a_ball_and_a_half_space_leave_a_cap() {
    let at = |z: f64, side: f64| SurfaceTouch { point: Vector3::z() * z, normal: Vector3::z() * side };
    let touches = [at(0.5, 1.0), at(-0.3, -1.0)];
    // the ball of 2 m whose top is at 0.5, above -0.3
    let found = balls_and_half_spaces(&touches, &[2.0, f64::INFINITY]).unwrap();
    let (r, h) = (2.0f64, 0.8f64);
    let volume = PI * h * h * (3.0 * r - h) / 3.0;
    assert!(found.volume.contains(volume) && found.volume.width() < 1.1e-3 * volume, "{}", found.volume);
    assert!(found.volume.low() <= found.surface.volume() + 1e-9);
    let same = balls_and_half_spaces(&touches, &[2.0, 2.0]).unwrap();
    assert_eq!(same, ball_intersection(&touches, 2.0).unwrap());
    for radii in [[f64::INFINITY; 2], [1.0, -1.0], [f64::NAN, 1.0]] {
        assert!(matches!(balls_and_half_spaces(&touches, &radii), Err(TouchError::Radius(_))));
    }
}

/// By Steiner's formula for a cube: `s^3 + 6 s^2 r + 3 pi s r^2 + 4/3 pi r^3`.
#[test]
fn a_rounded_cube_is_steiners() {
    let (s, r) = (2.0, 0.5);
    let touches: Vec<SurfaceTouch> = (0..8)
        .map(|i| {
            let corner = Vector3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)) * s;
            let normal = (corner - Vector3::repeat(s / 2.0)).normalize();
            SurfaceTouch { point: corner + normal * r, normal }
        })
        .collect();
    let volume = s.powi(3) + 6.0 * s * s * r + 3.0 * PI * s * r * r + 4.0 / 3.0 * PI * r.powi(3);
    let found = rounded_hull(&touches, r).unwrap().volume;
    assert!((found.mid() - volume).abs() < 1e-7 && found.low() <= volume, "{found} {volume}");
}

#[test]
fn contacts_that_bound_nothing_say_why() {
    let touch = |x: f64, y: f64, z: f64| {
        let point = Vector3::new(x, y, z);
        SurfaceTouch { point, normal: point.try_normalize(0.0).unwrap_or(Vector3::x()) }
    };
    assert_eq!(contact_hull(&[]), Err(TouchError::Nothing));
    assert_eq!(half_space_intersection(&[]), Err(TouchError::Nothing));
    let plane: Vec<SurfaceTouch> =
        (0..9).map(|i| touch(f64::from(i).sin(), f64::from(i).cos(), 0.25)).collect();
    assert_eq!(contact_hull(&plane), Err(TouchError::Flat));
    let broken = [touch(1.0, 0.0, 0.0), touch(f64::NAN, 0.0, 0.0)];
    assert_eq!(contact_hull(&broken), Err(TouchError::Value { index: 2 }));
    let long = SurfaceTouch { point: Vector3::x(), normal: Vector3::x() * 2.0 };
    assert_eq!(contact_hull(&[long]), Err(TouchError::Value { index: 1 }));
    assert_eq!(rounded_hull(&plane, -1.0), Err(TouchError::Radius(-1.0)));
    assert!(ball_intersection(&plane, f64::NAN).unwrap_err().to_string().contains("NaN"));
    // a normal that points inward
    let mut inward: Vec<SurfaceTouch> = spiral(30).map(ellipsoid).collect();
    inward[3].normal = -inward[3].normal;
    assert!(
        matches!(half_space_intersection(&inward), Err(TouchError::Inconsistent { index: 4, by }) if by > 0.5)
    );
}

/// An ellipse with the semi-axes 2 and 1 has the area 2 pi; a square has its own.
#[test]
fn bounds_in_the_plane() {
    let touch = |angle: f64| {
        let normal = Vector2::new(angle.cos(), angle.sin());
        let size = (4.0 * normal.x * normal.x + normal.y * normal.y).sqrt();
        PlanarTouch { point: Vector2::new(4.0 * normal.x, normal.y) / size, normal }
    };
    let touches: Vec<PlanarTouch> = (0..40).map(|i| touch(0.17 * f64::from(i))).collect();
    let inner = planar_hull(&touches).unwrap();
    let PlanarOuterBound::Bounded(outer) = half_plane_intersection(&touches).unwrap() else { panic!() };
    assert!(inner.area.high() < 2.0 * PI && 2.0 * PI < outer.area.low(), "{} {}", inner.area, outer.area);
    assert!(inner.area.low() > 6.2 && outer.area.high() < 6.35, "{} {}", inner.area, outer.area);
    // Gauss's shoelace over corners
    for region in [&inner, &outer] {
        let next = region.corners.iter().cycle().skip(1);
        let twice: f64 = region.corners.iter().zip(next).map(|(a, b)| a.x * b.y - a.y * b.x).sum();
        assert!((twice / 2.0 - region.area.mid()).abs() < 1e-12);
    }
    let three: Vec<PlanarTouch> = (0..3).map(|i| touch(0.5 * f64::from(i))).collect();
    let PlanarOuterBound::Unbounded { direction } = half_plane_intersection(&three).unwrap() else {
        panic!()
    };
    assert!(three.iter().all(|touch| touch.normal.dot(&direction) < 1e-15));
    assert_eq!(planar_hull(&three[..2]), Err(TouchError::Flat));
}

/// Harmonics by hand, their means over the sphere, and the derivatives of a support function by differences.
#[test]
fn harmonics_are_orthonormal_and_give_points() {
    let n = Vector3::new(0.48, -0.6, 0.64);
    let found = SphereSeries::basis(&n, 2);
    let (x, y, z) = (n.x, n.y, n.z);
    let by_hand = [
        1.0,
        3f64.sqrt() * z,
        3f64.sqrt() * x,
        3f64.sqrt() * y,
        5f64.sqrt() * (1.5 * z * z - 0.5),
        15f64.sqrt() * x * z,
        15f64.sqrt() * y * z,
        15f64.sqrt() / 2.0 * (x * x - y * y),
        15f64.sqrt() * x * y,
    ];
    assert!(found.iter().zip(by_hand).all(|(a, b)| (a - b).abs() < 1e-14), "{found:?}");
    // the mean over a fine spiral
    let mut sums = vec![0.0; 25];
    let count = 20_000;
    for n in spiral(count) {
        let basis = SphereSeries::basis(&n, 4);
        sums.iter_mut().zip(&basis).for_each(|(sum, value)| *sum += value * value / count as f64);
    }
    assert!(sums.iter().all(|sum| (sum - 1.0).abs() < 1e-3), "{sums:?}");

    let coefficients: Vec<f64> =
        (0..16).map(|i| if i == 0 { 1.0 } else { 0.02 * f64::from(i).sin() }).collect();
    let series = SphereSeries { coefficients, degree: 3 };
    for n in [n, Vector3::z(), -Vector3::x()] {
        let (point, bend) = series.point_and_bend(&n);
        assert!((point.dot(&n) - series.support(&n)).abs() < 1e-14);
        assert!((bend * n).norm() < 1e-13);
        for i in 0..3 {
            let along = |t: f64| {
                let v = n + Vector3::ith(i, t);
                v.norm() * series.support(&v.normalize())
            };
            assert!(((along(1e-5) - along(-1e-5)) / 2e-5 - point[i]).abs() < 1e-9);
        }
        assert!(series.least_radius(&n) > 0.3);
    }
}

/// A body of harmonics is recovered whole; of an ellipsoid what is beyond them is small; and the band holds the truth where nothing was touched.
#[test]
fn a_fit_finds_the_body() {
    let coefficients: Vec<f64> =
        (0..16).map(|i| if i == 0 { 1.0 } else { 0.02 * f64::from(i).cos() }).collect();
    let series = SphereSeries { coefficients, degree: 3 };
    let samples: Vec<SolidSample> = spiral(150)
        .map(|normal| SolidSample { normal, radius: series.support(&normal), weight: 1e20 })
        .collect();
    let found = fit_solid(&samples, None).unwrap();
    assert_eq!(found.support.degree, 3);
    let off = found.support.coefficients.iter().zip(&series.coefficients).map(|(a, b)| (a - b).abs());
    assert!(off.fold(0.0, f64::max) < 1e-12);

    let touches: Vec<SurfaceTouch> =
        spiral(300).map(ellipsoid).filter(|touch| touch.normal.z < 0.5).collect();
    let samples: Vec<SolidSample> = touches.iter().map(|touch| SolidSample::of(touch, 1e6)).collect();
    let found = fit_solid(&samples, None).unwrap();
    let inner = contact_hull(&touches).unwrap();
    let outer =
        bounded(half_space_intersection(&[&touches[..], &[ellipsoid(Vector3::z())]].concat()).unwrap());
    for n in spiral(100) {
        let truth = ellipsoid(n).point.dot(&n);
        let [low, high] = found.band(&n, &inner, Some(&outer));
        assert!(low <= truth && truth <= high, "{n} {low} {truth} {high}");
        if n.z < 0.3 {
            assert!(
                (found.support.support(&n) - truth).abs() < 2e-2,
                "{n} {}",
                found.support.support(&n) - truth
            );
        }
    }
    assert!(found.band(&Vector3::z(), &inner, None)[1].is_infinite());
    assert_eq!(fit_solid(&[], None), None);
}
