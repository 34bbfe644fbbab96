use super::*;
use rand::{RngExt, SeedableRng};
#[test]
#[ignore]
fn search() {
    let forms = [
        ("harm", Form::Harmonics { mean: 1.2, harmonics: vec![[0.0, 0.0], [0.1, 0.0], [0.03, -0.04]] }),
        ("ell", Form::Ellipse { semi_axes: [1.4, 1.1] }),
        ("sup", Form::Superellipse { semi_axes: [1.2, 1.0], exponent: 4, rounding: 0.3 }),
        ("spl", Form::Spline { radii: [1.2, 1.6, 1.3], knots: Knots::Uniform }),
    ];
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
    let times: Vec<f64> = (1..=100).map(|i| 0.014 * i as f64).collect();
    for (name, form) in &forms {
        let shape = Shape::new(form, CentreOfMass::Uniform).unwrap();
        println!(
            "{name} area {} gyr {} centroid {:?} q {}",
            shape.area(),
            shape.gyration(),
            shape.centroid(),
            shape.quadrature_error()
        );
        for regime in ["same", "one", "fixed", "general", "rest", "restsame"] {
            let mut best: Vec<(f64, String)> = vec![];
            for _ in 0..1500 {
                let mut grid = |lo: i32, hi: i32| rng.random_range(lo..=hi) as f64 / 10.0;
                let phi1 = grid(4, 9);
                let phi2 = grid(14, 19);
                let phi0 = grid(0, 62);
                let mut rate = grid(-20, 20);
                let mut c = [
                    Course { start: phi1, ..Default::default() },
                    Course { start: phi2, ..Default::default() },
                ];
                match regime {
                    "same" => c[0].rate = grid(-5, 5),
                    "one" => c[1].rate = grid(-3, 3),
                    "fixed" => (),
                    _ => {
                        if regime != "general" {
                            rate = 0.0
                        }
                        c[0].rate = grid(-5, 5);
                        if regime != "restsame" {
                            c[1].rate = grid(-5, 5);
                            c[0].swings = vec![Oscillation {
                                amplitude: grid(1, 2),
                                frequency: grid(4, 10),
                                phase: grid(0, 62),
                            }];
                            c[1].swings = vec![Oscillation {
                                amplitude: grid(1, 2),
                                frequency: grid(4, 10),
                                phase: grid(0, 62),
                            }];
                        }
                    }
                }
                if regime == "same" && c[0].rate == 0.0 || regime == "one" && c[1].rate == 0.0 {
                    continue;
                }
                let scene = Scene {
                    shape: shape.clone(),
                    mass: 1.0,
                    gyration: shape.gyration(),
                    orientation: phi0,
                    rate,
                    gravity: -9.81,
                    palm_inertia: [0.5, 0.6],
                    palm_lengths: [f64::INFINITY; 2],
                    drive: Drive::Prescribed(c.clone()),
                    tolerance: 1e-9,
                };
                let Ok(t) = simulate(&scene, &times) else { continue };
                if t.ended != Ended::Completed {
                    continue;
                }
                let (mut f, mut gap, mut v, mut sm) = (f64::MAX, f64::MAX, true, f64::MAX);
                let (mut rlo, mut rhi) = (f64::MAX, 0.0f64);
                for m in &t.moments {
                    let [a, b] = &m.palms;
                    f = f.min(a.force).min(b.force);
                    sm = sm.min(a.s).min(b.s);
                    gap = gap.min((m.omega0 - a.rate).abs()).min((m.omega0 - a.rate - b.rate).abs());
                    v &=
                        a.angle > 0.2 && a.angle < 1.3 && a.angle + b.angle > 1.9 && a.angle + b.angle < 2.95;
                    rlo = rlo.min(a.r).min(b.r);
                    rhi = rhi.max(a.r).max(b.r);
                }
                if gap < 0.3 || !v || f < 0.8 {
                    continue;
                }
                let score = f.min(4.0) * gap.min(0.8) * (rhi - rlo);
                best.push((
                    score,
                    format!("{phi0} {rate} {c:?} f {f:.2} gap {gap:.2} s {sm:.2} r {rlo:.2}..{rhi:.2}"),
                ));
            }
            best.sort_by(|a, b| b.0.total_cmp(&a.0));
            println!("{name} {regime}: {}", best.len());
            for (s, t) in best.iter().take(3) {
                println!("   {s:.3} {t}")
            }
        }
    }
}
