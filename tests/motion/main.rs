//! Bodies in motion and observers that recover them.

#[path = "../common/mod.rs"]
mod common;

mod implicit;
mod mechanics;
mod observe;
mod observers;
mod regimes;
mod slow;
mod space;
