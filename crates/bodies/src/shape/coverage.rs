//! Which normals of a body were touched.

use std::f64::consts::TAU;

/// The normals that were touched, as parts of a turn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Coverage {
    /// From where to where, in rad: increasing, disjoint, the first end in `[0, 2 pi)`. One that goes past a turn ends beyond it.
    pub touched: Vec<[f64; 2]>,
}

impl Coverage {
    /// Of the paths of contacts over a body: each is the angle of the normal at one sample after the other, in rad. A contact slides and does
    /// not jump: what lies between two samples was touched. Angles are as continuous as the contact is, not reduced to a turn.
    pub fn of_paths<'a>(paths: impl IntoIterator<Item = &'a [f64]>) -> Coverage {
        let mut arcs: Vec<[f64; 2]> = Vec::new();
        for path in paths {
            let finite = || path.iter().copied().filter(|angle| angle.is_finite());
            let (low, high) =
                finite().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), a| (low.min(a), high.max(a)));
            if low > high {
                continue;
            }
            if high - low >= TAU {
                return Coverage { touched: vec![[0.0, TAU]] };
            }
            let start = low.rem_euclid(TAU);
            arcs.push([start, start + (high - low)]);
        }
        Coverage::of_arcs(arcs)
    }

    fn of_arcs(mut arcs: Vec<[f64; 2]>) -> Coverage {
        arcs.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let mut touched: Vec<[f64; 2]> = Vec::new();
        for arc in arcs {
            match touched.last_mut() {
                Some(last) if arc[0] <= last[1] => last[1] = last[1].max(arc[1]),
                _ => touched.push(arc),
            }
        }
        // what goes past a turn may reach the first ones
        while touched.len() > 1
            && let (Some(last), Some(first)) = (touched.last().copied(), touched.first().copied())
            && last[1] >= first[0] + TAU
        {
            touched.remove(0);
            if let Some(end) = touched.last_mut() {
                end[1] = end[1].max(first[1] + TAU);
            }
        }
        if touched.len() == 1 && touched[0][1] - touched[0][0] >= TAU {
            touched = vec![[0.0, TAU]];
        }
        Coverage { touched }
    }

    /// The part of all normals that were touched, from 0 to 1.
    pub fn fraction(&self) -> f64 {
        (self.touched.iter().map(|[from, to]| to - from).sum::<f64>() / TAU).min(1.0)
    }

    /// What was not touched: from where to where, in rad, the first end in `[0, 2 pi)`.
    pub fn gaps(&self) -> Vec<[f64; 2]> {
        let (Some(first), count) = (self.touched.first(), self.touched.len()) else {
            return vec![[0.0, TAU]];
        };
        let next = |i: usize| if i + 1 < count { self.touched[i + 1][0] } else { first[0] + TAU };
        let gaps = (0..count).map(|i| [self.touched[i][1], next(i)]).filter(|[from, to]| to > from);
        gaps.map(|[from, to]| [from.rem_euclid(TAU), from.rem_euclid(TAU) + (to - from)]).collect()
    }

    /// Whether a normal was touched.
    pub fn contains(&self, angle: f64) -> bool {
        let angle = angle.rem_euclid(TAU);
        self.touched.iter().any(|[from, to]| (from..=to).contains(&&angle) || angle + TAU <= *to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two arcs of 1 rad that overlap by half, and one across the end of the turn, by hand.
    #[test]
    fn arcs_are_joined_across_the_turn() {
        let paths: [&[f64]; 3] = [&[1.0, 1.4, 2.0], &[2.5, 1.5], &[-0.25, 0.5]];
        let coverage = Coverage::of_paths(paths);
        assert!((coverage.fraction() - (1.5 + 0.75) / TAU).abs() < 1e-15);
        let gaps = coverage.gaps();
        assert_eq!(gaps.len(), 2, "{gaps:?}");
        assert!((gaps[0][0] - 2.5).abs() < 1e-15 && (gaps[0][1] - (TAU - 0.25)).abs() < 1e-14);
        assert!((gaps[1][0] - 0.5).abs() < 1e-14 && (gaps[1][1] - 1.0).abs() < 1e-14);
        assert!(coverage.contains(0.2) && coverage.contains(-0.2) && coverage.contains(TAU + 1.1));
        assert!(!coverage.contains(0.7) && !coverage.contains(3.0));
    }

    #[test]
    fn nothing_and_everything() {
        let nothing = Coverage::of_paths(std::iter::empty());
        assert_eq!((nothing.fraction(), nothing.gaps()), (0.0, vec![[0.0, TAU]]));
        assert_eq!(Coverage::of_paths([&[f64::NAN][..]]).fraction(), 0.0);
        // two halves that overlap at both ends
        for paths in [[&[0.0, 7.0][..], &[1.0]], [&[3.0, 6.4], &[0.0, 3.1]], [&[-0.1, 3.2], &[3.1, 6.3]]] {
            let coverage = Coverage::of_paths(paths);
            assert_eq!((coverage.fraction(), coverage.gaps()), (1.0, Vec::new()), "{paths:?}");
            assert!((0..100).all(|i| coverage.contains(f64::from(i))));
        }
    }
}
