//! Does the published physics hold for real bodies?
//!
//! The motions come from `palmistry::mechanics`, which knows no formula of the thesis. The formulas are
//! copied from the thesis (scanning faults mended, known errata in their true form, and the printed form
//! shown to fail), or read from `general.proof`. Every state is drawn from a fixed seed.

mod balance;
mod bounds;
mod chapter3;
mod chapter4;
mod chapter5;
mod circular;
mod drawn;
mod quaternions;
mod sheet;
mod spatial;
mod spheres;
mod terrain;
