//! Files that have grown: a piece of a whole file many times over, at three sizes, each twice the one before.
//!
//! What a reader does with them grows with their length. Where it grows as the square, or doubles, these sizes show it, whatever the machine.

use proptest::prelude::*;

/// In bytes, about.
pub const SIZES: [usize; 3] = [48 << 10, 96 << 10, 192 << 10];

/// Shorter times tell nothing, in s.
const TELLING: f64 = 0.3;

/// Twice the length takes so much longer where the time grows as a square, and less.
const SQUARE: f64 = 3.0;

/// How a file grows.
#[derive(Clone, Debug)]
pub enum Growth {
    /// Some lines are there many times, or each with a number of its own.
    Lines(usize, usize, bool),
    /// A piece of a line is there many times, or each with a number of its own.
    Piece(usize, usize, bool),
    /// A piece of a line stands in many brackets.
    Nested(usize, usize, (&'static str, &'static str)),
}

pub fn growth() -> impl Strategy<Value = Growth> {
    let place = any::<usize>;
    let brackets = prop::sample::select(vec![
        ("(", ")"),
        ("-(", ")"),
        ("[", "]"),
        ("{", "}"),
        ("sin(", ")"),
        ("x + (", ")"),
        ("<a>", "</a>"),
        ("<apply><plus/><ci>x</ci>", "</apply>"),
        ("{\"a\":", "}"),
        ("\"", "\""),
        ("", "^2"),
    ]);
    prop_oneof![
        (place(), 1usize..5, any::<bool>()).prop_map(|(at, count, own)| Growth::Lines(at, count, own)),
        (place(), 1usize..40, any::<bool>()).prop_map(|(at, count, own)| Growth::Piece(at, count, own)),
        (place(), 1usize..12, brackets).prop_map(|(at, count, pair)| Growth::Nested(at, count, pair)),
    ]
}

/// Whether times of three sizes grow as a square of these, or faster.
pub fn are_squares([first, second, third]: [f64; 3]) -> bool {
    third > TELLING && third > SQUARE * second && second > SQUARE * first
}

impl Growth {
    /// A file that has grown to a size.
    pub fn of(&self, file: &[u8], size: usize) -> Vec<u8> {
        let (piece, numbered) = match self {
            Growth::Lines(at, count, numbered) => (lines(file, *at, *count), *numbered),
            Growth::Piece(at, length, numbered) => (piece(file, *at, *length), *numbered),
            Growth::Nested(at, length, _) => (piece(file, *at, *length), false),
        };
        let own = &file[piece.clone()];
        let mut grown = file[..piece.start].to_vec();
        if let Growth::Nested(_, _, (open, close)) = self {
            let times = size / (open.len() + close.len());
            grown.extend(open.repeat(times).bytes());
            grown.extend(own);
            grown.extend(close.repeat(times).bytes());
        } else {
            let mut number = 0;
            while grown.len() < size {
                grown.extend(if numbered { with_number(own, number) } else { own.to_vec() });
                number += 1;
            }
        }
        grown.extend(&file[piece.end..]);
        grown
    }
}

/// So many lines of a file.
fn lines(file: &[u8], at: usize, count: usize) -> std::ops::Range<usize> {
    let mut starts = vec![0];
    starts.extend(file.iter().enumerate().filter(|(_, byte)| **byte == b'\n').map(|(at, _)| at + 1));
    starts.retain(|start| *start < file.len());
    let first = at % starts.len();
    starts[first]..starts.get(first + count).copied().unwrap_or(file.len())
}

/// So many bytes of a file, all of which are of letters as it has them.
fn piece(file: &[u8], at: usize, length: usize) -> std::ops::Range<usize> {
    let whole = |at: &usize| file.get(*at).is_none_or(|byte| byte & 0xc0 != 0x80);
    let start = (0..=at % file.len()).rev().find(whole).unwrap_or(0);
    let end = (start + length..).find(whole).unwrap_or(file.len()).min(file.len());
    start..end
}

/// A piece whose first number is another, or else its first name.
fn with_number(piece: &[u8], number: usize) -> Vec<u8> {
    let is_digit = |byte: &u8| byte.is_ascii_digit();
    let is_letter = |byte: &u8| byte.is_ascii_alphabetic() || *byte == b'_';
    let run = |from: usize, of: &dyn Fn(&u8) -> bool| {
        piece[from..].iter().position(|byte| !of(byte)).map_or(piece.len(), |length| from + length)
    };
    let place = match (piece.iter().position(is_digit), piece.iter().position(is_letter)) {
        (Some(start), _) => start..run(start, &is_digit),
        (None, Some(start)) => {
            let end = run(start, &is_letter);
            end..end
        }
        (None, None) => piece.len()..piece.len(),
    };
    [&piece[..place.start], number.to_string().as_bytes(), &piece[place.end..]].concat()
}

/// By hand.
#[test]
fn a_file_grows_as_is_said() {
    let file = "a = 1\nbc(x)\n";
    let of = |growth: Growth, size: usize| String::from_utf8(growth.of(file.as_bytes(), size)).unwrap();
    assert_eq!(of(Growth::Lines(0, 1, false), 12), "a = 1\na = 1\nbc(x)\n");
    assert_eq!(of(Growth::Lines(0, 1, true), 12), "a = 0\na = 1\nbc(x)\n");
    assert_eq!(of(Growth::Piece(0, 1, true), 4), "a0a1 = 1\nbc(x)\n");
    assert_eq!(of(Growth::Nested(0, 1, ("(", ")")), 4), "((a)) = 1\nbc(x)\n");
    assert!(are_squares([0.4, 1.5, 6.0]) && !are_squares([1.0, 2.1, 4.5]) && !are_squares([0.01, 0.05, 0.2]));
}
