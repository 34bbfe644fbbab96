//! Monomials in a table: each has a number, and one is stored once.

use std::cmp::Ordering;

/// All monomials that were met, by their numbers; the first one is one.
pub(super) struct Monomials {
    weights: Vec<u32>,
    variables: usize,
    powers: Vec<u16>,
    degrees: Vec<u32>,
    /// Of each some of what divides it, by bits: what divides has no bit more.
    masks: Vec<u64>,
    /// Of each the sum of its variables' salts: that of a product is the sum of two.
    hashes: Vec<u64>,
    salts: Vec<u64>,
    /// Numbers by hash, with the next free place where one is taken; a power of two many, at most half of them in use.
    slots: Vec<u32>,
    scratch: Vec<u16>,
}

const FREE: u32 = u32::MAX;

impl Monomials {
    /// Monomials in so many variables as there are weights: a degree is a sum of these.
    pub fn new(weights: Vec<u32>) -> Monomials {
        let variables = weights.len();
        let mut table = Monomials {
            weights,
            variables,
            powers: Vec::new(),
            degrees: Vec::new(),
            masks: Vec::new(),
            hashes: Vec::new(),
            // odd multiples of the golden ratio's bits, mixed: any numbers without small relations do
            salts: (1..=variables as u64).map(mixed).collect(),
            slots: vec![FREE; 1 << 12],
            scratch: vec![0; variables],
        };
        table.number(0);
        table
    }

    pub fn variables(&self) -> usize {
        self.variables
    }

    /// How many monomials were met.
    pub fn len(&self) -> usize {
        self.degrees.len()
    }

    pub fn powers(&self, monomial: u32) -> &[u16] {
        let begin = monomial as usize * self.variables;
        &self.powers[begin..begin + self.variables]
    }

    pub fn degree(&self, monomial: u32) -> u32 {
        self.degrees[monomial as usize]
    }

    pub fn mask(&self, monomial: u32) -> u64 {
        self.masks[monomial as usize]
    }

    /// The number of what stands in the scratch space, whose hash is given.
    fn number(&mut self, hash: u64) -> u32 {
        let wrap = self.slots.len() - 1;
        let mut slot = place(hash) & wrap;
        loop {
            match self.slots[slot] {
                FREE => break,
                known if self.hashes[known as usize] == hash && self.powers(known) == self.scratch => {
                    return known;
                }
                _ => slot = (slot + 1) & wrap,
            }
        }
        let number = self.degrees.len() as u32;
        self.slots[slot] = number;
        self.powers.extend_from_slice(&self.scratch);
        let (mut degree, mut mask) = (0, 0);
        let bits = (64 / self.variables.max(1)).clamp(1, 8);
        for (variable, power) in self.scratch.iter().enumerate().filter(|(_, power)| **power > 0) {
            degree += u32::from(*power) * self.weights[variable];
            // a bit for each of the first powers, as far as there are bits
            let first = variable * bits % 64;
            mask |= ((1u64 << bits.min(usize::from(*power))) - 1).rotate_left(first as u32);
        }
        self.degrees.push(degree);
        self.masks.push(mask);
        self.hashes.push(hash);
        if self.degrees.len() * 2 > self.slots.len() {
            self.grow();
        }
        number
    }

    fn grow(&mut self) {
        let wrap = self.slots.len() * 2 - 1;
        let mut slots = vec![FREE; wrap + 1];
        for (number, hash) in self.hashes.iter().enumerate() {
            let mut slot = place(*hash) & wrap;
            while slots[slot] != FREE {
                slot = (slot + 1) & wrap;
            }
            slots[slot] = number as u32;
        }
        self.slots = slots;
    }

    fn build(&mut self, a: u32, b: u32, hash: u64, combine: impl Fn(u16, u16) -> u16) -> u32 {
        let (a, b) = (a as usize * self.variables, b as usize * self.variables);
        let left = &self.powers[a..a + self.variables];
        let right = &self.powers[b..b + self.variables];
        for ((to, a), b) in self.scratch.iter_mut().zip(left).zip(right) {
            *to = combine(*a, *b);
        }
        self.number(hash)
    }

    /// The monomial with these powers.
    pub fn of(&mut self, powers: &[(usize, u16)]) -> u32 {
        self.scratch.fill(0);
        let mut hash = 0u64;
        for (variable, power) in powers {
            self.scratch[*variable] = *power;
            hash = hash.wrapping_add(self.salts[*variable].wrapping_mul(u64::from(*power)));
        }
        self.number(hash)
    }

    /// The product; powers stay far below what they can be, since degrees are limited.
    pub fn product(&mut self, a: u32, b: u32) -> u32 {
        let hash = self.hashes[a as usize].wrapping_add(self.hashes[b as usize]);
        self.build(a, b, hash, u16::wrapping_add)
    }

    /// Where `b` divides `a`.
    pub fn quotient(&mut self, a: u32, b: u32) -> u32 {
        let hash = self.hashes[a as usize].wrapping_sub(self.hashes[b as usize]);
        self.build(a, b, hash, u16::wrapping_sub)
    }

    pub fn lcm(&mut self, a: u32, b: u32) -> u32 {
        let mut hash = self.hashes[a as usize];
        for (variable, (a, b)) in self.powers(a).iter().zip(self.powers(b)).enumerate() {
            if b > a {
                hash = hash.wrapping_add(self.salts[variable].wrapping_mul(u64::from(b - a)));
            }
        }
        self.build(a, b, hash, u16::max)
    }

    /// Whether the least common multiple of the first two is the third.
    pub fn is_lcm(&self, a: u32, b: u32, lcm: u32) -> bool {
        let parts = self.powers(a).iter().zip(self.powers(b)).zip(self.powers(lcm));
        self.mask(a) | self.mask(b) == self.mask(lcm)
            && parts.fold(true, |is_so, ((a, b), lcm)| is_so & (a.max(b) == lcm))
    }

    pub fn divides(&self, a: u32, b: u32) -> bool {
        self.mask(a) & !self.mask(b) == 0
            && self.powers(a).iter().zip(self.powers(b)).fold(true, |is_so, (a, b)| is_so & (a <= b))
    }

    pub fn are_coprime(&self, a: u32, b: u32) -> bool {
        self.powers(a).iter().zip(self.powers(b)).all(|(a, b)| *a == 0 || *b == 0)
    }

    /// By degree, then the one with the lower power of the last variable in which they differ is the greater one.
    pub fn compare(&self, a: u32, b: u32) -> Ordering {
        let by_degree = self.degree(a).cmp(&self.degree(b));
        by_degree.then_with(|| self.powers(b).iter().rev().cmp(self.powers(a).iter().rev()))
    }
}

/// A number whose bits have nothing to do with those of another one's (the finisher of splitmix64).
fn mixed(number: u64) -> u64 {
    let a = number.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let b = (a ^ (a >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let c = (b ^ (b >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    c ^ (c >> 31)
}

/// Where to look for a hash first.
fn place(hash: u64) -> usize {
    (hash ^ (hash >> 29)) as usize
}
