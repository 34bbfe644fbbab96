//! The program: see [`command`].

mod command;

/// Run by the system's loader before Rust's runtime begins: only then can be seen whether standard output is closed.
#[cfg(target_os = "linux")]
#[used]
#[unsafe(link_section = ".init_array")]
static BEFORE_THE_RUNTIME: extern "C" fn() = {
    extern "C" fn look() {
        palmistry::file::look_at_standard_output();
    }
    look
};

/// The papers under `proofs/`; see build.rs.
const PAPERS: &[palmistry::file::PackedFile] = include!(concat!(env!("OUT_DIR"), "/papers.rs"));

fn main() -> std::process::ExitCode {
    palmistry::file::pack(PAPERS);
    command::run()
}
