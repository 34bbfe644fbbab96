//! Columns that drive the model and change in steps: between samples a polynomial through a step is no command that anybody gave.

use super::run::Experiment;
use palmistry_observe::{Interpolation, Task};

/// A column changes in steps where at least so many of its changes stand between samples at which it does not change.
const ISOLATED: f64 = 0.8;

/// And where it changes from one sample to the next in no more than this part of them.
const SELDOM: f64 = 0.5;

impl Experiment {
    /// A remark where columns that drive the model change in steps and are not held between samples.
    pub(super) fn steps_between_samples(&self, task: &Task<'_>) -> Option<String> {
        if self.scene.data.interpolation == Interpolation::Hold {
            return None;
        }
        let names = task.full.columns.iter().filter(|place| is_stepped(self.signals.column(**place)));
        let names: Vec<String> = names
            .map(|place| &self.signals.names()[*place])
            .filter(|name| !task.full.outputs.contains(name))
            .map(|name| format!("'{name}'"))
            .collect();
        (!names.is_empty()).then(|| {
            format!(
                "{} {} in steps, and what lies between the samples of a step is interpolated: where a value is held until the next one, say interpolation = \"hold\" under [data]",
                names.join(", "),
                if names.len() == 1 { "changes" } else { "change" }
            )
        })
    }
}

/// Whether a column jumps now and then, and rests in between.
fn is_stepped(column: &[f64]) -> bool {
    let changes: Vec<bool> = column.windows(2).map(|pair| pair[0] != pair[1]).collect();
    let all = changes.iter().filter(|changes| **changes).count();
    let rests =
        |place: Option<usize>| place.and_then(|place| changes.get(place)).is_none_or(|changes| !changes);
    let is_alone = |place: &usize| changes[*place] && rests(place.checked_sub(1)) && rests(Some(place + 1));
    let alone = (0..changes.len()).filter(is_alone).count();
    all > 0 && all as f64 <= SELDOM * changes.len() as f64 && alone as f64 >= ISOLATED * all as f64
}

#[cfg(test)]
mod tests {
    use super::is_stepped;

    #[test]
    fn steps_are_told_from_what_moves_or_rests() {
        let of = |value: &dyn Fn(usize) -> f64| (0..60).map(value).collect::<Vec<f64>>();
        assert!(is_stepped(&of(&|i| f64::from(i as u32 / 5 % 2))));
        assert!(is_stepped(&of(&|i| if i < 30 { 0.0 } else { 2.0 })));
        assert!(!is_stepped(&of(&|_| 3.0)));
        assert!(!is_stepped(&of(&|i| (0.1 * i as f64).sin())));
        // moves, and comes to rest
        assert!(!is_stepped(&of(&|i| (i as f64).min(30.0))));
        assert!(!is_stepped(&[]) && !is_stepped(&[1.0]));
    }
}
