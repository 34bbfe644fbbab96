//! Claims on ranks as theorems: that a rank is reached at a state, and that there are no more rows or columns.

use crate::names::in_comment;
use crate::of_claim::{
    OfClaim, Theorem, as_argument, conditions_in, entries, is_solved, refuse, under, uses_with,
};
use crate::place::State;
use crate::printer::{Kind, Reason};
use crate::rank::{of_codistribution, of_matrix};
use dashu::rational::RBig;
use palmistry_lang::{Statement, Value};
use palmistry_math::expression::syntax::{Equation, Expr, ExprKind, Relation};
use palmistry_math::expression::{NodeId, Symbol};
use std::collections::BTreeSet;

/// Values are put into values no more often: each time may take as much longer as a term is long.
const MOST_PUTS: usize = 4;

/// The rank that is asked for, and the number that it is said to be.
pub(crate) struct RankAsked<'a> {
    /// Of a matrix, or of the observability codistribution.
    matrix: Option<&'a Expr>,
    number: &'a Expr,
}

/// What a statement on a rank asks for.
pub(crate) fn rank_of(statement: &Statement) -> Option<RankAsked<'_>> {
    let Equation { left, right, .. } = &statement.equation;
    let of = |side: &'_ Expr| match &side.kind {
        ExprKind::Name(name) => name == "rank",
        ExprKind::Call(name, _) => name == "rank",
        _ => false,
    };
    let (rank, number) = if of(left) { (left, right) } else { (right, left) };
    match &rank.kind {
        ExprKind::Name(name) if name == "rank" => Some(RankAsked { matrix: None, number }),
        ExprKind::Call(name, arguments) if name == "rank" && arguments.len() == 1 => {
            Some(RankAsked { matrix: arguments.first(), number })
        }
        _ => None,
    }
}

/// What is said of a rank, without the conditions and the number; and what shows it.
struct Shown {
    /// The arguments of the statement.
    of: String,
    /// The rank cannot be larger.
    most: usize,
    state: State,
    /// Rows, or Lie derivatives.
    by: String,
    uses: BTreeSet<String>,
}

impl OfClaim<'_> {
    /// That a rank is as large as it is said to be, and `more` beyond that; whether it is a theorem as well that it is nowhere larger.
    pub fn rank(
        &mut self,
        statement: &Statement,
        asked: &RankAsked<'_>,
        more: usize,
    ) -> Result<(Theorem, bool), Reason> {
        refuse(statement)?;
        if statement.equation.relation != Relation::Equal || !statement.further.is_empty() {
            return Err("a rank in no equation".to_owned());
        }
        let number = match self.scratch.elaborate_guarded(asked.number).map_err(|problem| problem.message)? {
            (Value::Scalar(node), _) => self.scratch.graph.constant_value(node).cloned(),
            _ => None,
        };
        let whole = number.filter(|number| *number.denominator() == RBig::ONE.denominator().clone());
        let claimed = whole.and_then(|number| usize::try_from(number.numerator().clone()).ok());
        let wanted = more + claimed.ok_or("a rank that is no whole number")?;
        let conditions = [&statement.conditions[..], self.system.initial_conditions()].concat();
        let shown = match asked.matrix {
            Some(matrix) => self.of_matrix(matrix, &conditions, wanted)?,
            None => self.of_codistribution(&conditions, wanted)?,
        };
        let mut printer = self.definitions.outermost(self.system, self.names);
        let listed = as_argument(&conditions_in(&mut printer, &conditions)?);
        let mut uses = shown.uses;
        uses.extend(printer.used);
        // a set that comes in pieces may have a larger rank on one of them than on another
        let is_one_piece = conditions.iter().all(|condition| is_solved(self.system, condition));
        let is_greatest = wanted == shown.most;
        if wanted == 0 && !is_greatest {
            return Err("a rank of zero, which no row reaches".to_owned());
        }
        let rank = if asked.matrix.is_some() { "rank" } else { "observability_rank" };
        let said = if is_greatest { format!("greatest_{rank}") } else { format!("{rank}_reaches") };
        let name = match (more, is_greatest && is_one_piece) {
            (0, true) => self.claim.id.clone(),
            (0, false) => format!("{} reached", self.claim.id),
            _ => format!("{} refuted", self.claim.id),
        };
        let ident = self.names.of("claim", &name);
        let text = format!(
            "{}Theorem {ident} : {said} {listed} {} {wanted}.\nProof. {rank}_at {} {}%nat. Qed.\n",
            self.comment(statement),
            shown.of,
            self.state(&shown.state),
            shown.by
        );
        Ok((Theorem { text, uses: uses_with(uses, &shown.state, self) }, is_greatest && is_one_piece))
    }

    fn of_matrix(&mut self, matrix: &Expr, conditions: &[Equation], wanted: usize) -> Result<Shown, Reason> {
        if self.definitions.puts_in("", matrix) > MOST_PUTS {
            return Err("values are put into values more often than the library should write out".to_owned());
        }
        let mut printer = self.definitions.outermost(self.system, self.names);
        let printed = printer.print(matrix)?.as_matrix();
        let uses = printer.used;
        let (rows, columns) = match printed.kind {
            Kind::Matrix(rows, columns) => (rows, columns),
            Kind::Number => (1, 1),
        };
        let mut compared = under(self.scratch, conditions)?;
        let all = entries(self.scratch, matrix, &mut compared.guards)?;
        let all: Vec<Vec<NodeId>> = all.chunks(columns).map(<[NodeId]>::to_vec).collect();
        let named = self.variables(&uses);
        let (state, places) = of_matrix(self.scratch, &compared, &all, wanted, &named)?;
        let by = format!("[{}]", places.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "));
        Ok(Shown { of: printed.argument(), most: rows.min(columns), state, by, uses })
    }

    fn of_codistribution(&mut self, conditions: &[Equation], wanted: usize) -> Result<Shown, Reason> {
        let system = self.system;
        let fields = system.moving_fields();
        if !system.zero_outputs().is_empty() {
            return Err("outputs that are zero".to_owned());
        }
        if self.definitions.outputs.len() != system.outputs.len() {
            return Err("outputs that the file does not write one by one".to_owned());
        }
        let mut uses = BTreeSet::new();
        let mut idents = Vec::new();
        let mut printer = self.definitions.outermost(system, self.names);
        for field in &fields {
            let field = &system.fields[*field];
            if let Some(known) = self.definitions.fields.get(&field.name) {
                printer.used.insert(known.clone()?);
                idents.push(known.clone()?);
                continue;
            }
            // one that no file writes: it moves the last derivative of a known signal
            let is_one = |(_, rate): &(Symbol, NodeId)| {
                system.graph.constant_value(*rate).is_some_and(|rate| *rate == RBig::ONE)
            };
            if !field.components.iter().all(is_one) {
                return Err(format!("the field {}, which the file does not write", in_comment(&field.name)));
            }
            let moved = field.components.iter();
            let moved =
                moved.map(|(symbol, _)| format!("({}, 1)", printer.variable(system.symbol_name(*symbol))));
            idents.push(format!("field [{}]", moved.collect::<Vec<_>>().join("; ")));
        }
        uses.extend(printer.used);
        let mut outputs = Vec::new();
        for output in &self.definitions.outputs {
            let (text, mentions) = output.clone()?;
            outputs.push(text);
            uses.extend(mentions);
        }
        let mut printer = self.definitions.outermost(system, self.names);
        let unknowns: Vec<Symbol> = system.unknowns();
        let columns: Vec<String> =
            unknowns.iter().map(|symbol| printer.variable(system.symbol_name(*symbol))).collect();
        uses.extend(printer.used);
        let mut compared = under(self.scratch, conditions)?;
        compared.guards.extend(system.output_guards.iter().flatten().cloned());
        compared
            .guards
            .extend(fields.iter().flat_map(|field| system.fields[*field].guards.iter().flatten().cloned()));
        let named = self.variables(&uses);
        let (state, words) = of_codistribution(self.scratch, &compared, wanted, &named)?;
        let word = |word: &crate::rank::Word| {
            let along = word.fields.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ");
            format!("([{along}], {})", word.output)
        };
        let by = format!("[{}]", words.iter().map(word).collect::<Vec<_>>().join("; "));
        let of = format!("[{}] [{}] [{}]", idents.join("; "), outputs.join("; "), columns.join("; "));
        Ok(Shown { of, most: columns.len(), state, by, uses })
    }
}
