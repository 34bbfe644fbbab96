//! From a file to a system.

use super::dimension::{self, Declared};
use super::domain::Domain;
use super::elaborate::Wanted;
use super::error::{Problem, ReadError};
use super::grammar::{ClaimSyntax, Entries, Item, Statement, parse_entries};
use super::model::{Field, FieldPlace, Kind, Matrix, Range, Role, SymbolInfo, System, Value};
use super::problems::{Cause, Full, Problems, Remnant, names_of_text};
use super::written::{Scope, Written, in_one_line, places_in};
use crate::expression::parse::ends_a_line;
use crate::expression::syntax::{Expr, Name, Relation, Span};
use crate::expression::{Derivation, Graph, Guard, Symbol, parse_expression};
use crate::file::{self, ReadFailure, read_text};
use miette::NamedSource;
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Imports of imports beyond this are refused.
const DEEPEST_IMPORT: usize = 8;

/// More names than this are not imported: what an import imports comes with it, so that ten files of ten lines, each
/// of which imports the next ten times, would bring ten thousand million.
const MOST_NAMES: usize = 200_000;

/// Files longer than this are refused.
const LONGEST_FILE: u64 = 16 << 20;

impl std::str::FromStr for System {
    type Err = ReadError;

    /// A system from a text alone: what it imports is looked for where the program runs.
    fn from_str(text: &str) -> Result<System, ReadError> {
        System::parse("the text", text, Path::new(""))
    }
}

impl System {
    /// Reads a proof file.
    ///
    /// # Errors
    /// What is wrong with the file, and where.
    pub fn read(path: &Path) -> Result<System, ReadError> {
        System::examine(path, 1).into_result()
    }

    /// Reads a system from a text; imports are looked for in `folder`.
    ///
    /// # Errors
    /// What is wrong with the text, and where.
    pub fn parse(name: &str, text: &str, folder: &Path) -> Result<System, ReadError> {
        System::examine_text(name, text, folder, 1).into_result()
    }

    /// Reads a proof file and says all that is wrong with it, up to so many problems.
    pub fn examine(path: &Path, most: usize) -> Examination {
        let name = path.display().to_string();
        match load(path) {
            Ok(text) => {
                let folder = path.parent().unwrap_or(Path::new(""));
                let mut found = System::examine_text(&name, &text, folder, most);
                found.files.insert(path.to_owned());
                found
            }
            Err(message) => Examination {
                system: None,
                problems: vec![Problem::new(&(0..0), message, "").locate(&name, "")],
                more: false,
                files: BTreeSet::from([path.to_owned()]),
            },
        }
    }

    /// The same of a text; imports are looked for in `folder`.
    pub fn examine_text(name: &str, text: &str, folder: &Path, most: usize) -> Examination {
        let mut found = System::examine_draft(name, text, folder, most);
        found.system = found.system.filter(|_| found.problems.is_empty());
        found
    }

    /// The same of a text on which somebody is at work: the system is what could be understood, also where something is
    /// wrong. Nothing is decided of such a one.
    pub(crate) fn examine_draft(name: &str, text: &str, folder: &Path, most: usize) -> Examination {
        let text = with_plain_line_ends(text);
        let mut reading = Reading::default();
        reading.open.extend(file::identity(Path::new(name)));
        let mut problems = Problems::up_to(most);
        let built = System::build(name, &text, folder, Graph::default(), &mut reading, &mut problems);
        // what an imported file refers to is looked for where that file itself is read
        let system = built
            .ok()
            .filter(|system| system.check_references(folder, &mut problems, &mut reading.files).is_ok());
        let more = problems.more;
        let found = problems.into_found();
        let source = Arc::new(NamedSource::new(name, text));
        let mut problems: Vec<ReadError> =
            found.into_iter().map(|problem| problem.locate_in(&source)).collect();
        problems.sort_by_key(|problem| problem.span.offset());
        Examination { system, problems, more, files: reading.files }
    }

    /// The value of an expression that is not in the file but asked of it from outside.
    ///
    /// # Errors
    /// What is wrong with the expression, and where in it.
    pub fn evaluate_text(&mut self, text: &str) -> Result<Value, ReadError> {
        self.evaluate_text_guarded(text).map(|(value, _)| value)
    }

    /// The same, and where it exists: the value was simplified, and may have values where the text has none.
    ///
    /// # Errors
    /// What is wrong with the expression, and where in it.
    pub fn evaluate_text_guarded(&mut self, text: &str) -> Result<(Value, Vec<Guard>), ReadError> {
        let text = &with_plain_line_ends(text);
        let expr = parse_expression(text).map_err(|e| expected(e).locate("expression", text))?;
        self.elaborate_guarded(&expr).map_err(|problem| problem.locate("expression", text))
    }

    /// Reads a text into a graph; where the reading ends before the text does, that is given back.
    fn build(
        name: &str,
        text: &str,
        folder: &Path,
        graph: Graph,
        reading: &mut Reading,
        problems: &mut Problems,
    ) -> Result<System, Box<Graph>> {
        let mut system = System {
            title: String::new(),
            cite: None,
            name: name.to_owned(),
            source: text.to_owned(),
            graph,
            states: Vec::new(),
            fields: Vec::new(),
            outputs: Vec::new(),
            output_guards: Vec::new(),
            avoid: Vec::new(),
            claims: Vec::new(),
            sets: Vec::new(),
            maps: Vec::new(),
            lines: Vec::new(),
            reductions: Vec::new(),
            symbols: BTreeMap::new(),
            definitions: BTreeMap::new(),
            definition_domains: HashMap::new(),
            domain: Default::default(),
            written: BTreeMap::new(),
            imported_fields: Vec::new(),
            field_places: HashMap::new(),
            partials: HashMap::new(),
            states_are_final: false,
            aliases: Vec::new(),
            sampled: HashSet::new(),
            calculated: HashSet::new(),
            dimensions: Default::default(),
            imported_dimensions: Vec::new(),
        };
        match system.fill(folder, reading, problems) {
            Ok(()) => Ok(system),
            Err(Full) => Err(Box::new(system.graph)),
        }
    }

    /// Enters all that stands in the text.
    fn fill(&mut self, folder: &Path, reading: &mut Reading, problems: &mut Problems) -> Result<(), Full> {
        let text = self.source.clone();
        if let Err(problem) = refuse_reordering(&text) {
            problems.add(problem)?;
        }
        let Entries { items, damage, .. } = parse_entries(&text, problems.room());
        for part in damage {
            problems.add(expected(part.expected))?;
            if let Some((word, names)) = names_of_text(&text[part.left_out]) {
                problems.break_names(word, names);
            }
        }
        let mut ids = HashSet::new();
        for item in &items {
            if let Item::Claim(claim) = item
                && !ids.insert(claim.id.clone())
            {
                let message = format!("there is a claim '{}' already", claim.id);
                problems.add(Problem::new(&claim.span, message, "the second one"))?;
            }
            let remnant = Remnant::of(item, problems);
            if let Err(problem) = self.enter(item, folder, reading) {
                self.entry_failed(problem, remnant, problems)?;
            }
        }
        for claim in self.claims.clone() {
            for statement in claim.body.statements() {
                if let Err(problem) = self.check(&claim, statement) {
                    let remnant = Remnant::of_statement(statement, problems);
                    self.entry_failed(problem, remnant, problems)?;
                }
            }
        }
        self.domain = Default::default();
        if self.title.is_empty() {
            problems.add(
                Problem::new(&(0..0), "the file does not name a system", "here")
                    .help("begin with: system \"what it is\"")
                    .because(Cause::Title),
            )?;
        }
        let imports = std::mem::take(&mut self.imported_dimensions);
        let (dimensions, mistakes) = dimension::check(self, &items, &imports);
        self.dimensions = Arc::new(dimensions);
        for mistake in mistakes {
            problems.add(mistake)?;
        }
        Ok(())
    }

    fn enter(&mut self, item: &Item, folder: &Path, reading: &mut Reading) -> Result<(), Problem> {
        match item {
            Item::System { title, cite, span } => {
                if !self.title.is_empty() {
                    let message = format!("the file describes a system already: \"{}\"", self.title);
                    return Err(
                        Problem::new(span, message, "the second one").help("one file holds one system")
                    );
                }
                if title.is_empty() {
                    return Err(Problem::new(span, "a system needs a title", "this is empty"));
                }
                (self.title, self.cite) = (title.clone(), cite.clone());
            }
            Item::Use { alias, path, span } => self.import(alias, &folder.join(path), span, reading)?,
            Item::State(list) => {
                for Declared { name, .. } in list {
                    if let Some(field) = self.fields.first() {
                        let message = format!("the field '{}' above does not know of this state", field.name);
                        return Err(Problem::new(&name.span, message, "declare states before fields"));
                    }
                    if self.states_are_final {
                        let message = format!(
                            "something above is differentiated by all states, and '{}' is none yet",
                            name.text
                        );
                        return Err(Problem::new(&name.span, message, "declare states before 'd(...)'"));
                    }
                    let symbol = self.declare(name, Kind::State)?;
                    self.states.push(symbol);
                }
            }
            Item::Param(list) => {
                for Declared { name, value, .. } in list {
                    let default = value.as_ref().map(|value| self.rational(value)).transpose()?;
                    let symbol = self.declare(name, Kind::Parameter)?;
                    if let Some(info) = self.symbols.get_mut(&symbol) {
                        info.default = default;
                    }
                }
            }
            Item::Angle(names) => {
                for name in names {
                    let Some(symbol) = self.find_symbol(&name.text) else {
                        return Err(self.unknown(&name.text, &name.span, Wanted::Symbol));
                    };
                    if let Some(info) = self.symbols.get_mut(&symbol) {
                        info.is_angle = true;
                    }
                }
            }
            Item::Let { name, value: expr, .. } => {
                self.refuse_taken(name)?;
                if self.find_symbol(&name.text).is_some() {
                    let message = format!("'{}' is a symbol of an imported system", name.text);
                    return Err(Problem::new(&name.span, message, "a definition of this name would hide it")
                        .help("choose another name, or declare the symbol with 'param'"));
                }
                let (value, domain) = self.apart(|system| system.elaborate(expr))?;
                if !self.calculates_nothing(expr) {
                    self.calculated.insert(name.text.clone());
                }
                if value == Value::CodistributionRank {
                    return Err(Problem::new(
                        &expr.span,
                        "the rank of the codistribution has no name",
                        "claim it as it is",
                    ));
                }
                self.written.insert(name.text.clone(), self.written_as(&expr.span, [expr]));
                self.definition_domains.insert(name.text.clone(), domain);
                self.definitions.insert(name.text.clone(), value);
            }
            Item::Field { role, name, components, others_are_zero } => {
                self.enter_field(*role, name.clone(), components, *others_are_zero)?
            }
            Item::Output(list) => {
                for (expr, _) in list {
                    let (value, domain) = self.apart(|system| system.scalar(expr))?;
                    // what is seen twice is seen once: a second time it would count as a measurement of its own
                    let guards = self.guards_of(&domain);
                    match self.outputs.iter().position(|(_, known)| *known == value) {
                        Some(place) => self.output_guards[place].extend(guards),
                        None => {
                            self.output_guards.push(guards);
                            self.outputs.push((in_one_line(&self.source, &expr.span), value));
                        }
                    }
                }
            }
            Item::Sample { ranges, avoid } => self.sample(ranges, avoid)?,
            Item::Claim(claim) => self.claims.push((**claim).clone()),
            Item::View(view) => self.enter_view(view)?,
        }
        Ok(())
    }

    /// Whether a statement of a claim can be understood: its names are known and its two sides can be equal at all.
    fn check(&mut self, claim: &ClaimSyntax, statement: &Statement) -> Result<(), Problem> {
        let (left, right) = (&statement.equation.left, &statement.equation.right);
        let values = Value::compared(self.elaborate(left)?, self.elaborate(right)?);
        let comparable = match &values {
            (Value::Matrix(l), Value::Matrix(r)) => (l.rows, l.columns) == (r.rows, r.columns),
            (Value::Matrix(_), _) | (_, Value::Matrix(_)) => false,
            (left, right) => matches!(left, Value::Scalar(_)) || matches!(right, Value::Scalar(_)),
        };
        let of_codistribution =
            matches!(values, (Value::CodistributionRank, _) | (_, Value::CodistributionRank));
        if of_codistribution
            && !self.states.is_empty()
            && !self.outputs.is_empty()
            && let Some(problem) = self.no_motion()
        {
            let span = if self.fields.is_empty() { statement.span.clone() } else { problem.span.clone() };
            return Err(Problem {
                span,
                message: format!("claim {}: {}", claim.id, problem.message),
                cause: Cause::Motion,
                ..problem
            });
        }
        if !comparable {
            let message = format!("{} cannot equal {}", values.0.describe(), values.1.describe());
            let problem = Problem::new(&statement.span, message, "this claim");
            return Err(problem.because(Cause::Shape));
        }
        let relation = statement.equation.relation;
        let of_numbers = values.0.as_number().is_some() && values.1.as_number().is_some();
        if relation != Relation::Equal && !of_numbers {
            let (left, right) = (values.0.describe(), values.1.describe());
            let message = format!("'{}' compares numbers, not {left} and {right}", relation.sign());
            return Err(Problem::new(&statement.equation.span, message, "this relation"));
        }
        for further in &statement.further {
            self.scalar(&further.right)?;
        }
        if statement.on_sample && !of_numbers {
            let message = "'on sample' is said of numbers; a rank is that at almost all states";
            return Err(Problem::new(&statement.span, message, "this claim"));
        }
        for condition in &statement.conditions {
            self.scalar(&condition.left)?;
            self.scalar(&condition.right)?;
            if let Some(within) = &condition.within {
                return Err(Problem::new(&within.span, "a condition is met exactly", "without 'within'"));
            }
        }
        if let Some(within) = &statement.equation.within {
            self.scalar(within)?;
        }
        if statement.carried.is_some() {
            let is_print = statement.equation.right.is_literal();
            if !is_print || !of_numbers || relation != Relation::Equal {
                let message = "'carrying ... digits' is said of a number in print, as in e at {x = 1} = 2.718 carrying 10 digits";
                return Err(Problem::new(&statement.span, message, "this claim"));
            }
        }
        Ok(())
    }

    fn refuse_taken(&self, name: &Name) -> Result<(), Problem> {
        let declared = self.find_symbol(&name.text).and_then(|symbol| self.symbols.get(&symbol));
        let taken = declared.is_some_and(|info| info.kind != Kind::Imported)
            || self.definitions.contains_key(&name.text)
            || ["pi", "rank", "others"].contains(&name.text.as_str());
        if taken {
            return Err(Problem::new(
                &name.span,
                format!("'{}' has a meaning already", name.text),
                "declared again",
            ));
        }
        if name.text.contains('.') {
            let message = "a name with a dot belongs to an imported system";
            return Err(Problem::new(&name.span, message, "choose one without"));
        }
        Ok(())
    }

    fn declare(&mut self, name: &Name, kind: Kind) -> Result<Symbol, Problem> {
        self.refuse_taken(name)?;
        let symbol = self.graph.intern(&name.text);
        let is_angle = self.is_angle(symbol);
        self.symbols.insert(symbol, SymbolInfo { kind, is_angle, default: None, range: None });
        Ok(symbol)
    }

    fn enter_field(
        &mut self,
        role: Role,
        name: Name,
        components: &[(Name, Expr)],
        others_are_zero: bool,
    ) -> Result<(), Problem> {
        if name.text.contains('.') {
            let message = "a name with a dot belongs to an imported system";
            return Err(Problem::new(&name.span, message, "choose one without"));
        }
        if self.field(&name.text).is_some() {
            return Err(Problem::new(
                &name.span,
                format!("there is a field '{}' already", name.text),
                "the second one",
            ));
        }
        // asked in this order: a file of many fields is not gone through for each of them
        if role == Role::Drift
            && let Some(first) = self.drift()
        {
            let message = format!("there is a drift '{}' already", self.fields[first].name);
            return Err(Problem::new(&name.span, message, "the second one").help(format!(
                "write 'input {0}' if it is driven, 'field {0}' if it is only differentiated along",
                name.text
            )));
        }
        let mut rates: Vec<(Symbol, _)> = Vec::new();
        let mut moved: HashSet<Symbol> = HashSet::new();
        let mut guards = Vec::new();
        for (state, expr) in components {
            let is_state =
                |symbol: &Symbol| self.symbol_info(*symbol).is_some_and(|info| info.kind == Kind::State);
            let symbol = self.find_symbol(&state.text).filter(is_state);
            let Some(symbol) = symbol else {
                return Err(self.unknown(&state.text, &state.span, Wanted::State));
            };
            if !moved.insert(symbol) {
                let message = format!("'{}' is given twice in the field '{}'", state.text, name.text);
                return Err(Problem::new(&state.span, message, "the second time"));
            }
            let (rate, domain) = self.apart(|system| system.scalar(expr))?;
            rates.push((symbol, rate));
            guards.push(self.guards_of(&domain));
        }
        let missing = self.states.iter().find(|state| !moved.contains(state));
        if let (Some(missing), false) = (missing, others_are_zero) {
            let message =
                format!("the field '{}' does not say how '{}' moves", name.text, self.symbol_name(*missing));
            return Err(Problem::new(&name.span, message, "this field")
                .help("end it with: others' = 0, if the states that it does not name stand still"));
        }
        let written = match (components.first(), components.last()) {
            (Some((first, _)), Some((_, last))) => {
                self.written_as(&(first.span.start..last.span.end), components.iter().map(|(_, expr)| expr))
            }
            _ => Written::default(),
        };
        let written = if others_are_zero { written.followed_by("others' = 0") } else { written };
        let derivation = Derivation::new(rates.iter().copied().collect());
        self.field_places.insert(name.text.clone(), FieldPlace::Own(self.fields.len()));
        self.fields.push(Field {
            name: name.text,
            role,
            span: name.span,
            components: rates,
            guards,
            written,
            derivation,
        });
        Ok(())
    }

    /// Some expressions as they are written, within a span that holds them all.
    fn written_as<'a>(&self, span: &Span, expressions: impl IntoIterator<Item = &'a Expr>) -> Written {
        let states = self.state_names();
        let is_definition = |name: &str| self.definitions.contains_key(name);
        let scope = Scope { source: &self.source, is_definition: &is_definition, states: &states };
        let mut places = Vec::new();
        for expr in expressions {
            places_in(&scope, expr, &mut places);
        }
        Written::new(&self.source, span, places)
    }

    fn sample(&mut self, ranges: &[(Name, Expr, Expr)], avoid: &[Expr]) -> Result<(), Problem> {
        for (name, low, high) in ranges {
            let Some(symbol) = self.find_symbol(&name.text) else {
                return Err(self.unknown(&name.text, &name.span, Wanted::Symbol));
            };
            let range = Range { low: self.rational(low)?, high: self.rational(high)? };
            if range.low > range.high {
                let span = low.span.start..high.span.end;
                return Err(Problem::new(
                    &span,
                    format!("the range of '{}' is empty", name.text),
                    "low above high",
                ));
            }
            // a range that came with an import may be replaced, one of this file not
            if !self.sampled.insert(symbol) {
                let message = format!("'{}' has a range already", name.text);
                return Err(Problem::new(&name.span, message, "the second one"));
            }
            if let Some(info) = self.symbols.get_mut(&symbol) {
                info.range = Some(range);
            }
        }
        for expr in avoid {
            let value = self.scalar(expr)?;
            self.avoid.push((in_one_line(&self.source, &expr.span), value));
        }
        Ok(())
    }

    /// Reads another file into the same graph. Its symbols are those of the same name here; its fields and definitions
    /// go under `alias.name`.
    fn import(
        &mut self,
        alias: &Name,
        path: &Path,
        span: &Span,
        reading: &mut Reading,
    ) -> Result<(), Problem> {
        let refuse = |message: String| Problem::new(span, message, "this file");
        reading.files.insert(path.to_owned());
        let place =
            file::identity(path).map_err(|e| refuse(format!("cannot read {}: {e}", path.display())))?;
        if let Some(begin) = reading.open.iter().position(|open| *open == place) {
            let round = reading.open[begin..].iter().chain([&place]);
            let names: Vec<String> = round.map(|file| name_of(file)).collect();
            return Err(refuse(format!("the file imports itself: {}", names.join(" -> ")))
                .help("put what both need into a third file, and import that"));
        }
        if alias.text.contains('.') {
            let message = "a name with a dot belongs to what an imported system imports";
            return Err(Problem::new(&alias.span, message, "choose one without"));
        }
        if self.aliases.iter().any(|(known, _)| *known == alias.text) {
            let message = format!("'{}' is the name of an imported system already", alias.text);
            return Err(
                Problem::new(&alias.span, message, "the second one").help("choose another name for this one")
            );
        }
        self.aliases.push((alias.text.clone(), path.to_owned()));
        let other = match reading.done.get(&place) {
            Some(known) => known.clone(),
            None if reading.open.len() > DEEPEST_IMPORT => {
                let message = format!("imports within imports, more than {DEEPEST_IMPORT} deep");
                return Err(refuse(message).help("import fewer files from one another"));
            }
            None => {
                reading.open.push(place.clone());
                let other = Arc::new(self.import_anew(path, span, reading)?);
                reading.open.pop();
                reading.done.insert(place, other.clone());
                other
            }
        };
        let names = self.definitions.len() + other.definitions.len();
        if names > MOST_NAMES {
            let message = format!("the imports bring more than {MOST_NAMES} names");
            return Err(
                refuse(message).help("each import brings all that its file imports, under a name of its own")
            );
        }
        for (symbol, info) in &other.symbols {
            if self.definitions.contains_key(self.graph.symbol_name(*symbol)) {
                let hidden = self.graph.symbol_name(*symbol);
                let message = format!("'{hidden}' is a definition above, and a symbol of {}", path.display());
                return Err(Problem::new(span, message, "imported here")
                    .help("choose another name for the definition"));
            }
            match self.symbols.entry(*symbol) {
                Entry::Vacant(place) => {
                    place.insert(SymbolInfo { kind: Kind::Imported, ..info.clone() });
                }
                Entry::Occupied(mut place) => {
                    let known = place.get_mut();
                    known.is_angle |= info.is_angle;
                    // where imported files differ neither speaks for this one
                    if known.kind == Kind::Imported {
                        known.default =
                            known.default.take().filter(|value| Some(value) == info.default.as_ref());
                        let own = self.sampled.contains(symbol);
                        known.range =
                            known.range.take().filter(|range| own || Some(range) == info.range.as_ref());
                    }
                }
            }
        }
        self.imported_dimensions.push((alias.text.clone(), span.clone(), other.dimensions.clone()));
        for field in other.fields.iter().chain(&other.imported_fields) {
            let name = format!("{}.{}", alias.text, field.name);
            // of two of one name the first is meant
            let place = FieldPlace::Imported(self.imported_fields.len());
            self.field_places.entry(name.clone()).or_insert(place);
            let written = field.written.clone().under(&alias.text);
            self.imported_fields.push(Field { name, written, ..field.clone() });
        }
        for (name, written) in &other.written {
            self.written.insert(format!("{}.{name}", alias.text), written.clone().under(&alias.text));
        }
        for (name, value) in &other.definitions {
            self.definitions.insert(format!("{}.{name}", alias.text), value.clone());
        }
        if !other.outputs.is_empty() {
            // a word of the language, so that no definition has this name
            let name = format!("{}.output", alias.text);
            let entries: Vec<_> = other.outputs.iter().map(|(_, output)| *output).collect();
            let column = Matrix { rows: entries.len(), columns: 1, entries };
            self.definition_domains
                .insert(name.clone(), Domain::of(other.output_guards.iter().flatten().copied()));
            self.definitions.insert(name, Value::Matrix(column));
        }
        self.calculated.extend(other.calculated.iter().map(|name| format!("{}.{name}", alias.text)));
        for (name, domain) in &other.definition_domains {
            let domain = domain.clone().under(&alias.text);
            self.definition_domains.insert(format!("{}.{name}", alias.text), domain);
        }
        Ok(())
    }

    /// Reads a file that was not imported yet. The graph comes back here.
    fn import_anew(&mut self, path: &Path, span: &Span, reading: &mut Reading) -> Result<System, Problem> {
        let name = path.display().to_string();
        let text = load(path).map_err(|message| Problem::new(span, message, "this file"))?;
        let text = with_plain_line_ends(&text);
        let folder = path.parent().unwrap_or(Path::new(""));
        let graph = std::mem::take(&mut self.graph);
        // what is wrong with an imported file is told of that file: here is said that something is
        let mut problems = Problems::up_to(1);
        let built = System::build(&name, &text, folder, graph, reading, &mut problems);
        let mut other = built.map_err(|graph| {
            // what was declared above the import is in it
            self.graph = *graph;
            let first = problems.into_found().into_iter().next();
            let problem = first.unwrap_or_else(|| Problem::new(&(0..0), "the file cannot be read", ""));
            let inner = problem.locate(&name, &text);
            let (line, column) = inner.line_and_column();
            let problem =
                Problem::new(span, format!("{name}:{line}:{column}: {}", inner.message), "imported here");
            match inner.help {
                Some(help) => problem.help(help),
                None => problem,
            }
        })?;
        self.graph = std::mem::take(&mut other.graph);
        Ok(other)
    }
}

/// The files of one reading.
#[derive(Default)]
struct Reading {
    /// Those that are being read: each is imported by the one before.
    open: Vec<PathBuf>,
    /// Those that are read, so that none is read twice, however many others import it. Their graphs are empty: all are
    /// in the one graph of the reading.
    done: HashMap<PathBuf, Arc<System>>,
    /// All that were asked for, whether they are there or not.
    files: BTreeSet<PathBuf>,
}

/// What examining a file came to.
#[derive(Debug)]
pub struct Examination {
    /// The system, where nothing is wrong.
    pub system: Option<System>,
    /// What is wrong, in the order of the file.
    pub problems: Vec<ReadError>,
    /// Whether there is more than was asked for.
    pub more: bool,
    /// The files that were read or looked for: this one, and all that it imports or refers to.
    pub files: BTreeSet<PathBuf>,
}

impl Examination {
    /// The system, or the first problem.
    ///
    /// # Errors
    /// What is wrong with the file, and where.
    pub fn into_result(self) -> Result<System, ReadError> {
        match self.system {
            Some(system) => Ok(system),
            None => Err(self
                .problems
                .into_iter()
                .next()
                .unwrap_or_else(|| Problem::new(&(0..0), "the file cannot be read", "").locate("", ""))),
        }
    }
}

/// The last part of a path, for messages.
fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// A text in which every line ends with a line feed, whatever its editor took for the end of a line, and without a
/// byte-order mark: so that the reader, the error and the person who looks count the same lines.
pub(crate) fn with_plain_line_ends(text: &str) -> String {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut plain = String::with_capacity(text.len());
    let mut characters = text.chars().peekable();
    while let Some(c) = characters.next() {
        // a carriage return before a line feed stays, and is blank
        let within_an_end = c == '\r' && characters.peek() == Some(&'\n');
        plain.push(if ends_a_line(c) && !within_an_end { '\n' } else { c });
    }
    plain
}

/// Refuses characters that make a text look other than it is read: marks of the direction of writing, behind which an
/// editor shows a claim as a comment or a comment as a claim.
pub(super) fn refuse_reordering(text: &str) -> Result<(), Problem> {
    let reorders = |c: char| matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{200e}' | '\u{200f}' | '\u{61c}');
    match text.char_indices().find(|(_, c)| reorders(*c)) {
        None => Ok(()),
        Some((at, c)) => {
            let message = format!("U+{:04X} changes the order in which the text is shown", c as u32);
            Err(Problem::new(&(at..at + c.len_utf8()), message, "an invisible character").help("remove it"))
        }
    }
}

/// The text of a file, or what is wrong with it in words. A byte-order mark is no part of it.
pub(crate) fn load(path: &Path) -> Result<String, String> {
    read_text(path, LONGEST_FILE).map_err(|why| match why {
        why @ (ReadFailure::TooLong(_) | ReadFailure::NotText { .. }) => {
            why.to_string().replacen("it", &path.display().to_string(), 1)
        }
        why => format!("cannot read {}: {why}", path.display()),
    })
}

fn expected(error: crate::expression::Expected) -> Problem {
    Problem {
        message: error.to_string(),
        span: error.at..error.at + 1,
        label: "here".to_owned(),
        help: error.help,
        cause: Cause::Itself,
    }
}
