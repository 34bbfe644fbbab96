//! Singular values in any number of fixed size, by one-sided Jacobi rotations: pairs of columns are turned until they are
//! orthogonal, and their lengths are then the singular values (M. R. Hestenes, "Inversion of matrices by
//! biorthogonalization", J. SIAM 6, 1958).

use palmistry_math::number::{Function, RealNumber, Refusal};

const MOST_SWEEPS: usize = 40;
const ROUNDS_OF_SCALING: usize = 20;

/// How many singular values of a matrix (by rows) exceed `max(rows, columns) * epsilon` of the largest, after rows and
/// columns have been brought to about one size by powers of two, which round nothing.
///
/// # Errors
/// [`Refusal::NotFinite`], where an entry or a singular value is not finite.
pub(super) fn rank<T: RealNumber>(
    mut entries: Vec<T>,
    columns: usize,
    epsilon: f64,
) -> Result<usize, Refusal> {
    if columns == 0 || entries.is_empty() {
        return Ok(0);
    }
    scale(&mut entries, columns);
    let rows = entries.len() / columns;
    let mut vectors: Vec<Vec<T>> =
        (0..columns).map(|j| (0..rows).map(|i| entries[i * columns + j]).collect()).collect();
    let values = lengths(&mut vectors, epsilon)?;
    if !values.iter().all(|value| value.is_finite()) {
        return Err(Refusal::NotFinite);
    }
    let largest = values.iter().map(|value| value.to_f64()).fold(0.0, f64::max);
    let threshold = rows.max(columns) as f64 * epsilon * largest;
    Ok(values.iter().filter(|value| value.to_f64() > threshold).count())
}

/// Divides rows and columns in turn by the power of two next to their largest entry.
fn scale<T: RealNumber>(entries: &mut [T], columns: usize) {
    let rows = entries.len() / columns;
    for _ in 0..ROUNDS_OF_SCALING {
        let mut changed = false;
        for line in 0..rows + columns {
            let (first, step, count) =
                if line < rows { (line * columns, 1, columns) } else { (line - rows, columns, rows) };
            let places = || (0..count).map(|k| first + k * step);
            let largest = places().fold(0.0f64, |a, place| a.max(entries[place].to_f64().abs()));
            if largest == 0.0 || !largest.is_finite() {
                continue;
            }
            let exponent = -(largest.log2().round() as i32);
            changed |= exponent != 0;
            // in steps, so that the power itself neither overflows nor vanishes in single precision
            let mut rest = exponent;
            while rest != 0 {
                let part = rest.clamp(-100, 100);
                let factor = T::from_f64(2f64.powi(part));
                for place in places() {
                    entries[place] = entries[place] * factor;
                }
                rest -= part;
            }
        }
        if !changed {
            break;
        }
    }
}

fn dot<T: RealNumber>(a: &[T], b: &[T]) -> T {
    a.iter().zip(b).fold(T::from_f64(0.0), |sum, (x, y)| sum + *x * *y)
}

/// The lengths of the columns, once they are orthogonal.
fn lengths<T: RealNumber>(vectors: &mut [Vec<T>], epsilon: f64) -> Result<Vec<T>, Refusal> {
    let one = T::from_f64(1.0);
    let magnitude = |x: T| if x < T::from_f64(0.0) { -x } else { x };
    for _ in 0..MOST_SWEEPS {
        let mut turned = false;
        for i in 0..vectors.len() {
            for j in i + 1..vectors.len() {
                let (head, tail) = vectors.split_at_mut(j);
                let (Some(a), Some(b)) = (head.get_mut(i), tail.first_mut()) else { continue };
                let (alpha, beta, gamma) = (dot(a, a), dot(b, b), dot(a, b));
                let size = (alpha.to_f64() * beta.to_f64()).sqrt();
                if gamma.to_f64().abs() <= epsilon * size || gamma.to_f64() == 0.0 {
                    continue;
                }
                turned = true;
                let zeta = (beta - alpha) / (gamma + gamma);
                let root = (one + zeta * zeta).function(Function::Sqrt)?;
                let t = one / (magnitude(zeta) + root);
                let t = if zeta < T::from_f64(0.0) { -t } else { t };
                let cosine = one / (one + t * t).function(Function::Sqrt)?;
                let sine = cosine * t;
                for (x, y) in a.iter_mut().zip(b.iter_mut()) {
                    (*x, *y) = (cosine * *x - sine * *y, sine * *x + cosine * *y);
                }
            }
        }
        if !turned {
            break;
        }
    }
    vectors.iter().map(|vector| dot(vector, vector).function(Function::Sqrt)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use palmistry_math::number::DoubleDouble;

    #[test]
    fn a_hilbert_matrix_is_singular_for_single_precision_alone() {
        // det of the 8x8 Hilbert matrix is 2.7e-33 (1/365356847125734485878112256000000, OEIS A005249): its smallest
        // singular value, 1.1e-10, is far above 2^-104 and below 8 * 2^-23 of the largest, 1.7
        let hilbert = |i: usize, j: usize| 1.0 / (i + j + 1) as f64;
        let doubles: Vec<f64> = (0..64).map(|k| hilbert(k / 8, k % 8)).collect();
        assert_eq!(rank(doubles.clone(), 8, f64::EPSILON), Ok(8));
        let singles: Vec<f32> = doubles.iter().map(|x| *x as f32).collect();
        assert!(rank(singles, 8, f64::from(f32::EPSILON)).unwrap() < 8);
    }

    #[test]
    fn what_only_double_doubles_see() {
        let one = DoubleDouble::from_f64(1.0);
        let entries = vec![one, one, one, one + DoubleDouble::from_f64(1e-25)];
        assert_eq!(rank(entries.clone(), 2, 2f64.powi(-104)), Ok(2));
        let rounded: Vec<f64> = entries.iter().map(|x| x.to_f64()).collect();
        assert_eq!(rank(rounded, 2, f64::EPSILON), Ok(1));
    }

    #[test]
    fn sizes_do_not_matter_and_infinities_are_refused() {
        assert_eq!(rank(vec![1e-30f32, 2e-30, 1e30, 3e30], 2, f64::from(f32::EPSILON)), Ok(2));
        assert_eq!(rank(vec![0.0f32; 4], 2, f64::from(f32::EPSILON)), Ok(0));
        assert_eq!(rank(vec![f64::INFINITY, 1.0, 1.0, 2.0], 2, f64::EPSILON), Err(Refusal::NotFinite));
    }
}
