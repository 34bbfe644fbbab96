//! `palmistry --version`, and with `--verbose` what was built and what it uses on this machine.

use palmistry::number::Instructions;

/// The version in a line, or more of it.
pub(crate) fn text(verbose: bool) -> String {
    let line = concat!("palmistry ", env!("CARGO_PKG_VERSION"));
    if !verbose {
        return line.to_owned();
    }
    let processor = match Instructions::detect() {
        Instructions::Portable => "no vector instructions",
        Instructions::Avx2 => "vectors of four doubles (AVX2)",
        Instructions::Avx512 => "vectors of eight doubles (AVX-512)",
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let rows = [
        ("commit", env!("PALMISTRY_COMMIT").to_owned()),
        ("compiler", env!("PALMISTRY_COMPILER").to_owned()),
        ("target", env!("PALMISTRY_TARGET").to_owned()),
        ("features", "cli, report, parquet".to_owned()),
        (
            "numbers",
            "single and double precision, double-doubles, up to 200 digits, intervals, residues, exact rationals"
                .to_owned(),
        ),
        ("processor", format!("{}: {processor}; threads: {threads}", std::env::consts::ARCH)),
    ];
    let rows: Vec<String> = rows.iter().map(|(name, value)| format!("  {name:<10} {value}")).collect();
    format!("{line}\n{}", rows.join("\n"))
}
