//! Lines through points in whole pixels, in few characters.

use std::fmt::Write;

/// Points that lie nearer to the line through those that are kept are left out, in pixels.
const NEAR: f64 = 0.8;

/// The points that a line needs, by the method of Ramer, Douglas and Peucker.
pub(super) fn simplified(points: &[(i32, i32)]) -> Vec<(i32, i32)> {
    let Some(last) = points.len().checked_sub(1) else { return Vec::new() };
    let mut kept = vec![false; points.len()];
    (kept[0], kept[last]) = (true, true);
    let mut open = vec![(0, last)];
    while let Some((begin, end)) = open.pop() {
        let away = |place: usize| distance(points[place], points[begin], points[end]);
        let farthest = (begin + 1..end).max_by(|a, b| away(*a).total_cmp(&away(*b)));
        if let Some(farthest) = farthest.filter(|place| away(*place) > NEAR) {
            kept[farthest] = true;
            open.extend([(begin, farthest), (farthest, end)]);
        }
    }
    points.iter().zip(kept).filter_map(|(point, kept)| kept.then_some(*point)).collect()
}

/// How far a point is from the stretch between two others.
fn distance(point: (i32, i32), from: (i32, i32), to: (i32, i32)) -> f64 {
    let vector = |a: (i32, i32), b: (i32, i32)| (f64::from(b.0 - a.0), f64::from(b.1 - a.1));
    let (along, reach) = (vector(from, to), vector(from, point));
    let length = along.0.hypot(along.1);
    if length == 0.0 {
        return reach.0.hypot(reach.1);
    }
    let part = ((reach.0 * along.0 + reach.1 * along.1) / (length * length)).clamp(0.0, 1.0);
    (reach.0 - part * along.0).hypot(reach.1 - part * along.1)
}

/// A part of a path.
pub(super) struct Stretch {
    from: (i32, i32),
    /// What is drawn from there, in steps.
    steps: String,
    to: (i32, i32),
}

impl Stretch {
    /// A part that ends where it began: what is drawn there goes around, or is a point.
    pub fn around(from: (i32, i32), steps: String) -> Self {
        Self { from, steps, to: from }
    }

    /// The line through points.
    pub fn through(points: &[(i32, i32)]) -> Self {
        let [from, .., to] = *points else {
            return Self::around(points.first().copied().unwrap_or_default(), String::new());
        };
        if let [_, _] = points {
            let straight = |steps: String| Self { from, steps, to };
            match (to.0 - from.0, to.1 - from.1) {
                (0, dy) => return straight(format!("v{dy}")),
                (dx, 0) => return straight(format!("h{dx}")),
                _ => {}
            }
        }
        let mut steps = "l".to_owned();
        for (from, to) in points.iter().zip(&points[1..]) {
            for value in [to.0 - from.0, to.1 - from.1] {
                let space = if value >= 0 && steps.len() > 1 { " " } else { "" };
                let _ = write!(steps, "{space}{value}");
            }
        }
        Self { from, steps, to }
    }

    /// The same line and back to where it began.
    pub fn closed(mut self) -> Self {
        self.steps.push('z');
        self.to = self.from;
        self
    }

    /// Writes it behind what ended somewhere, from there or from nought, whichever is shorter. Returns where it ends.
    pub fn write(&self, behind: Option<(i32, i32)>, out: &mut String) -> (i32, i32) {
        let (x, y) = self.from;
        let moved = |command: char, x: i32, y: i32| {
            let space = if y < 0 { "" } else { " " };
            format!("{command}{x}{space}{y}")
        };
        let far = moved('M', x, y);
        let near = behind.map(|(last_x, last_y)| moved('m', x - last_x, y - last_y));
        out.push_str(near.as_ref().filter(|near| near.len() < far.len()).unwrap_or(&far));
        out.push_str(&self.steps);
        self.to
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: what lies on a line goes, a corner stays, and so does the end of a line that turns back.
    #[test]
    fn a_line_keeps_its_corners() {
        let points = [(0, 0), (1, 0), (2, 0), (3, 3), (4, 6), (9, 6), (4, 6)];
        assert_eq!(simplified(&points), [(0, 0), (2, 0), (4, 6), (9, 6), (4, 6)]);
        assert_eq!(simplified(&[(3, 4)]), [(3, 4)]);
        assert_eq!(simplified(&[(5, 5), (5, 9), (5, 5)]), [(5, 5), (5, 9), (5, 5)]);
        assert!(simplified(&[]).is_empty());
    }

    /// By hand: dots near each other, a line behind them, and what is as short from nought.
    #[test]
    fn what_begins_near_an_end_is_told_from_there() {
        let dot = |x, y| Stretch::around((x, y), "h0".to_owned());
        let line = Stretch::through(&[(120, 300), (120, 310)]);
        let parts = [
            dot(100, 200),
            dot(104, 199),
            line,
            Stretch::through(&[(0, 0), (3, 4), (3, 0)]).closed(),
            dot(1, 1),
        ];
        let (mut path, mut end) = (String::new(), None);
        for part in parts {
            end = Some(part.write(end, &mut path));
        }
        assert_eq!(path, "M100 200h0m4-1h0m16 101v10M0 0l3 4 0-4zM1 1h0");
    }
}
