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

/// A line through points, by steps.
pub(super) fn track(points: &[(i32, i32)]) -> String {
    let Some(first) = points.first() else { return String::new() };
    let mut path = format!("M{} {}", first.0, first.1);
    match points {
        [_, last] if last.0 == first.0 => return format!("{path}v{}", last.1 - first.1),
        [_, last] if last.1 == first.1 => return format!("{path}h{}", last.0 - first.0),
        _ => {}
    }
    let mut steps = String::new();
    for (from, to) in points.iter().zip(&points[1..]) {
        for value in [to.0 - from.0, to.1 - from.1] {
            if value >= 0 && !steps.is_empty() {
                steps.push(' ');
            }
            let _ = write!(steps, "{value}");
        }
    }
    if !steps.is_empty() {
        let _ = write!(path, "l{steps}");
    }
    path
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
}
