//! Measurements in rows: experiment, output, time, value, and settings for the row alone.

use palmistry_io::foreign::{name_of, shown};
use palmistry_lang::{Code, Problem, ReadError, load};
use std::ops::Range;
use std::path::Path;

/// The most measurements.
const MOST_ROWS: usize = 1_000_000;

/// The columns that a file of measurements has.
const COLUMNS: [&str; 4] = ["experiment", "output", "time", "value"];

/// Of a row with more cells than the header has names.
const MORE_CELLS: &str =
    "a decimal point is written '.', as in 0.5: commas separate columns; or take the cells too many out";

/// A row.
pub(super) struct MeasuredRow {
    pub experiment: String,
    pub output: String,
    /// Infinite where the row says so: the steady state.
    pub time: f64,
    pub value: f64,
    /// `name = value`, separated by semicolons.
    pub set: String,
    /// Where it stands in the file, in bytes.
    pub place: Range<usize>,
}

/// The rows of a file.
pub(super) struct MeasuredRows {
    pub rows: Vec<MeasuredRow>,
    name: String,
    text: String,
}

/// What to do where a column is missing.
fn no_column(head: &csv::StringRecord, wanted: &str) -> String {
    if let Some(only) = head.get(0).filter(|only| head.len() == 1 && only.contains([';', '\t'])) {
        let sign = if only.contains(';') { "semicolons" } else { "tabs" };
        return format!("columns are separated by commas, here by {sign}");
    }
    let here = head.iter().map(shown).collect::<Vec<_>>().join(", ");
    format!(
        "the header names the columns {}; here: {here}; rename the one that is '{wanted}'",
        COLUMNS.join(", ")
    )
}

impl MeasuredRows {
    /// Reads a file.
    ///
    /// # Errors
    /// What is wrong with it, and where.
    pub fn read(path: &Path) -> Result<MeasuredRows, ReadError> {
        let name = name_of(path);
        let text = load(path)
            .map_err(|message| Problem::new(Code::SceneValue, &(0..0), message, "").locate(&name, ""))?;
        MeasuredRows::parse(&name, text)
    }

    fn parse(name: &str, text: String) -> Result<MeasuredRows, ReadError> {
        let at = |place: Range<usize>, message: String, help: &str| {
            Problem::new(Code::SceneValue, &place, message, "here").help(help).locate(name, &text)
        };
        let mut reader =
            csv::ReaderBuilder::new().trim(csv::Trim::All).flexible(true).from_reader(text.as_bytes());
        let no_table = "a row a measurement: experiment,output,time,value and, where something is set for a row alone, set";
        let head = reader
            .headers()
            .map_err(|why| at(0..0, format!("the file cannot be read: {why}"), no_table))?
            .clone();
        let find = |wanted: &str| head.iter().position(|own| own == wanted);
        let first = 0..text.lines().next().map_or(0, str::len);
        let mut places = [0; 4];
        for (place, wanted) in places.iter_mut().zip(COLUMNS) {
            *place = find(wanted).ok_or_else(|| {
                let message = format!("the file has no column '{wanted}'");
                at(first.clone(), message, &no_column(&head, wanted))
            })?;
        }
        if let Some(other) = head.iter().find(|own| *own != "set" && !COLUMNS.contains(own)) {
            return Err(at(first, format!("'{}' is no column that is known here", shown(other)), no_table));
        }
        let set = find("set");
        let mut rows = Vec::new();
        for record in reader.records() {
            let record =
                record.map_err(|why| at(0..0, format!("the file cannot be read: {why}"), no_table))?;
            let start = record.position().map_or(0, |place| place.byte() as usize).min(text.len());
            let place = start..text[start..].find('\n').map_or(text.len(), |length| start + length);
            if record.len() > head.len() {
                let message = format!("the row has {} cells, and the header {}", record.len(), head.len());
                return Err(at(place, message, MORE_CELLS));
            }
            let cell = |column: usize| record.get(column).filter(|cell| !cell.is_empty());
            let needed = |column: usize| {
                cell(column).ok_or_else(|| {
                    at(
                        place.clone(),
                        format!("the row has no '{}'", &head[column]),
                        "fill it in, or take the row out",
                    )
                })
            };
            let number = |column: usize| {
                let text = needed(column)?;
                let value = text.parse::<f64>().ok().filter(|value| !value.is_nan());
                value.ok_or_else(|| {
                    let help = "write a decimal with a point, as in 0.5, or take the row out";
                    at(place.clone(), format!("'{}' is no number", shown(text)), help)
                })
            };
            let (time, value) = (number(places[2])?, number(places[3])?);
            if time < 0.0 {
                return Err(at(
                    place,
                    format!("the time {time} is before the start"),
                    "times are counted from the start of the experiment; inf is where nothing changes any more",
                ));
            }
            if value.is_infinite() {
                return Err(at(place, "the value is infinite".to_owned(), "write a decimal"));
            }
            if rows.len() >= MOST_ROWS {
                return Err(at(
                    place,
                    format!("more than {MOST_ROWS} measurements are not read"),
                    "take every tenth, or a part",
                ));
            }
            rows.push(MeasuredRow {
                experiment: needed(places[0])?.to_owned(),
                output: needed(places[1])?.to_owned(),
                time,
                value,
                set: set.and_then(cell).unwrap_or_default().to_owned(),
                place,
            });
        }
        if rows.is_empty() {
            return Err(at(first, "nothing was measured".to_owned(), no_table));
        }
        Ok(MeasuredRows { rows, name: name.to_owned(), text })
    }

    /// A mistake in a row.
    pub fn error(&self, row: &MeasuredRow, message: impl Into<String>, help: impl Into<String>) -> ReadError {
        Problem::new(Code::SceneValue, &row.place, message, "in this row")
            .help(help)
            .locate(&self.name, &self.text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_read_and_faults_named() {
        let text = "experiment,output,time,value,set\na, y ,0,1.5,\nb,y,inf,2,k = 3\n";
        let rows = MeasuredRows::parse("m.csv", text.to_owned()).unwrap().rows;
        assert_eq!((rows.len(), rows[0].output.as_str(), rows[1].time), (2, "y", f64::INFINITY));
        assert_eq!(rows[1].set, "k = 3");
        for (text, message) in [
            ("experiment,output,time\na,y,0\n", "the file has no column 'value'"),
            ("experiment,output,time,value\na,y,x,1\n", "'x' is no number"),
            ("experiment,output,time,value\na,y,-1,1\n", "the time -1 is before the start"),
            ("experiment,output,time,value\na,y,0,\n", "the row has no 'value'"),
            ("experiment,output,time,value\na,y,0,nan\n", "'nan' is no number"),
            ("experiment,output,time,value\na,y,0,inf\n", "the value is infinite"),
            ("experiment,output,time,value\n", "nothing was measured"),
            ("experiment,output,time,value,what\na,y,0,1,2\n", "'what' is no column that is known here"),
        ] {
            let Err(why) = MeasuredRows::parse("m.csv", text.to_owned()) else { panic!("{text}") };
            assert_eq!(why.message, message);
        }
        for (text, message, help) in [
            (
                "experiment,output,time,value\na,y,0,0,691\n",
                "the row has 5 cells, and the header 4",
                "written '.'",
            ),
            (
                "experiment;output;time;value\na;y;0;1\n",
                "the file has no column 'experiment'",
                "here by semicolons",
            ),
            ("experiment,output,t,value\na,y,0,1\n", "the file has no column 'time'", "output, t, value"),
            ("experiment,output,time,value\na,y,0,n/a\n", "'n/a' is no number", "take the row out"),
        ] {
            let Err(why) = MeasuredRows::parse("m.csv", text.to_owned()) else { panic!("{text}") };
            assert_eq!(why.message, message);
            assert!(why.help.as_deref().unwrap_or_default().contains(help), "{text}: {:?}", why.help);
        }
    }
}
