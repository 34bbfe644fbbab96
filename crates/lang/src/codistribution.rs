//! `codistribution(k)`: the rows from which a rank is decided, up to an order.

use super::codes::Code;
use super::error::Problem;
use super::matrices::LARGEST_MATRIX;
use super::model::{Matrix, System, Time, Value};
use dashu::integer::IBig;
use palmistry_math::expression::syntax::{Expr, ExprKind, Span};
use palmistry_math::expression::{NodeId, gradient};

/// No more rows are written down, nor a matrix of more entries than any other has.
const MOST_ROWS: usize = 4096;

impl System {
    /// The differentials of the outputs and of their Lie derivatives along at most `k` fields, the drift and the inputs in any order
    /// and as often as one likes: a row each, by all unknowns, shorter ones first. In discrete time those of the outputs after at
    /// most `k` steps. What is `k` for the whole codistribution is known as the index of observability.
    pub(super) fn codistribution(&mut self, arguments: &[Expr], span: &Span) -> Result<Value, Problem> {
        let Some(order) = self.order(arguments) else {
            let message =
                "'codistribution' takes the greatest number of fields that an output is differentiated along";
            return Err(Problem::new(Code::Arguments, span, message, "here")
                .help("as in rank(codistribution(2)) = 4"));
        };
        let fields = self.moving_fields();
        let names: Vec<String> = fields.iter().map(|field| self.fields[*field].name.clone()).collect();
        if self.outputs.is_empty() || names.is_empty() {
            let message =
                "there is no codistribution: no output, or no field that moves the states, stands above";
            return Err(Problem::new(Code::Field, span, message, "here")
                .help("claim it below the fields and the outputs"));
        }
        if !self.zero_outputs().is_empty() {
            let message = "outputs that are zero tie the states, which no matrix of Lie derivatives says";
            return Err(Problem::new(Code::ZeroOutput, span, message, "here")
                .help("ask for 'rank', which knows of them"));
        }
        let unknowns = self.states_of(&[], span)?;
        self.motion_is_final = true;
        let outputs: Vec<NodeId> = self.outputs.iter().map(|(_, value)| *value).collect();
        let column =
            |entries: Vec<NodeId>| Value::Matrix(Matrix { rows: entries.len(), columns: 1, entries });
        let mut guards: Vec<_> = self.output_guards.iter().flatten().copied().collect();
        let mut last = vec![outputs.clone()];
        let mut rows: Vec<NodeId> = outputs;
        for _ in 0..order {
            let mut longer = Vec::new();
            for name in &names {
                for values in &last {
                    let height = rows.len() + values.len();
                    if height > MOST_ROWS || height * unknowns.len() > LARGEST_MATRIX {
                        let message = format!(
                            "a codistribution of more than {MOST_ROWS} rows, or of more than {LARGEST_MATRIX} entries"
                        );
                        return Err(
                            Problem::new(Code::TooLarge, span, message, "here").help("ask for a lower order")
                        );
                    }
                    let value = column(values.clone());
                    let further = match self.time {
                        Time::Continuous => {
                            self.refuse_the_last_derivative(name, &value, span)?;
                            self.along_named(name, value, (span, span))?
                        }
                        Time::Discrete => {
                            let (value, needed) =
                                self.after_step(name, (value, std::mem::take(&mut guards)), span)?;
                            guards = needed;
                            value
                        }
                    };
                    self.refuse_growth(span)?;
                    if let Value::Matrix(further) = further {
                        rows.extend(&further.entries);
                        longer.push(further.entries);
                    }
                }
            }
            last = longer;
        }
        self.need_all(guards);
        let mut entries = Vec::with_capacity(rows.len() * unknowns.len());
        for row in &rows {
            entries.extend(gradient(&mut self.graph, *row, &unknowns));
            self.refuse_growth(span)?;
        }
        Ok(Value::Matrix(Matrix { rows: rows.len(), columns: unknowns.len(), entries }))
    }

    fn order(&self, arguments: &[Expr]) -> Option<usize> {
        let [Expr { kind: ExprKind::Number(order), .. }] = arguments else { return None };
        let is_whole = order.denominator().is_one();
        is_whole.then(|| usize::try_from(IBig::clone(order.numerator())).ok()).flatten()
    }
}
