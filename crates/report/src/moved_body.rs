//! A body between two flat palms, in motion and in single poses, by the elements of SVG alone.

use std::fmt::Write;

const FIRST: &str = "#0072b2";
const SECOND: &str = "#d55e00";

/// A pose: orientation, centre of mass, the palms' angles against the horizontal and each other, the contacts along the palms. Radians and metres.
pub(super) struct MovedPose {
    pub phi0: f64,
    pub centre: [f64; 2],
    pub palms: [f64; 2],
    pub contacts: [f64; 2],
}

impl MovedPose {
    /// The palms' angles against the horizontal.
    fn angles(&self) -> [f64; 2] {
        [self.palms[0], self.palms[0] + self.palms[1]]
    }
}

fn path(points: &[[f64; 2]], scale: f64) -> String {
    let mut out = String::new();
    for (i, [x, y]) in points.iter().enumerate() {
        let _ = write!(out, "{}{:.1},{:.1}", if i == 0 { "M" } else { "L" }, x * scale, -y * scale);
    }
    out.push('Z');
    out
}

/// Samples that are shown, evenly.
pub(super) fn rows(count: usize, most: usize) -> Vec<usize> {
    let shown = count.min(most);
    (0..shown).map(|i| if shown < 2 { 0 } else { i * (count - 1) / (shown - 1) }).collect()
}

/// The body and its palms in motion, over and over; the outline in its own frame about the centre of mass.
pub(super) fn moved_body(points: &[[f64; 2]], poses: &[MovedPose]) -> String {
    if poses.len() < 2 || points.is_empty() {
        return "<p>There is no motion to show.</p>".to_owned();
    }
    let reach = points.iter().map(|[x, y]| x.hypot(*y)).fold(0.0, f64::max);
    let far = poses.iter().map(|at| at.centre[0].hypot(at.centre[1])).fold(0.0, f64::max) + reach;
    let scale = 210.0 / far;
    let join = |of: &dyn Fn(&MovedPose) -> String| poses.iter().map(of).collect::<Vec<_>>().join(";");
    let degrees = |angle: f64| -angle.to_degrees();
    let duration = "dur=\"12s\" repeatCount=\"indefinite\" calcMode=\"linear\"";
    let palm = |which: usize, colour: &str| {
        format!(
            "<line x1=\"0\" y1=\"0\" x2=\"{:.0}\" y2=\"0\" stroke=\"{colour}\" stroke-width=\"4\"><animateTransform attributeName=\"transform\" type=\"rotate\" values=\"{}\" {duration}/></line>",
            1.1 * far * scale,
            join(&|at| format!("{:.2}", degrees(at.angles()[which])))
        )
    };
    let moved = join(&|at| format!("{:.1} {:.1}", at.centre[0] * scale, -at.centre[1] * scale));
    let rotated = join(&|at| format!("{:.2}", degrees(at.phi0)));
    let contact = |which: usize| {
        let place = |at: &MovedPose| {
            let (sine, cosine) = at.angles()[which].sin_cos();
            [at.contacts[which] * cosine * scale, -at.contacts[which] * sine * scale]
        };
        format!(
            "<circle r=\"4\" fill=\"#c8283c\"><animate attributeName=\"cx\" values=\"{}\" {duration}/><animate attributeName=\"cy\" values=\"{}\" {duration}/></circle>",
            join(&|at| format!("{:.1}", place(at)[0])),
            join(&|at| format!("{:.1}", place(at)[1]))
        )
    };
    format!(
        "<svg role=\"img\" aria-label=\"The body and its palms in motion\" viewBox=\"-250 -230 500 260\" width=\"500\" height=\"260\">{}{}\
         <g><animateTransform attributeName=\"transform\" type=\"translate\" values=\"{moved}\" {duration}/>\
         <g><animateTransform attributeName=\"transform\" type=\"rotate\" values=\"{rotated}\" {duration}/>\
         <path d=\"{}\" fill=\"#9cbfd8\" fill-opacity=\"0.6\" stroke=\"{FIRST}\"/><circle r=\"3\" fill=\"#282c34\"/><line x1=\"0\" y1=\"0\" x2=\"{:.1}\" y2=\"0\" stroke=\"#282c34\"/></g></g>{}{}</svg>",
        palm(0, FIRST),
        palm(1, SECOND),
        path(points, scale),
        0.6 * reach * scale,
        contact(0),
        contact(1),
    )
}

/// One pose, the centre of mass in the middle; `size` is a mean radius.
pub(super) fn still_body(points: &[[f64; 2]], at: &MovedPose, size: f64) -> String {
    let scale = 48.0 / size;
    let place = |[x, y]: [f64; 2]| [scale * (x - at.centre[0]), -scale * (y - at.centre[1])];
    let mut out = String::from(
        "<svg role=\"img\" aria-label=\"The body between its palms\" viewBox=\"-100 -90 200 180\" width=\"200\" height=\"180\">",
    );
    for (angle, colour) in at.angles().into_iter().zip([FIRST, SECOND]) {
        // what lies outside is cut off by the picture's own frame
        let ends = [0.0, 20.0 * size].map(|far| place([far * angle.cos(), far * angle.sin()]));
        let _ = write!(
            out,
            "<path d=\"M{:.1},{:.1}L{:.1},{:.1}\" stroke=\"{colour}\" stroke-width=\"3\"/>",
            ends[0][0], ends[0][1], ends[1][0], ends[1][1]
        );
    }
    let (sine, cosine) = at.phi0.sin_cos();
    let turned: Vec<[f64; 2]> =
        points.iter().map(|[x, y]| [cosine * x - sine * y, sine * x + cosine * y]).collect();
    let _ = write!(
        out,
        "<path d=\"{}\" fill=\"#9cbfd8\" fill-opacity=\"0.6\" stroke=\"{FIRST}\"/><circle r=\"3\" fill=\"#282c34\"/><path d=\"M0,0L{:.1},{:.1}\" stroke=\"#282c34\"/>",
        path(&turned, scale),
        0.6 * 48.0 * cosine,
        -0.6 * 48.0 * sine
    );
    for (which, angle) in at.angles().into_iter().enumerate() {
        let [x, y] = place([at.contacts[which] * angle.cos(), at.contacts[which] * angle.sin()]);
        let _ = write!(out, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.5\" fill=\"#c8283c\"/>");
    }
    out.push_str("</svg>");
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    /// A disc of radius 1 between palms at 45 and 135 degrees, by hand: its middle is the square root of two over the joint, both contacts are 1 from it. Each palm is drawn on the line
    /// that has the distance 48 from the middle, wherever its ends are.
    #[test]
    fn palms_are_drawn_where_they_touch() {
        let points: Vec<[f64; 2]> =
            (0..90).map(|i| (f64::from(i) * 4.0).to_radians().sin_cos().into()).collect();
        let at = MovedPose {
            phi0: 0.3,
            centre: [0.0, 2f64.sqrt()],
            palms: [FRAC_PI_2 / 2.0, FRAC_PI_2],
            contacts: [1.0; 2],
        };
        let drawn = still_body(&points, &at, 1.0);
        let lines: Vec<Vec<f64>> = drawn
            .split("<path d=\"M")
            .skip(1)
            .filter(|part| part.contains("stroke-width"))
            .map(|part| {
                part.split('"').next().unwrap_or("").split(['L', ',']).map(|x| x.parse().unwrap()).collect()
            })
            .collect();
        assert_eq!(lines.len(), 2);
        for line in lines {
            let [dx, dy] = [line[2] - line[0], line[3] - line[1]];
            let off = (line[0] * dy - line[1] * dx).abs() / dx.hypot(dy);
            assert!((off - 48.0).abs() < 0.1, "{off}");
        }
        assert!(
            drawn.contains("cx=\"33.9\" cy=\"33.9\"") && drawn.contains("cx=\"-33.9\" cy=\"33.9\""),
            "{drawn}"
        );
    }
}
