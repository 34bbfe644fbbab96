//! The program as its users meet it: papers, pages, files that are damaged, a process among others.

#[path = "../common/mod.rs"]
mod common;

mod appendix;
mod benchmarks;
mod columns;
mod coq;
mod damaged;
mod editors;
mod harm;
mod import;
#[cfg(unix)]
mod lab;
mod least;
mod observable_pictures;
mod page;
mod paper;
mod papers;
mod petab;
#[cfg(unix)]
mod process;
