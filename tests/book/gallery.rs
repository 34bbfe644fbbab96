//! The gallery: each model and paper that came with the program, with its diagram and three lines. The page is written by this test
//! (`PALMISTRY_BOOK=renew`), which otherwise holds it to what the program finds.

use palmistry::observability::Observability;
use palmistry::paper::Paper;
use palmistry::report::{DiagramGround, structure_picture};
use palmistry::sweep::BranchAnswer;
use palmistry::{RankQuestion, System, answer_rank};
use std::fmt::Write;
use std::path::{Path, PathBuf};

const PAPERS: [&str; 4] = ["moll2002", "koteich2015", "martinelli2005", "hermann1977"];
const HEAD: &str = "# Gallery

The papers and models that came with the program, each with its diagram: an arrow leads from a state to those that stand in its rate, a ring marks
states that appear in an output, squares are signals; green is generically observable, red is not, grey is known or undecided. Beside a single
state stand its unknown constants and its inputs.
`palmistry verify --paper NAME` checks all of a paper; `palmistry lab` lists all of them; `palmistry rank FILE` says what the ranks rest on.

";

/// A page and its pictures, by the names of their files.
struct Gallery {
    page: String,
    pictures: Vec<(String, String)>,
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// What the outputs tell generically; nothing is sampled.
fn branch_of(system: &System) -> Option<BranchAnswer> {
    let question = RankQuestion { samples: 0, ..RankQuestion::default() };
    answer_rank(&mut system.clone(), &question).ok()?.branches.into_iter().next()
}

/// In code, so that no name is taken for markup.
fn in_code(text: &str) -> String {
    format!("`{text}`")
}

impl Gallery {
    fn diagram(&mut self, name: &str, system: &System, branch: &BranchAnswer) {
        let picture = structure_picture(system, Some(branch), DiagramGround::Alone)
            .unwrap_or_else(|| panic!("{name} has no diagram"));
        let file = format!("{name}.svg");
        let _ = writeln!(self.page, "![Diagram of {name}](pictures/gallery/{file})\n");
        self.pictures.push((file, format!("{picture}\n")));
    }

    /// Two lines: how large it is and its rank; what is observable and what is not.
    fn lines(&mut self, system: &System, branch: &BranchAnswer) {
        let of = |wanted: Observability| -> Vec<String> {
            let all = branch.unknowns.iter().zip(&branch.generic.unknowns);
            all.filter(|(_, (_, seen))| *seen == wanted).map(|((name, _), _)| in_code(name)).collect()
        };
        let [yes, no, open] = [Observability::Yes, Observability::No, Observability::Undecided].map(of);
        let rank = branch.generic.rank().map_or("not known".to_owned(), |rank| rank.to_string());
        let _ = writeln!(
            self.page,
            "- {}, {}; rank {rank} of {}.",
            counted(system.unknown_count(), "unknown"),
            counted(system.outputs.len(), "output"),
            branch.generic.dimension
        );
        let told = match (yes.is_empty(), no.is_empty(), open.is_empty()) {
            (false, true, true) => "All are observable or identifiable, locally and generically.".to_owned(),
            (true, false, true) => "None is observable or identifiable.".to_owned(),
            _ => {
                let lists = [("Observable or identifiable", yes), ("not", no), ("undecided", open)];
                let lists = lists.iter().filter(|(_, list)| !list.is_empty());
                let lists: Vec<String> =
                    lists.map(|(what, list)| format!("{what}: {}", list.join(", "))).collect();
                format!("{}.", lists.join("; "))
            }
        };
        let _ = writeln!(self.page, "- {told}\n");
    }

    fn paper(&mut self, folder: &str) {
        let paper = Paper::read(&root().join("proofs").join(folder)).expect("a paper");
        let systems: Vec<System> = paper
            .files
            .iter()
            .map(|file| System::read(&paper.folder.join(file)).expect("a proof file"))
            .collect();
        let claims = systems.iter().map(|system| system.claims.len()).sum::<usize>();
        let year = paper.year.map_or(String::new(), |year| format!(" ({year})"));
        let _ = writeln!(self.page, "## {}\n", paper.title);
        let first = systems.iter().find_map(|system| Some((system, branch_of(system)?)));
        let (system, branch) = first.expect("a system with a rank");
        self.diagram(folder, system, &branch);
        let _ = writeln!(
            self.page,
            "- {}{year}. [{} and {}](../../proofs/{folder}/). Diagram and rank: {}.",
            paper.authors.join(", "),
            counted(systems.len(), "proof file"),
            counted(claims, "claim"),
            system.title
        );
        self.lines(system, &branch);
    }

    fn model(&mut self, path: &Path) {
        let system = System::read(path).expect("a proof file");
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        let Some(branch) = branch_of(&system) else { return };
        let _ = writeln!(self.page, "## {}\n", system.title);
        self.diagram(&name, &system, &branch);
        let cite = system.cite.as_ref().map_or(String::new(), |cite| format!("{cite}. "));
        let _ = writeln!(self.page, "- {cite}[{name}.proof](../../proofs/benchmarks/{name}.proof).");
        self.lines(&system, &branch);
    }
}

#[test]
fn the_gallery_is_what_the_program_finds() {
    let mut gallery = Gallery { page: HEAD.to_owned(), pictures: Vec::new() };
    gallery.page.push_str("# Papers\n\n");
    PAPERS.iter().for_each(|paper| gallery.paper(paper));
    gallery.page.push_str("# Models that people know\n\n");
    let folder = root().join("proofs/benchmarks");
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| file.extension().is_some_and(|end| end == "proof"));
    files.sort();
    assert_eq!(files.len(), 40);
    files.iter().for_each(|file| gallery.model(file));
    assert_eq!(gallery.page.matches("\n## ").count(), PAPERS.len() + files.len());
    // a picture and three lines each
    for entry in gallery.page.split("\n## ").skip(1) {
        let count = |begin: &str| entry.lines().filter(|line| line.starts_with(begin)).count();
        assert_eq!((count("!["), count("- ")), (1, 3), "{entry}");
    }
    let (page, pictures) = (root().join("book/src/gallery.md"), root().join("book/src/pictures/gallery"));
    let page_text = gallery.page.trim_end().to_owned() + "\n";
    if std::env::var("PALMISTRY_BOOK").is_ok_and(|word| word == "renew") {
        std::fs::create_dir_all(&pictures).unwrap();
        std::fs::write(&page, &page_text).unwrap();
        gallery
            .pictures
            .iter()
            .for_each(|(name, picture)| std::fs::write(pictures.join(name), picture).unwrap());
    }
    assert!(
        std::fs::read_to_string(&page).unwrap() == page_text,
        "book/src/gallery.md is not what the program finds: renew it"
    );
    for (name, picture) in &gallery.pictures {
        assert!(std::fs::read_to_string(pictures.join(name)).unwrap() == *picture, "{name}: renew it");
    }
    let files = std::fs::read_dir(&pictures).unwrap().count();
    assert_eq!(files, gallery.pictures.len(), "a picture of nothing in book/src/pictures/gallery");
}
