//! Vectors and small linear systems over [`Real`].

use super::Real;

/// A vector of `N` components.
pub type Vector<const N: usize> = [Real; N];

/// A square matrix, by rows.
pub type Square<const N: usize> = [[Real; N]; N];

/// `a + b`
pub fn sum<const N: usize>(a: &Vector<N>, b: &Vector<N>) -> Vector<N> {
    std::array::from_fn(|i| &a[i] + &b[i])
}

/// `a - b`
pub fn difference<const N: usize>(a: &Vector<N>, b: &Vector<N>) -> Vector<N> {
    std::array::from_fn(|i| &a[i] - &b[i])
}

/// `factor * a`
pub fn scaled<const N: usize>(factor: &Real, a: &Vector<N>) -> Vector<N> {
    std::array::from_fn(|i| factor * &a[i])
}

/// The scalar product.
pub fn dot<const N: usize>(a: &Vector<N>, b: &Vector<N>) -> Real {
    (0..N).fold(Real::zero(), |total, i| total + &a[i] * &b[i])
}

/// The cross product of two vectors in the plane, a number: positive where `b` lies to the left of `a`.
pub fn cross_planar(a: &Vector<2>, b: &Vector<2>) -> Real {
    &a[0] * &b[1] - &a[1] * &b[0]
}

/// The cross product in space.
pub fn cross(a: &Vector<3>, b: &Vector<3>) -> Vector<3> {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        &a[j] * &b[k] - &a[k] * &b[j]
    })
}

/// `m * a`
pub fn apply<const N: usize>(m: &Square<N>, a: &Vector<N>) -> Vector<N> {
    std::array::from_fn(|i| dot(&m[i], a))
}

/// The transpose of a matrix.
pub fn transposed<const N: usize>(m: &Square<N>) -> Square<N> {
    std::array::from_fn(|i| std::array::from_fn(|j| m[j][i].clone()))
}

/// The product of two matrices.
pub fn product<const N: usize>(a: &Square<N>, b: &Square<N>) -> Square<N> {
    std::array::from_fn(|i| {
        std::array::from_fn(|j| (0..N).fold(Real::zero(), |total, k| total + &a[i][k] * &b[k][j]))
    })
}

/// The axis of a matrix: the vector `w` with `w × p = (m - mᵀ)/2 p` for every `p`. The symmetric part has no say.
pub fn axial(m: &Square<3>) -> Vector<3> {
    let half = Real::power_of_two(-1);
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        (&m[k][j] - &m[j][k]) * &half
    })
}

/// The solution of `m x = b` by elimination with partial pivoting; undefined where `m` is singular.
pub fn solve<const N: usize>(mut m: Square<N>, mut b: Vector<N>) -> Vector<N> {
    for column in 0..N {
        let pivot = (column..N)
            .fold(column, |best, row| if m[row][column].abs() > m[best][column].abs() { row } else { best });
        m.swap(column, pivot);
        b.swap(column, pivot);
        for row in column + 1..N {
            let factor = &m[row][column] / &m[column][column];
            m[row] = difference(&m[row], &scaled(&factor, &m[column]));
            b[row] = &b[row] - &factor * &b[column];
        }
    }
    let mut x: Vector<N> = std::array::from_fn(|_| Real::zero());
    for row in (0..N).rev() {
        let known = (row + 1..N).fold(Real::zero(), |total, k| total + &m[row][k] * &x[k]);
        x[row] = (&b[row] - known) / &m[row][row];
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_linear_system_is_solved_and_a_singular_one_has_no_solution() {
        let whole = |rows: [[i64; 3]; 3]| rows.map(|row| row.map(Real::whole));
        // x = (1, -2, 3) by hand
        let found = solve(whole([[0, 1, 2], [1, 0, 1], [2, 1, 0]]), [4, 4, 0].map(Real::whole));
        for (x, expected) in found.iter().zip([1, -2, 3]) {
            assert!((x - Real::whole(expected)).abs() < Real::power_of_two(-300));
        }
        let singular = solve(whole([[1, 2, 3], [2, 4, 6], [0, 1, 1]]), [1, 2, 3].map(Real::whole));
        assert!(singular.iter().any(|x| !x.is_defined()));
    }

    #[test]
    fn the_axis_of_a_cross_product_is_found_again() {
        let axis = [2, -3, 5].map(Real::whole);
        let basis: Square<3> = std::array::from_fn(|i| std::array::from_fn(|j| Real::whole((i == j) as i64)));
        let matrix = transposed(&std::array::from_fn(|i| cross(&axis, &basis[i])));
        assert_eq!(axial(&matrix), axis);
    }
}
