//! Can it be seen? Ranks at states and on boxes, how fast, how exactly, and where numbers break.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/picture.rs"]
mod picture;

mod accessible;
mod certify;
mod certify_domains;
mod certify_verdicts;
mod design;
mod discrete;
mod given;
mod identifiable_functions;
mod models;
mod neighbours;
mod observable;
mod orbits;
mod parts;
mod rank_edges;
mod region_edges;
mod solutions;
mod stream;
mod stress;
mod trade;
mod unseen_fields;
