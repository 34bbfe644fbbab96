//! The proof files that verdicts are about, read when they are asked for and once.

use palmistry_io::file::Checksum;
use palmistry_lang::System;
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

/// A system, or as text why its file was not read.
type Source = Result<Arc<System>, String>;

/// Where proof files are read from.
#[derive(Debug, Default)]
pub struct ProofSources {
    folder: PathBuf,
    known: Mutex<HashMap<String, Source>>,
}

impl ProofSources {
    /// Files in a folder, by the names that verdicts give them.
    pub fn below(folder: PathBuf) -> Self {
        ProofSources { folder, known: Mutex::default() }
    }

    /// Systems that were read already, by their names; no files are read.
    pub fn given(systems: impl IntoIterator<Item = System>) -> Self {
        let known = systems.into_iter().map(|system| (system.name.clone(), Ok(Arc::new(system))));
        ProofSources { folder: PathBuf::new(), known: Mutex::new(known.collect()) }
    }

    /// The system of a file.
    pub(super) fn system(&self, name: &str) -> Source {
        // one after the other: two verdicts of a file wait for one reading of it
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(source) = known.get(name) {
            return source.clone();
        }
        let found = System::read(&self.folder.join(name)).map(Arc::new).map_err(|why| why.to_string());
        known.insert(name.to_owned(), found.clone());
        found
    }
}

/// The digest of a proof file's text, by which a verdict on another text is noticed. It is no signature.
pub fn source_digest(text: &str) -> String {
    format!("{:016x}", Checksum::of(text))
}
