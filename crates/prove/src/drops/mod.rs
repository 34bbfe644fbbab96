//! Where the rank drops: the exact set, and a proof that off it the rank is what it is at almost all states.
//!
//! All states are divided into cases. On each a minor is found that is not identically zero there, as a product of
//! factors; where none of these vanishes the rank is full, and where one does is a smaller case, which is followed in turn:
//! the equation is solved, put in, and another minor is looked for. A case ends where it is empty (an equation has no real
//! solution, or contradicts what does not vanish), where a minor has no factor left that could vanish, or where no minor is
//! found: there the rank is lower, and certainly so where the fields do not leave the set. The union of the cases of the last
//! kind is where the rank drops.
//!
//! Nothing is sampled: random points modulo primes only choose rows.

mod algebra;
mod case;
mod choice;
mod claim;
mod coordinates;
mod cover;
mod explore;
mod factors;
mod full;
mod lower;
mod merge;
mod minor;
mod on_box;
mod point;
mod real;
mod rows;
mod sets;
mod shown;

pub(crate) use claim::{ClaimedEverywhere, Everywhere, MinorIdentity, StatesOfCases, decide_everywhere};
pub(crate) use cover::NamedSet;
pub use on_box::BoxShare;
pub(crate) use on_box::share_of_the_box;
pub(crate) use rows::rows_up_to;
pub use sets::{
    DropAnswer, DropSet, UsedMinor, singular_set_at_once, where_it_drops, where_it_drops_telling,
};
