//! Bodies in motion against closed forms, laws of conservation and the 320-bit floor.

mod curved;
mod friction;
mod motions;
mod shapes;
mod witness;
