//! A picture read back: its title, its texts, and the marks of a colour.

/// What stands in a picture.
pub struct Picture {
    pub title: String,
    /// All texts, in the order of the file.
    pub texts: Vec<String>,
    /// Colour and outline of each path: of its stroke, or of what it is filled with.
    paths: Vec<(String, String)>,
}

impl Picture {
    /// Reads what was drawn.
    pub fn read(text: &str) -> Picture {
        assert!(text.starts_with("<svg ") && text.trim_end().ends_with("</svg>"));
        let mut texts: Vec<String> = Vec::new();
        for rest in text.split("<text ").skip(1) {
            let inside = rest.split_once('>').unwrap().1.split_once("</text>").unwrap().0;
            texts.push(inside.to_owned());
        }
        let attribute = |tag: &str, name: &str| -> Option<String> {
            let begin = format!(" {name}=\"");
            Some(tag.split_once(&begin)?.1.split_once('"')?.0.to_lowercase())
        };
        let path = |rest: &str| {
            let tag = format!(" {}", rest.split_once('>').unwrap().0);
            let colour = attribute(&tag, "fill").filter(|fill| fill != "none").or(attribute(&tag, "stroke"));
            (colour.unwrap_or_default(), attribute(&tag, "d").unwrap_or_default())
        };
        let paths = text.split("<path ").skip(1).map(path).collect();
        let title = text.split_once("aria-label=\"").unwrap().1.split_once('"').unwrap().0.to_owned();
        Picture { title, texts, paths }
    }

    fn of<'p>(&'p self, colour: &'p str) -> impl Iterator<Item = &'p str> {
        self.paths.iter().filter(move |(own, _)| own == colour).map(|(_, outline)| outline.as_str())
    }

    /// The lines of a colour, each by the number of its points.
    #[allow(dead_code)] // not every test has lines
    pub fn lines_of(&self, colour: &str) -> Vec<usize> {
        let points = |line: &str| {
            let numbers = line.split(|c: char| !c.is_ascii_digit() && c != '.' && c != '-');
            let signed = numbers.flat_map(|word| word.split('-'));
            signed.filter(|number| !number.is_empty()).count() / 2
        };
        let lines = self.of(colour).flat_map(|outline| outline.split('m').skip(1));
        lines.map(points).collect()
    }

    /// How many closed outlines are filled with a colour.
    #[allow(dead_code)] // not every test has boxes
    pub fn boxes_of(&self, colour: &str) -> usize {
        self.of(colour).map(|outline| outline.matches('z').count()).sum()
    }
}
