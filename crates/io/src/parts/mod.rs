//! Parts of a long computation that several machines share: each a text that is sealed, and stretches that together are all of it.

mod cover;
mod sealed;

pub use cover::{NoCover, in_order};
pub use sealed::{Bits, CONTRADICTS, PartError, seal, unseal};
