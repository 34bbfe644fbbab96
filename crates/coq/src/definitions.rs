//! The definitions and fields of a file and of those that it imports, in an order in which each is known where it is named.

use crate::names::{Names, in_comment};
use crate::printer::{Kind, Known, Printer, Reason, kind_of};
use dashu::rational::RBig;
use palmistry_lang::{Entry, Field, System, Time, entries_of};
use palmistry_math::expression::syntax::{Expr, ExprKind, Name};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// What is printed for a name: a definition of Coq, and the names that it mentions.
pub(crate) struct Defined {
    pub ident: String,
    pub text: String,
    pub uses: BTreeSet<String>,
}

/// All that can be named.
#[derive(Default)]
pub(crate) struct Definitions {
    /// In the order in which they are printed.
    pub list: Vec<Defined>,
    /// By the whole names of the outermost file.
    pub values: BTreeMap<String, Result<Known, Reason>>,
    /// Fields, likewise.
    pub fields: BTreeMap<String, Result<String, Reason>>,
    /// How often values are put into values, by the whole names of definitions.
    pub puts: BTreeMap<String, usize>,
    /// The outputs of the outermost file: terms, and the names that they mention.
    pub outputs: Vec<Result<(String, BTreeSet<String>), Reason>>,
    files: HashMap<PathBuf, Option<Rc<System>>>,
    /// How many imports were followed.
    imports: usize,
}

/// Files that import each other ten times over have as many imports as there are ways through them.
const MOST_IMPORTS: usize = 1000;

impl Definitions {
    /// Those of a file, under a prefix.
    pub fn add(&mut self, system: &System, prefix: &str, names: &mut Names) {
        for (alias, path) in system.imports() {
            // what cannot be read any more, or comes after too many others, is not known, and what names it is left out
            if self.imports < MOST_IMPORTS
                && let Some(other) = self.read(path)
            {
                self.imports += 1;
                self.add(&other, &format!("{prefix}{alias}."), names);
            }
        }
        for entry in entries_of(&system.source) {
            match entry {
                Entry::Definition { name, value } => {
                    let found = self.definition(system, prefix, &name, &value, names);
                    self.puts.insert(format!("{prefix}{name}"), self.puts_in(prefix, &value));
                    self.values.insert(format!("{prefix}{name}"), found);
                }
                Entry::Field { name, components, is_map } => {
                    let found = match is_map || system.time == Time::Discrete {
                        true => Err("a map of discrete time".to_owned()),
                        false => self.field(system, prefix, &name, &components, names),
                    };
                    self.fields.insert(format!("{prefix}{name}"), found);
                }
                Entry::Output { value } if prefix.is_empty() => {
                    let mut printer = self.printer(system, prefix, names);
                    let found = printer.scalar(&value).map(|found| (found.text, printer.used));
                    self.outputs.push(found);
                }
                Entry::Output { .. } => (),
            }
        }
    }

    /// How often values are put into values in an expression, `e at {x = (y at {z = 0})} at {z = w}`: the library writes each of them
    /// out, so that terms grow with each as a product does. The size of the graph does not show what was folded on the way.
    pub fn puts_in(&self, prefix: &str, expr: &Expr) -> usize {
        let of = |part: &Expr| self.puts_in(prefix, part);
        match &expr.kind {
            ExprKind::Name(name) => self.puts.get(&format!("{prefix}{name}")).copied().unwrap_or(0),
            ExprKind::At(inner, list) => {
                1 + of(inner).max(list.iter().map(|(_, value)| of(value)).max().unwrap_or(0))
            }
            ExprKind::Call(_, arguments) => arguments.iter().map(of).max().unwrap_or(0),
            ExprKind::Sum(parts) | ExprKind::Product(parts) => {
                parts.iter().map(|(_, part)| of(part)).max().unwrap_or(0)
            }
            ExprKind::Matrix(rows) => rows.iter().flatten().map(of).max().unwrap_or(0),
            ExprKind::Power(base, _) => of(base),
            ExprKind::RealPower(base, exponent) => of(base).max(of(exponent)),
            ExprKind::Number(_) | ExprKind::Indexed(_) => 0,
        }
    }

    /// A file, which is read once however often it is imported.
    fn read(&mut self, path: &Path) -> Option<Rc<System>> {
        let known = self.files.entry(path.to_owned());
        known.or_insert_with(|| System::read(path).ok().map(Rc::new)).clone()
    }

    fn printer<'a>(&'a self, system: &'a System, prefix: &str, names: &'a mut Names) -> Printer<'a> {
        let (definitions, fields) = (&self.values, &self.fields);
        Printer { system, prefix: prefix.to_owned(), names, definitions, fields, used: BTreeSet::new() }
    }

    fn definition(
        &mut self,
        system: &System,
        prefix: &str,
        name: &str,
        value: &Expr,
        names: &mut Names,
    ) -> Result<Known, Reason> {
        let kind = kind_of(system.definition(name).ok_or_else(|| "no value".to_owned())?)?;
        let mut printer = self.printer(system, prefix, names);
        let printed = printer.print(value)?;
        if printed.kind != kind {
            return Err("a shape that was read in another way".to_owned());
        }
        let uses = printer.used;
        let ident = names.of("value", &format!("{prefix}{name}"));
        let of = match kind {
            Kind::Number => "term",
            Kind::Matrix(..) => "matrix",
        };
        let text = format!("Definition {ident} : {of} := {}.", printed.text);
        self.list.push(Defined { ident: ident.clone(), text, uses });
        Ok(Known { ident, kind })
    }

    fn field(
        &mut self,
        system: &System,
        prefix: &str,
        name: &str,
        components: &[(Name, Expr)],
        names: &mut Names,
    ) -> Result<String, Reason> {
        let field = system.fields.iter().find(|field| field.name == name);
        let more = match field {
            Some(field) => not_written(system, field, components)?,
            None => return Err("no field".to_owned()),
        };
        let mut printer = self.printer(system, prefix, names);
        let mut pairs = Vec::new();
        for (state, rate) in components {
            let rate = printer.scalar(rate)?;
            pairs.push(format!("({}, {})", printer.variable(&state.text), rate.text));
        }
        for (symbol, rate) in more {
            pairs.push(format!("({}, {})", printer.variable(&symbol), printer.variable(&rate)));
        }
        let uses = printer.used;
        let ident = names.of("field", &format!("{prefix}{name}"));
        let text = format!("Definition {ident} := field\n  [{}].", pairs.join(";\n   "));
        self.list.push(Defined { ident: ident.clone(), text, uses });
        Ok(ident)
    }

    /// The definitions that some names rest on, in order, and the variables among these names.
    pub fn needed(&self, used: &BTreeSet<String>) -> (Vec<&Defined>, BTreeSet<String>) {
        let mut wanted = used.clone();
        let mut kept = Vec::new();
        // each names only what is before it
        for defined in self.list.iter().rev() {
            if wanted.remove(&defined.ident) {
                wanted.extend(defined.uses.iter().cloned());
                kept.push(defined);
            }
        }
        kept.reverse();
        (kept, wanted)
    }

    /// The printer of what the outermost file says.
    pub fn outermost<'a>(&'a self, system: &'a System, names: &'a mut Names) -> Printer<'a> {
        self.printer(system, "", names)
    }
}

/// The components of a field that come with signals: `u' = u'`, and nothing else.
fn not_written(
    system: &System,
    field: &Field,
    components: &[(Name, Expr)],
) -> Result<Vec<(String, String)>, Reason> {
    let mut found = Vec::new();
    for (symbol, rate) in &field.components {
        let name = system.symbol_name(*symbol);
        if components.iter().any(|(state, _)| state.text == name) {
            continue;
        }
        match system.graph.as_symbol(*rate) {
            Some(rate) => found.push((name.to_owned(), system.symbol_name(rate).to_owned())),
            None if system.graph.constant_value(*rate).is_some_and(RBig::is_zero) => (),
            None => return Err(format!("the rate of {}, which the file does not write", in_comment(name))),
        }
    }
    Ok(found)
}
