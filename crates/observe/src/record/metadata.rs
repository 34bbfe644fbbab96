//! Whether the metadata of a Parquet file can be believed: checked before the format's reader sees them, since that
//! trusts what they say of lengths and may then loop without end, take all memory, or call itself until the stack ends.
//!
//! Source of all numbers of fields: <https://github.com/apache/parquet-format/blob/master/src/main/thrift/parquet.thrift>.

use super::MOST_CELLS;
use super::thrift::Shape::{Bytes, Double, List, Structure, Truth, Whole};
use super::thrift::{Malformed, Reader, Shape, Thrift};

/// At the beginning and at the end of a file.
const MAGIC: &[u8] = b"PAR1";

/// The length of the metadata, and [`MAGIC`].
const TAIL: usize = 8;

/// The schema may have groups within groups up to this.
const DEEPEST_SCHEMA: usize = 32;

/// Snappy makes no more than sixty-four bytes out of three.
const MOST_TIMES_LARGER: i64 = 22;

type Fields = &'static [(i16, Shape)];

const STATISTICS: Fields =
    &[(1, Bytes), (2, Bytes), (3, Whole(64)), (4, Whole(64)), (5, Bytes), (6, Bytes), (7, Truth), (8, Truth)];
const EMPTY: Shape = Structure(&[]);
const TIME_UNIT: Shape = Structure(&[(1, EMPTY), (2, EMPTY), (3, EMPTY)]);
const TIME_TYPE: Shape = Structure(&[(1, Truth), (2, TIME_UNIT)]);
const LOGICAL_TYPE: Fields = &[
    (5, Structure(&[(1, Whole(32)), (2, Whole(32))])),
    (7, TIME_TYPE),
    (8, TIME_TYPE),
    (10, Structure(&[(1, Whole(8)), (2, Truth)])),
    (16, Structure(&[(1, Whole(8))])),
    (17, Structure(&[(1, Bytes)])),
    (18, Structure(&[(1, Bytes), (2, Whole(32))])),
];
const SCHEMA_ELEMENT: Fields = &[
    (1, Whole(32)),
    (2, Whole(32)),
    (3, Whole(32)),
    (4, Bytes),
    (NUMBER_OF_CHILDREN, Whole(32)),
    (6, Whole(32)),
    (7, Whole(32)),
    (8, Whole(32)),
    (9, Whole(32)),
    (10, Structure(LOGICAL_TYPE)),
];
const NUMBER_OF_CHILDREN: i16 = 5;
const KEY_VALUE: Shape = Structure(&[(1, Bytes), (2, Bytes)]);
const SIZE_STATISTICS: Fields = &[(1, Whole(64)), (2, List(&Whole(64))), (3, List(&Whole(64)))];
const BOX: Fields =
    &[(1, Double), (2, Double), (3, Double), (4, Double), (5, Double), (6, Double), (7, Double), (8, Double)];
const COLUMN: Fields = &[
    (1, Whole(32)),
    (2, List(&Whole(32))),
    (3, List(&Bytes)),
    (COMPRESSION, Whole(32)),
    (NUMBER_OF_VALUES, Whole(64)),
    (6, Whole(64)),
    (COMPRESSED_LENGTH, Whole(64)),
    (8, List(&KEY_VALUE)),
    (DATA_OFFSET, Whole(64)),
    (10, Whole(64)),
    (DICTIONARY_OFFSET, Whole(64)),
    (12, Structure(STATISTICS)),
    (13, List(&Structure(&[(1, Whole(32)), (2, Whole(32)), (3, Whole(32))]))),
    (14, Whole(64)),
    (15, Whole(32)),
    (16, Structure(SIZE_STATISTICS)),
    (17, Structure(&[(1, Structure(BOX)), (2, List(&Whole(32)))])),
];
/// 0 for none, 1 for Snappy.
const COMPRESSION: i16 = 4;
const NUMBER_OF_VALUES: i16 = 5;
const COMPRESSED_LENGTH: i16 = 7;
const DATA_OFFSET: i16 = 9;
const DICTIONARY_OFFSET: i16 = 11;
const CHUNK: Fields = &[
    (1, Bytes),
    (2, Whole(64)),
    (OF_CHUNK, Structure(COLUMN)),
    (4, Whole(64)),
    (5, Whole(32)),
    (6, Whole(64)),
    (7, Whole(32)),
    (9, Bytes),
];
const OF_CHUNK: i16 = 3;
const ROW_GROUP: Fields = &[
    (CHUNKS, List(&Structure(CHUNK))),
    (2, Whole(64)),
    (3, Whole(64)),
    (4, List(&Structure(&[(1, Whole(32)), (2, Truth), (3, Truth)]))),
    (5, Whole(64)),
    (6, Whole(64)),
    (7, Whole(16)),
];
const CHUNKS: i16 = 1;
const FILE: Fields = &[
    (1, Whole(32)),
    (SCHEMA, List(&Structure(SCHEMA_ELEMENT))),
    (3, Whole(64)),
    (ROW_GROUPS, List(&Structure(ROW_GROUP))),
    (5, List(&KEY_VALUE)),
    (6, Bytes),
    (7, List(&EMPTY_UNION)),
    (9, Bytes),
];
const EMPTY_UNION: Shape = Structure(&[(1, EMPTY), (2, EMPTY)]);
const SCHEMA: i16 = 2;
const ROW_GROUPS: i16 = 4;
const PAGE: Fields = &[
    (1, Whole(32)),
    (UNCOMPRESSED, Whole(32)),
    (COMPRESSED, Whole(32)),
    (4, Whole(32)),
    (
        DATA_PAGE,
        Structure(&[
            (1, Whole(32)),
            (2, Whole(32)),
            (3, Whole(32)),
            (4, Whole(32)),
            (5, Structure(STATISTICS)),
        ]),
    ),
    (6, EMPTY),
    (DICTIONARY_PAGE, Structure(&[(1, Whole(32)), (2, Whole(32)), (3, Truth)])),
    (DATA_PAGE_2, Structure(DATA_PAGE_2_FIELDS)),
];
const DATA_PAGE_2_FIELDS: Fields = &[
    (1, Whole(32)),
    (2, Whole(32)),
    (3, Whole(32)),
    (4, Whole(32)),
    (5, Whole(32)),
    (6, Whole(32)),
    (7, Truth),
    (8, Structure(STATISTICS)),
];
const UNCOMPRESSED: i16 = 2;
const COMPRESSED: i16 = 3;
const DATA_PAGE: i16 = 5;
const DICTIONARY_PAGE: i16 = 7;
const DATA_PAGE_2: i16 = 8;
/// In the header of each kind of page.
const VALUES_OF_PAGE: i16 = 1;

/// Checks all that a file says of lengths: that the metadata are well formed, every column lies in the file and every
/// page in its column, and no number of values is beyond belief.
///
/// # Errors
/// A message about what is wrong.
pub(super) fn check(file: &[u8]) -> Result<(), String> {
    let body =
        file.strip_suffix(MAGIC).filter(|body| body.starts_with(MAGIC) && file.len() >= TAIL + MAGIC.len());
    let Some((body, length)) = body.and_then(|body| body.split_last_chunk::<4>()) else {
        return Err("it does not begin and end as a Parquet file does".to_owned());
    };
    let length = u32::from_le_bytes(*length) as usize;
    let Some(begin) = body.len().checked_sub(length).filter(|begin| *begin >= MAGIC.len()) else {
        return Err("its metadata are longer than the file".to_owned());
    };
    let (data, metadata) = body.split_at(begin);
    let metadata =
        Reader { rest: metadata }.structure(FILE).map_err(|Malformed| "its metadata are damaged")?;
    schema(metadata.list(SCHEMA))?;
    for group in metadata.list(ROW_GROUPS) {
        for chunk in group.list(CHUNKS) {
            let column = chunk.field(OF_CHUNK).ok_or("a column has no metadata")?;
            pages(data, column)?;
        }
    }
    Ok(())
}

/// Whether the schema, written as a list, is a tree that is not too deep.
fn schema(elements: &[Thrift]) -> Result<(), String> {
    // how many children are to come in each of the groups that are open
    let mut open: Vec<i64> = vec![1];
    for element in elements {
        let children = element.whole(NUMBER_OF_CHILDREN).unwrap_or(0);
        match open.last_mut() {
            Some(left) if children >= 0 && children <= elements.len() as i64 => *left -= 1,
            _ => return Err("its schema is damaged".to_owned()),
        }
        open.push(children);
        while open.last() == Some(&0) {
            open.pop();
        }
        if open.len() > DEEPEST_SCHEMA {
            return Err(format!("its schema has groups within groups, more than {DEEPEST_SCHEMA} deep"));
        }
    }
    if open.is_empty() { Ok(()) } else { Err("its schema is damaged".to_owned()) }
}

/// Whether the pages of a column fill the place that they are said to fill, and promise no more than they can hold.
fn pages(data: &[u8], column: &Thrift) -> Result<(), String> {
    let begin = column.whole(DICTIONARY_OFFSET).or_else(|| column.whole(DATA_OFFSET)).unwrap_or(-1);
    let length = column.whole(COMPRESSED_LENGTH).unwrap_or(-1);
    let place = usize::try_from(begin).ok().zip(usize::try_from(length).ok());
    let place = place.and_then(|(begin, length)| data.get(begin..begin.checked_add(length)?));
    let mut reader = Reader { rest: place.ok_or("a column lies outside the file")? };
    let believed = |count: i64| u64::try_from(count).is_ok_and(|count| count <= MOST_CELLS);
    if !believed(column.whole(NUMBER_OF_VALUES).unwrap_or(-1)) {
        return Err("a column promises more values than are believed".to_owned());
    }
    // columns that are compressed in other ways are refused later, by name
    let known = matches!(column.whole(COMPRESSION), Some(0 | 1));
    let mut promised = 0i64;
    while !reader.rest.is_empty() {
        let page = reader.structure(PAGE).map_err(|Malformed| "the head of a page is damaged")?;
        let (stored, whole) = (page.whole(COMPRESSED).unwrap_or(-1), page.whole(UNCOMPRESSED).unwrap_or(-1));
        let body = usize::try_from(stored).ok().filter(|stored| *stored <= reader.rest.len());
        let body = body.ok_or("a page is longer than its column")?;
        if whole < 0 || known && whole > stored.saturating_mul(MOST_TIMES_LARGER) + TAIL as i64 {
            return Err("a page promises more bytes than it can hold".to_owned());
        }
        let values = |kind: i16| page.field(kind).and_then(|head| head.whole(VALUES_OF_PAGE));
        if values(DICTIONARY_PAGE).is_some_and(|values| values < 0 || values > whole) {
            return Err("a dictionary promises more entries than it can hold".to_owned());
        }
        promised += values(DATA_PAGE).or_else(|| values(DATA_PAGE_2)).unwrap_or(0);
        if values(DATA_PAGE).or_else(|| values(DATA_PAGE_2)).is_some_and(|values| values < 0)
            || !believed(promised)
        {
            return Err("a page promises more values than are believed".to_owned());
        }
        reader.rest = &reader.rest[body..];
    }
    Ok(())
}
