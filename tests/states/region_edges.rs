//! Certificates at the edges: no boxes, boxes of one point, maps of some of the parts.

use palmistry::certificate::{BoxStanding, RegionAnswer};
use palmistry::{System, certify};

fn certified(text: &str, boxes: u64) -> RegionAnswer {
    certify(&mut text.parse::<System>().unwrap(), boxes).unwrap()
}

fn standings(answer: &RegionAnswer) -> Vec<BoxStanding> {
    let mut standings: Vec<BoxStanding> =
        answer.map.as_ref().unwrap().patches.iter().map(|patch| patch.standing).collect();
    standings.sort_unstable();
    standings.dedup();
    standings
}

/// The map is of x and y, where the minor vanishes nowhere; that of z does, and a state is what it is in all parts.
#[test]
fn a_map_is_not_proved_where_another_part_is_not() {
    let system = |low: &str| {
        format!(
            "system \"s\" state x, y, z drift f x' = 0 y' = 0 z' = 0 output x^2*y, y^3, z^2 \
             sample x in [1, 2] y in [1, 2] z in [{low}, 2]"
        )
    };
    // a third of the range is zero, where the rank falls
    let open = certified(&system("-1"), 100);
    let map = open.map.as_ref().unwrap();
    assert_eq!((map.x.name.as_str(), map.y.name.as_str()), ("x", "y"));
    assert!(map.at.contains(&("z".to_owned(), 0.0)), "{:?}", map.at);
    // whether the factor is known to vanish there or not told apart from zero depends on how the box was halved
    for boxes in [0, 100] {
        let standings = standings(&certified(&system("-1"), boxes));
        assert!(!standings.contains(&BoxStanding::Proved), "{boxes}: {standings:?}");
    }
    let proved = certified(&system("1"), 100);
    assert_eq!((proved.proved, standings(&proved)), (1.0, vec![BoxStanding::Proved]));
}

/// Nothing is proved before a box was looked at, and a box of one point is looked at like another.
#[test]
fn what_no_box_was_asked_for_is_not_proved() {
    let system = |x: &str, v: &str| {
        format!("system \"s\" state x, v drift f x' = v v' = -x output x^2 sample x in {x} v in {v}")
    };
    let none = certified(&system("[1, 1]", "[2, 2]"), 0);
    assert_eq!((none.proved, none.proved_of_sampled, none.boxes, none.finished), (0.0, 0.0, 0, false));
    let one = certified(&system("[1, 1]", "[2, 2]"), 1);
    assert_eq!((one.proved, one.boxes, one.finished), (1.0, 1, true));
    let singular = certified(&system("[0, 0]", "[0, 0]"), 10);
    assert_eq!((singular.proved, singular.minors.len(), singular.finished), (0.0, 0, true));
}
