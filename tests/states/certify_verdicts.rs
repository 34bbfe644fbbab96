//! Certificates written down box by box, and checked again by code that knows no factors and no charts.

use crate::common::{folder, json, palmistry};
use dashu::rational::RBig;
use palmistry::System;
use palmistry::certificate::{Limits, Region, RegionRows};
use palmistry::checker::{CertifiedBoxes, Doubt, Effort, Evidence, Finding, Ratio, VerdictFile};
use palmistry::evidence::certificate_file;
use std::collections::BTreeMap;
use std::path::Path;

/// The boxes of a file after a search.
fn certified(system: &mut System, rows: RegionRows, most: usize) -> (CertifiedBoxes, Region) {
    let mut region = Region::new(system, rows, &BTreeMap::new(), None).unwrap();
    region.keep_boxes(most);
    region.run(Limits { seconds: None, boxes: Some(3000) }, &false.into(), &|_| ());
    let (file, written) = certificate_file(system, &region, most, &false.into()).unwrap();
    let again = VerdictFile::read(&file.text().unwrap()).unwrap();
    assert_eq!(again, file, "what is read is what was written");
    let [record] = again.verdicts.as_slice() else { panic!("one verdict") };
    let Evidence::Boxes(boxes) = &record.evidence else { panic!("{record:?}") };
    assert_eq!(boxes.boxes.len(), written.boxes);
    (boxes.clone(), region)
}

fn system(text: &str) -> System {
    System::parse("test.proof", &format!("system \"test\" {text}"), Path::new("")).unwrap()
}

fn check(boxes: &CertifiedBoxes) -> Finding {
    boxes.check(&Effort::default(), &false.into())
}

fn ratio(top: i64, bottom: i64) -> Ratio {
    Ratio(RBig::from(top) / RBig::from(bottom))
}

/// The same with the digest that fits: what a careful hand would write.
fn sealed(mut boxes: CertifiedBoxes) -> CertifiedBoxes {
    boxes.digest = boxes.digest_of_the_rest();
    boxes
}

/// One box alone, with the volume that it has in a whole box from -1 to 1 in every coordinate.
fn alone(boxes: &CertifiedBoxes, sides: Vec<[Ratio; 2]>) -> CertifiedBoxes {
    let mut found = boxes.clone();
    found.boxes.truncate(1);
    let half = |[low, high]: &[Ratio; 2]| (&high.0 - &low.0) / RBig::from(2);
    found.volume = Ratio(sides.iter().map(half).fold(RBig::ONE, |product, part| product * part));
    found.proved_volume = Ratio(RBig::ONE);
    found.boxes[0].sides = sides;
    sealed(found)
}

/// Every box of the small regimes that is written is found again.
#[test]
fn shipped_certificates_are_found_again() {
    // the part of the whole box that the largest 200 boxes make, as far as plain arithmetic shows them: more with a
    // better checker, never less
    for (file, rows, part) in [
        ("proofs/moll2002/same_rate.proof", RegionRows::Codistribution(None), 4),
        ("proofs/moll2002/same_rate.proof", RegionRows::Own, 4),
        ("proofs/moll2002/one_palm_fixed.proof", RegionRows::Codistribution(None), 50),
    ] {
        let mut system = System::read(Path::new(file)).unwrap();
        let (boxes, region) = certified(&mut system, rows, 200);
        assert_eq!(check(&boxes), Finding::Confirmed { times: boxes.boxes.len() }, "{file}");
        assert!(boxes.boxes.len() > 10, "{file}: {} boxes", boxes.boxes.len());
        assert_eq!(boxes.proved_volume.0, region.proved_exactly());
        assert!(
            boxes.volume.0 > RBig::from(1) / RBig::from(part),
            "{file}: {}",
            boxes.volume.0.to_f64().value()
        );
    }
}

/// A box that is made larger, rows of another minor, an end, a guard: none of it is confirmed.
#[test]
fn what_was_changed_is_not_confirmed() {
    let mut pole = system("state x output x\nlet rows = [2 + 1/x^2]\nsample x in [-1, 1]");
    let (boxes, _) = certified(&mut pole, RegionRows::Own, 50);
    assert!(matches!(check(&boxes), Finding::Confirmed { .. }));
    // the honest version of a box alone is confirmed, so that what follows is not refused for its form
    let honest = alone(&boxes, vec![[ratio(1, 2), ratio(1, 1)]]);
    assert_eq!(check(&honest), Finding::Confirmed { times: 1 });
    for over in [[ratio(-1, 3), ratio(1, 1)], [ratio(0, 1), ratio(1, 1)], [ratio(-1, 1), ratio(0, 1)]] {
        let finding = check(&alone(&boxes, vec![over.clone()]));
        assert_eq!(finding, Finding::NotConfirmed(Doubt::BoxNotShown(0)), "{over:?}");
    }
    // beyond the whole box
    let beyond = alone(&boxes, vec![[ratio(1, 2), ratio(2, 1)]]);
    assert_eq!(check(&beyond), Finding::NotConfirmed(Doubt::BoxOutside(0)));
    // by hand, without another digest
    let mut by_hand = boxes.clone();
    by_hand.requirements.pop();
    assert_eq!(check(&by_hand), Finding::NotConfirmed(Doubt::DigestDiffers));
    let mut by_hand = boxes.clone();
    by_hand.boxes[0].sides[0] = [ratio(-1, 1), ratio(1, 1)];
    assert_eq!(check(&by_hand), Finding::NotConfirmed(Doubt::DigestDiffers));
    // twice the same, a volume that is too large, and nothing at all
    let mut twice = boxes.clone();
    let first = twice.boxes[0].clone();
    twice.boxes.push(first);
    assert!(matches!(check(&sealed(twice)), Finding::NotConfirmed(Doubt::BoxesOverlap { first: 0, .. })));
    let mut more = boxes.clone();
    more.volume = ratio(1, 1);
    assert_eq!(check(&sealed(more)), Finding::NotConfirmed(Doubt::VolumeDiffers));
    let mut nothing = boxes;
    nothing.boxes.clear();
    assert_eq!(check(&sealed(nothing)), Finding::NotConfirmed(Doubt::Empty));
}

/// The rows of a minor that vanishes, and a requirement that is not met: with every digest as it should be.
#[test]
fn rows_that_are_not_independent_are_not_confirmed() {
    let mut three = system(
        "state x, y output x\nlet rows = [1 + x^2, y; x, 3; 2 + 2*x^2, 2*y]\nsample x in [-1, 1] y in [-1, 1]",
    );
    let (boxes, _) = certified(&mut three, RegionRows::Own, 10);
    assert!(matches!(check(&boxes), Finding::Confirmed { .. }));
    let mut proportional = system(
        "state x, y output x\nlet rows = [1 + x^2, y; 2 + 2*x^2, 2*y; x, 3]\nsample x in [-1, 1] y in [-1, 1]",
    );
    let (other, _) = certified(&mut proportional, RegionRows::Own, 10);
    let mut wrong = other.clone();
    // all three rows are written only where both minors were used: put the row in
    wrong.rows = vec![other.rows[0].clone(); 2];
    wrong.row_names = vec!["row 1".to_owned(), "row 1 again".to_owned()];
    wrong.boxes.iter_mut().for_each(|found| found.rows = vec![0, 1]);
    assert_eq!(check(&sealed(wrong.clone())), Finding::NotConfirmed(Doubt::BoxNotShown(0)));
    wrong.boxes[0].rows = vec![0, 0];
    assert_eq!(check(&sealed(wrong.clone())), Finding::NotConfirmed(Doubt::BoxWithoutMinor(0)));
    wrong.boxes[0].rows = vec![0, 7];
    assert_eq!(check(&sealed(wrong)), Finding::NotConfirmed(Doubt::BoxWithoutMinor(0)));
    let mut logarithm = system("state x output x\nlet rows = [1 + log(x + 2)^2]\nsample x in [-1, 1]");
    let (boxes, _) = certified(&mut logarithm, RegionRows::Own, 10);
    let mut outside = boxes.clone();
    outside.ranges[0].low = ratio(-4, 1);
    outside.boxes[0].sides = vec![[ratio(-4, 1), ratio(-3, 1)]];
    outside.boxes.truncate(1);
    outside.volume = ratio(1, 5);
    assert!(matches!(
        check(&sealed(outside)),
        Finding::NotConfirmed(Doubt::MissingInBox { index: 0, requirement: 0 })
    ));
}

/// The command line: the file is written, found again, and found wanting when a digit is changed.
#[test]
fn a_certificate_is_rechecked_from_its_file_alone() {
    let folder = folder();
    let path = folder.path().join("boxes.json");
    let name = path.to_str().unwrap();
    let output = palmistry(&[
        "certify",
        "proofs/moll2002/same_rate.proof",
        "--boxes",
        "2000",
        "--verdicts",
        name,
        "--verdict-boxes",
        "60",
        "--json",
    ]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let written = json(&output)["verdict_boxes"]["written"].as_u64().unwrap();
    assert!((10..=60).contains(&written), "{written}");
    let checked = palmistry(&["recheck", name, "--json"]);
    assert_eq!(checked.status.code(), Some(0));
    assert_eq!(json(&checked)["confirmed"], 1);
    let text = std::fs::read_to_string(&path).unwrap();
    let changed = text.replacen("\"rows\":[0,1", "\"rows\":[1,0", 1);
    let changed =
        if changed == text { text.replacen("\"angle\":true", "\"angle\":false", 1) } else { changed };
    assert_ne!(changed, text);
    std::fs::write(&path, changed).unwrap();
    let checked = palmistry(&["recheck", name, "--json"]);
    assert_eq!(checked.status.code(), Some(1));
    assert_eq!(json(&checked)["not_confirmed"], 1);
    // nothing is proved, and nothing is claimed
    let file = crate::common::write(
        &folder,
        "blind.proof",
        "system \"s\" state x drift f x' = 1 output x - x\nsample x in [0, 1]",
    );
    let output = palmistry(&["certify", file.to_str().unwrap(), "--verdicts", name, "--json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(json(&output)["verdict_boxes"]["written"], 0);
    assert_eq!(json(&palmistry(&["recheck", name, "--json"]))["confirmed"], 0);
}
