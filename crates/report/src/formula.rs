//! Statements and expressions of the language as mathematics: MathML for a page, LaTeX for a paper.

use palmistry_lang::{Looks, Statement, parse_statement};
use palmistry_math::expression::notation::{
    Fence, Formula, FormulaLayout, FormulaSign, latex, mathml_in_pieces,
};
use palmistry_math::expression::parse_expression;
use palmistry_math::expression::syntax::{Equation, Expr, ExprKind};

/// What lies deeper is shown as it is written: browsers give up before.
const DEEPEST: usize = 60;

/// A statement as it is written in a file, as a formula; none where the text is no statement.
fn statement_formula(text: &str, looks: &Looks) -> Option<Formula> {
    let statement = parse_statement(text).ok()?;
    let layout = FormulaLayout::with_looks(text, expressions(&statement), looks);
    let relations = |equations: Vec<&Equation>| match layout.relations(&equations) {
        Formula::Row(parts) => parts,
        other => vec![other],
    };
    let mut row = match statement.is_about_observability() {
        true => vec![layout.expression(&statement.equation.left)],
        false => relations(statement.relations().collect()),
    };
    if statement.on_sample {
        row.push(Formula::Text("on sample"));
    }
    if !statement.conditions.is_empty() {
        row.push(Formula::Text("where"));
        row.extend(relations(statement.conditions.iter().collect()));
    }
    if statement.except.as_ref().is_some_and(Vec::is_empty) {
        row.push(Formula::Text("everywhere"));
    }
    for (place, set) in statement.except.iter().flatten().enumerate() {
        row.push(Formula::Text(if place == 0 { "except where" } else { "or" }));
        row.extend(relations(set.iter().collect()));
    }
    Some(Formula::Row(row))
}

fn expressions(statement: &Statement) -> impl Iterator<Item = &Expr> {
    statement
        .all_equations()
        .flat_map(|one| [Some(&one.left), Some(&one.right), one.within.as_ref()].into_iter().flatten())
}

fn expression_formula(text: &str, looks: &Looks) -> Option<Formula> {
    let expr = parse_expression(text).ok()?;
    Some(FormulaLayout::with_looks(text, [&expr], looks).expression(&expr))
}

/// A definition `name = text` as a formula.
fn definition_formula(name: &str, text: &str, looks: &Looks) -> Option<Formula> {
    statement_formula(&format!("{name} = {text}"), looks)
}

/// A statement in LaTeX; none where the text is no statement, as a definition in prose is.
///
/// ```
/// use palmistry_report::statement_latex;
/// let found = statement_latex("L(f, s1) = -omega0*(r1 + d1)/2 where omega0 != 0");
/// assert_eq!(found.as_deref(), Some(
///     "L_{f}s_{1} = -\\frac{\\omega_{0}\\left(r_{1} + d_{1}\\right)}{2}\\ \\text{where}\\ \\omega_{0} \\neq 0"
/// ));
/// ```
pub fn statement_latex(text: &str) -> Option<String> {
    statement_latex_in(text, &Looks::default())
}

/// The same with the looks that a file gives to its names.
pub fn statement_latex_in(text: &str, looks: &Looks) -> Option<String> {
    statement_formula(text, looks).map(|formula| latex(&formula))
}

/// An expression in LaTeX; none where the text is no expression.
pub fn expression_latex(text: &str) -> Option<String> {
    expression_latex_in(text, &Looks::default())
}

/// The same with the looks that a file gives to its names.
pub fn expression_latex_in(text: &str, looks: &Looks) -> Option<String> {
    expression_formula(text, looks).map(|formula| latex(&formula))
}

/// What a text says, as MathML between whose parts a line may break; none where it is neither a statement nor an expression, or
/// so deep that a browser would not set it.
pub fn formula_mathml(text: &str) -> Option<String> {
    formula_mathml_in(text, &Looks::default())
}

/// The same with the looks that a file gives to its names.
pub fn formula_mathml_in(text: &str, looks: &Looks) -> Option<String> {
    shown(statement_formula(text, looks).or_else(|| expression_formula(text, looks))?)
}

/// The same of a name and what it stands for.
pub fn definition_mathml(name: &str, text: &str, looks: &Looks) -> Option<String> {
    shown(definition_formula(name, text, looks)?)
}

fn shown(formula: Formula) -> Option<String> {
    (formula.depth() <= DEEPEST).then(|| mathml_in_pieces(&formula))
}

/// Several statements, as conditions on a set of states: each a formula of its own, so that a line may break behind each comma.
pub fn conditions_mathml(conditions: &[String], looks: &Looks) -> Option<String> {
    let each = conditions.iter().map(|condition| shown(statement_formula(condition, looks)?));
    each.collect::<Option<Vec<String>>>().map(|each| each.join(", "))
}

/// A vector field as a differential operator: a sum of rates before partial derivatives. Each part has a sign, what stands before the
/// derivative, and the state by which it is; a rate that is `1` is left out.
pub(crate) fn field_mathml(parts: &[SignedPart<'_>], looks: &Looks) -> Option<String> {
    let rows: Vec<String> = parts.iter().map(|part| format!("{}, {}", part.rate, part.state)).collect();
    let text = format!("[{}]", rows.join("; "));
    let matrix = parse_expression(&text).ok()?;
    let layout = FormulaLayout::with_looks(&text, [&matrix], looks);
    let ExprKind::Matrix(rows) = &matrix.kind else { return None };
    let mut row = Vec::new();
    for (part, entries) in parts.iter().zip(rows) {
        let [rate, state] = entries.as_slice() else { return None };
        match (row.is_empty(), part.negative) {
            (true, true) => row.push(Formula::Sign(FormulaSign::Negative)),
            (true, false) => {}
            (false, true) => row.push(Formula::Sign(FormulaSign::Minus)),
            (false, false) => row.push(Formula::Sign(FormulaSign::Plus)),
        }
        if part.rate != "1" {
            let formula = layout.expression(rate);
            row.push(match &rate.kind {
                ExprKind::Sum(_) => Formula::Fence(Fence::Round, Box::new(formula)),
                _ => formula,
            });
            row.push(Formula::Sign(FormulaSign::Thin));
        }
        let by = Formula::Row(vec![Formula::Sign(FormulaSign::Partial), layout.expression(state)]);
        row.push(Formula::Fraction(Box::new(Formula::Sign(FormulaSign::Partial)), Box::new(by)));
    }
    shown(Formula::Row(row))
}

/// A part of a vector field.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SignedPart<'a> {
    pub negative: bool,
    pub rate: &'a str,
    pub state: &'a str,
}
