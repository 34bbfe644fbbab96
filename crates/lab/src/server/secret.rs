//! Names that nobody guesses.

/// A name of 128 random bits.
///
/// # Panics
/// Where the system has no random numbers.
pub(super) fn random_name() -> String {
    let mut bits = [0; 16];
    rand::TryRng::try_fill_bytes(&mut rand::rngs::SysRng, &mut bits).expect("the system has random numbers");
    bits.iter().map(|byte| format!("{byte:02x}")).collect()
}
