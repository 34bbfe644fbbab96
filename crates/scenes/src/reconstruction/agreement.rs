//! Compares the batch estimate of all measurements with the estimates of the windows: both are of one body.

use super::super::recovered::{Contradiction, WholeMotion, WholeSample};
use super::super::run::Answer;
use super::super::simulation::NOMINAL;
use palmistry_bodies::shape::Measured;
use palmistry_observe::{Seam, Update};

/// A difference of this many standard deviations is not chance.
const CERTAIN: f64 = 5.0;

/// The interpolation error of a value, relative to its maximum over the record: the measurements that drive the model are known at samples only.
const COMPUTED: f64 = 1e-7;

/// The same across a kink of the body's curvature, which the torques show: the tolerance for an exact fit of measurements without stated noise.
const KINKED: f64 = 1e-4;

/// A state of a motion at a sample.
type OfSample = fn(&WholeSample) -> Measured;

/// Whether each window agrees with its neighbours: not if a seam is open, nor if it has no closed seam where others have one. Which of two is wrong is not known.
fn are_at_one(updates: &[Update]) -> Vec<bool> {
    let meets = |place: usize| updates.get(place).and_then(|own| own.seam).map(|seam| !seam.is_open());
    let any = (0..updates.len()).any(|place| meets(place) == Some(true));
    let is_at_one = |place: usize| {
        let both = [meets(place), meets(place + 1)];
        !both.contains(&Some(false)) && (!any || both.contains(&Some(true)))
    };
    (0..updates.len()).map(is_at_one).collect()
}

/// The state in which a window differs most from a motion, in deviations of their difference. Both come from the same measurements, so that the variance of their difference is no
/// larger than the sum of theirs.
fn farthest(names: &[&str], update: &Update, whole: &WholeMotion) -> Option<(f64, Contradiction)> {
    let row = whole.samples.binary_search_by(|sample| sample.time.total_cmp(&update.from));
    let sample = whole.samples.get(row.ok()?)?;
    let of: [(&str, OfSample); 3] =
        [("r1", |at| at.radii[0]), ("r2", |at| at.radii[1]), ("omega0", |at| at.omega0)];
    let off = of.into_iter().filter_map(|(name, of)| {
        let of_all = of(sample);
        let most = whole.samples.iter().map(|at| of(at).value.abs()).fold(0.0, f64::max);
        let place = names.iter().position(|other| *other == name)?;
        let by_window = Measured { value: update.estimate[place], deviation: update.deviations[place] };
        let is_exact = !whole.stated && whole.rms_residual <= NOMINAL;
        let computed = if is_exact { KINKED * most } else { COMPUTED * most };
        let deviation = by_window.deviation.hypot(of_all.deviation).hypot(computed);
        let off = (by_window.value - of_all.value).abs() / deviation;
        let name = name.to_owned();
        (off > CERTAIN).then_some((off, Contradiction { time: update.from, name, by_window, of_all }))
    });
    off.max_by(|a, b| a.0.total_cmp(&b.0))
}

/// The largest contradiction between a motion and the windows that fit and agree with their neighbours; none where they bear it out.
pub(super) fn contradiction(names: &[&str], answer: &Answer, whole: &WholeMotion) -> Option<Contradiction> {
    let updates = &answer.track.updates;
    let windows = updates.iter().zip(are_at_one(updates));
    let at_one = windows.filter(|(update, at_one)| *at_one && update.is_borne_out());
    let off = at_one.filter_map(|(update, _)| farthest(names, update, whole));
    off.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, found)| found)
}

/// Windows that fit but contradict the batch estimate of all measurements: each ended in a local minimum. They are compared with it as with a neighbour.
pub(super) fn strays(names: &[&str], answer: &Answer, whole: &WholeMotion) -> Vec<(usize, Seam, String)> {
    let windows = answer.track.updates.iter().enumerate().filter(|(_, update)| update.is_borne_out());
    let stray = windows.filter_map(|(place, update)| {
        let (off, found) = farthest(names, update, whole)?;
        let own = Seam::of_any_correlation(update.from, [&[0.0], &[0.0]], [&[off], &[1.0]])?;
        let why = format!(
            "from {:.3} s {} is {off:.0} standard deviations from the batch estimate of all measurements: this window ended in a local minimum",
            update.from, found.name
        );
        Some((place, own, why))
    });
    stray.collect()
}
