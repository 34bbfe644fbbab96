//! Integer vectors that integer equations annihilate: the exponents of monomials that scalings leave as they are.

/// A basis of all integer vectors `e` of so many entries with `row . e = 0` for every row, with small entries. The basis is one of
/// the whole lattice: every integer solution is an integer combination of it. None where numbers grow beyond 64 bits.
pub(super) fn integer_kernel(rows: &[Vec<i64>], columns: usize) -> Option<Vec<Vec<i64>>> {
    // columns of the unit matrix are combined until the images of all but a few vanish (Hermite's normal form)
    let mut vectors: Vec<Vec<i64>> =
        (0..columns).map(|place| (0..columns).map(|at| i64::from(at == place)).collect()).collect();
    for row in rows {
        let image = |vector: &Vec<i64>| dot(row, vector);
        loop {
            let images = vectors.iter().map(image).collect::<Option<Vec<i64>>>()?;
            let least = (0..vectors.len()).filter(|at| images[*at] != 0).min_by_key(|at| images[*at].abs());
            let Some(least) = least else { break };
            let others: Vec<usize> =
                (0..vectors.len()).filter(|at| *at != least && images[*at] != 0).collect();
            if others.is_empty() {
                vectors.remove(least);
                break;
            }
            for other in others {
                let quotient = images[other].checked_div(images[least])?;
                let taken = vectors[least].clone();
                vectors[other] = combination(&vectors[other], &taken, quotient.checked_neg()?)?;
            }
        }
    }
    reduce(&mut vectors)?;
    vectors.iter_mut().for_each(|vector| orient(vector));
    Some(vectors)
}

fn dot(a: &[i64], b: &[i64]) -> Option<i64> {
    a.iter().zip(b).try_fold(0i64, |sum, (x, y)| sum.checked_add(x.checked_mul(*y)?))
}

/// `a + factor * b`
fn combination(a: &[i64], b: &[i64], factor: i64) -> Option<Vec<i64>> {
    a.iter().zip(b).map(|(x, y)| x.checked_add(factor.checked_mul(*y)?)).collect()
}

/// How long an exponent is in print: how many symbols, and how large their powers.
fn length(vector: &[i64]) -> (i64, usize) {
    let powers = vector.iter().map(|e| e.saturating_abs()).fold(0, i64::saturating_add);
    (powers, vector.iter().filter(|e| **e != 0).count())
}

/// [`length`] of a [`combination`], which is formed for few of those that are looked at.
fn combined_length(a: &[i64], b: &[i64], factor: i64) -> Option<(i64, usize)> {
    a.iter().zip(b).try_fold((0i64, 0), |(powers, count), (x, y)| {
        let entry = x.checked_add(factor.checked_mul(*y)?)?;
        Some((powers.saturating_add(entry.saturating_abs()), count + usize::from(entry != 0)))
    })
}

/// Adds and subtracts vectors of the basis as long as one gets shorter.
fn reduce(vectors: &mut [Vec<i64>]) -> Option<()> {
    loop {
        let mut shorter = false;
        for at in 0..vectors.len() {
            for other in (0..vectors.len()).filter(|other| *other != at) {
                for factor in [1, -1] {
                    let (here, there) = (&vectors[at], &vectors[other]);
                    if combined_length(here, there, factor)? < length(here) {
                        vectors[at] = combination(here, there, factor)?;
                        shorter = true;
                    }
                }
            }
        }
        if !shorter {
            return Some(());
        }
    }
}

/// Products before quotients; of two symbols the first above the bar.
fn orient(vector: &mut [i64]) {
    let sum: i64 = vector.iter().fold(0, |sum, e| sum.saturating_add(*e));
    let first = vector.iter().find(|e| **e != 0).copied().unwrap_or(0);
    if sum < 0 || sum == 0 && first < 0 {
        vector.iter_mut().for_each(|e| *e = e.saturating_neg());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Michaelis and Menten's `x' = -V x/(K + x)` with the scale of `x` unknown: weights 1, 1, 1 of `x, V, K`, and of `c` in
    /// `y = c x` minus one.
    #[test]
    fn exponents_of_a_scaling() {
        let found = integer_kernel(&[vec![1, 1, 1, -1]], 4).unwrap();
        assert_eq!(found.len(), 3);
        assert!(found.iter().all(|e| e.iter().map(|x| x.abs()).sum::<i64>() == 2));
    }

    /// Weights 2 and 3: `x^3/y^2` has a positive sum of exponents, and nothing smaller is a solution.
    #[test]
    fn the_lattice_is_whole() {
        assert_eq!(integer_kernel(&[vec![2, 3]], 2).unwrap(), [vec![3, -2]]);
        assert_eq!(integer_kernel(&[vec![2, 2]], 2).unwrap(), [vec![1, -1]]);
        assert!(integer_kernel(&[vec![1, 0], vec![0, 1]], 2).unwrap().is_empty());
        assert_eq!(integer_kernel(&[], 2).unwrap().len(), 2);
    }
}
