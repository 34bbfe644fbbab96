//! What entries of the thesis say about sentences, by other means: poses are counted, forces are solved for. And how the errata
//! show such entries, and statements that are undecided.

use palmistry::paper::Paper;
use palmistry::report::errata_markdown;
use palmistry::{System, decide_all};
use std::f64::consts::PI;
use std::path::Path;

/// How many stable poses a body has between two palms: the minima of the height of its centre of mass over a whole turn.
fn stable_poses(support: impl Fn(f64) -> f64, phi1: f64, phi2: f64) -> usize {
    let height = |phi0: f64| {
        let normal = phi1 - phi0 - PI / 2.0;
        let (a, b) = ((phi1 + phi2).sin(), phi1.sin());
        (a * support(normal) + b * support(normal + phi2 - PI)) / phi2.sin()
    };
    let heights: Vec<f64> = (0..720).map(|i| height(f64::from(i) * PI / 360.0 + 1e-4)).collect();
    let is_lower = |i: usize, j: usize| heights[i] < heights[j % 720];
    (0..720).filter(|i| is_lower(*i, i + 719) && is_lower(*i, i + 1)).count()
}

/// 3.text.two_poses: never two, but four for the body that a quarter of a turn leaves as it is, and one for the disc with its mass
/// off its middle.
#[test]
fn poses_do_not_come_in_twos() {
    let mut palms = 0;
    for i in 1..20 {
        for j in 1..20 {
            let (phi1, phi2) = (f64::from(i) * 0.15, f64::from(j) * 0.15);
            if phi1 + phi2 > PI - 0.1 {
                continue;
            }
            palms += 1;
            assert_eq!(stable_poses(|a| 1.0 + 0.05 * (4.0 * a).cos(), phi1, phi2), 4, "{phi1} {phi2}");
            assert_eq!(stable_poses(|a| 1.0 - 0.3 * a.sin(), phi1, phi2), 1, "{phi1} {phi2}");
        }
    }
    assert!(palms > 150, "{palms}");
}

/// 3.text.friction: forces that carry the weight of a unit disc, solved for by Cramer's rule, with any friction up to the
/// coefficient at either contact. The greatest moment about the middle is that of the claim, and it is least at a wide angle.
#[test]
fn friction_moves_the_mass_least_at_a_wide_angle() {
    let mu: f64 = 0.05;
    let greatest = |steep: f64| {
        let (s, c) = steep.sin_cos();
        let mut greatest: f64 = 0.0;
        for i in -20..=20 {
            for j in -20..=20 {
                let (lean1, lean2) = (mu * f64::from(i) / 20.0, mu * f64::from(j) / 20.0);
                let (across, up) = ([-s + lean1 * c, s + lean2 * c], [c + lean1 * s, c - lean2 * s]);
                let determinant = across[0] * up[1] - across[1] * up[0];
                let push = [-across[1] / determinant, across[0] / determinant];
                assert!((push[0] * up[0] + push[1] * up[1] - 1.0).abs() < 1e-12);
                if push[0] > 0.0 && push[1] > 0.0 {
                    greatest = greatest.max((lean1 * push[0] + lean2 * push[1]).abs());
                }
            }
        }
        greatest
    };
    let angles: [f64; 4] = [0.05, 0.5, 1.0, 1.4];
    for steep in angles {
        let claimed = mu / ((1.0 + mu * mu) * steep.cos());
        assert!((greatest(steep) - claimed).abs() < 1e-12, "{steep}");
    }
    assert!(angles.windows(2).all(|pair| greatest(pair[0]) < greatest(pair[1])));
}

/// Words with which entries about sentences begin are counted and set off, damage says that no conclusion changes, and what is
/// undecided stands in the errata with its reason.
#[test]
fn errata_are_all_that_was_found() {
    let text = "system \"s\" state x \
        erratum 1 at \"page 1\": printed \"x is y\" as x = 2*x corrected x = x*1 \"False as stated, true where x is 0.\" conclusion \"none\" \
        loose 2 at \"page 2\": printed \"x is small\" meant 2*x = x + x \"Overstated: it may be large.\" conclusion \"none changes\" \
        loose 3: printed \"x grows\" meant 2*x = x + x \"As said before.\" \
        damaged 4: reads x = 3*x repaired x = x*1 undecided 5: \"Whether x is large was not looked at.\"";
    let system = System::parse("test.proof", text, Path::new("")).unwrap();
    let outcomes = decide_all(&system, 1, &false.into(), &|_| ());
    let report = errata_markdown(&Paper::default(), &outcomes);
    for part in [
        "- *Overstated* (1): ",
        "- *False as stated* (1): ",
        "\n*False as stated*, true where x is 0.\n",
        "\n*Overstated*: it may be large.\n\nConclusion: none changes\n",
        "\nAs said before.\n",
        "No conclusion of the paper changes, unless an entry says so",
        "# Undecided\n",
        "## 5\n\nWhether x is large was not looked at.\n",
    ] {
        assert!(report.contains(part), "{part}: {report}");
    }
    let none = errata_markdown(&Paper::default(), []);
    assert!(!none.contains("Overstated") && !none.contains("# Undecided"), "{none}");
}
