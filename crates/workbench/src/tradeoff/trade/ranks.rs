//! Ways to the rank of a small matrix.
//!
//! The floating-point ones first scale each row to length one, and count what exceeds `max(rows, columns)` times the
//! spacing of the numbers at one times the largest: singular values, or the pivots of a decomposition.

use faer::Mat;
use nalgebra::{DMatrix, RealField};
use palmistry_math::number::{Arithmetic, Floats, Interval, MOST_ITERATIONS, RealNumber};
use palmistry_rank::observability::{certain_rank, rank, singular_values};

/// What a way says of one matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RankVerdict {
    Rank(usize),
    /// It cannot decide.
    Undecided,
    /// An entry is no number, or the decomposition gave up.
    Failed,
}

/// Decides the ranks of blocks one after the other; `None` is a block that could not be computed.
pub(super) type RankWay<'w, N> =
    Box<dyn Fn(&[Option<Vec<N>>], &mut dyn FnMut(RankVerdict)) + Send + Sync + 'w>;

/// A way that takes one block at a time, by rows.
pub(super) fn each<'w, N>(decide: impl Fn(&[N]) -> RankVerdict + Send + Sync + 'w) -> RankWay<'w, N> {
    Box::new(move |blocks, sink| {
        for block in blocks {
            sink(block.as_deref().map_or(RankVerdict::Failed, &decide));
        }
    })
}

/// A machine float that both libraries take.
pub(super) trait Float: RealNumber + RealField + faer::traits::RealField {}
impl Float for f32 {}
impl Float for f64 {}

/// Rows scaled to length one, by the largest entry first.
fn scaled<F: Float>(block: &[F], columns: usize) -> Option<Vec<F>> {
    let mut scaled = block.to_vec();
    for row in scaled.chunks_mut(columns) {
        if !row.iter().all(|x| RealNumber::is_finite(*x)) {
            return None;
        }
        let zero = <F as RealNumber>::from_f64(0.0);
        let largest = row.iter().fold(zero, |a, x| if x.abs() > a { x.abs() } else { a });
        if largest > zero {
            let length = row.iter().fold(zero, |sum, x| sum + (*x / largest) * (*x / largest)).sqrt();
            for x in row {
                *x = *x / largest / length;
            }
        }
    }
    Some(scaled)
}

fn counted<F: Float>(values: impl Iterator<Item = F> + Clone, rows: usize, columns: usize) -> RankVerdict {
    let size = |x: F| RealNumber::to_f64(x).abs();
    let largest = values.clone().map(size).fold(0.0, f64::max);
    let spacing = RealNumber::to_f64(F::default_epsilon());
    let tolerance = rows.max(columns) as f64 * spacing * largest;
    if !largest.is_finite() {
        return RankVerdict::Failed;
    }
    RankVerdict::Rank(values.filter(|x| size(*x) > tolerance).count())
}

/// With rows scaled, as a matrix of one of the libraries.
fn nalgebra_matrix<F: Float>(block: &[F], columns: usize) -> Option<DMatrix<F>> {
    Some(DMatrix::from_row_slice(block.len() / columns, columns, &scaled(block, columns)?))
}

fn faer_matrix<F: Float>(block: &[F], columns: usize) -> Option<Mat<F>> {
    let scaled = scaled(block, columns)?;
    Some(Mat::from_fn(block.len() / columns, columns, |i, j| scaled[i * columns + j]))
}

pub(super) fn svd_nalgebra<F: Float>(block: &[F], columns: usize) -> RankVerdict {
    let found = nalgebra_matrix(block, columns)
        .and_then(|matrix| matrix.try_svd(false, false, F::default_epsilon(), MOST_ITERATIONS));
    found.map_or(RankVerdict::Failed, |svd| {
        counted(svd.singular_values.iter().copied(), block.len() / columns, columns)
    })
}

pub(super) fn svd_faer<F: Float>(block: &[F], columns: usize) -> RankVerdict {
    let found = faer_matrix(block, columns).and_then(|matrix| matrix.singular_values().ok());
    found.map_or(RankVerdict::Failed, |values| counted(values.into_iter(), block.len() / columns, columns))
}

/// The pivots of a triangular factor; with fewer rows than columns it is not square.
fn on_the_diagonal<F: Float>(factor: &DMatrix<F>) -> impl Iterator<Item = F> + Clone {
    (0..factor.nrows().min(factor.ncols())).map(|place| factor[(place, place)])
}

pub(super) fn qr<F: Float>(block: &[F], columns: usize) -> RankVerdict {
    let Some(matrix) = nalgebra_matrix(block, columns) else { return RankVerdict::Failed };
    let r = matrix.col_piv_qr().unpack_r();
    counted(on_the_diagonal(&r), block.len() / columns, columns)
}

pub(super) fn lu<F: Float>(block: &[F], columns: usize) -> RankVerdict {
    let Some(matrix) = nalgebra_matrix(block, columns) else { return RankVerdict::Failed };
    let u = matrix.full_piv_lu().u();
    counted(on_the_diagonal(&u), block.len() / columns, columns)
}

/// As `palmistry rank` does it: equilibrated, by faer.
pub(super) fn equilibrated(block: &[f64], columns: usize) -> RankVerdict {
    let errors = vec![0.0; block.len()];
    singular_values(block, &errors, columns)
        .map_or(RankVerdict::Failed, |spectrum| RankVerdict::Rank(spectrum.rank))
}

/// Elimination with complete pivoting for numbers that no library decomposes, with the given spacing at one.
pub(super) fn elimination<T: RealNumber>(block: &[T], columns: usize, spacing: f64) -> RankVerdict {
    let rows: Vec<Vec<T>> = block.chunks(columns).map(<[T]>::to_vec).collect();
    if !block.iter().all(|x| x.is_finite()) {
        return RankVerdict::Failed;
    }
    let mut matrix = rows;
    for row in &mut matrix {
        let largest = row.iter().fold(0.0f64, |a, x| a.max(x.to_f64().abs()));
        if largest > 0.0 {
            row.iter_mut().for_each(|x| *x = *x / T::from_f64(largest));
        }
    }
    let count = matrix.len();
    let mut first = 0.0;
    for step in 0..count.min(columns) {
        let places = (step..count).flat_map(|i| (step..columns).map(move |j| (i, j)));
        let size = |(i, j): (usize, usize)| matrix[i][j].to_f64().abs();
        let Some((i, j)) = places.max_by(|a, b| size(*a).total_cmp(&size(*b))) else { break };
        let pivot = size((i, j));
        if step == 0 {
            first = pivot;
        }
        if pivot <= count.max(columns) as f64 * spacing * first || pivot == 0.0 {
            return RankVerdict::Rank(step);
        }
        matrix.swap(step, i);
        matrix.iter_mut().for_each(|row| row.swap(step, j));
        let (above, below) = matrix.split_at_mut(step + 1);
        let top = &above[step];
        for row in below {
            let factor = row[step] / top[step];
            for (x, p) in row[step..].iter_mut().zip(&top[step..]) {
                *x = *x - factor * *p;
            }
        }
    }
    RankVerdict::Rank(count.min(columns))
}

/// A full rank for certain, or nothing.
pub(super) fn intervals(block: &[Interval], columns: usize) -> RankVerdict {
    let rows: Vec<Vec<Interval>> = block.chunks(columns).map(<[Interval]>::to_vec).collect();
    let most = rows.len().min(columns);
    match certain_rank(&Floats::<Interval>::new(), rows, |v| v.mid().abs() / v.rad()) {
        Ok(rank) if rank == most => RankVerdict::Rank(rank),
        Ok(_) => RankVerdict::Undecided,
        Err(_) => RankVerdict::Failed,
    }
}

/// By elimination over numbers that know whether they are zero.
pub(super) fn exact<A: Arithmetic>(arithmetic: &A, block: &[A::Number], columns: usize) -> RankVerdict {
    let rows = block.chunks(columns).map(<[A::Number]>::to_vec).collect();
    rank(arithmetic, rows).map_or(RankVerdict::Failed, RankVerdict::Rank)
}
