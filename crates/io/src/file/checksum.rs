//! A number by which a text that was cut or changed is noticed. It guards against accidents and against nobody who means harm.

/// The 64-bit hash of Fowler, Noll and Vo (variant 1a): the same everywhere and for ever.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Checksum(u64);

impl Default for Checksum {
    /// That of the empty text.
    fn default() -> Self {
        Checksum(0xcbf2_9ce4_8422_2325)
    }
}

impl Checksum {
    /// That of a text alone.
    pub fn of(text: &str) -> u64 {
        let mut sum = Checksum::default();
        sum.add(text);
        sum.value()
    }

    pub fn add(&mut self, text: &str) {
        for byte in text.bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    pub fn value(self) -> u64 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The published test vectors of the authors (`fnv64a`).
    #[test]
    fn the_published_answers_are_met() {
        assert_eq!(Checksum::of(""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(Checksum::of("a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(Checksum::of("foobar"), 0x8594_4171_f739_67e8);
    }
}
