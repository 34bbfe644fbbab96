//! What a system is.

use super::domain::Domain;
use super::grammar::ClaimSyntax;
use crate::expression::{Derivation, Graph, Guard, NodeId, Symbol, gradient};
use dashu::rational::RBig;
use std::collections::{BTreeMap, HashMap, HashSet};

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
    pub low: RBig,
    pub high: RBig,
}

/// What is known of a symbol.
#[derive(Clone, Debug)]
pub struct SymbolInfo {
    pub kind: Kind,
    /// Whether it is met only inside sines and cosines.
    pub is_angle: bool,
    /// The value of a parameter where nothing else is said.
    pub default: Option<RBig>,
    /// Where it is drawn from.
    pub range: Option<Range>,
}

/// A vector field: `x' = component` for each state that it moves.
#[derive(Clone, Debug)]
pub struct Field {
    pub name: String,
    /// The states that it moves, and how; all others stand still.
    pub components: Vec<(Symbol, NodeId)>,
    /// Where each component exists.
    pub guards: Vec<Vec<Guard>>,
    pub(crate) derivation: Derivation,
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
    pub rows: usize,
    pub columns: usize,
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
    Scalar(NodeId),
    Matrix(Matrix),
    /// `rank(M)`, the rank of a matrix at almost all points.
    Rank(Matrix),
    /// `rank`, the rank of the observability codistribution.
    CodistributionRank,
    /// `pole(e, x)`, the order of the pole of `e` where `x` vanishes.
    Pole {
        expression: NodeId,
        factor: NodeId,
    },
}

impl Value {
    /// In words, for messages.
    pub fn describe(&self) -> String {
        match self {
            Value::Scalar(_) => "a number".to_owned(),
            Value::Matrix(m) => format!("a matrix of {} by {}", m.rows, m.columns),
            Value::Rank(_) | Value::CodistributionRank => "a rank".to_owned(),
            Value::Pole { .. } => "the order of a pole".to_owned(),
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
    /// All expressions of the file.
    pub graph: Graph,
    /// The states, in the order in which the file names them.
    pub states: Vec<Symbol>,
    /// The vector fields of this file, in order; the first is the drift by custom.
    pub fields: Vec<Field>,
    /// The outputs: how they are written, and what they are.
    pub outputs: Vec<(String, NodeId)>,
    /// Where each output exists.
    pub output_guards: Vec<Vec<Guard>>,
    /// What sampled states keep away from being zero.
    pub avoid: Vec<(String, NodeId)>,
    /// The claims, as syntax.
    pub claims: Vec<ClaimSyntax>,
    pub(crate) symbols: BTreeMap<Symbol, SymbolInfo>,
    pub(crate) definitions: BTreeMap<String, Value>,
    /// Where each definition exists, imported ones included.
    pub(crate) definition_domains: HashMap<String, Domain>,
    /// What the terms that are being read need to exist.
    pub(crate) domain: Domain,
    /// The definitions of this file as they are written.
    pub(crate) definition_texts: BTreeMap<String, String>,
    /// Fields of imported systems, under their full names.
    pub(crate) imported_fields: Vec<Field>,
    /// Where the field of a name is.
    pub(crate) field_places: HashMap<String, FieldPlace>,
    pub(crate) partials: HashMap<Symbol, Derivation>,
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

    /// A symbol's name.
    pub fn symbol_name(&self, symbol: Symbol) -> &str {
        self.graph.symbol_name(symbol)
    }

    /// The symbol of a name, if the file declares it.
    pub fn find_symbol(&self, name: &str) -> Option<Symbol> {
        self.graph.find_symbol(name).filter(|symbol| self.symbols.contains_key(symbol))
    }

    /// The field of a name, imported ones included.
    pub(crate) fn named_field(&self, name: &str) -> Option<&Field> {
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

    /// The names that a definition of the file has given.
    pub fn definition(&self, name: &str) -> Option<&Value> {
        self.definitions.get(name)
    }

    /// The definitions of this file that a text mentions, and those that they mention in turn: name and text, in the
    /// order in which they are met.
    pub fn definitions_in(&self, text: &str) -> Vec<(String, String)> {
        let mut found: Vec<(String, String)> = Vec::new();
        let mut met: HashSet<&str> = HashSet::new();
        let mut texts = vec![text];
        while let Some(text) = texts.pop() {
            let words = text.split(|c: char| !c.is_alphanumeric() && c != '_' && c != '.');
            for word in words.filter(|word| !word.is_empty()) {
                if let Some((name, definition)) = self.definition_texts.get_key_value(word)
                    && met.insert(name)
                {
                    found.push((name.clone(), definition.clone()));
                    texts.push(definition);
                }
            }
        }
        found
    }

    /// The Lie derivative of an expression along a field of this file, by its place among [`System::fields`].
    pub fn lie_derivative(&mut self, field: usize, expression: NodeId) -> NodeId {
        self.fields[field].derivation.apply(&mut self.graph, expression)
    }

    /// The differential of an expression: its derivatives by the states, in their order.
    pub fn differential(&mut self, expression: NodeId) -> Vec<NodeId> {
        gradient(&mut self.graph, expression, &self.states)
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
