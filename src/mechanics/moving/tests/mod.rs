//! Bodies in motion against closed forms, laws of conservation and the 320-bit floor.

mod curved;
mod motions;
mod shapes;
mod witness;
