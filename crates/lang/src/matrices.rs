//! Calculating with matrices of expressions: sums, products, blocks, inverse, the products of vectors.

use super::codes::Code;
use super::determinant::{LARGEST, determinant};
use super::error::Problem;
use super::model::{Matrix, System, Value};
use palmistry_math::expression::syntax::{Expr, Span};
use palmistry_math::expression::{Need, NodeId};

/// The greatest number of entries of a matrix.
pub(super) const LARGEST_MATRIX: usize = 1 << 16;

impl System {
    /// The determinant of a square matrix of expressions. An error is a matrix that is not square, or too large to be written out.
    pub fn determinant(&mut self, matrix: &Matrix, span: &Span) -> Result<Value, Problem> {
        if matrix.rows != matrix.columns {
            let message = format!("the determinant of a matrix of {} by {}", matrix.rows, matrix.columns);
            let problem = Problem::new(Code::Shape, span, message, "this is not square");
            return Err(match matrix.columns == self.unknowns().len() {
                true => problem.help(self.columns_in_words()),
                false => problem.help("a determinant has as many rows as columns, as in det([a, b; c, d])"),
            });
        }
        if matrix.rows > LARGEST {
            let message = format!("a determinant of {} rows; at most {LARGEST} are expanded", matrix.rows);
            return Err(Problem::new(Code::TooLarge, span, message, "this"));
        }
        Ok(Value::Scalar(determinant(&mut self.graph, matrix)))
    }

    /// The inverse by cofactors over the determinant: exact, and short for the small matrices of papers.
    pub(super) fn inverse(&mut self, matrix: &Matrix, span: &Span) -> Result<Value, Problem> {
        let Value::Scalar(whole) = self.determinant(matrix, span)? else {
            return Err(Problem::new(Code::Shape, span, "no determinant", "here"));
        };
        let n = matrix.rows;
        let mut entries = Vec::with_capacity(n * n);
        for row in 0..n {
            for column in 0..n {
                // the cofactor of the transposed place
                let kept = |skip: usize| (0..n).filter(move |i| *i != skip);
                let minor: Vec<NodeId> = kept(column)
                    .flat_map(|i| kept(row).map(move |j| (i, j)))
                    .map(|(i, j)| matrix.at(i, j))
                    .collect();
                let minor = Matrix { rows: n - 1, columns: n - 1, entries: minor };
                let value = determinant(&mut self.graph, &minor);
                let value = if (row + column) % 2 == 0 { value } else { self.graph.neg(value) };
                self.need(whole, Need::NotZero);
                entries.push(self.graph.div(value, whole));
            }
        }
        Ok(Value::Matrix(Matrix { rows: n, columns: n, entries }))
    }

    /// The sum of the products of entries.
    pub(super) fn dot(&mut self, a: &Matrix, b: &Matrix, span: &Span) -> Result<Value, Problem> {
        let vectors = (a.rows == 1 || a.columns == 1) && (b.rows == 1 || b.columns == 1);
        if !vectors || a.entries.len() != b.entries.len() {
            let message =
                format!("a matrix of {} by {} and one of {} by {}", a.rows, a.columns, b.rows, b.columns);
            return Err(Problem::new(Code::Shape, span, message, "'dot' takes two vectors of one length"));
        }
        let products: Vec<NodeId> =
            a.entries.iter().zip(&b.entries).map(|(x, y)| self.graph.mul(*x, *y)).collect();
        Ok(Value::Scalar(self.graph.sum(products)))
    }

    /// The vector product in three dimensions; in two, the number `a1 b2 - a2 b1`.
    pub(super) fn cross(&mut self, a: &Matrix, b: &Matrix, span: &Span) -> Result<Value, Problem> {
        let (x, y) = (&a.entries, &b.entries);
        let vectors = (a.rows == 1 || a.columns == 1) && (a.rows, a.columns) == (b.rows, b.columns);
        let mut part = |i: usize, j: usize| {
            let (left, right) = (self.graph.mul(x[i], y[j]), self.graph.mul(x[j], y[i]));
            self.graph.sub(left, right)
        };
        match x.len() {
            2 if vectors => Ok(Value::Scalar(part(0, 1))),
            3 if vectors => {
                let entries = vec![part(1, 2), part(2, 0), part(0, 1)];
                Ok(Value::Matrix(Matrix { entries, ..*a }))
            }
            _ => {
                let message =
                    format!("a matrix of {} by {} and one of {} by {}", a.rows, a.columns, b.rows, b.columns);
                Err(Problem::new(
                    Code::Shape,
                    span,
                    message,
                    "'cross' takes two vectors of length two or three",
                ))
            }
        }
    }

    /// A matrix from rows of blocks: numbers, and matrices that fit together.
    pub(super) fn blocks(&mut self, rows: &[Vec<Expr>], span: &Span) -> Result<Value, Problem> {
        let mut entries = Vec::new();
        let (mut height, mut width) = (0, None);
        for row in rows {
            let mut blocks = Vec::new();
            for block in row {
                let matrix = match self.elaborate(block)? {
                    Value::Scalar(id) => Matrix { rows: 1, columns: 1, entries: vec![id] },
                    Value::Matrix(matrix) => matrix,
                    other => {
                        let message = format!("{} cannot stand in a matrix", other.describe());
                        return Err(Problem::new(Code::Value, &block.span, message, "this"));
                    }
                };
                if blocks.first().is_some_and(|first: &Matrix| first.rows != matrix.rows) {
                    let message = format!("a block of {} rows beside one of {}", matrix.rows, blocks[0].rows);
                    return Err(Problem::new(Code::Shape, &block.span, message, "this block"));
                }
                blocks.push(matrix);
            }
            let columns: usize = blocks.iter().map(|block| block.columns).sum();
            let begin = row.first().map_or(span, |first| &first.span);
            if *width.get_or_insert(columns) != columns {
                let message = format!("a row of {columns} entries below one of {}", width.unwrap_or(0));
                return Err(Problem::new(Code::Shape, begin, message, "this row")
                    .help("all rows have as many entries, as in [a, b; c, d]"));
            }
            for line in 0..blocks.first().map_or(0, |block| block.rows) {
                for block in &blocks {
                    entries
                        .extend_from_slice(&block.entries[line * block.columns..(line + 1) * block.columns]);
                }
                height += 1;
            }
            if entries.len() > LARGEST_MATRIX {
                return Err(Problem::new(
                    Code::TooLarge,
                    span,
                    format!("a matrix of more than {LARGEST_MATRIX} entries"),
                    "here",
                ));
            }
        }
        Ok(Value::Matrix(Matrix { rows: height, columns: width.unwrap_or(0), entries }))
    }

    /// The same operation on every entry.
    pub(super) fn map(
        &mut self,
        value: Value,
        span: &Span,
        mut operation: impl FnMut(&mut Self, NodeId) -> NodeId,
    ) -> Result<Value, Problem> {
        match value {
            Value::Scalar(id) => Ok(Value::Scalar(operation(self, id))),
            Value::Matrix(m) => {
                let entries = m.entries.iter().map(|id| operation(self, *id)).collect();
                Ok(Value::Matrix(Matrix { entries, ..m }))
            }
            other => {
                let message = format!("{} cannot be calculated with", other.describe());
                Err(Problem::new(Code::Value, span, message, "it stands alone on one side of '='")
                    .help("as in rank = 3"))
            }
        }
    }

    pub(super) fn entrywise(&mut self, a: Value, b: Value, span: &Span) -> Result<Value, Problem> {
        match Value::compared(a, b) {
            (Value::Scalar(x), Value::Scalar(y)) => Ok(Value::Scalar(self.graph.add(x, y))),
            (Value::Matrix(x), Value::Matrix(y)) if (x.rows, x.columns) == (y.rows, y.columns) => {
                let pairs = x.entries.iter().zip(&y.entries);
                let entries = pairs.map(|(x, y)| self.graph.add(*x, *y)).collect();
                Ok(Value::Matrix(Matrix { entries, ..x }))
            }
            (x, y) => {
                let message = format!("{} and {} cannot be added", x.describe(), y.describe());
                Err(Problem::new(Code::Shape, span, message, "this").help(of_kinds(&x, &y)))
            }
        }
    }

    pub(super) fn multiply(
        &mut self,
        a: Value,
        b: Value,
        divides: bool,
        span: &Span,
    ) -> Result<Value, Problem> {
        // a matrix of one entry is a number where the shapes do not fit otherwise, and as a divisor
        let fits = match (&a, &b) {
            (Value::Matrix(x), Value::Matrix(y)) => x.columns == y.rows && !divides,
            _ => false,
        };
        let (a, b) = match (a.as_number(), b.as_number()) {
            _ if fits => (a, b),
            (_, Some(number)) => (a, Value::Scalar(number)),
            (Some(number), None) => (Value::Scalar(number), b),
            (None, None) => (a, b),
        };
        match (a, b, divides) {
            (value, Value::Scalar(divisor), true) => {
                self.need(divisor, Need::NotZero);
                self.map(value, span, |system, id| system.graph.div(id, divisor))
            }
            (value @ (Value::Scalar(_) | Value::Matrix(_)), Value::Scalar(factor), false) => {
                self.map(value, span, |system, id| system.graph.mul(id, factor))
            }
            (Value::Scalar(factor), value @ Value::Matrix(_), false) => {
                self.map(value, span, |system, id| system.graph.mul(factor, id))
            }
            (Value::Matrix(x), Value::Matrix(y), false) if x.columns == y.rows => {
                let mut entries = Vec::new();
                for row in 0..x.rows {
                    for column in 0..y.columns {
                        let mut sum = self.graph.integer(0);
                        for k in 0..x.columns {
                            let product = self.graph.mul(x.at(row, k), y.at(k, column));
                            sum = self.graph.add(sum, product);
                        }
                        entries.push(sum);
                    }
                }
                Ok(Value::Matrix(Matrix { rows: x.rows, columns: y.columns, entries }))
            }
            (x, y, divides) => {
                let verb = if divides { "divided" } else { "multiplied" };
                let message = format!("{} cannot be {verb} by {}", x.describe(), y.describe());
                Err(Problem::new(Code::Shape, span, message, "this").help(of_kinds(&x, &y)))
            }
        }
    }

    /// By what the columns of a row of differentials are.
    pub(super) fn columns_in_words(&self) -> String {
        let names = self.column_names();
        let first = names.first().map_or("x", |name| name);
        format!(
            "a row d(e) has an entry for each unknown: {}; d(e, {first}) is by these alone that are named",
            names.join(", ")
        )
    }
}

/// Why two values do not go together in a calculation.
fn of_kinds(x: &Value, y: &Value) -> &'static str {
    match (x, y) {
        (Value::Scalar(_) | Value::Matrix(_), Value::Scalar(_) | Value::Matrix(_)) => {
            "matrices have fitting numbers of rows and columns, as in [a; b] + [c; d] or [a, b]*[c; d]; a product of two vectors is dot(v, w)"
        }
        _ => "it stands alone on one side of a claim, as in rank = 3",
    }
}

/// Rows for columns.
pub(super) fn transpose(matrix: &Matrix) -> Matrix {
    let entries = (0..matrix.columns).flat_map(|j| (0..matrix.rows).map(move |i| matrix.at(i, j))).collect();
    Matrix { rows: matrix.columns, columns: matrix.rows, entries }
}
