//! What a paper looks at beside its claims: sets of states by name, maps and lines, and systems that are others under
//! conditions. Read here, and checked as far as names go; what is found there is decided above.

use super::codes::Code;
use super::elaborate::Wanted;
use super::error::Problem;
use super::grammar::quoted;
use super::model::System;
use super::signals;
use super::syntax::Item;
use super::written::in_one_line;
use dashu::rational::RBig;
use palmistry_math::expression::parse::{
    Read, Text, assignments, conditions, equations, keyword, list, name, range, repeat, sign, stop, sum,
    target,
};
use palmistry_math::expression::syntax::{Equation, Expr, ExprKind, Name, Span};
use palmistry_math::expression::{NodeId, Symbol};
use winnow::combinator::{alt, cut_err, opt, peek, preceded};
use winnow::prelude::*;
use winnow::stream::Location;

/// States that meet conditions, under the name by which reports call them: `set "no gravity": g = 0`.
#[derive(Clone, Debug)]
pub struct NamedSet {
    /// Its name.
    pub name: String,
    /// What its states meet.
    pub conditions: Vec<Equation>,
    /// The same as it is written, one text a condition.
    pub written: Vec<String>,
    /// Whether it is a `singularity`: the fields or outputs are infinite there, so that there is no rank.
    pub is_pole: bool,
    /// Where its name stands.
    pub span: Span,
}

/// The values of what does not move, as they are written.
pub type Point = Vec<(String, RBig)>;

/// A coordinate with its least and greatest value.
#[derive(Clone, Debug, PartialEq)]
pub struct CoordinateRange<N> {
    /// Its name.
    pub name: String,
    /// The least value.
    pub low: N,
    /// The greatest one.
    pub high: N,
}

/// A plane of two coordinates over which it is looked at how well a state is observable:
/// `map "valleys": x in [0, 1], y in [0, 2] at {z = 1} order 2 of x "caption"`.
#[derive(Clone, Debug)]
pub struct MapView {
    /// Its title.
    pub title: String,
    /// The two coordinates.
    pub axes: [CoordinateRange<RBig>; 2],
    /// The values of other symbols.
    pub at: Point,
    /// The length of the words of the full codistribution; until the rank stops growing where none is given.
    pub order: Option<usize>,
    /// The state that is looked at; the worst at each point where none is named.
    pub of: Option<String>,
    /// What is seen on it, in words.
    pub caption: Option<String>,
    /// Where its title stands.
    pub span: Span,
}

/// Where a line ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineEnd {
    /// Where an expression vanishes that is linear in the coordinate: `x to 2` is where `x - 2` does.
    Zero(NodeId),
    /// Nowhere.
    Infinity,
}

/// A line along one coordinate: `line "into the pole": x to 2 from {y = 1}`.
#[derive(Clone, Debug)]
pub struct LineView {
    /// Its title.
    pub title: String,
    /// The coordinate that moves.
    pub moving: String,
    /// Where it goes.
    pub end: LineEnd,
    /// The values of other symbols: its own, or those of the map before it.
    pub from: Point,
    /// The state that is looked at; all of them where none is named.
    pub of: Option<String>,
    /// Where its title stands.
    pub span: Span,
}

/// Says that a system is another one under conditions: `reduction of general: omega2 = 0 "what is left out"`.
#[derive(Clone, Debug)]
pub struct ReductionTo {
    /// The other system, by the name under which it is imported.
    pub alias: Name,
    /// Its file, as it was found.
    pub path: std::path::PathBuf,
    /// The conditions as they are written.
    pub written: Vec<String>,
    /// What is left out, in words.
    pub remark: Option<String>,
}

/// One of these entries as it stands in the file.
#[derive(Clone, Debug)]
pub(crate) enum View {
    Set {
        title: String,
        conditions: Vec<Equation>,
        is_pole: bool,
        span: Span,
    },
    Map {
        title: String,
        axes: Vec<Axis>,
        at: Vec<(Name, Expr)>,
        order: Option<Expr>,
        of: Option<Name>,
        caption: Option<String>,
        span: Span,
    },
    Line {
        title: String,
        moving: Name,
        end: End,
        from: Option<Vec<(Name, Expr)>>,
        of: Option<Name>,
        span: Span,
    },
    Reduction {
        alias: Name,
        conditions: Vec<Equation>,
        remark: Option<String>,
    },
}

impl View {
    /// The equations in it: conditions, and where a line ends.
    pub(super) fn equations(&self) -> Vec<&Equation> {
        match self {
            View::Set { conditions, .. } | View::Reduction { conditions, .. } => conditions.iter().collect(),
            View::Line { end: End::Zero(equation), .. } => vec![equation],
            View::Line { .. } | View::Map { .. } => Vec::new(),
        }
    }
}

/// A coordinate and its range as they are written.
#[derive(Clone, Debug)]
pub(crate) struct Axis {
    pub name: Name,
    pub low: Expr,
    pub high: Expr,
}

#[derive(Clone, Debug)]
pub(crate) enum End {
    Value(Expr),
    Zero(Box<Equation>),
    Infinity,
}

/// The words that begin these entries; they are names too. `pole` is the former name of `singularity`.
pub(super) const WORDS: [&str; 6] = ["set", "singularity", "pole", "map", "line", "reduction"];

/// Whether one of these entries begins here, or one of what is known, and not a name that is one of their words: a quotation mark or `of` follows.
pub(super) fn begins(input: &mut Text<'_>) -> bool {
    let title = |word: &'static str| (keyword(word), winnow::token::literal("\"")).void();
    let reduction = (keyword("reduction"), keyword("of"), name, sign(":")).void();
    let mut any =
        alt((title("set"), title("singularity"), title("pole"), title("map"), title("line"), reduction));
    peek(any.by_ref()).parse_next(input).is_ok() || signals::begins(input)
}

fn title(input: &mut Text<'_>) -> Read<(String, Span)> {
    let begin = input.current_token_start();
    let (title, taken) = quoted.with_taken().parse_next(input)?;
    if title.is_empty() {
        return stop(begin, "a name between the quotation marks", None);
    }
    // as it is written, with all its blanks
    let length = taken[1..].find('"').map_or(taken.len(), |end| end + 2);
    let span = begin..begin + length;
    cut_err(sign(":")).context("':' behind the name").parse_next(input)?;
    Ok((title, span))
}

/// A name, or one component of a vector.
fn coordinate(input: &mut Text<'_>) -> Read<Name> {
    let target = target(input)?;
    let mut names = repeat(input, &[], |indices| target.names(indices))?;
    match names.len() {
        1 => Ok(names.remove(0)),
        _ => stop(target.span.start, "one coordinate", None),
    }
}

fn set(input: &mut Text<'_>) -> Read<View> {
    let singularity = alt((keyword("singularity"), keyword("pole")));
    let is_pole = alt((keyword("set").value(false), singularity.value(true))).parse_next(input)?;
    let (title, span) = title(input)?;
    Ok(View::Set { title, conditions: conditions(input)?, is_pole, span })
}

fn map(input: &mut Text<'_>) -> Read<View> {
    keyword("map").parse_next(input)?;
    let (title, span) = title(input)?;
    let axis = |input: &mut Text<'_>| -> Read<Axis> {
        let name = coordinate.context("a coordinate and its range, as in x in [0, 1]").parse_next(input)?;
        cut_err(keyword("in")).context("'in' and a range [low, high]").parse_next(input)?;
        let (low, high, _) = cut_err(range).parse_next(input)?;
        Ok(Axis { name, low, high })
    };
    let at_axes = input.current_token_start();
    let axes: Vec<Axis> =
        cut_err(list("a coordinate and its range, as in x in [0, 1]", axis)).parse_next(input)?;
    if axes.len() != 2 {
        return stop(at_axes, "two coordinates, as in x in [0, 1], y in [0, 2]", None);
    }
    let at = opt(preceded(keyword("at"), assignments)).parse_next(input)?.unwrap_or_default().0;
    let order = opt(preceded(keyword("order"), cut_err(sum))).parse_next(input)?;
    let of = shown(input)?;
    let caption = opt(quoted).parse_next(input)?;
    Ok(View::Map { title, axes, at, order, of, caption, span })
}

/// The state that a picture shows: `of x`.
fn shown(input: &mut Text<'_>) -> Read<Option<Name>> {
    let state = cut_err(coordinate).context("a state, as in of x");
    opt(preceded(keyword("of"), state)).parse_next(input)
}

fn line(input: &mut Text<'_>) -> Read<View> {
    keyword("line").parse_next(input)?;
    let (title, span) = title(input)?;
    let moving = cut_err(coordinate).context("the coordinate that moves").parse_next(input)?;
    cut_err(keyword("to")).context("'to', as in x to 2, x to y = 3, x to infinity").parse_next(input)?;
    let end = match opt(keyword("infinity")).parse_next(input)? {
        Some(_) => End::Infinity,
        None => {
            let start = input.checkpoint();
            let value = cut_err(sum).parse_next(input)?;
            if opt(peek(sign("="))).parse_next(input)?.is_none() {
                End::Value(value)
            } else {
                input.reset(&start);
                let mut found = cut_err(equations).parse_next(input)?;
                if found.len() > 1 {
                    return stop(found[1].span.start, "one equation", None);
                }
                End::Zero(Box::new(found.remove(0)))
            }
        }
    };
    let from = opt(preceded(keyword("from"), assignments)).parse_next(input)?.map(|(list, _)| list);
    let of = shown(input)?;
    Ok(View::Line { title, moving, end, from, of, span })
}

fn reduction(input: &mut Text<'_>) -> Read<View> {
    (keyword("reduction"), keyword("of")).parse_next(input)?;
    let alias = cut_err(name).context("the name of an imported system").parse_next(input)?;
    cut_err(sign(":")).context("':' and conditions").parse_next(input)?;
    Ok(View::Reduction { alias, conditions: conditions(input)?, remark: opt(quoted).parse_next(input)? })
}

/// One of these entries, where one begins.
pub(super) fn view(input: &mut Text<'_>) -> Read<Item> {
    if !begins(input) || signals::begins(input) {
        return winnow::combinator::fail.parse_next(input);
    }
    alt((set, map, line, reduction)).map(|view| Item::View(Box::new(view))).parse_next(input)
}

impl System {
    /// Enters a set, a map, a line or a reduction.
    pub(super) fn enter_view(&mut self, view: &View) -> Result<(), Problem> {
        match view {
            View::Set { title, conditions, is_pole, span } => {
                if !self.set_titles.insert(title.clone()) {
                    let message = format!("there is a set \"{title}\" already");
                    return Err(Problem::new(Code::Twice, span, message, "the second one")
                        .help("choose another title"));
                }
                let written = self.check_conditions(conditions)?;
                self.sets.push(NamedSet {
                    name: title.clone(),
                    conditions: conditions.clone(),
                    written,
                    is_pole: *is_pole,
                    span: span.clone(),
                });
            }
            View::Map { title, axes, at, order, of, caption, span } => {
                let mut checked = Vec::new();
                for Axis { name, low, high } in axes {
                    self.coordinate(name)?;
                    let (least, greatest) = (self.rational(low)?, self.rational(high)?);
                    if least >= greatest {
                        let message = format!("the range of '{}' has no width", name.text);
                        let span = low.span.start..high.span.end;
                        return Err(Problem::new(Code::Range, &span, message, "low above high")
                            .help("the low end comes first, as in [0, 1]"));
                    }
                    checked.push(CoordinateRange { name: name.text.clone(), low: least, high: greatest });
                }
                let [x, y] = checked.try_into().unwrap_or_else(|_| unreachable!("the grammar has two"));
                if x.name == y.name {
                    let message = "the two coordinates are one";
                    return Err(Problem::new(Code::View, &axes[1].name.span, message, "the second time")
                        .help("a map has two, as in x in [0, 1], y in [0, 2]"));
                }
                let at = self.point(at)?;
                let order = order.as_ref().map(|order| self.word_length(order)).transpose()?;
                let of = self.shown(of.as_ref())?;
                let (title, caption, span) = (title.clone(), caption.clone(), span.clone());
                self.maps.push(MapView { title, axes: [x, y], at, order, of, caption, span });
            }
            View::Line { title, moving, end, from, of, span } => {
                let symbol = self.coordinate(moving)?;
                let end = match end {
                    End::Value(value) => {
                        let target = self.scalar(value)?;
                        let coordinate = self.graph.symbol(symbol);
                        LineEnd::Zero(self.graph.sub(coordinate, target))
                    }
                    End::Zero(equation) => {
                        let (left, right) = (self.scalar(&equation.left)?, self.scalar(&equation.right)?);
                        LineEnd::Zero(self.graph.sub(left, right))
                    }
                    End::Infinity => LineEnd::Infinity,
                };
                let from = match from {
                    Some(list) => self.point(list)?,
                    None => self.maps.last().map(|map| map.at.clone()).unwrap_or_default(),
                };
                let of = self.shown(of.as_ref())?;
                let (title, moving, span) = (title.clone(), moving.text.clone(), span.clone());
                self.lines.push(LineView { title, moving, end, from, of, span });
            }
            View::Reduction { alias, conditions, remark } => {
                let Some((_, path)) = self.aliases.iter().find(|(known, _)| *known == alias.text) else {
                    let message = format!("there is no imported system '{}'", alias.text);
                    return Err(Problem::new(Code::View, &alias.span, message, "not imported above")
                        .help(format!("import it: use {} = \"its file\"", alias.text)));
                };
                let path = path.clone();
                let written = self.check_conditions(conditions)?;
                let (alias, remark) = (alias.clone(), remark.clone());
                self.reductions.push(ReductionTo { alias, path, written, remark });
            }
        }
        Ok(())
    }

    /// Conditions whose two sides are numbers, as they are written.
    fn check_conditions(&mut self, conditions: &[Equation]) -> Result<Vec<String>, Problem> {
        let mut written: Vec<String> = Vec::new();
        for condition in conditions {
            self.scalar(&condition.left)?;
            self.scalar(&condition.right)?;
            if let Some(within) = &condition.within {
                return Err(Problem::new(
                    Code::Statement,
                    &within.span,
                    "a condition is met exactly",
                    "without 'within'",
                ));
            }
            let text = in_one_line(&self.source, &condition.span);
            // the relations of a chain have one text
            if written.last() != Some(&text) {
                written.push(text);
            }
        }
        Ok(written)
    }

    fn coordinate(&self, name: &Name) -> Result<Symbol, Problem> {
        self.find_symbol(&name.text).ok_or_else(|| self.unknown(&name.text, &name.span, Wanted::Symbol))
    }

    /// The state that a picture shows.
    fn shown(&self, of: Option<&Name>) -> Result<Option<String>, Problem> {
        let Some(name) = of else { return Ok(None) };
        if self.unknowns().contains(&self.coordinate(name)?) {
            return Ok(Some(name.text.clone()));
        }
        let message =
            format!("'{}' is known, and a picture shows how well an unknown is observable", name.text);
        Err(Problem::new(Code::View, &name.span, message, "not unknown")
            .help("name a state, or a parameter that is unknown"))
    }

    fn point(&mut self, list: &[(Name, Expr)]) -> Result<Point, Problem> {
        // for names that are not known or given twice
        self.assignment(list)?;
        list.iter().map(|(name, value)| Ok((name.text.clone(), self.rational(value)?))).collect()
    }

    fn word_length(&mut self, order: &Expr) -> Result<usize, Problem> {
        match &order.kind {
            ExprKind::Number(number) if number.is_int() => {
                usize::try_from(number.numerator().clone()).ok().filter(|length| *length <= LONGEST_WORD)
            }
            _ => None,
        }
        .ok_or_else(|| {
            let message = format!("the order of Lie derivatives is a number from 0 to {LONGEST_WORD}");
            Problem::new(Code::Number, &order.span, message, "this is none").help("as in order 2")
        })
    }
}

/// Words of more fields than this are not drawn.
const LONGEST_WORD: usize = 12;
