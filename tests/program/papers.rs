//! The short papers beside the thesis: a robot that measures ranges to beacons, a motor without a position sensor, and what a
//! rank does not say. Each is verified as a user does it, and beside it stands what is known of it by hand, by finite
//! differences, or by driving a robot about.

use crate::common::{folder, json, palmistry, with_threads};
use serde_json::Value;

/// A named set of a file, the rank there of all words and of the file's own rows; nothing for a pole.
type Expected = (&'static str, &'static str, Option<(usize, usize)>);

/// By hand. What two beacons tell on a straight course at speed v is x, x^2 + y^2, v c, v y s and v^2 (c, s for the cosine and
/// sine of the heading), so that the differentials to count are dx, y dy, d(vc), d(vys) and v dv; for one beacon they are
/// those of q = (x^2 + y^2)/2, of v(xc + ys) and of v^2. A robot that turns has in addition, without v, the numbers c, s, ys and yc.
const ROBOT: [Expected; 29] = [
    // along^2 + left^2 = 2q: two of the three words are independent, at every state
    ("one_beacon.proof", "the whole sample box", Some((2, 2))),
    // q and along have parallel differentials where the robot heads for the beacon
    ("one_beacon.proof", "heading for the beacon, or away from it", Some((2, 1))),
    ("one_beacon.proof", "the beacon abeam", Some((2, 2))),
    // d(along) = [c, s, 0] and d(left) = [-s, c, 0] there, and dq = 0
    ("one_beacon.proof", "at the beacon", Some((2, 1))),
    // beta, sin(beta)/r, cos(beta)/r
    ("polar.proof", "the whole sample box", Some((2, 2))),
    ("polar.proof", "heading for the beacon, or away from it", Some((2, 1))),
    ("polar.proof", "the beacon abeam", Some((2, 2))),
    ("polar.proof", "at the beacon", None),
    // x, c, s, ys, yc are the pose; own rows: -b s (yc - xs)
    ("two_beacons.proof", "the whole sample box", Some((3, 3))),
    ("two_beacons.proof", "on the line of the beacons", Some((3, 3))),
    // own rows there: [x, 0, 0], [c, 0, 0], [c, 0, 0]
    ("two_beacons.proof", "on the line and along it", Some((3, 1))),
    ("two_beacons.proof", "parallel to the line", Some((3, 2))),
    ("two_beacons.proof", "heading for beacon 1, or away from it", Some((3, 2))),
    // own rows: dq1 = 0 at beacon 1; at beacon 2 their determinant is (bs)^2
    ("two_beacons.proof", "at beacon 1", Some((3, 2))),
    ("two_beacons.proof", "at beacon 2", Some((3, 3))),
    ("two_beacons.proof", "the beacons coincide", Some((2, 2))),
    // own rows: -b^2 v y^2; by hand y dy, v y c dtheta + v s dy, -v s dtheta
    ("straight.proof", "the whole sample box", Some((4, 4))),
    // v dv has to be among them
    ("straight.proof", "on the line of the beacons", Some((4, 3))),
    ("straight.proof", "parallel to the line", Some((4, 4))),
    // dx and dv
    ("straight.proof", "on the line and along it", Some((2, 2))),
    // dx, y dy, and c dv or y s dv
    ("straight.proof", "standing", Some((3, 3))),
    ("straight.proof", "standing on the line of the beacons", Some((2, 2))),
    // q, v(xc + ys) and v^2; own rows have the first two, each twice
    ("straight.proof", "the beacons coincide", Some((3, 2))),
    // xc + ys is the range there up to its sign, and constant along theta
    ("straight.proof", "the beacons coincide straight ahead", Some((2, 2))),
    // x and v; own rows: x^2
    ("track.proof", "the whole sample box", Some((2, 2))),
    ("track.proof", "abeam of beacon 1", Some((2, 1))),
    ("track.proof", "standing", Some((2, 2))),
    // x dx, d(xv), v dv
    ("track.proof", "the beacons coincide", Some((2, 2))),
    ("track.proof", "one beacon abeam of a vehicle that stands", Some((0, 0))),
];

/// By hand: d(cos x) = -sin(x) dx and d(sin x) = cos(x) dx, of which the own rows have the first; d(x^3) = 3x^2 dx.
const BY_DEFINITION: [Expected; 5] = [
    ("winding.proof", "the whole sample box", Some((1, 1))),
    ("winding.proof", "turning points of the first output", Some((1, 0))),
    ("winding.proof", "turning points of the second output", Some((1, 1))),
    ("cubic.proof", "the whole sample box", Some((1, 1))),
    ("cubic.proof", "where the cube is flat", Some((0, 0))),
];

/// By hand. With w, the derivative of the flux by the position, the rates of the currents see the speed by w and the position by
/// the rate of w. Without saliency w is psi times the tangent, its rate psi omega times the normal, and where the rotor stands
/// the second derivatives add psi (acceleration, stiffness) = psi k (iq, -id) to the column of the position.
const MOTOR: [Expected; 35] = [
    ("salient.proof", "the whole sample box", Some((4, 4))),
    // the voltages make the currents change, and w with them
    ("salient.proof", "standstill", Some((4, 4))),
    ("salient.proof", "no saliency", Some((4, 4))),
    // w stands, for ever
    ("salient.proof", "standstill without saliency", Some((3, 3))),
    ("salient.proof", "standstill at constant currents", Some((3, 3))),
    ("salient.proof", "no current", Some((4, 4))),
    ("salient.proof", "standstill without current", Some((4, 4))),
    ("salient.proof", "no magnet", Some((4, 4))),
    // w = 0, and nothing will make a current
    ("salient.proof", "no magnet, current or voltage", Some((2, 2))),
    ("salient.proof", "no inductance along the magnet", None),
    ("torque.proof", "the whole sample box", Some((4, 4))),
    // own rows: psi^2 omega / La^2
    ("torque.proof", "standstill", Some((4, 3))),
    ("torque.proof", "standstill without acceleration", Some((4, 3))),
    ("torque.proof", "standstill, the current across the magnet", Some((4, 3))),
    // third derivatives: the voltage makes a current, and that a torque
    ("torque.proof", "standstill without current", Some((4, 3))),
    ("torque.proof", "switched off at standstill", Some((3, 3))),
    ("torque.proof", "no current", Some((4, 4))),
    // the two currents
    ("torque.proof", "no magnet", Some((2, 2))),
    ("torque.proof", "no inductance", None),
    ("load.proof", "the whole sample box", Some((5, 5))),
    // psi^3 times the acceleration
    ("load.proof", "standstill", Some((5, 5))),
    ("load.proof", "standstill, balanced", Some((5, 4))),
    // position and load keep the balance together
    ("load.proof", "standstill, balanced at constant currents", Some((4, 4))),
    ("load.proof", "standstill without current", Some((5, 5))),
    // the load moves the rotor
    ("load.proof", "switched off", Some((5, 5))),
    ("load.proof", "switched off at standstill", Some((5, 5))),
    ("load.proof", "switched off at standstill without load", Some((4, 4))),
    ("load.proof", "no magnet", Some((2, 2))),
    ("injection.proof", "the whole sample box", Some((4, 4))),
    // -2 (Ld - Lq)/(Ld Lq) |w|^2 has no speed in it
    ("injection.proof", "standstill", Some((4, 4))),
    ("injection.proof", "standstill without current", Some((4, 4))),
    ("injection.proof", "no saliency", Some((4, 4))),
    ("injection.proof", "standstill without saliency", Some((3, 3))),
    ("injection.proof", "no magnet", Some((4, 4))),
    // own rows have no word that tells the speed where w is zero
    ("injection.proof", "no magnet, standstill without current", Some((4, 3))),
];

/// The one rank that all sampled states have.
fn only_rank(histogram: &Value) -> usize {
    let ranks = histogram.as_object().unwrap_or_else(|| panic!("{histogram}"));
    assert_eq!(ranks.len(), 1, "{histogram}");
    ranks.keys().next().unwrap().parse().unwrap()
}

/// The rank on a set, of all words and of the own rows, on each branch of its conditions the same; nothing for a pole.
fn ranks(set: &Value) -> Option<(usize, usize)> {
    if set["singularity"].is_string() {
        return None;
    }
    let own: Vec<usize> = match set["branches"].as_array() {
        Some(branches) => {
            branches.iter().map(|branch| only_rank(&branch["own_rows"]["rank_histogram"])).collect()
        }
        None => vec![only_rank(&set["own_rows"]["rank_histogram"])],
    };
    assert!(own.iter().all(|rank| *rank == own[0]), "{set}");
    let full = &set["rank_histogram"];
    let states: u64 = full.as_object().unwrap().values().map(|count| count.as_u64().unwrap()).sum();
    assert!(states >= 200, "{set}");
    assert_eq!(set["certified"].as_u64(), Some(states), "{set}");
    Some((only_rank(full), own[0]))
}

/// A folder verified: all as expected, and the ranks on all named sets as they are by hand. What was found.
fn verified(name: &str, expected: &[Expected]) -> Value {
    let (out, path) = (folder(), format!("proofs/{name}"));
    let output = palmistry(&["verify", &path, "--json", "--out", out.path().to_str().unwrap()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let found = json(&output);
    assert_eq!(found["ok"], true);
    let mut here = Vec::new();
    for file in found["files"].as_array().unwrap() {
        assert_eq!(file["left_out"], serde_json::json!([]));
        for set in file["ranks"].as_array().unwrap() {
            here.push((file["file"].as_str().unwrap(), set["set"].as_str().unwrap(), ranks(set)));
        }
    }
    for (one, other) in here.iter().zip(expected) {
        assert_eq!(one, other);
    }
    assert_eq!(here.len(), expected.len());
    let page = std::fs::read_to_string(out.path().join("index.html")).unwrap();
    assert!(!page.contains("could not be drawn"));
    found
}

/// How many maps, lines and proved reductions there are.
fn seen(found: &Value) -> [usize; 3] {
    let mut counts = [0; 3];
    for file in found["files"].as_array().unwrap() {
        for (count, what) in counts.iter_mut().zip(["maps", "lines", "reductions"]) {
            *count += file[what].as_array().unwrap().len();
        }
        for reduction in file["reductions"].as_array().unwrap() {
            assert_eq!(reduction["proved"], true, "{reduction}");
        }
    }
    counts
}

/// Without times two runs write the same, whatever the number of threads.
#[test]
fn without_times_nothing_changes() {
    let run = |threads: &str| {
        let out = folder();
        let to = out.path().to_str().unwrap();
        let output =
            with_threads(&["verify", "proofs/martinelli2005", "--no-times", "--out", to], Some(threads));
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        ["index.html", "verify.json", "errata.md"]
            .map(|name| std::fs::read_to_string(out.path().join(name)).unwrap())
    };
    let (one, two) = (run("1"), run("2"));
    for (a, b) in one.iter().zip(&two) {
        assert_eq!(a, b);
    }
    assert!(!one[1].contains("seconds") && !one[0].contains(" in all."), "a time is told");
}

#[test]
fn a_robot_and_its_beacons() {
    assert_eq!(seen(&verified("martinelli2005", &ROBOT)), [4, 7, 1]);
}

#[test]
fn a_motor_without_position_sensor() {
    assert_eq!(seen(&verified("koteich2015", &MOTOR)), [3, 4, 1]);
}

#[test]
fn what_a_rank_does_not_say() {
    assert_eq!(seen(&verified("hermann1977", &BY_DEFINITION)), [1, 1, 0]);
}

/// By hand. Tyres: on a straight course no slip makes a force, whose derivative by the friction has the slip's third power as a factor; r and ay still
/// give the two states. Where the stiffnesses are unknown the steering moves the vehicle off the straight course. Bioreactor: X = 0 stays, so
/// that every derivative is a multiple of X; at rest the derivatives of X, of its growth rate and of the rate of S are all there is.
const EXAMPLES: [(&str, &str, &str, u64); 11] = [
    ("tyre", "saturating.proof", "the whole sample box", 3),
    ("tyre", "saturating.proof", "straight driving", 2),
    ("tyre", "saturating.proof", "the front axle without slip", 3),
    ("tyre", "saturating.proof", "a turn without sideslip", 3),
    ("tyre", "linear.proof", "the whole sample box", 4),
    ("tyre", "linear.proof", "steering away from straight driving", 4),
    ("bioreactor", "biomass.proof", "the whole sample box", 5),
    ("bioreactor", "biomass.proof", "washed out", 1),
    ("bioreactor", "biomass.proof", "no substrate", 5),
    ("bioreactor", "biomass.proof", "steady state", 3),
    ("bioreactor", "substrate.proof", "the whole sample box", 4),
];

/// The two papers that are examples are verified as expected, with a picture each.
#[test]
fn the_examples_of_papers() {
    let mut found = Vec::new();
    for (paper, refuted) in [("tyre", ["friction.linear"]), ("bioreactor", ["growth.linear"])] {
        let (out, path) = (folder(), format!("examples/papers/{paper}"));
        let to = out.path().to_str().unwrap();
        let output = palmistry(&["verify", &path, "--json", "--no-times", "--out", to]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let answer = json(&output);
        assert_eq!(answer["ok"], true);
        for file in answer["files"].as_array().unwrap() {
            assert_eq!(file["left_out"], serde_json::json!([]));
            for set in file["ranks"].as_array().unwrap() {
                let name = |value: &Value| value.as_str().unwrap().to_owned();
                let rank = only_rank(&set["rank_histogram"]) as u64;
                found.push((paper, name(&file["file"]), name(&set["set"]), rank));
            }
            let claims = file["claims"].as_array().unwrap().iter();
            let wrong: Vec<&str> = claims
                .filter(|claim| claim["verdict"] == "refuted")
                .map(|claim| claim["id"].as_str().unwrap())
                .collect();
            assert!(wrong.is_empty() || wrong == refuted, "{wrong:?}");
        }
        assert_eq!(seen(&answer)[0], 2, "a map for each file");
    }
    let expected = EXAMPLES.map(|(paper, file, set, rank)| (paper, file.to_owned(), set.to_owned(), rank));
    assert_eq!(found, expected);
}

/// Every claim of the short papers has the verdict that its file expects; those that are refuted on purpose are these.
#[test]
fn the_claims_hold_and_the_wrong_ones_do_not() {
    for (folder, least, refuted) in [
        ("martinelli2005", 140, &["rank.all", "mirror.turning", "mirror.turning"][..]),
        ("koteich2015", 95, &["rank.standstill.folklore", "poles.third", "rank.standstill.folklore"]),
        ("hermann1977", 18, &["one.mirror.moving", "condition.full"]),
    ] {
        let output = palmistry(&["prove", &format!("proofs/{folder}"), "--json"]);
        assert!(output.status.success(), "{folder}");
        let found = json(&output);
        let claims = found["claims"].as_array().unwrap();
        assert!(claims.len() >= least, "{folder}: {}", claims.len());
        let mut wrong: Vec<&str> = Vec::new();
        for claim in claims {
            assert_eq!(claim["ok"], true, "{claim}");
            if claim["verdict"] == "refuted" {
                assert!(claim["witness"].is_object(), "{claim}");
                wrong.push(claim["id"].as_str().unwrap());
            }
        }
        wrong.sort_unstable();
        let mut refuted = refuted.to_vec();
        refuted.sort_unstable();
        assert_eq!(wrong, refuted, "{folder}");
    }
}

/// What is refuted, and what is said of a rank, is found again by the checker.
#[test]
fn the_verdicts_are_checked_again() {
    let out = folder();
    // confirmed at least, and neither confirmed nor half confirmed at most
    for (name, least, most) in [("martinelli2005", 135, 3), ("koteich2015", 90, 3), ("hermann1977", 16, 4)] {
        let verdicts = out.path().join(name);
        let verdicts = verdicts.to_str().unwrap();
        assert!(palmistry(&["prove", &format!("proofs/{name}"), "--verdicts", verdicts]).status.success());
        let output = palmistry(&["recheck", verdicts]);
        assert!(output.status.success(), "{name}");
        let text = String::from_utf8_lossy(&output.stdout);
        let count = |word: &str| text.lines().filter(|line| line.trim_start().starts_with(word)).count();
        let found = ["confirmed", "consistent", "not checked"].map(count);
        assert!(found[0] >= least && found[1] + found[2] <= most, "{name}: {found:?}");
    }
}

/// A value by the program.
fn value(file: &str, expression: &str, at: &str) -> f64 {
    let output = palmistry(&["eval", file, expression, "--at", at, "--digits", "15", "--json"]);
    json(&output)["value"].as_str().unwrap().parse().unwrap()
}

/// The motor a second time, from its flux in the rotor's frame, in which the inductances are constant: no matrix of inductances
/// that depends on the position, and derivatives by differences.
mod motor {
    const LD: f64 = 0.005;
    const LQ: f64 = 0.01;

    /// The flux linkages in the stator's frame: currents into the rotor's frame, flux there, and back.
    fn flux(at: [f64; 3]) -> [f64; 2] {
        let [ia, ib, theta] = at;
        let (sine, cosine) = theta.sin_cos();
        let along = LD * (ia * cosine + ib * sine) + 0.1;
        let across = LQ * (ib * cosine - ia * sine);
        [along * cosine - across * sine, along * sine + across * cosine]
    }

    /// The derivative of the flux by one of the currents or by the position.
    fn slope(at: [f64; 3], place: usize) -> [f64; 2] {
        let step = 1e-5;
        let (mut more, mut less) = (at, at);
        more[place] += step;
        less[place] -= step;
        let (more, less) = (flux(more), flux(less));
        [(more[0] - less[0]) / (2.0 * step), (more[1] - less[1]) / (2.0 * step)]
    }

    fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
        a[0] * b[1] - a[1] * b[0]
    }

    /// The rates of the currents by Faraday's law, at the voltages 5 and 3 and half an ohm; the state is ia, ib, omega, theta.
    fn rates(state: [f64; 4]) -> [f64; 2] {
        let [ia, ib, omega, theta] = state;
        let at = [ia, ib, theta];
        let (a, b, w) = (slope(at, 0), slope(at, 1), slope(at, 2));
        let rest = [5.0 - 0.5 * ia - omega * w[0], 3.0 - 0.5 * ib - omega * w[1]];
        [cross(rest, b) / cross(a, b), cross(a, rest) / cross(a, b)]
    }

    /// The determinant of the rates of the currents by speed and position.
    pub fn determinant(state: [f64; 4]) -> f64 {
        let by = |place: usize, step: f64| {
            let (mut more, mut less) = (state, state);
            more[place] += step;
            less[place] -= step;
            let (more, less) = (rates(more), rates(less));
            [(more[0] - less[0]) / (2.0 * step), (more[1] - less[1]) / (2.0 * step)]
        };
        cross(by(2, 1e-2), by(3, 1e-4))
    }
}

#[test]
fn the_determinant_of_a_salient_motor_by_differences() {
    let file = "proofs/koteich2015/salient.proof";
    for (state, at) in [
        ([2.0, 1.0, 50.0, 0.5], "ia=2,ib=1,omega=50,theta=0.5"),
        ([2.0, 1.0, 0.0, 0.5], "ia=2,ib=1,omega=0,theta=0.5"),
        ([-7.0, 4.0, -80.0, -2.0], "ia=-7,ib=4,omega=-80,theta=-2"),
    ] {
        let (found, by_differences) = (value(file, "det(rows)", at), motor::determinant(state));
        assert!((found - by_differences).abs() < 1e-4 * found.abs(), "{at}: {found}, {by_differences}");
    }
    // without saliency it is psi^2 omega / Ld^2 = 0.01 * 50 / 0.005^2
    let without = value(file, "det(rows)", "ia=2,ib=1,omega=50,theta=0.5,Lq=0.005");
    assert!((without - 20_000.0).abs() < 1e-6, "{without}");
}

/// Where a robot is after driving forward at speed one for a time while it turns at a constant rate: on an arc.
fn driven([x, y, theta]: [f64; 3], turn: f64, time: f64) -> [f64; 3] {
    let end = theta + turn * time;
    if turn == 0.0 {
        return [x + time * theta.cos(), y + time * theta.sin(), end];
    }
    [x + (end.sin() - theta.sin()) / turn, y - (end.cos() - theta.cos()) / turn, end]
}

/// The ranges to beacons at (0, 0) and (2, 0) along three arcs.
fn ranges(mut pose: [f64; 3], turns: [f64; 3]) -> Vec<[f64; 2]> {
    let mut found = Vec::new();
    for turn in turns {
        for _ in 0..20 {
            pose = driven(pose, turn, 0.05);
            found.push([pose[0].hypot(pose[1]), (pose[0] - 2.0).hypot(pose[1])]);
        }
    }
    found
}

/// The greatest difference between the ranges to one beacon.
fn apart(a: &[[f64; 2]], b: &[[f64; 2]], beacon: usize) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a[beacon] - b[beacon]).abs()).fold(0.0, f64::max)
}

/// The symmetries that the claims speak of, with whole trajectories and no derivative: the rotation about the only beacon is never
/// seen; the mirror image in the line of two beacons is seen once the robot turns, and not before.
#[test]
fn what_no_trajectory_tells() {
    let pose: [f64; 3] = [1.5, 0.8, 0.4];
    let angle: f64 = 0.7;
    let (sine, cosine) = angle.sin_cos();
    let rotated = [pose[0] * cosine - pose[1] * sine, pose[0] * sine + pose[1] * cosine, pose[2] + angle];
    let mirrored = [pose[0], -pose[1], -pose[2]];
    let (straight, winding) = ([0.0; 3], [0.9, -0.4, 1.3]);
    for turns in [straight, winding] {
        let (here, there) = (ranges(pose, turns), ranges(rotated, turns));
        assert!(apart(&here, &there, 0) < 1e-12);
        assert!(apart(&here, &there, 1) > 0.1, "the second beacon sees it");
    }
    let (here, there) = (ranges(pose, straight), ranges(mirrored, straight));
    assert!(apart(&here, &there, 0).max(apart(&here, &there, 1)) < 1e-12);
    let (here, there) = (ranges(pose, winding), ranges(mirrored, winding));
    assert!(apart(&here, &there, 0).max(apart(&here, &there, 1)) > 0.1);
}

/// Rates of the range along a path, by differences of arcs, and the determinant of two_beacons.proof from its own entries: rows
/// [x, y, 0], [c, s, yc - xs], [c, s, yc - (x - 2)s].
#[test]
fn words_of_the_range_by_differences() {
    let file = "proofs/martinelli2005/one_beacon.proof";
    let pose: [f64; 3] = [1.0, 2.0, 0.3];
    let at = "x=1,y=2,theta=0.3";
    let range = |time: f64| {
        let [x, y, _] = driven(pose, 0.0, time);
        x.hypot(y)
    };
    let step = 1e-3;
    let first = (range(step) - range(-step)) / (2.0 * step);
    let second = (range(step) - 2.0 * range(0.0) + range(-step)) / (step * step);
    assert!((value(file, "L(drive, range)", at) - first).abs() < 1e-6);
    assert!((value(file, "L(drive, drive, range)", at) - second).abs() < 1e-6);

    let ([x, y, theta], b) = (pose, 2.0);
    let (s, c) = theta.sin_cos();
    let (first, second) = (y * c - x * s, y * c - (x - b) * s);
    let determinant = x * (s * second - first * s) - y * (c * second - first * c);
    let found = value("proofs/martinelli2005/two_beacons.proof", "det(rows)", at);
    assert!((found - determinant).abs() < 1e-12, "{found}, {determinant}");
}

/// Three palms in space: every claim is proved, and at each drawn state and jet all sixteen unknowns are certainly seen, by all words
/// and by the derivatives of the measurements along one motion.
#[test]
fn three_palms_tell_all_of_a_body_that_turns() {
    let found = json(&palmistry(&["prove", "proofs/moll2002/space", "--json"]));
    let claims = found["claims"].as_array().unwrap();
    assert!(claims.len() >= 45, "{}", claims.len());
    assert!(claims.iter().all(|claim| claim["verdict"] == "proved"), "{found}");
    let found =
        json(&palmistry(&["rank", "proofs/moll2002/space/ranks.proof", "--samples", "100", "--json"]));
    for rows in [&found, &found["own_rows"]] {
        assert_eq!(rows["rank_histogram"], serde_json::json!({ "16": 100 }), "{found}");
        assert_eq!(rows["certified"], 100);
    }
}
