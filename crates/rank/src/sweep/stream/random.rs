//! Random numbers that are a function of their place: Threefry-2x64 with 13 rounds (J. K. Salmon, M. A. Moraes,
//! R. O. Dror and D. E. Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC 2011).
//!
//! Nothing is carried from one number to the next, so that it does not matter who draws which and in what order.

/// Rotations of the rounds, from the paper's table 2.
const ROTATIONS: [u32; 8] = [16, 42, 12, 31, 16, 32, 24, 21];
/// Added into the key schedule.
const PARITY: u64 = 0x1BD1_1BDA_A9FC_1A22;
const ROUNDS: usize = 13;

/// Two words for each counter.
#[inline(always)]
pub(super) fn threefry<const N: usize>(
    mut x: [u64; N],
    mut y: [u64; N],
    key: [u64; 2],
) -> ([u64; N], [u64; N]) {
    let keys = [key[0], key[1], PARITY ^ key[0] ^ key[1]];
    for lane in 0..N {
        x[lane] = x[lane].wrapping_add(keys[0]);
        y[lane] = y[lane].wrapping_add(keys[1]);
    }
    for round in 0..ROUNDS {
        for lane in 0..N {
            x[lane] = x[lane].wrapping_add(y[lane]);
            y[lane] = y[lane].rotate_left(ROTATIONS[round % 8]) ^ x[lane];
        }
        if round % 4 == 3 {
            let step = round / 4 + 1;
            for lane in 0..N {
                x[lane] = x[lane].wrapping_add(keys[step % 3]);
                y[lane] = y[lane].wrapping_add(keys[(step + 1) % 3]).wrapping_add(step as u64);
            }
        }
    }
    (x, y)
}

/// A number in `[0, 1)` on a grid of `2^-52` from a random word.
#[inline(always)]
pub(super) fn unit<const N: usize>(words: [u64; N]) -> [f64; N] {
    let mut units = [0.0; N];
    for lane in 0..N {
        units[lane] = f64::from_bits(words[lane] >> 12 | 1.0f64.to_bits()) - 1.0;
    }
    units
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Known answers of the authors' library Random123, file `kat_vectors`, lines `threefry2x64 13`.
    #[test]
    fn the_published_answers_are_met() {
        let answers = [
            ([0, 0], [0, 0], [0xf167_b032_c3b4_80bd, 0xe91f_9fee_4b7a_6fb5]),
            ([u64::MAX; 2], [u64::MAX; 2], [0xccde_c5c9_17a8_74b1, 0x4df5_3abc_a26c_eb01]),
            (
                [0x243f_6a88_85a3_08d3, 0x1319_8a2e_0370_7344],
                [0xa409_3822_299f_31d0, 0x082e_fa98_ec4e_6c89],
                [0xc3aa_c715_6104_2993, 0x3fe7_ae88_01af_f316],
            ),
        ];
        for (counter, key, answer) in answers {
            let (x, y) = threefry([counter[0]; 8], [counter[1]; 8], key);
            assert_eq!((x, y), ([answer[0]; 8], [answer[1]; 8]));
            assert_eq!(threefry([counter[0]], [counter[1]], key), ([answer[0]], [answer[1]]));
        }
    }

    #[test]
    fn units_fill_the_interval() {
        assert_eq!(unit([0; 8])[0], 0.0);
        assert_eq!(unit([u64::MAX; 8])[0], 1.0 - f64::EPSILON);
    }
}
