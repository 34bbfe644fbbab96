//! Merged parts equal one run, and incomplete ones are refused.

use super::part::*;
use crate::{Experiment, NoiseLevel, Scene, basins, curvature_map, noise_study};
use palmistry_io::UNINTERRUPTED;
use std::path::PathBuf;

/// Two curvatures of each palm in one motion, a window of ten samples: five trials.
#[test]
fn a_map_over_curvatures_is_one_run_to_the_last_bit() {
    let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../proofs/moll2002/scenes"));
    let text = std::fs::read_to_string(folder.join("circular_palms.toml")).unwrap();
    let text = text.split("[study").next().unwrap().replace("window = 80", "guess_off = 0.1\nwindow = 10");
    let study = "\n[study.curvature]\nrange = [-0.2, 0.25]\npoints = 2\norientations = [3.4]\nrates = [-0.8]\nnoise = 1e-4\n";
    let scene = Scene::parse(folder.join("x.toml").to_str().unwrap(), &format!("{text}{study}")).unwrap();
    let experiment = Experiment::new(scene, None).unwrap();
    let studies = Studies::new(&experiment, &UNINTERRUPTED).unwrap();
    assert_eq!(studies.trials(), 5);
    let study = experiment.scene.study.curvature.as_ref().unwrap();
    let whole = curvature_map(&experiment, study, &UNINTERRUPTED, &|| ()).unwrap();
    for of in [1, 2, 7] {
        assert_eq!(studies.merge(parts(&studies, of)).unwrap().curvature.as_ref(), Some(&whole), "{of}");
    }
}

/// Two studies of which neither has a number of trials that 7 divides.
fn experiment() -> Experiment {
    let path = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/systems/van_der_pol.toml"));
    let text = std::fs::read_to_string(&path).unwrap();
    let short = [
        ("duration = 8\nsamples = 161", "duration = 0.5\nsamples = 11"),
        ("window = 160\nsteps = 50", "window = 10\nsteps = 6"),
        ("\"multiple-shooting\"", "\"newton\""),
    ];
    let text = short.iter().fold(text, |text, (long, short)| {
        assert!(text.contains(long), "{long}");
        text.replace(long, short)
    });
    let study = "\n[study.noise]\nlevels = [1e-4, 1e-3]\nseeds = 3\n\n\
                 [study.basin]\nx = [-2.5, 2.5]\ny = [-2.5, 2.5]\npoints = 2\n";
    let scene = Scene::parse(path.to_str().unwrap(), &format!("{text}{study}")).unwrap();
    Experiment::new(scene, None).unwrap()
}

fn parts(studies: &Studies<'_>, of: u64) -> Vec<(String, StudyPart)> {
    let stretch = |number| palmistry_rank::sweep::shard_of(studies.trials(), number, of);
    let part = |number| studies.part(stretch(number), &UNINTERRUPTED, &|| ()).unwrap();
    // the last first, and each written and read
    let read = |part: StudyPart| StudyPart::read(&part.text().unwrap()).unwrap();
    (1..=of).rev().map(|number| (format!("{number}/{of}"), read(part(number)))).collect()
}

/// Oracle: the studies in one run, which use no parts. With more parts than trials some are empty.
#[test]
fn any_number_of_parts_is_one_run_to_the_last_bit() {
    let experiment = experiment();
    let studies = Studies::new(&experiment, &UNINTERRUPTED).unwrap();
    let (study, simulated) = (&experiment.scene.study, experiment.simulated().unwrap());
    let noise =
        noise_study(&experiment, simulated, study.noise.as_ref().unwrap(), &UNINTERRUPTED, &|| ()).unwrap();
    let maps = basins(&experiment, study.basin.as_ref().unwrap(), &UNINTERRUPTED, &|| ()).unwrap();
    assert_eq!(studies.trials(), (2 * 3 + 4 * experiment.scene.observer.methods.len()) as u64);
    assert_eq!(
        (noise.len(), noise[0].converged, maps.len()),
        (2, 3, experiment.scene.observer.methods.len())
    );
    let bits = |levels: &[NoiseLevel]| -> Vec<u64> {
        levels
            .iter()
            .flat_map(|level| level.errors.iter().chain(&level.bounds))
            .map(|x| x.to_bits())
            .collect()
    };
    for of in [1, 3, 7, 20] {
        let found = studies.merge(parts(&studies, of)).unwrap();
        assert_eq!(bits(&found.noise), bits(&noise), "{of}");
        assert_eq!((&found.noise, &found.basins, &found.curvature), (&noise, &maps, &None), "{of}");
    }
}

#[test]
fn what_is_no_whole_is_refused_by_name() {
    let mut experiment = experiment();
    let all = {
        let studies = Studies::new(&experiment, &UNINTERRUPTED).unwrap();
        let all = parts(&studies, 3);
        let trials = studies.trials();
        let third = palmistry_rank::sweep::shard_of(trials, 2, 3);
        let [a, b, c] = [2, 1, 0].map(|place: usize| all[place].clone());
        let merged = |parts: &[&(String, StudyPart)]| {
            studies.merge(parts.iter().map(|part| (*part).clone()).collect()).err()
        };
        assert_eq!(merged(&[]), Some(StudyMergeError::NoParts));
        assert_eq!(merged(&[&c, &b, &a]), None);
        assert_eq!(merged(&[&c, &a]), Some(StudyMergeError::Gap(third.clone())));
        assert_eq!(merged(&[&a, &b]), Some(StudyMergeError::Gap(third.end..trials)));
        let overlap =
            StudyMergeError::Overlap { one: "2/3".to_owned(), other: "again".to_owned(), trials: third };
        assert_eq!(merged(&[&a, &b, &("again".to_owned(), b.1.clone()), &c]), Some(overlap));
        // incomplete numbers, under a right checksum
        let mut short = b.clone();
        short.1.noise.pop();
        short.1.arrives.push(true);
        assert_eq!(merged(&[&a, &short, &c]), Some(StudyMergeError::Contradicts("2/3".to_owned())));
        all
    };
    let first = || all.last().unwrap().0.clone();
    // the same question, other measurements
    let mut other = experiment.clone();
    let (name, value) = other.question.guess[0].clone();
    other.question.guess[0] = (name, value + 1e-15 * value.abs().max(1.0));
    let studies = Studies::new(&other, &UNINTERRUPTED).unwrap();
    assert_eq!(studies.merge(vec![all[2].clone()]), Err(StudyMergeError::OtherReadings(first())));
    // another seed
    experiment.scene.seed += 1;
    let studies = Studies::new(&experiment, &UNINTERRUPTED).unwrap();
    assert_eq!(studies.merge(vec![all[2].clone()]), Err(StudyMergeError::OtherQuestion(first())));
}
