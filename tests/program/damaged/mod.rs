//! Damaged files, for each of the readers: whatever stands in a file, the reader returns, and does not panic.
//!
//! The corpus in `tests/corpus`, a folder a reader, is replayed by every run; beside it come shipped files with bytes
//! changed, cut out, doubled and lengths that lie, and files that have grown: see [`growth`].
//! `PALMISTRY_FUZZ_CASES=100000` asks for a longer run. A case that
//! takes longer than [`HUNG`] is a hang: it is shown, and the test ends.

mod growth;

use palmistry::RankQuestion;
use palmistry::certificate::{Limits, Region, RegionRows};
use palmistry::checker::{Checking, Effort, ProofSources, VerdictFile};
use palmistry::claim::{Kept, decide_all_keeping};
use palmistry::experiment::space::SpaceScene;
use palmistry::experiment::{Experiment, Scene, Studies, StudyPart};
use palmistry::import::{ForeignFormat, ImportQuestion, import};
use palmistry::observer::{FaultRules, OnFault, Record};
use palmistry::sweep::{RankPart, RankPreparation};
use palmistry::system::System;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};

/// A case that takes longer hangs; none takes a hundredth of it.
const HUNG: Duration = Duration::from_secs(60);

/// Cases for each reader, unless the environment asks for another number.
const CASES: u32 = 300;

/// For so many of them one file grows.
const GROWN: u32 = 50;

fn cases() -> u32 {
    std::env::var("PALMISTRY_FUZZ_CASES").ok().and_then(|text| text.parse().ok()).unwrap_or(CASES)
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// A reader on a thread of its own, which is told one case after the other.
struct Watched {
    cases: Sender<Vec<u8>>,
    done: std::sync::mpsc::Receiver<()>,
    name: &'static str,
}

impl Watched {
    fn new(name: &'static str, read: impl Fn(&[u8]) + Send + 'static) -> Watched {
        let (cases, inbox) = channel::<Vec<u8>>();
        let (told, done) = channel();
        std::thread::Builder::new()
            .stack_size(16 << 20)
            .spawn(move || {
                for case in inbox {
                    read(&case);
                    let _ = told.send(());
                }
            })
            .expect("a thread");
        Watched { cases, done, name }
    }

    /// Has a case read, and fails where the reader panics or does not come back.
    fn read(&self, case: &[u8]) {
        self.cases.send(case.to_vec()).expect("the reader is there");
        match self.done.recv_timeout(HUNG) {
            Ok(()) => {}
            Err(why) => {
                let kept = std::env::temp_dir().join(format!("{}-{}.case", self.name, case.len()));
                let _ = std::fs::write(&kept, case);
                let what = if why == RecvTimeoutError::Timeout { "hangs" } else { "panics" };
                panic!("the reader of {} {what} on {}", self.name, kept.display());
            }
        }
    }

    /// Replays the corpus, then reads damaged copies of whole files.
    fn try_all(&self, whole: &[Vec<u8>]) {
        let folder = root().join("tests/corpus").join(self.name);
        let mut corpus: Vec<PathBuf> =
            std::fs::read_dir(folder).expect("its corpus").map(|entry| entry.unwrap().path()).collect();
        corpus.sort();
        assert!(!corpus.is_empty(), "the corpus of {} is there", self.name);
        let corpus: Vec<Vec<u8>> = corpus.iter().map(|file| std::fs::read(file).unwrap()).collect();
        for case in corpus.iter().chain(whole) {
            self.read(case);
        }
        let begin: Vec<Vec<u8>> = whole.iter().chain(&corpus).cloned().collect();
        let damaged = (prop::sample::select(begin), prop::collection::vec(damage(), 1..6)).prop_map(
            |(mut bytes, all)| {
                for one in &all {
                    one.inflict(&mut bytes);
                }
                bytes
            },
        );
        let config = Config { cases: cases(), failure_persistence: None, ..Config::default() };
        let tried = std::cell::Cell::new(0);
        TestRunner::new(config)
            .run(&damaged, |case| {
                self.read(&case);
                tried.set(tried.get() + 1);
                Ok(())
            })
            .unwrap();
        assert!(tried.get() >= cases(), "{} cases", tried.get());
        self.try_grown(whole);
    }

    /// Reads copies that have grown.
    fn try_grown(&self, whole: &[Vec<u8>]) {
        let config =
            Config { cases: cases().div_ceil(GROWN), failure_persistence: None, ..Config::default() };
        TestRunner::new(config)
            .run(&(prop::sample::select(whole.to_vec()), growth::growth()), |(file, growth)| {
                let sizes = growth::SIZES.map(|size| growth.of(&file, size));
                let seconds = |of: &Vec<u8>| {
                    let begin = Instant::now();
                    self.read(of);
                    begin.elapsed().as_secs_f64()
                };
                let mut times = [0, 1, 2].map(|place: usize| seconds(&sizes[place]));
                // what else runs here may have taken the time
                for _ in 0..2 {
                    if growth::are_squares(times) {
                        times = [0, 1, 2].map(|place: usize| times[place].min(seconds(&sizes[place])));
                    }
                }
                if growth::are_squares(times) {
                    let kept = std::env::temp_dir().join(format!("{}-grown.case", self.name));
                    let _ = std::fs::write(&kept, &sizes[2]);
                    panic!(
                        "the reader of {} takes {times:?} s for files of {:?} bytes, the last one {}",
                        self.name,
                        sizes.map(|own| own.len()),
                        kept.display()
                    );
                }
                Ok(())
            })
            .unwrap();
    }
}

/// Something that happens to a file.
#[derive(Clone, Debug)]
enum Damage {
    /// A byte becomes another.
    Byte(prop::sample::Index, u8),
    /// A bit is flipped.
    Bit(prop::sample::Index, u8),
    /// Some bytes are lost.
    Cut(prop::sample::Index, u8),
    /// Some bytes are there twice.
    Doubled(prop::sample::Index, u8),
    /// The rest is lost.
    Ended(prop::sample::Index),
    /// A length that lies: so many bytes with the highest bit set, and the last one.
    Length(prop::sample::Index, u8, u8),
    /// A piece of the language, or of nothing.
    Scrap(prop::sample::Index, &'static str),
}

fn damage() -> impl Strategy<Value = Damage> {
    let place = any::<prop::sample::Index>;
    let scraps = prop::sample::select(vec![
        "1e99999",
        "-",
        "((((",
        "[",
        "\u{feff}",
        "\u{0}",
        "#",
        "\r",
        "\u{2028}",
        "\"",
        "\"\"\"",
        "=",
        "{",
        "claim 1:",
        "use a = \"general.proof\"\n",
        "rank",
        "^1000",
        "/0",
        "nan",
        "inf",
        "-1",
        "18446744073709551616",
        "é",
        ",,,,",
        "\n[",
        "open ",
        "end ",
    ]);
    prop_oneof![
        (place(), any::<u8>()).prop_map(|(at, to)| Damage::Byte(at, to)),
        (place(), 0u8..8).prop_map(|(at, bit)| Damage::Bit(at, bit)),
        (place(), any::<u8>()).prop_map(|(at, count)| Damage::Cut(at, count)),
        (place(), any::<u8>()).prop_map(|(at, count)| Damage::Doubled(at, count)),
        place().prop_map(Damage::Ended),
        (place(), 1u8..10, any::<u8>()).prop_map(|(at, count, last)| Damage::Length(at, count, last)),
        (place(), scraps).prop_map(|(at, scrap)| Damage::Scrap(at, scrap)),
    ]
}

impl Damage {
    fn inflict(&self, bytes: &mut Vec<u8>) {
        if bytes.is_empty() {
            return;
        }
        let length = bytes.len();
        let piece = |at: usize, count: u8| at..(at + usize::from(count)).min(length);
        match self {
            Damage::Byte(at, to) => bytes[at.index(length)] = *to,
            Damage::Bit(at, bit) => bytes[at.index(length)] ^= 1 << bit,
            Damage::Cut(at, count) => drop(bytes.drain(piece(at.index(length), *count))),
            Damage::Doubled(at, count) => {
                let piece = piece(at.index(length), *count);
                let twice = bytes[piece.clone()].to_vec();
                bytes.splice(piece.start..piece.start, twice);
            }
            Damage::Ended(at) => bytes.truncate(at.index(length)),
            Damage::Length(at, count, last) => {
                let lie: Vec<u8> = (1..*count).map(|_| 0xff).chain([*last]).collect();
                let at = at.index(length);
                let end = (at + lie.len()).min(length);
                bytes.splice(at..end, lie);
            }
            Damage::Scrap(at, scrap) => {
                let at = at.index(length);
                bytes.splice(at..at, scrap.bytes());
            }
        }
    }
}

/// All files of a folder with an extension.
fn shipped(folder: &str, extension: &str) -> Vec<Vec<u8>> {
    let files = some(folder, extension);
    assert!(files.len() > 3, "{folder} has files");
    files
}

/// The same, however few.
fn some(folder: &str, extension: &str) -> Vec<Vec<u8>> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(root().join(folder))
        .expect("a folder")
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == extension))
        .collect();
    files.sort();
    files.iter().map(|file| std::fs::read(file).unwrap()).collect()
}

#[test]
fn proof() {
    let folder = root().join("proofs/moll2002");
    let reader = Watched::new("proof", move |bytes| {
        if let Ok(text) = std::str::from_utf8(bytes) {
            let first = System::parse("damaged.proof", text, &folder).err();
            // who asks for all problems gets the first of them too, and none for a file that can be read
            let all = System::examine_text("damaged.proof", text, &folder, 20);
            assert!(all.problems.len() <= 20 && all.problems.is_empty() == first.is_none());
            assert!(all.problems.is_sorted_by_key(|problem| problem.span.offset()));
            if let Some(first) = first.filter(|_| !all.more) {
                assert!(all.problems.iter().any(|problem| problem.message == first.message), "{first:?}");
            }
            // a form that is found is one, and stays
            if let Ok(form) = palmistry::system::format_text("damaged.proof", text) {
                assert_eq!(palmistry::system::format_text("damaged.proof", &form).ok().as_ref(), Some(&form));
            }
        }
    });
    // the long ones are as slow to read as they are long, and have no other entries
    let small = |file: &Vec<u8>| file.len() < 8000;
    reader.try_all(&shipped("proofs/moll2002", "proof").into_iter().filter(small).collect::<Vec<_>>());
}

/// Models of other programs, read as every format. What is read is written, and read back.
#[test]
fn foreign() {
    let reader = Watched::new("foreign", |bytes| {
        if let Ok(text) = std::str::from_utf8(bytes) {
            // as what it says it is, and as one of the others
            let other = ForeignFormat::ALL[bytes.len() % ForeignFormat::ALL.len()];
            for format in [None, Some(other)] {
                let question =
                    ImportQuestion { format, model: Some("1".to_owned()), ..ImportQuestion::default() };
                match import("damaged", text, &question) {
                    Ok(imported) => {
                        System::parse("written.proof", &imported.text, Path::new("")).expect("a proof file");
                    }
                    Err(why) => assert!(!why.message.is_empty()),
                }
            }
        }
    });
    let whole: Vec<Vec<u8>> =
        ["jl", "xml", "py", "m", "txt"].into_iter().flat_map(|end| some("tests/imports", end)).collect();
    assert!(whole.len() >= 8, "{} files", whole.len());
    reader.try_all(&whole);
}

#[test]
fn scene() {
    let reader = Watched::new("scene", |bytes| {
        if let Ok(text) = std::str::from_utf8(bytes) {
            let _ = Scene::parse("damaged.toml", text);
            let _ = SpaceScene::parse("damaged.toml", text);
        }
    });
    reader.try_all(&shipped("proofs/moll2002/scenes", "toml"));
}

/// Reads a record in every way.
fn read_record(path: &Path, bytes: &[u8]) {
    std::fs::write(path, bytes).unwrap();
    let _ = Record::read(path, &[]);
    let _ = Record::read(path, &["s1"]);
    let _ = Record::read_checked(path, &[], &FaultRules { on_fault: OnFault::Skip, ..FaultRules::default() });
}

/// A record of a few rows, as it is written.
fn record(name: &str) -> Vec<u8> {
    let folder = crate::common::folder();
    let path = folder.path().join(name);
    let values = |by: f64| (0..60).map(|i| by * f64::from(i)).collect::<Vec<f64>>();
    let columns = vec![("s1".to_owned(), values(0.1)), ("s2".to_owned(), values(-3.0))];
    Record::new(values(0.01), columns).unwrap().write(&path).unwrap();
    std::fs::read(&path).unwrap()
}

#[test]
fn comma_separated() {
    let folder = crate::common::folder();
    let reader = Watched::new("comma_separated", move |bytes| {
        read_record(&folder.path().join("damaged.csv"), bytes);
    });
    reader.try_all(&[record("whole.csv")]);
}

#[test]
fn parquet() {
    let folder = crate::common::folder();
    let reader = Watched::new("parquet", move |bytes| {
        read_record(&folder.path().join("damaged.parquet"), bytes);
    });
    reader.try_all(&[record("whole.parquet")]);
}

#[test]
fn expression() {
    let reader = Watched::new("expression", |bytes| {
        let head = "system \"s\" state x, y param k = 2 field f x' = y y' = x/k let a = [x, y; 1, k]";
        let mut system = System::parse("e.proof", head, Path::new("")).unwrap();
        let text = String::from_utf8_lossy(bytes);
        let _ = system.evaluate_text(&text);
        let _ = palmistry::number::parse_decimal(&text);
        let _ = palmistry::observability::parse_condition(&text);
    });
    let whole =
        ["det(a)^3/(x^2 + y^2)", "L(f, f, sin(x)*atan(y/k)) at {x = 1/3, y = -2}", "rank(a) + d(x*y, x)"];
    reader.try_all(&whole.map(|text| text.as_bytes().to_vec()));
}

/// The state of a search, as `certify --state` keeps it. What was damaged is refused: nothing is taken up from it.
#[test]
fn journal() {
    let text = "system \"s\" state x drift f x' = x output x^2 sample x in [-1, 2]";
    let mut system = System::parse("e.proof", text, Path::new("")).unwrap();
    let mut region =
        Region::new(&mut system, RegionRows::Codistribution(None), &BTreeMap::new(), None).unwrap();
    region.run(Limits { seconds: None, boxes: Some(100) }, &false.into(), &|_| ());
    let saved = region.saved();
    assert!(saved.lines().count() > 4, "{saved}");
    let (whole, region) = (saved.clone(), Mutex::new(region));
    let reader = Watched::new("journal", move |bytes| {
        if let Ok(text) = std::str::from_utf8(bytes)
            && region.lock().unwrap().resume(text).is_ok()
        {
            // a last line without an end is no damage
            assert_eq!(
                text.trim_end_matches('\n'),
                whole.trim_end_matches('\n'),
                "a damaged state is taken up"
            );
        }
    });
    reader.try_all(&[saved.into_bytes()]);
}

/// A part of a sweep. What was damaged is refused, or says the same.
#[test]
fn part() {
    let text = std::fs::read_to_string(root().join("tests/models/cr.proof")).unwrap();
    let mut system = System::parse("cr.proof", &text, Path::new("")).unwrap();
    let question = RankQuestion { samples: 20, ..RankQuestion::default() };
    let threads = rayon::ThreadPoolBuilder::new().stack_size(64 << 20).build().unwrap();
    let whole = threads.install(|| {
        let prepared = RankPreparation::new(&mut system, &question).unwrap();
        prepared.sweep(&system, 3..20).unwrap().text().unwrap()
    });
    let expected = whole.clone();
    let reader = Watched::new("part", move |bytes| {
        if let Ok(text) = std::str::from_utf8(bytes)
            && let Ok(part) = RankPart::read(text)
        {
            // blanks may stand anywhere
            let said = part.text().expect("it is whole");
            assert!(said == expected || part.range().is_empty(), "a damaged part is read");
        }
    });
    reader.try_all(&[whole.into_bytes()]);
}

/// A part of a scene's studies. What was damaged is refused, or says the same.
#[test]
fn study_part() {
    let path = root().join("examples/systems/van_der_pol.toml");
    let scene = std::fs::read_to_string(&path).unwrap();
    let short = scene.replace("duration = 8\nsamples = 161", "duration = 1\nsamples = 21");
    let short = short.replace("window = 160\nsteps = 50", "window = 20\nsteps = 8");
    let studies =
        "[study.noise]\nlevels = [1e-3]\nseeds = 3\n[study.basin]\nx = [-2, 2]\ny = [-2, 2]\npoints = 2\n";
    let scene = Scene::parse(path.to_str().unwrap(), &format!("{short}{studies}")).unwrap();
    let experiment = Experiment::new(scene, None).unwrap();
    let never = false.into();
    let studies = Studies::new(&experiment, &never).unwrap();
    let whole = studies.part(1..6, &never, &|| ()).unwrap().text().unwrap();
    let expected = whole.clone();
    let reader = Watched::new("study_part", move |bytes| {
        if let Ok(text) = std::str::from_utf8(bytes)
            && let Ok(part) = StudyPart::read(text)
        {
            // blanks may stand anywhere
            let said = part.text().expect("it is whole");
            assert!(said == expected || part.range().is_empty(), "a damaged part is read");
        }
    });
    reader.try_all(&[whole.into_bytes()]);
}

/// A share of a search. What was damaged is refused.
#[test]
fn share() {
    let text = "system \"s\" state x drift f x' = x output x^2 sample x in [-1, 2]";
    let mut system = System::parse("e.proof", text, Path::new("")).unwrap();
    let mut region =
        Region::new(&mut system, RegionRows::Codistribution(None), &BTreeMap::new(), None).unwrap();
    region.run(Limits { seconds: None, boxes: Some(10) }, &false.into(), &|_| ());
    let base = region.take_share(1, 1);
    region.run(Limits { seconds: None, boxes: Some(50) }, &false.into(), &|_| ());
    let whole = region.part_text(base, 1, 1);
    assert!(whole.lines().count() > 3, "{whole}");
    let (expected, region) = (whole.clone(), Mutex::new(region));
    let reader = Watched::new("share", move |bytes| {
        if let Ok(text) = std::str::from_utf8(bytes)
            && region.lock().unwrap().read_part(text).is_ok()
        {
            assert_eq!(
                text.trim_end_matches('\n'),
                expected.trim_end_matches('\n'),
                "a damaged share is read"
            );
        }
    });
    reader.try_all(&[whole.into_bytes()]);
}

/// What `--verdicts` writes, as `recheck` reads it.
#[test]
fn verdicts() {
    let text = "system \"s\" state x, y drift f x' = y y' = x output x\nclaim 1: (x + 1)^2 = x^2 + 2*x + 1\n\
                claim 2 expect refuted: x = y\nclaim 3: rank = 2\n";
    let system = System::parse("v.proof", text, Path::new("")).unwrap();
    let outcomes = decide_all_keeping(Kept::Evidence, &system, 1, &false.into(), &|_| ());
    let records: Vec<_> = outcomes.into_iter().flat_map(|outcome| outcome.evidence).collect();
    assert!(records.len() >= 3, "{} records", records.len());
    let whole = VerdictFile::new(1, records).text().unwrap();
    let sources = ProofSources::given([system]);
    let reader = Watched::new("verdicts", move |bytes| {
        if let Ok(text) = std::str::from_utf8(bytes)
            && let Ok(file) = VerdictFile::read(text)
        {
            let (effort, never) = (Effort::default(), false.into());
            let with = Checking { sources: &sources, seed: 1, effort: &effort, interrupt: &never };
            let _ = file.check(with, &|| ()).len();
        }
    });
    reader.try_all(&[whole.into_bytes()]);
}
