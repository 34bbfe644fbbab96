//! Surfaces in space on a page: a picture that stands still by itself, and turns under a pointer that drags it with a few lines of script.

use super::document::{TURNING, document};
use maud::{Markup, PreEscaped, html};
use nalgebra::Vector3;
use palmistry_bodies::shape::sphere::SurfaceMesh;
use std::fmt::Write;

/// What turns pictures; one on a page is enough.
pub(super) const SCRIPT: &str = TURNING;

/// The direction from which a picture is shown at first, in rad: the azimuth, and the height above the horizon.
const TURN: f64 = 0.9;
const RISE: f64 = 0.35;

/// A surface with a name and how it is drawn.
pub struct ShownSurface<'a> {
    /// What it is, for the legend.
    pub name: &'a str,
    /// A colour of CSS.
    pub colour: &'a str,
    /// The surface.
    pub surface: &'a SurfaceMesh,
}

/// A page about surfaces: a title, rows of a table (what, and its value as text), and their picture.
///
/// It is one file with nothing from elsewhere.
pub fn solid_page(title: &str, rows: &[(String, String)], surfaces: &[ShownSurface]) -> String {
    let content = html! {
        main {
            h1 { (title) }
            table {
                tbody { @for (what, value) in rows { tr { th scope="row" { (what) } td { (value) } } } }
            }
            (turnable_picture(title, surfaces))
            script { (PreEscaped(SCRIPT)) }
        }
    };
    document(title, &content, false)
}

/// The picture of surfaces, edges that are hidden by their own surface fainter. It is turned by the script of the page.
pub(super) fn turnable_picture(title: &str, surfaces: &[ShownSurface]) -> Markup {
    let corners = || surfaces.iter().flat_map(|shown| &shown.surface.corners);
    let count = corners().count().max(1) as f64;
    let middle = corners().sum::<Vector3<f64>>() / count;
    let reach = corners().map(|corner| (corner - middle).norm()).fold(0.0, f64::max);
    let unit = if reach > 0.0 && reach.is_finite() { reach } else { 1.0 };
    let parts: Vec<Part> = surfaces
        .iter()
        .map(|shown| Part {
            corners: shown.surface.corners.iter().map(|corner| rounded((corner - middle) / unit)).collect(),
            polygons: &shown.surface.polygons,
        })
        .collect();
    let data = serde_json::to_string(&parts).unwrap_or_default();
    html! {
        figure {
            svg class="solid" viewBox="-1.05 -1.05 2.1 2.1" width="560" height="560" role="img" aria-label=(title)
                data-turn=(TURN) data-rise=(RISE) data-solid=(data) {
                @for (part, shown) in parts.iter().zip(surfaces) {
                    @let [hidden, seen] = part.projected(TURN, RISE);
                    path d=(hidden) fill="none" stroke=(shown.colour) stroke-width="0.002" stroke-opacity="0.2" {}
                    path d=(seen) fill="none" stroke=(shown.colour) stroke-width="0.004" stroke-opacity="0.8" {}
                }
            }
            figcaption {
                @for (place, shown) in surfaces.iter().enumerate() {
                    @if place > 0 { ", " }
                    // a colour as an attribute: the page allows no style but its own
                    svg width="10" height="10" role="img" aria-label={ "the colour of " (shown.name) } {
                        rect width="10" height="10" fill=(shown.colour) {}
                    }
                    " " (shown.name)
                }
                ". Drag to turn it."
            }
        }
    }
}

#[derive(serde::Serialize)]
struct Part<'a> {
    corners: Vec<[f64; 3]>,
    polygons: &'a [Vec<usize>],
}

fn rounded(place: Vector3<f64>) -> [f64; 3] {
    [place.x, place.y, place.z].map(|value| (value * 1e4).round() / 1e4)
}

impl Part<'_> {
    /// The paths of polygons that show their back, and of those that show their front.
    fn projected(&self, turn: f64, rise: f64) -> [String; 2] {
        let ((s, c), (t, d)) = (turn.sin_cos(), rise.sin_cos());
        let seen: Vec<[f64; 2]> =
            self.corners.iter().map(|[x, y, z]| [c * y - s * x, t * (c * x + s * y) - d * z]).collect();
        let mut sides = [String::new(), String::new()];
        for polygon in self.polygons {
            let next = polygon.iter().cycle().skip(1);
            let area: f64 = polygon
                .iter()
                .zip(next)
                .map(|(a, b)| seen[*a][0] * seen[*b][1] - seen[*a][1] * seen[*b][0])
                .sum();
            // the picture's second axis points downward: a front goes round the other way
            let path = &mut sides[usize::from(area < 0.0)];
            for (place, corner) in polygon.iter().enumerate() {
                let [x, y] = seen[*corner];
                let _ = write!(path, "{}{x:.3} {y:.3}", if place == 0 { "M" } else { "L" });
            }
            path.push('Z');
        }
        sides
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palmistry_bodies::shape::sphere::{SurfaceTouch, contact_hull};

    /// Of a cube three faces are visible from a corner, and three are not: each triangle of the hull is in one path.
    #[test]
    fn a_cube_shows_three_of_its_faces() {
        let touches: Vec<SurfaceTouch> = (0..8)
            .map(|i| Vector3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)))
            .map(|point| SurfaceTouch { point, normal: Vector3::x() })
            .collect();
        let surface = contact_hull(&touches).unwrap().surface;
        let corners = surface.corners.iter().map(|corner| rounded(corner - Vector3::repeat(0.5))).collect();
        let part = Part { corners, polygons: &surface.polygons };
        let [hidden, seen] = part.projected(TURN, RISE).map(|path| path.matches('M').count());
        assert_eq!((hidden, seen), (6, 6));
        // from straight above two triangles are visible, two are not, and the sides are lines
        let [_, top] = part.projected(0.3, std::f64::consts::FRAC_PI_2);
        let above: Vec<&str> = top.split('M').skip(1).collect();
        assert!(above.len() >= 2);

        let shown = ShownSurface { name: "hull", colour: "steelblue", surface: &surface };
        let page = solid_page("A cube", &[("volume".to_owned(), "1 m^3".to_owned())], &[shown]);
        assert_eq!(page.matches("<path").count(), 2);
        assert!(page.contains("data-solid=") && page.contains("pointermove") && page.contains("1 m^3"));
    }
}
