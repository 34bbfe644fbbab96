//! Windows that do not determine the state grow: their measurements are used again together with those that come next.
//!
//! A window in which an estimated state is unobservable holds or integrates, as the settings say. The next one is tried together with it, from what was known
//! before both; where that explains the measurements it is the answer, and else the window stands alone. So it goes on up to [`MOST`] windows, after which the
//! first ones are let go, so that no stream keeps more than that.

use super::inheritance::Anew;
use super::learned::{Learned, UninformativeWindows};
use super::task::Task;
use super::track::{Track, Update};
use super::{MovingWindow, weights};
use std::ops::Range;
use std::sync::Arc;

/// So many windows are taken together, at most.
pub const MOST: usize = 8;

impl MovingWindow {
    /// Whether an uninformative window is taken again with the next: not where each stands alone, is whole, or has a weight for each pair of its measurements.
    pub(super) fn may_grow(&self, task: &Task<'_>, clamped: &[usize]) -> bool {
        task.inherit && !task.whole && clamped.is_empty() && !weights::are_needed(task)
    }

    /// The update of a window together with the uninformative ones before it, where the measurements bear it out, and what was known before them.
    pub(super) fn grown_by_unobservable<'u>(
        &self,
        task: &Task<'_>,
        rows: &Range<usize>,
        unobserved: Option<&'u UninformativeWindows>,
        learned: &Learned,
        anew: &Anew<'_>,
        track: &mut Track,
    ) -> Option<(&'u UninformativeWindows, Update, Vec<Update>)> {
        let unobserved = unobserved?;
        let all = rows.start - unobserved.rows..rows.end;
        let before = Learned { is_asked: learned.is_asked, ..unobserved.before.clone() };
        // remarks of a failed attempt are dropped: the window then stands alone
        let mut told = Track::default();
        let (update, others) = self.next_update(task, &all, &[], &before, anew, &mut told);
        if !update.is_borne_out() {
            return None;
        }
        track.updates.extend(told.updates);
        track.remarks.extend(told.remarks);
        track.remarks.push(format!(
            "from {:.3} s a window alone determines too little: it has grown to {} samples",
            update.from,
            all.len()
        ));
        Some((unobserved, update, others))
    }

    /// What the next window takes as well, after one that is uninformative.
    pub(super) fn unobservable_after(
        &self,
        rows: &Range<usize>,
        unobserved: Option<&UninformativeWindows>,
        learned: &Learned,
        update: &Update,
        track: &mut Track,
    ) -> Option<Arc<UninformativeWindows>> {
        let own = rows.len() - 1;
        let alone =
            || UninformativeWindows { rows: own, before: Learned { unobserved: None, ..learned.clone() } };
        let next = match unobserved {
            Some(unobserved) if unobserved.rows + 2 * own <= MOST * self.window.max(2) => {
                UninformativeWindows { rows: unobserved.rows + own, before: unobserved.before.clone() }
            }
            Some(_) => {
                track.remarks.push(format!(
                    "by {:.3} s {MOST} windows together do not determine what is estimated: they grow anew from the last one on",
                    update.to
                ));
                alone()
            }
            None => alone(),
        };
        Some(Arc::new(next))
    }
}
