//! Shapes of one look put together wherever that changes nothing: a shape may be drawn earlier than it was where it touches nothing
//! that was drawn in between.

use super::element::{Corners, Kind, Look, Part, Shape};

/// Shapes of one look.
pub(super) struct Layer {
    pub look: Look,
    pub drawn: String,
    /// Where its path ends.
    end: Option<(i32, i32)>,
    places: Vec<Corners>,
}

impl Layer {
    fn add(&mut self, part: &Part, corners: Corners) {
        match part {
            Part::Words(words) => self.drawn.push_str(words),
            Part::Path(stretch) => self.end = Some(stretch.write(self.end, &mut self.drawn)),
        }
        self.places.push(corners);
    }
}

/// Layers that look as the shapes one after the other do.
pub(super) fn layers(shapes: impl Iterator<Item = Shape>) -> Vec<Layer> {
    let mut found: Vec<Layer> = Vec::new();
    for Shape { look, part, corners } in shapes {
        // thin lines in the colour of the page are a mesh that is not to be visible
        if look.kind == Kind::Stroke("1".to_owned()) && look.colour == "#FFFFFF" {
            continue;
        }
        let place = home(&found, &look, &corners).unwrap_or_else(|| {
            found.push(Layer { look, drawn: String::new(), end: None, places: Vec::new() });
            found.len() - 1
        });
        found[place].add(&part, corners);
    }
    found
}

/// The last layer of a look, where nothing behind it is in the way.
fn home(layers: &[Layer], look: &Look, corners: &Corners) -> Option<usize> {
    // what is half transparent adds up where it overlaps: each for itself
    if look.opacity != "1" {
        return None;
    }
    let place = layers.iter().rposition(|layer| layer.look == *look)?;
    let in_the_way = |layer: &Layer| layer.places.iter().any(|other| touch(other, corners));
    (!layers[place + 1..].iter().any(in_the_way)).then_some(place)
}

/// Whether two rectangles have something in common.
fn touch(a: &Corners, b: &Corners) -> bool {
    a[0] <= b[2] && b[0] <= a[2] && a[1] <= b[3] && b[1] <= a[3]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shape(colour: &str, corners: Corners) -> Shape {
        let look = Look { kind: Kind::Fill, colour: colour.to_owned(), opacity: "1".to_owned() };
        Shape { look, part: Part::Words(colour.to_owned()), corners }
    }

    /// A red square beside a blue one joins the red one before it; one on the blue one stays on it.
    #[test]
    fn what_lies_on_another_stays_there() {
        let squares = |last: Corners| {
            let shapes = [shape("r", [0, 0, 4, 4]), shape("b", [10, 0, 14, 4]), shape("r", last)];
            layers(shapes.into_iter()).into_iter().map(|layer| layer.drawn).collect::<Vec<_>>()
        };
        assert_eq!(squares([20, 0, 24, 4]), ["rr", "b"]);
        assert_eq!(squares([12, 2, 20, 4]), ["r", "b", "r"]);
    }
}
