//! The compact protocol of Apache Thrift, as far as Parquet's metadata need it, read with every length checked before
//! it is believed. (The format's own reader trusts lengths: on a damaged file it may count to 2^31 at its end, for each
//! of many lists, and so for ever.)
//!
//! Source: <https://github.com/apache/thrift/blob/master/doc/specs/thrift-compact-protocol.md>.

/// What a field of a structure is. A field that is not listed may be anything that is well formed.
#[derive(Clone, Copy, Debug)]
pub(super) enum Shape {
    Truth,
    /// A whole number of 8, 16, 32 or 64 bits.
    Whole(u32),
    Double,
    Bytes,
    List(&'static Shape),
    /// The fields that are known, by their numbers.
    Structure(&'static [(i16, Shape)]),
}

/// What was read.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Thrift {
    Whole(i64),
    List(Vec<Thrift>),
    Structure(Vec<(i16, Thrift)>),
    /// Something whose value does not matter.
    Other,
}

impl Thrift {
    /// A field of a structure.
    pub fn field(&self, number: i16) -> Option<&Thrift> {
        let Thrift::Structure(fields) = self else { return None };
        fields.iter().find(|(other, _)| *other == number).map(|(_, value)| value)
    }

    /// A field that is a whole number.
    pub fn whole(&self, number: i16) -> Option<i64> {
        match self.field(number) {
            Some(Thrift::Whole(value)) => Some(*value),
            _ => None,
        }
    }

    /// The entries of a field that is a list; none where there is no such field.
    pub fn list(&self, number: i16) -> &[Thrift] {
        match self.field(number) {
            Some(Thrift::List(entries)) => entries,
            _ => &[],
        }
    }
}

/// Structures within structures beyond this are refused; Parquet has seven.
const DEEPEST: usize = 16;

/// The metadata are not what the format says, or have a length that cannot be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Malformed;

/// Bytes that are read from the front.
pub(super) struct Reader<'a> {
    pub rest: &'a [u8],
}

type Read<T> = Result<T, Malformed>;

impl Reader<'_> {
    fn byte(&mut self) -> Read<u8> {
        let (first, rest) = self.rest.split_first().ok_or(Malformed)?;
        self.rest = rest;
        Ok(*first)
    }

    fn skip(&mut self, count: u64) -> Read<()> {
        let count = usize::try_from(count).map_err(|_| Malformed)?;
        self.rest = self.rest.get(count..).ok_or(Malformed)?;
        Ok(())
    }

    fn unsigned(&mut self) -> Read<u64> {
        let mut value = 0u64;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            if shift == 63 && byte > 1 {
                return Err(Malformed);
            }
            value |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Ok(value);
            }
        }
        Err(Malformed)
    }

    fn signed(&mut self, bits: u32) -> Read<i64> {
        let coded = self.unsigned()?;
        let value = (coded >> 1) as i64 ^ -((coded & 1) as i64);
        let beyond = 64 - bits;
        if value << beyond >> beyond == value { Ok(value) } else { Err(Malformed) }
    }

    /// Reads a structure whose known fields have to be what they are.
    pub fn structure(&mut self, known: &'static [(i16, Shape)]) -> Read<Thrift> {
        self.fields(known, 0)
    }

    fn fields(&mut self, known: &'static [(i16, Shape)], depth: usize) -> Read<Thrift> {
        if depth > DEEPEST {
            return Err(Malformed);
        }
        let (mut fields, mut number) = (Vec::new(), 0i16);
        loop {
            let head = self.byte()?;
            if head & 0x0f == 0 {
                return Ok(Thrift::Structure(fields));
            }
            // the long form of a number is for steps of more than fifteen, and Parquet has none
            let step = i16::from(head >> 4);
            number = number.checked_add(step).filter(|_| step > 0).ok_or(Malformed)?;
            let shape = known.iter().find(|(other, _)| *other == number).map(|(_, shape)| shape);
            fields.push((number, self.value(head & 0x0f, shape, depth)?));
        }
    }

    /// Reads a value with the kind that stands before it.
    fn value(&mut self, kind: u8, shape: Option<&Shape>, depth: usize) -> Read<Thrift> {
        match (kind, shape) {
            (1 | 2, None | Some(Shape::Truth)) => Ok(Thrift::Other),
            (3, None | Some(Shape::Whole(8))) => self.byte().map(|byte| Thrift::Whole(i64::from(byte as i8))),
            (4, None | Some(Shape::Whole(16))) => self.signed(16).map(Thrift::Whole),
            (5, None | Some(Shape::Whole(32))) => self.signed(32).map(Thrift::Whole),
            (6, None | Some(Shape::Whole(64))) => self.signed(64).map(Thrift::Whole),
            (7, None | Some(Shape::Double)) => self.skip(8).map(|()| Thrift::Other),
            (8, None | Some(Shape::Bytes)) => {
                let length = self.unsigned()?;
                self.skip(length).map(|()| Thrift::Other)
            }
            (9, None) => self.entries(None, depth + 1),
            (9, Some(Shape::List(entry))) => self.entries(Some(entry), depth + 1),
            (12, None) => self.fields(&[], depth + 1),
            (12, Some(Shape::Structure(known))) => self.fields(known, depth + 1),
            _ => Err(Malformed),
        }
    }

    fn entries(&mut self, shape: Option<&Shape>, depth: usize) -> Read<Thrift> {
        if depth > DEEPEST {
            return Err(Malformed);
        }
        let head = self.byte()?;
        if head == 0 {
            return Ok(Thrift::List(Vec::new())); // some programs write no kind for a list without entries
        }
        let count = match head >> 4 {
            15 => self.unsigned()?,
            count => u64::from(count),
        };
        // every entry takes a byte; truth values, about which the readers differ, are in no list of Parquet's
        if count > self.rest.len() as u64 || matches!(head & 0x0f, 1 | 2) {
            return Err(Malformed);
        }
        (0..count).map(|_| self.value(head & 0x0f, shape, depth)).collect::<Read<Vec<_>>>().map(Thrift::List)
    }
}
