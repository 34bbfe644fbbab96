//! A certificate as boxes, each with the rows of its minor, written down for the checker.

use crate::certificate::{HeldSymbol, ProvedBox, Region};
use dashu::integer::IBig;
use dashu::rational::RBig;
use palmistry_checker::Lowering;
use palmistry_checker::{
    CertifiedBox, CertifiedBoxes, ClaimKind, ClaimParts, Evidence, Missing, Ratio, RecordedWord, SymbolRange,
    VerdictFile, VerdictRecord, listed_statement, source_digest,
};
use palmistry_lang::System;
use std::collections::BTreeSet;
use std::sync::atomic::{AtomicBool, Ordering};

/// The checker's work on all boxes of a file, in operations on intervals: some seconds.
const EFFORT: u64 = 1 << 31;
/// And on one of them at least.
const LEAST_EFFORT: u64 = 1 << 20;

/// What was written of a certificate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WrittenBoxes {
    /// The boxes in the file.
    pub boxes: usize,
    /// How many of the largest proved boxes the checker's plain arithmetic does not confirm with bounded work: they are
    /// left out, so that the checker confirms all that is written.
    pub left_out: usize,
}

/// The largest proved boxes of a region, at most so many, as a file of one verdict; a file of none where no box is proved.
///
/// # Errors
/// Where there are more operations than a listing holds.
pub fn certificate_file(
    system: &System,
    region: &Region,
    most: usize,
    interrupt: &AtomicBool,
) -> Result<(VerdictFile, WrittenBoxes), Missing> {
    let proved = region.proved_boxes(most);
    let mut boxes = certified_boxes(system, region, &proved)?;
    let each = (EFFORT / (proved.len().max(1) as u64)).max(LEAST_EFFORT);
    let left_out = boxes.keep_what_is_shown(each, interrupt);
    let written = WrittenBoxes { boxes: boxes.boxes.len(), left_out };
    let evidence = if boxes.boxes.is_empty() {
        let why = if interrupt.load(Ordering::Relaxed) {
            "the run was interrupted before its boxes were checked"
        } else {
            "no box is proved that plain interval arithmetic shows, too"
        };
        Evidence::Unchecked(why.to_owned())
    } else {
        Evidence::Boxes(boxes)
    };
    let what = if region.is_of_own_rows() { ClaimKind::RowsOnBoxes } else { ClaimKind::SystemOnBoxes };
    let record = VerdictRecord {
        file: system.name.clone(),
        digest: source_digest(&system.source),
        id: "certify".to_owned(),
        statement: listed_statement(what, ""),
        asked: ClaimParts::listed(what, ""),
        verdict: RecordedWord::Found,
        evidence,
    };
    Ok((VerdictFile::new(0, vec![record]), written))
}

fn certified_boxes(
    system: &System,
    region: &Region,
    proved: &[ProvedBox],
) -> Result<CertifiedBoxes, Missing> {
    let used: BTreeSet<usize> = proved.iter().flat_map(|found| found.rows.iter().copied()).collect();
    let kept: Vec<usize> = used.into_iter().collect();
    let mut lowering = Lowering::new(&system.graph);
    let mut rows = Vec::new();
    for row in &kept {
        let entries = region.rows()[*row].entries.iter();
        rows.push(entries.map(|entry| lowering.place(*entry)).collect::<Result<Vec<_>, _>>()?);
    }
    let requirements =
        region.guards().iter().map(|guard| lowering.requirement(*guard)).collect::<Result<_, _>>()?;
    let name = |symbol| system.symbol_name(symbol).to_owned();
    let free = region.ranges().iter().map(|range| SymbolRange {
        symbol: range.name.clone(),
        angle: system.is_angle(range.symbol),
        low: Ratio(range.low.clone()),
        high: Ratio(range.high.clone()),
    });
    let held = region.held().iter().map(|HeldSymbol { symbol, value }| SymbolRange {
        symbol: name(*symbol),
        angle: system.is_angle(*symbol),
        low: Ratio(value.clone()),
        high: Ratio(value.clone()),
    });
    let boxes = proved.iter().map(|found| CertifiedBox {
        sides: found.sides.iter().map(|ends| ends.clone().map(Ratio)).collect(),
        rows: found.rows.iter().filter_map(|row| kept.binary_search(row).ok()).collect(),
    });
    Ok(CertifiedBoxes {
        columns: system.unknowns().iter().map(|state| name(*state)).collect(),
        row_names: kept.iter().map(|row| region.rows()[*row].name.clone()).collect(),
        rows,
        requirements,
        ranges: free.chain(held).collect(),
        boxes: boxes.collect(),
        volume: Ratio(RBig::ZERO),
        proved_boxes: Ratio(RBig::from(IBig::from(region.proved_box_count()))),
        proved_volume: Ratio(region.proved_exactly()),
        digest: String::new(),
        listing: lowering.finish(),
    })
}
