//! What a system is.

use super::codes::Code;
use super::dimension::{Dimensions, Import};
use super::domain::Domain;
use super::error::Problem;
use super::syntax::ClaimSyntax;
use super::unknowns::Coordinates;
use super::views::{LineView, MapView, NamedSet, ReductionTo};
use super::written::Written;
use dashu::rational::RBig;
use palmistry_math::expression::notation::FormulaName;
use palmistry_math::expression::syntax::{Equation, Span};
use palmistry_math::expression::{Derivation, Graph, Guard, NodeId, Symbol, gradient};
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::path::PathBuf;
use std::sync::Arc;

/// The rank of a dense matrix of so many columns takes half a minute and 3 GB.
const MOST_COLUMNS: usize = 10_000;

/// How names look in formulas, where a file says it.
pub type Looks = Arc<BTreeMap<String, FormulaName>>;

/// What a symbol is in its system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A coordinate of the state space.
    State,
    /// A constant whose value may be fixed.
    Parameter,
    /// Known only from a system that was imported.
    Imported,
}

/// The closed interval from which a coordinate is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Range {
    /// The low end.
    pub low: RBig,
    /// The high end, no lower than the low one.
    pub high: RBig,
}

/// What is known of a symbol.
#[derive(Clone, Debug)]
pub struct SymbolInfo {
    /// What it is in the system.
    pub kind: Kind,
    /// Whether it is met only inside sines and cosines.
    pub is_angle: bool,
    /// The value of a parameter where nothing else is said.
    pub default: Option<RBig>,
    /// Where it is drawn from.
    pub range: Option<Range>,
}

/// What a vector field is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// How the states move by themselves; a system has at most one.
    Drift,
    /// How they move besides where something drives them: `x' = f + u g`.
    Input,
    /// Only differentiated along, as in `L(f, e)`: no rank and no observer knows of it.
    Other,
}

impl Role {
    /// The word that declares a field of this role.
    pub fn name(self) -> &'static str {
        match self {
            Role::Drift => "drift",
            Role::Input => "input",
            Role::Other => "field",
        }
    }
}

/// How the states of a system move.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Time {
    /// At rates: `x' = e`.
    #[default]
    Continuous,
    /// In steps: `x+ = e`. The drift is a map, and the derivative along it the composition with it.
    Discrete,
}

/// A vector field: `x' = component` for each state that it moves.
#[derive(Clone, Debug)]
pub struct Field {
    /// Its name.
    pub name: String,
    /// What it is for. Fields of imported systems keep theirs.
    pub role: Role,
    /// Where its name stands in the text of its file.
    pub span: Span,
    /// The states that it moves, and how; all others stand still.
    pub components: Vec<(Symbol, NodeId)>,
    /// Where each component exists.
    pub guards: Vec<Vec<Guard>>,
    /// Its components as they are written.
    pub(crate) written: Written,
    pub(crate) derivation: Derivation,
}

impl Field {
    /// Forgets what was differentiated along it, or composed with it, since its components are others.
    pub fn derive_anew(&mut self, graph: &Graph) {
        self.derivation = self.derivation.with_values(graph, self.components.iter().copied().collect());
    }
}

/// A field that takes part in a rank, for reports.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FieldRole {
    /// The field's name.
    pub name: String,
    /// What it does to the states.
    pub role: Role,
}

/// Where a field is, among those of its file or among the imported ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FieldPlace {
    Own(usize),
    Imported(usize),
}

/// A matrix of expressions, by rows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Matrix {
    /// How many rows.
    pub rows: usize,
    /// How many columns.
    pub columns: usize,
    /// The entries, row by row.
    pub entries: Vec<NodeId>,
}

impl Matrix {
    /// The entry in a row and a column, both counted from zero.
    pub fn at(&self, row: usize, column: usize) -> NodeId {
        self.entries[row * self.columns + column]
    }
}

/// What an expression of the language can mean.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Value {
    /// One expression.
    Scalar(NodeId),
    /// A table of expressions.
    Matrix(Matrix),
    /// `rank(M)`, the rank of a matrix at almost all points.
    Rank(Matrix),
    /// `rank`, the rank of the observability codistribution.
    CodistributionRank,
    /// `pole(e, x)`, the order of the pole of `e` where `x` vanishes.
    Pole {
        /// What has the pole.
        expression: NodeId,
        /// What vanishes there.
        factor: NodeId,
    },
    /// `observable(e, ...)` or `unobservable(e, ...)`: a statement by itself.
    Visible {
        /// What it is said of.
        functions: Vec<NodeId>,
        /// Whether they are seen.
        is_observable: bool,
    },
    /// `solutions(e)`, how many values of an expression give the same outputs.
    Solutions(NodeId),
    /// `infinity`, with which such a number is compared.
    Infinity,
}

impl Value {
    /// Whether two values can be compared that are no matrices: a number with anything but infinity, which a number of solutions
    /// can be.
    pub(crate) fn are_comparable(&self, other: &Value) -> bool {
        let is_one = |value: &Value| matches!(value, Value::Scalar(_));
        match (self, other) {
            (Value::Infinity, other) | (other, Value::Infinity) => matches!(other, Value::Solutions(_)),
            (left, right) => is_one(left) || is_one(right),
        }
    }

    /// The number that it is: a matrix of one row and one column is one wherever a number is meant.
    pub fn as_number(&self) -> Option<NodeId> {
        match self {
            Value::Scalar(id) => Some(*id),
            Value::Matrix(matrix) if (matrix.rows, matrix.columns) == (1, 1) => {
                matrix.entries.first().copied()
            }
            _ => None,
        }
    }

    /// The same, as a number where it is one.
    pub fn or_number(self) -> Value {
        self.as_number().map_or(self, Value::Scalar)
    }

    /// Two sides that are compared: a matrix of one entry beside anything but a matrix is a number.
    pub fn compared(left: Value, right: Value) -> (Value, Value) {
        match (&left, &right) {
            (Value::Matrix(_), Value::Matrix(_)) => (left, right),
            _ => (left.or_number(), right.or_number()),
        }
    }

    /// In words, for messages.
    pub fn describe(&self) -> String {
        match self {
            Value::Scalar(_) => "a number".to_owned(),
            Value::Matrix(m) => format!("a matrix of {} by {}", m.rows, m.columns),
            Value::Rank(_) | Value::CodistributionRank => "a rank".to_owned(),
            Value::Pole { .. } => "the order of a pole".to_owned(),
            Value::Visible { .. } => "a statement about observability".to_owned(),
            Value::Solutions(_) => "a number of solutions".to_owned(),
            Value::Infinity => "infinity".to_owned(),
        }
    }
}

/// Values for some symbols.
pub type Assignment = HashMap<Symbol, NodeId>;

/// A control system and what is claimed of it.
#[derive(Clone, Debug)]
pub struct System {
    /// Its title.
    pub title: String,
    /// Where it is published.
    pub cite: Option<String>,
    /// The name of the file.
    pub name: String,
    /// The text of the file.
    pub source: String,
    /// Where its lines begin.
    pub(super) line_starts: Vec<usize>,
    /// All expressions of the file.
    pub graph: Graph,
    /// The states, in the order in which the file names them.
    pub states: Vec<Symbol>,
    /// Those of them that are known: they have no column in a codistribution, and no dimension counts them
    /// ([`System::unknowns`]).
    pub known: BTreeSet<Symbol>,
    /// The vector fields of this file, of any role, in order. Words of Lie derivatives name fields by their places here.
    pub fields: Vec<Field>,
    /// The outputs: how they are written, and what they are.
    pub outputs: Vec<(String, NodeId)>,
    /// Where each output exists.
    pub output_guards: Vec<Vec<Guard>>,
    /// What sampled states keep away from being zero.
    pub avoid: Vec<(String, NodeId)>,
    /// The claims, as syntax.
    pub claims: Vec<ClaimSyntax>,
    /// Inequalities under which they are made.
    pub(super) assumed: Vec<Equation>,
    /// Sets of states that deserve a look of their own, in the order of the file.
    pub sets: Vec<NamedSet>,
    /// Their titles.
    pub(super) set_titles: BTreeSet<String>,
    /// Planes over which singular values are looked at.
    pub maps: Vec<MapView>,
    /// Lines along which they are.
    pub lines: Vec<LineView>,
    /// The systems that this one is under conditions.
    pub reductions: Vec<ReductionTo>,
    /// All symbols that the file declares, with what it says of them.
    pub symbols: BTreeMap<Symbol, SymbolInfo>,
    /// What the coordinates were declared as.
    pub(crate) coordinates: Coordinates,
    /// What `let` defines, by name.
    pub definitions: BTreeMap<String, Value>,
    /// Where each definition exists, imported ones included.
    pub(crate) definition_domains: HashMap<String, Domain>,
    /// What the terms that are being read need to exist.
    pub(crate) domain: Domain,
    /// The definitions as they are written, imported ones under their full names.
    pub(crate) written: BTreeMap<String, Written>,
    /// Fields of imported systems, under their full names.
    pub(crate) imported_fields: Vec<Field>,
    /// Where the field of a name is.
    pub(crate) field_places: HashMap<String, FieldPlace>,
    pub(crate) partials: HashMap<Symbol, Derivation>,
    /// Whether something has been differentiated by all states: then these are all that there are.
    pub(crate) states_are_final: bool,
    /// Whether rows of a codistribution have been written down: then these are all fields and outputs.
    pub(crate) motion_is_final: bool,
    /// How names look in formulas, where the file says it.
    pub looks: Looks,
    /// The names that this file gives to imported systems, and their files.
    pub(crate) aliases: Vec<(String, PathBuf)>,
    /// The symbols that this file gives a range to.
    pub(crate) sampled: HashSet<Symbol>,
    /// The definitions that stand for the result of a calculation, and not for a formula; imported ones included.
    pub(crate) calculated: HashSet<String>,
    /// What is known of dimensions.
    pub(crate) dimensions: Arc<Dimensions>,
    /// Whether the states move continuously or in steps.
    pub time: Time,
    /// The vectors, by their names: those whose components are symbols or definitions.
    pub(crate) vectors: BTreeSet<String>,
    /// The dimensions of the files that this one imports, while it is read.
    pub(crate) imported_dimensions: Vec<Import>,
}

impl System {
    /// What is known of a symbol.
    pub fn symbol_info(&self, symbol: Symbol) -> Option<&SymbolInfo> {
        self.symbols.get(&symbol)
    }

    /// All symbols, in the order in which they were first named.
    pub fn symbols(&self) -> impl Iterator<Item = (Symbol, &SymbolInfo)> {
        self.symbols.iter().map(|(symbol, info)| (*symbol, info))
    }

    /// Whether a symbol is an angle.
    pub fn is_angle(&self, symbol: Symbol) -> bool {
        self.symbols.get(&symbol).is_some_and(|info| info.is_angle)
    }

    /// All symbols that are angles.
    pub fn angles(&self) -> HashSet<Symbol> {
        self.symbols().filter(|(_, info)| info.is_angle).map(|(symbol, _)| symbol).collect()
    }

    /// Whether a symbol is an angle, for those who ask while the graph grows: what is an angle now.
    pub fn angle_test(&self) -> impl Fn(Symbol) -> bool + use<> {
        let angles = self.angles();
        move |symbol| angles.contains(&symbol)
    }

    /// A symbol's name.
    pub fn symbol_name(&self, symbol: Symbol) -> &str {
        self.graph.symbol_name(symbol)
    }

    /// The names of the states, in their order.
    pub fn state_names(&self) -> Vec<String> {
        self.states.iter().map(|state| self.symbol_name(*state).to_owned()).collect()
    }

    /// The symbol of a name, if the file declares it.
    pub fn find_symbol(&self, name: &str) -> Option<Symbol> {
        self.graph.find_symbol(name).filter(|symbol| self.symbols.contains_key(symbol))
    }

    /// The field of a name, imported ones included.
    pub(crate) fn field(&self, name: &str) -> Option<&Field> {
        match self.field_places.get(name)? {
            FieldPlace::Own(place) => self.fields.get(*place),
            FieldPlace::Imported(place) => self.imported_fields.get(*place),
        }
    }

    /// The same, to be derived along.
    pub(crate) fn field_mut(&mut self, name: &str) -> Option<&mut Field> {
        match self.field_places.get(name)? {
            FieldPlace::Own(place) => self.fields.get_mut(*place),
            FieldPlace::Imported(place) => self.imported_fields.get_mut(*place),
        }
    }

    /// The places of the fields that move the states: the drift and the inputs, in the order of the file. Ranks are made
    /// of these.
    pub fn moving_fields(&self) -> Vec<usize> {
        (0..self.fields.len()).filter(|field| self.fields[*field].role != Role::Other).collect()
    }

    /// The place of the drift among [`System::fields`].
    pub fn drift(&self) -> Option<usize> {
        self.fields.iter().position(|field| field.role == Role::Drift)
    }

    /// Name and role of the fields that move the states, in the order of the file.
    pub fn roles(&self) -> Vec<FieldRole> {
        let role =
            |field: usize| FieldRole { name: self.fields[field].name.clone(), role: self.fields[field].role };
        self.moving_fields().into_iter().map(role).collect()
    }

    /// The line and the column of a place in the text, in characters, both counted from one.
    pub fn place(&self, at: usize) -> (usize, usize) {
        // the place is on the boundary of a character, or at the end
        let at = at.min(self.source.len());
        let line = self.line_starts.partition_point(|start| *start <= at);
        let before = self.source.get(self.line_starts[line - 1]..at);
        (line, before.map_or(0, |before| before.chars().count()) + 1)
    }

    /// Nothing, where a field moves the states and a dense matrix has room for all of them.
    ///
    /// # Errors
    /// In words, with the line and the word to add, where no field is a drift or an input: a rank of such a system would be
    /// that of its outputs alone, or of fields that were declared for something else. And where the states and unknown parameters,
    /// counted once an experiment, are more than 10,000.
    pub fn require_motion(&self) -> Result<(), String> {
        match self.no_motion() {
            None => Ok(()),
            Some(problem) => {
                let (line, _) = self.place(problem.span.start);
                let place = if self.fields.is_empty() {
                    self.name.clone()
                } else {
                    format!("{}, line {line}", self.name)
                };
                Err(format!("{place}: {}; {}", problem.message, problem.help.unwrap_or_default()))
            }
        }
    }

    /// What is wrong with a rank where no field moves the states or they are too many, at the first field, else at the beginning of the file.
    pub(crate) fn no_motion(&self) -> Option<Problem> {
        let moves = !self.moving_fields().is_empty();
        let problem = match self.fields.first() {
            Some(field) if moves && self.states.len() > MOST_COLUMNS => {
                let count = self.states.len();
                let message = format!(
                    "ranks and estimates are of at most {MOST_COLUMNS} states and unknown parameters, and these are {count}"
                );
                Problem::new(Code::TooLarge, &field.span, message, "what moves them")
                    .help("leave out what is not asked for, or declare a parameter that is known as 'param'")
            }
            _ if moves => return None,
            Some(field) => {
                let name = &field.name;
                let message = format!(
                    "'field {name}' is only differentiated along, and a rank needs a drift or an input"
                );
                Problem::new(Code::Field, &field.span, message, "neither drift nor input").help(format!(
                    "write 'drift {name}' for the unforced dynamics, 'input {name}' for a field that an input drives"
                ))
            }
            None => {
                let message =
                    "a rank needs a drift or an input, and the file declares no field that moves its states";
                Problem::new(Code::Field, &(0..0), message, "")
                    .help("write \"drift f  others' = 0\" where the states rest")
            }
        };
        Some(problem)
    }

    /// The names that a definition of the file has given.
    pub fn definition(&self, name: &str) -> Option<&Value> {
        self.definitions.get(name)
    }

    /// The Lie derivative of an expression along a field of this file, by its place among [`System::fields`].
    pub fn lie_derivative(&mut self, field: usize, expression: NodeId) -> NodeId {
        self.fields[field].derivation.apply(&mut self.graph, expression)
    }

    /// The differential of an expression: its derivatives by the unknown states, in their order.
    pub fn differential(&mut self, expression: NodeId) -> Vec<NodeId> {
        let unknowns = self.unknowns();
        gradient(&mut self.graph, expression, &unknowns)
    }

    /// The partial derivative of an expression by a symbol.
    pub fn partial(&mut self, expression: NodeId, symbol: Symbol) -> NodeId {
        let derivation = match self.partials.entry(symbol) {
            std::collections::hash_map::Entry::Occupied(entry) => entry.into_mut(),
            std::collections::hash_map::Entry::Vacant(entry) => {
                entry.insert(Derivation::partial(&mut self.graph, symbol))
            }
        };
        derivation.apply(&mut self.graph, expression)
    }
}
