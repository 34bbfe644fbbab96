//! All readings at once against what windows make of theirs: both are of one body.

use super::super::recovered::{Contradiction, WholeMotion};
use super::super::run::Answer;
use palmistry_bodies::shape::Measured;
use palmistry_observe::Update;

/// So many deviations are not chance.
const CERTAIN: f64 = 5.0;

/// What interpolation between samples leaves of a value.
const COMPUTED: f64 = 1e-7;

/// The windows that the readings bear out, without those that are too far from a neighbour: which of the two is wrong is not known.
fn windows_at_one(updates: &[Update]) -> impl Iterator<Item = &Update> {
    let is_open =
        |place: usize| updates.get(place).and_then(|own| own.seam).is_some_and(|seam| seam.is_open());
    let is_at_one =
        move |place: usize| updates[place].is_borne_out() && !is_open(place) && !is_open(place + 1);
    (0..updates.len()).filter(move |place| is_at_one(*place)).map(|place| &updates[place])
}

/// What windows that fit and meet their neighbours contradict most of a motion; none where they bear it out. Both come from the same readings, so that the variance of their difference is no larger than the sum of theirs.
pub(super) fn contradiction(names: &[&str], answer: &Answer, whole: &WholeMotion) -> Option<Contradiction> {
    let mut worst: Option<(f64, Contradiction)> = None;
    for update in windows_at_one(&answer.track.updates) {
        let row = whole.samples.binary_search_by(|sample| sample.time.total_cmp(&update.from));
        let Some(sample) = row.ok().and_then(|row| whole.samples.get(row)) else { continue };
        let told = [("r1", sample.radii[0]), ("r2", sample.radii[1]), ("omega0", sample.omega0)];
        for (name, of_all) in told {
            let Some(place) = names.iter().position(|other| *other == name) else { continue };
            let by_window = Measured { value: update.estimate[place], deviation: update.deviations[place] };
            let computed = COMPUTED * by_window.value.abs();
            let deviation = by_window.deviation.hypot(of_all.deviation).hypot(computed);
            let off = (by_window.value - of_all.value).abs() / deviation;
            if off > CERTAIN && worst.as_ref().is_none_or(|(most, _)| off > *most) {
                let found = Contradiction { time: update.from, name: name.to_owned(), by_window, of_all };
                worst = Some((off, found));
            }
        }
    }
    worst.map(|(_, found)| found)
}
