//! What plotters draws, element by element: how each looks, and its part of a path.

use super::track::{Stretch, simplified};
use super::{BACK, BELOW};

/// Left, top, right, bottom, in pixels.
pub(super) type Corners = [i32; 4];

/// A shape that is drawn.
pub(super) struct Shape {
    pub look: Look,
    pub part: Part,
    /// Around everything that it covers.
    pub corners: Corners,
}

/// What of a shape is written down.
pub(super) enum Part {
    Words(String),
    Path(Stretch),
}

/// A text whose indices stand below the line; what follows one is back on it.
fn with_indices(words: &str, size: f64) -> String {
    let mut parts = words.split(BELOW);
    let mut out = parts.next().unwrap_or_default().to_owned();
    let down = (0.25 * size).round();
    for part in parts {
        let (index, rest) = part.split_once(BACK).unwrap_or((part, ""));
        out.push_str(&format!("<tspan dy=\"{down}\" font-size=\"80%\">{index}</tspan>"));
        if !rest.is_empty() {
            out.push_str(&format!("<tspan dy=\"-{down}\">{rest}</tspan>"));
        }
    }
    out
}

fn around(points: &[(i32, i32)]) -> Corners {
    let least = |of: fn(&(i32, i32)) -> i32| points.iter().map(of).min().unwrap_or(0);
    let most = |of: fn(&(i32, i32)) -> i32| points.iter().map(of).max().unwrap_or(0);
    [least(|p| p.0), least(|p| p.1), most(|p| p.0), most(|p| p.1)]
}

/// How shapes look; those of one look are one path.
#[derive(Clone, PartialEq, Eq)]
pub(super) struct Look {
    pub kind: Kind,
    pub colour: String,
    pub opacity: String,
}

#[derive(Clone, PartialEq, Eq)]
pub(super) enum Kind {
    Fill,
    /// Filled circles of a diameter.
    Dots(i32),
    Stroke(String),
    Words {
        size: i32,
        anchor: String,
    },
}

/// An element of the SVG of plotters.
pub(super) struct Element<'a> {
    tag: &'a str,
    attributes: Vec<(&'a str, &'a str)>,
    words: &'a str,
}

/// The elements of a flat SVG, in order.
pub(super) fn elements(text: &str) -> impl Iterator<Item = Element<'_>> {
    text.split('<').skip(1).filter_map(|part| {
        let (head, words) = part.split_once('>')?;
        let (tag, rest) = head.split_once(' ')?;
        let mut attributes = Vec::new();
        let mut quoted = rest.split('"');
        while let (Some(name), Some(value)) = (quoted.next(), quoted.next()) {
            attributes.push((name.trim().trim_end_matches('='), value));
        }
        (tag != "svg").then_some(Element { tag, attributes, words: words.trim() })
    })
}

impl Element<'_> {
    fn attribute(&self, name: &str) -> &str {
        self.attributes.iter().find(|(known, _)| *known == name).map_or("", |(_, value)| value)
    }

    fn number(&self, name: &str) -> i32 {
        self.attribute(name).parse().unwrap_or(0)
    }

    /// How it looks, its part of a path, and where it is.
    pub fn shape(&self) -> Option<Shape> {
        let (look, part) = self.look_and_part()?;
        let width = match &look.kind {
            Kind::Stroke(width) => width.parse::<f64>().unwrap_or(1.0).ceil() as i32,
            _ => 0,
        };
        let [left, top, right, bottom] = self.corners();
        let corners = [left - width, top - width, right + width, bottom + width];
        Some(Shape { look, part, corners })
    }

    /// Around everything that it covers.
    fn corners(&self) -> Corners {
        let number = |name: &str| self.number(name);
        match self.tag {
            "rect" => {
                let (x, y) = (number("x"), number("y"));
                [x, y, x + number("width"), y + number("height")]
            }
            "circle" => {
                let (x, y, r) = (number("cx"), number("cy"), number("r"));
                [x - r, y - r, x + r, y + r]
            }
            // more than the text covers, wherever it begins and however it is turned
            "text" => {
                let size = self.attribute("font-size").parse::<f64>().unwrap_or(10.0) * 1.24;
                let reach = (size * (0.7 * self.words.chars().count() as f64 + 1.0)).ceil() as i32;
                let (x, y, high) = (number("x"), number("y"), (1.5 * size).ceil() as i32);
                match self.attribute("transform") {
                    "" => {
                        let [before, behind] = match self.attribute("text-anchor") {
                            "start" => [0, reach],
                            "end" => [reach, 0],
                            _ => [reach / 2 + 1, reach / 2 + 1],
                        };
                        [x - before, y - high, x + behind, y + high]
                    }
                    _ => [x - reach, y - reach, x + reach, y + reach],
                }
            }
            "line" => around(&[(number("x1"), number("y1")), (number("x2"), number("y2"))]),
            _ => around(&self.points()),
        }
    }

    fn look_and_part(&self) -> Option<(Look, Part)> {
        let opacity = match self.attribute("opacity") {
            "" => "1".to_owned(),
            other => other.to_owned(),
        };
        let (fill, stroke) = (self.attribute("fill"), self.attribute("stroke"));
        let look =
            |kind: Kind, colour: &str| Look { kind, colour: colour.to_owned(), opacity: opacity.clone() };
        let lined = || match self.attribute("stroke-width") {
            "" => "1".to_owned(),
            width => width.to_owned(),
        };
        let outline = |path: Stretch| match fill {
            "none" => (look(Kind::Stroke(lined()), stroke), Part::Path(path)),
            _ => (look(Kind::Fill, fill), Part::Path(path)),
        };
        Some(match self.tag {
            "rect" => {
                let [x, y, width, height] = ["x", "y", "width", "height"].map(|name| self.number(name));
                outline(Stretch::around((x, y), format!("h{width}v{height}h{}z", -width)))
            }
            "line" => {
                let ends = [("x1", "y1"), ("x2", "y2")].map(|(x, y)| (self.number(x), self.number(y)));
                (look(Kind::Stroke(lined()), stroke), Part::Path(Stretch::through(&ends)))
            }
            "polyline" => {
                let line = Stretch::through(&simplified(&self.points()));
                (look(Kind::Stroke(lined()), stroke), Part::Path(line))
            }
            "polygon" => {
                let mut points = self.points();
                // all one way around, so that shapes of one path that overlap do not cut holes
                let turned = |pair: (&(i32, i32), &(i32, i32))| pair.0.0 * pair.1.1 - pair.1.0 * pair.0.1;
                let around = points.iter().zip(points.iter().cycle().skip(1)).map(turned).sum::<i32>();
                if around < 0 {
                    points.reverse();
                }
                (look(Kind::Fill, fill), Part::Path(Stretch::through(&points).closed()))
            }
            "circle" => {
                let [x, y, r] = ["cx", "cy", "r"].map(|name| self.number(name));
                let twice = 2 * r;
                if fill != "none" {
                    let dot = Stretch::around((x, y), "h0".to_owned());
                    return Some((look(Kind::Dots(twice), fill), Part::Path(dot)));
                }
                let around = format!("a{r} {r} 0 1 1 {twice} 0a{r} {r} 0 1 1-{twice} 0z");
                outline(Stretch::around((x - r, y), around))
            }
            "text" => self.words(&look),
            _ => return None,
        })
    }

    fn points(&self) -> Vec<(i32, i32)> {
        let pair = |text: &str| {
            let (x, y) = text.split_once(',')?;
            Some((x.parse().ok()?, y.parse().ok()?))
        };
        self.attribute("points").split_whitespace().filter_map(pair).collect()
    }

    fn words(&self, look: &impl Fn(Kind, &str) -> Look) -> (Look, Part) {
        // plotters takes a font's height for 1.24 of its size
        let size = (self.attribute("font-size").parse::<f64>().unwrap_or(10.0) * 1.24).round();
        let [x, y] = [self.number("x"), self.number("y")];
        let down = match self.attribute("dy") {
            "0.76em" => 0.76,
            "0.5ex" => 0.33,
            _ => -0.25,
        };
        let turn = self.attribute("transform").split(['(', ',']).nth(1).unwrap_or_default();
        let words = with_indices(self.words, size);
        let (down, kind) = (
            (down * size).round() as i32,
            Kind::Words { size: size as i32, anchor: self.attribute("text-anchor").to_owned() },
        );
        let placed = match turn {
            "" => format!("<text x=\"{x}\" y=\"{}\">{words}</text>", y + down),
            turn => {
                format!(
                    "<text x=\"{x}\" y=\"{y}\" dy=\"{down}\" transform=\"rotate({turn} {x} {y})\">{words}</text>"
                )
            }
        };
        (look(kind, self.attribute("fill")), Part::Words(placed))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_stand_below_the_line() {
        assert_eq!(with_indices("distance, m", 12.0), "distance, m");
        assert_eq!(
            with_indices(&format!("v{BELOW}y{BACK}, m/s"), 12.0),
            "v<tspan dy=\"3\" font-size=\"80%\">y</tspan><tspan dy=\"-3\">, m/s</tspan>"
        );
        assert_eq!(
            with_indices(&format!("of {BELOW}y{BACK}"), 12.0),
            "of <tspan dy=\"3\" font-size=\"80%\">y</tspan>"
        );
    }
}
