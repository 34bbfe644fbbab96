//! A picture as SVG for pages in light and dark: what plotters draws, with shapes of one look written as one path, colours that
//! follow the page, and numbers under the pointer.

mod element;
mod layer;
mod track;

use element::{Kind, Look, elements};
use layer::{Layer, layers};
use plotters::coord::Shift;
use plotters::prelude::*;
use std::fmt::Write;

/// What a picture has that stands alone; on a page the page has it.
pub(super) const STANDALONE: &str =
    " xmlns=\"http://www.w3.org/2000/svg\" color=\"#282c34\" font-family=\"system-ui,sans-serif\"";

/// Behind this mark the letters of a text stand below the line, as an index does, up to [`BACK`]: plotters knows plain texts alone.
pub(super) const BELOW: char = '\u{e000}';
/// Where an index ends.
pub(super) const BACK: char = '\u{e001}';

/// A text with its indices on the line, for places that hold plain texts alone.
pub(super) fn on_the_line(text: &str) -> String {
    text.replace(BELOW, "_").replace(BACK, "")
}

/// What is drawn on.
pub(super) type Drawing<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// The colour of texts and axes; on a page the ink of the page.
pub(super) const INK: RGBColor = RGBColor(40, 44, 52);
/// Lines behind a chart; on a page the colour of its rules.
pub(super) const MESH: RGBColor = RGBColor(225, 228, 232);
/// Texts that are less important; on a page those of the page.
pub(super) const SOFT: RGBColor = RGBColor(95, 100, 110);

/// A part of a picture over which the pointer shows a text: left, top, right, bottom, in pixels.
pub(super) struct Hover {
    pub corners: [i32; 4],
    pub text: String,
}

/// A field of cells of a few colours.
pub(super) struct Cells {
    /// Left, top, right, bottom, in pixels.
    pub corners: [i32; 4],
    pub columns: usize,
    /// By rows, from the top.
    pub colours: Vec<RGBColor>,
}

/// What a picture has beside what plotters draws.
#[derive(Default)]
pub(super) struct Extras {
    pub hovers: Vec<Hover>,
    /// Behind everything else.
    pub cells: Option<Cells>,
}

/// A picture that is to be drawn.
pub(super) struct Canvas<'a> {
    pub size: (u32, u32),
    /// What it shows, for those who cannot see it.
    pub title: &'a str,
    /// What stands behind the fields of a colour.
    pub by_colour: &'a [(RGBColor, String)],
    /// Whether its edges are those of cells, between which no gap may show.
    pub is_crisp: bool,
}

/// A picture without texts under the pointer.
pub(super) fn svg(
    size: (u32, u32),
    title: &str,
    draw: impl FnOnce(&Drawing<'_>) -> Result<(), Box<dyn std::error::Error>>,
) -> String {
    Canvas { size, title, by_colour: &[], is_crisp: false }.draw(|area, _| draw(area))
}

impl Canvas<'_> {
    /// Draws into a string. What cannot be drawn is said in its place.
    pub fn draw(
        &self,
        draw: impl FnOnce(&Drawing<'_>, &mut Extras) -> Result<(), Box<dyn std::error::Error>>,
    ) -> String {
        let mut text = String::new();
        let mut extras = Extras::default();
        let result = {
            let area = SVGBackend::with_string(&mut text, self.size).into_drawing_area();
            draw(&area, &mut extras).and_then(|()| area.present().map_err(Into::into))
        };
        match result {
            Ok(()) => self.written(&text, &extras),
            Err(error) => format!("<p>this plot could not be drawn: {}</p>", escaped(&error.to_string())),
        }
    }

    fn written(&self, text: &str, Extras { hovers, cells }: &Extras) -> String {
        let (width, height) = self.size;
        let mut out = format!(
            "<svg role=\"img\" aria-label=\"{}\"{STANDALONE} viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
             height=\"{height}\"{}>",
            escaped(&on_the_line(self.title)),
            if self.is_crisp { " shape-rendering=\"crispEdges\"" } else { "" }
        );
        if let Some(cells) = cells {
            self.cells(cells, &mut out);
        }
        for Layer { look, drawn, .. } in layers(elements(text).filter_map(|element| element.shape())) {
            // beside cells the fields of a colour are those of its scale, which has numbers
            let by_colour = if cells.is_some() { &[] } else { self.by_colour };
            finish(&look, &drawn, by_colour, &mut out);
        }
        if !hovers.is_empty() {
            out.push_str("<g fill=\"#0000\">");
            for Hover { corners: [left, top, right, bottom], text } in hovers {
                let (wide, high) = (right - left, bottom - top);
                let _ = write!(
                    out,
                    "<path d=\"M{left} {top}h{wide}v{high}h-{wide}z\"><title>{}</title></path>",
                    escaped(text)
                );
            }
            out.push_str("</g>");
        }
        out.push_str("</svg>");
        out
    }

    /// Cells as lines as wide as a cell is high, neighbours of one colour together: a path a colour, in whole numbers of cells.
    fn cells(&self, cells: &Cells, out: &mut String) {
        let [left, top, right, bottom] = cells.corners.map(f64::from);
        let rows = cells.colours.len() / cells.columns.max(1);
        let (wide, high) = ((right - left) / cells.columns as f64, (bottom - top) / rows as f64);
        let middle = top + high / 2.0;
        // a little wider than a cell, so that no gaps show
        let _ = write!(
            out,
            "<g fill=\"none\" stroke-width=\"1.04\" transform=\"translate({left} {middle:.3}) scale({wide:.4} {high:.4})\">"
        );
        let mut colours: Vec<RGBColor> = Vec::new();
        for colour in &cells.colours {
            if !colours.contains(colour) {
                colours.push(*colour);
            }
        }
        for colour in colours {
            let (mut path, mut at) = (String::new(), (0, 0));
            for (y, row) in cells.colours.chunks(cells.columns).enumerate() {
                let mut x = 0;
                for run in row.chunk_by(|a, b| a == b) {
                    if run[0] == colour {
                        let (dx, dy) = (x - at.0, y as i32 - at.1);
                        let _ = write!(path, "m{dx}{}{dy}h{}", if dy < 0 { "" } else { " " }, run.len());
                        at = (x + run.len() as i32, y as i32);
                    }
                    x += run.len() as i32;
                }
            }
            let known = self.by_colour.iter().find(|(known, _)| *known == colour);
            let title = known.map_or(String::new(), |(_, text)| format!("<title>{}</title>", escaped(text)));
            let _ = write!(out, "<path stroke=\"{}\" d=\"{path}\">{title}</path>", paint(&hex(colour)));
        }
        out.push_str("</g>");
    }
}

/// Writes down the shapes of one look.
fn finish(look: &Look, drawn: &str, by_colour: &[(RGBColor, String)], out: &mut String) {
    let opacity = if look.opacity == "1" { String::new() } else { format!(" opacity=\"{}\"", look.opacity) };
    let _ = match &look.kind {
        Kind::Fill => {
            let known = by_colour.iter().find(|(colour, _)| hex(*colour) == look.colour);
            let colour = paint(&look.colour);
            match known {
                Some((_, text)) => {
                    let title = escaped(text);
                    write!(
                        out,
                        "<path fill=\"{colour}\"{opacity} d=\"{drawn}\"><title>{title}</title></path>"
                    )
                }
                None => write!(out, "<path fill=\"{colour}\"{opacity} d=\"{drawn}\"/>"),
            }
        }
        Kind::Dots(width) => {
            let colour = paint(&look.colour);
            write!(
                out,
                "<path stroke=\"{colour}\" stroke-width=\"{width}\" stroke-linecap=\"round\"{opacity} d=\"{drawn}\"/>"
            )
        }
        Kind::Stroke(width) => {
            let colour = paint(&look.colour);
            let width = if width == "1" { String::new() } else { format!(" stroke-width=\"{width}\"") };
            write!(out, "<path fill=\"none\" stroke=\"{colour}\"{width}{opacity} d=\"{drawn}\"/>")
        }
        Kind::Words { size, anchor } => {
            let anchor =
                if *anchor == "start" { String::new() } else { format!(" text-anchor=\"{anchor}\"") };
            let colour = paint(&look.colour);
            write!(out, "<g fill=\"{colour}\" font-size=\"{size}\"{anchor}>{drawn}</g>")
        }
    };
}

fn hex(colour: RGBColor) -> String {
    format!("#{:02X}{:02X}{:02X}", colour.0, colour.1, colour.2)
}

/// A colour of plotters as one that follows the page; where there is no page, as it is.
fn paint(colour: &str) -> String {
    if colour == "#000000" || colour == hex(INK) {
        "currentColor".to_owned()
    } else if colour == "#FFFFFF" {
        "var(--paper,#fff)".to_owned()
    } else if colour == hex(MESH) {
        format!("var(--line,{colour})")
    } else if colour == hex(SOFT) {
        format!("var(--soft,{colour})")
    } else {
        colour.to_lowercase()
    }
}

/// A text that may stand in XML.
pub(super) fn escaped(text: &str) -> String {
    palmistry_io::foreign::html(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: two squares of one colour are one path, a line between them another, and the text stands where it was put.
    #[test]
    fn shapes_of_one_look_are_one_path() {
        let red = RGBColor(200, 40, 60);
        let by_colour = [(red, "from 1 < 2".to_owned())];
        let canvas = Canvas { size: (100, 50), title: "a \"b\"", by_colour: &by_colour, is_crisp: false };
        let found = canvas.draw(|area, extras| {
            area.draw(&Rectangle::new([(1, 2), (11, 12)], red.filled()))?;
            area.draw(&Rectangle::new([(20, 2), (30, 12)], red.filled()))?;
            area.draw(&PathElement::new([(0, 0), (5, 3), (4, 4)], INK))?;
            area.draw(&Text::new("x & y", (7, 20), ("sans-serif", 12).into_font().color(&INK)))?;
            extras.hovers.push(Hover { corners: [1, 2, 3, 5], text: "value".to_owned() });
            Ok(())
        });
        assert!(found.contains("aria-label=\"a &quot;b&quot;\""), "{found}");
        assert!(found.contains("<path fill=\"#c8283c\" d=\"M1 2h10v10h-10zM20 2h10v10h-10z\"><title>from 1 &lt; 2</title></path>"), "{found}");
        assert!(
            found.contains("<path fill=\"none\" stroke=\"currentColor\" d=\"M0 0l5 3-1 1\"/>"),
            "{found}"
        );
        assert!(
            found.contains(
                "<g fill=\"currentColor\" font-size=\"12\"><text x=\"7\" y=\"29\">x &amp; y</text></g>"
            ),
            "{found}"
        );
        assert!(found.contains("<path d=\"M1 2h2v3h-2z\"><title>value</title></path>"), "{found}");
    }

    /// By hand: two rows of three cells, of two colours.
    #[test]
    fn neighbours_of_one_colour_are_one_line() {
        let (red, blue) = (RGBColor(200, 40, 60), RGBColor(0, 0, 200));
        let canvas = Canvas { size: (100, 50), title: "", by_colour: &[], is_crisp: true };
        let found = canvas.draw(|_, extras| {
            let colours = vec![red, red, blue, blue, red, red];
            extras.cells = Some(Cells { corners: [10, 20, 40, 40], columns: 3, colours });
            Ok(())
        });
        assert!(found.contains("translate(10 25.000) scale(10.0000 10.0000)"), "{found}");
        assert!(found.contains("<path stroke=\"#c8283c\" d=\"m0 0h2m-1 1h2\"></path>"), "{found}");
        assert!(found.contains("<path stroke=\"#0000c8\" d=\"m2 0h1m-3 1h1\"></path>"), "{found}");
    }

    /// A polygon and its mirror image go around the same way.
    #[test]
    fn overlapping_shapes_cut_no_holes() {
        let square = |around: &str| {
            let text = format!("<polygon opacity=\"1\" fill=\"#112233\" points=\"{around}\"/>");
            layers(elements(&text).filter_map(|element| element.shape())).remove(0).drawn
        };
        assert_eq!(square("0,0 4,0 4,4 0,4 "), "M0 0l4 0 0 4-4 0z");
        assert_eq!(square("0,4 4,4 4,0 0,0 "), "M0 0l4 0 0 4-4 0z");
    }
}
