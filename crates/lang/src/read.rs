//! From a file to a system.

use super::codes::Code;
use super::components::is_component;
use super::declare::in_words;
use super::dimension::{self, Declared};
use super::elaborate::Wanted;
use super::error::{Problem, line_starts};
use super::examine::expected;
use super::grammar::{Entries, parse_entries};
use super::imports::Reading;
use super::model::{Kind, Range, System, Time, Value};
use super::problems::{Cause, Full, Problems, Remnant, names_of_text};
use super::signals::{Derivatives, Knowledge};
use super::source_text::refuse_reordering;
use super::syntax::{Item, OutputSyntax};
use super::unknowns::UnknownKind;
use super::written::{Written, in_one_line};
use palmistry_math::expression::parse::UNDECLARABLE;
use palmistry_math::expression::syntax::{Expr, ExprKind, Name, Span};
use palmistry_math::expression::{Graph, Guard, NodeId, Symbol};
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::path::Path;
use std::sync::Arc;

impl System {
    /// Reads a text into a graph; where the reading ends before the text does, that is given back.
    pub(super) fn build(
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
            line_starts: line_starts(text),
            graph,
            states: Vec::new(),
            known: BTreeSet::new(),
            fields: Vec::new(),
            outputs: Vec::new(),
            output_guards: Vec::new(),
            avoid: Vec::new(),
            claims: Vec::new(),
            assumed: Vec::new(),
            sets: Vec::new(),
            set_titles: BTreeSet::new(),
            maps: Vec::new(),
            lines: Vec::new(),
            reductions: Vec::new(),
            symbols: BTreeMap::new(),
            coordinates: Default::default(),
            definitions: BTreeMap::new(),
            definition_domains: HashMap::new(),
            domain: Default::default(),
            written: BTreeMap::new(),
            imported_fields: Vec::new(),
            field_places: HashMap::new(),
            partials: HashMap::new(),
            states_are_final: false,
            motion_is_final: false,
            looks: Default::default(),
            aliases: Vec::new(),
            sampled: HashSet::new(),
            calculated: HashSet::new(),
            dimensions: Default::default(),
            imported_dimensions: Vec::new(),
            vectors: BTreeSet::new(),
            time: Time::Continuous,
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
        let Entries { items, damage, indices, .. } = parse_entries(&text, problems.room());
        for part in damage {
            problems.add(expected(part.expected))?;
            if let Some((word, names)) = names_of_text(&text[part.left_out]) {
                problems.break_names(word, names);
            }
        }
        let derivatives = self.look_ahead(&items);
        let mut ids = HashSet::new();
        for item in &items {
            if let Item::Claim(claim) = item
                && !ids.insert(claim.id.clone())
            {
                let message = format!("there is a claim '{}' already", claim.id);
                problems.add(
                    Problem::new(Code::Twice, &claim.span, message, "the second one")
                        .help("each claim has its own number or name"),
                )?;
            }
            let remnant = Remnant::of(item, problems);
            if let Err(problem) = self.enter(item, folder, reading, &derivatives) {
                self.entry_failed(problem, remnant, problems)?;
            }
        }
        let finished = match self.time {
            Time::Continuous => self.finish_signals(),
            Time::Discrete => self.finish_discrete_signals(),
        };
        if let Err(problem) = finished {
            problems.add(problem)?;
        }
        for problem in self.looks_alike(&items) {
            problems.add(problem)?;
        }
        for problem in self.assumptions_that_cannot_hold() {
            problems.add(problem)?;
        }
        self.claim_what_is_assumed();
        for claim in self.claims.clone() {
            for statement in claim.body.statements() {
                if let Err(problem) = self.check(&claim, statement) {
                    let remnant = Remnant::of_statement(statement, problems);
                    self.entry_failed(problem, remnant, problems)?;
                }
            }
        }
        for index in &indices {
            if let Err(problem) = self.refuse_taken_index(index) {
                problems.add(problem)?;
            }
        }
        self.domain = Default::default();
        if self.title.is_empty() {
            problems.add(
                Problem::new(Code::Syntax, &(0..0), "the file does not name a system", "here")
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

    fn enter(
        &mut self,
        item: &Item,
        folder: &Path,
        reading: &mut Reading,
        derivatives: &Derivatives,
    ) -> Result<(), Problem> {
        match item {
            Item::System { title, cite, span } => {
                if !self.title.is_empty() {
                    let message = format!("the file describes a system already: \"{}\"", self.title);
                    return Err(Problem::new(Code::Twice, span, message, "the second one")
                        .help("one file holds one system"));
                }
                if title.is_empty() {
                    return Err(Problem::new(Code::Syntax, span, "a system needs a title", "this is empty"));
                }
                (self.title, self.cite) = (title.clone(), cite.clone());
            }
            Item::Use { alias, path, span } => self.import(alias, &folder.join(path), span, reading)?,
            Item::State(list) => {
                for Declared { name, .. } in list {
                    self.declare_coordinate(name, UnknownKind::State)?;
                }
            }
            Item::Param(list) => {
                for Declared { name, value, knowledge, .. } in list {
                    let default = value.as_ref().map(|value| self.rational(value)).transpose()?;
                    if *knowledge == Some(Knowledge::Unknown) {
                        self.declare_unknown_constant(name, default)?;
                        continue;
                    }
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
                    for one in self.everywhere(symbol) {
                        if let Some(info) = self.symbols.get_mut(&one) {
                            info.is_angle = true;
                        }
                    }
                }
            }
            Item::Let { name, value: expr, .. } => {
                self.refuse_taken(name)?;
                if self.find_symbol(&name.text).is_some() {
                    let message = format!("'{}' is a symbol of an imported system", name.text);
                    return Err(Problem::new(
                        Code::Import,
                        &name.span,
                        message,
                        "a definition of this name would hide it",
                    )
                    .help("choose another name, or declare the symbol with 'param'"));
                }
                let (value, domain) = self.apart(|system| system.elaborate(expr))?;
                if !self.calculates_nothing(expr) {
                    self.calculated.insert(name.text.clone());
                }
                let nameless = match &value {
                    Value::CodistributionRank => Some("the rank of the codistribution".to_owned()),
                    Value::Visible { .. } | Value::Solutions(_) | Value::Infinity => Some(value.describe()),
                    _ => None,
                };
                if let Some(nameless) = nameless {
                    let message = format!("{nameless} has no name");
                    return Err(Problem::new(Code::Value, &expr.span, message, "claim it as it is"));
                }
                self.note_component(&name.text);
                let written = match (&value, is_component(&name.text)) {
                    // the text speaks of all components
                    (Value::Scalar(value), true) => Written::plain(self.graph.text(*value)),
                    _ => self.written_as(&expr.span, [expr]),
                };
                self.written.insert(name.text.clone(), written);
                self.definition_domains.insert(name.text.clone(), domain);
                self.definitions.insert(name.text.clone(), value);
            }
            Item::Field { name, .. } if self.motion_is_final => {
                return Err(late("this field", &name.span));
            }
            Item::Field { role, name, components, is_map: true, .. } => {
                self.enter_map(*role, name.clone(), components)?
            }
            Item::Field { role, name, components, others_are_zero, .. } => {
                self.enter_field(*role, name.clone(), components, *others_are_zero)?
            }
            Item::Output(list) | Item::Zero(list) => {
                let is_zero = matches!(item, Item::Zero(_));
                let mut further = Vec::new();
                for OutputSyntax { value: expr, is_repeated, .. } in list {
                    if self.motion_is_final {
                        return Err(late("this output", &expr.span));
                    }
                    let (value, domain) = self.apart(|system| system.scalar(expr))?;
                    let guards = self.guards_of(&domain);
                    self.refuse_without_value(expr)?;
                    let text = match (&expr.kind, is_repeated) {
                        (_, false) => in_one_line(&self.source, &expr.span),
                        (ExprKind::Name(name), true) => name.clone(),
                        (_, true) => self.graph.text(value),
                    };
                    for (experiment, copies) in self.further_experiments() {
                        let there = self.graph.substitute(&[value], &copies)[0];
                        let guards = self.substitute_guards(&guards, &copies);
                        further.push((in_words(&text, experiment), there, guards));
                    }
                    if is_zero {
                        self.coordinates.zero_outputs.push(value);
                    }
                    self.see(text, value, guards);
                }
                for (text, value, guards) in further {
                    if is_zero {
                        self.coordinates.zero_outputs.push(value);
                    }
                    self.see(text, value, guards);
                }
            }
            Item::Signals { knowledge, list } => {
                for signal in list {
                    self.declare_signal(*knowledge, signal, derivatives)?;
                }
            }
            Item::Initial(list) => {
                for one in list {
                    self.enter_initial(one)?;
                }
            }
            Item::Experiments { count, span } => self.enter_experiments(count, span)?,
            Item::Sample { ranges, avoid } => self.sample(ranges, avoid)?,
            Item::Assume(relations) => self.assume(relations)?,
            Item::Looks(list) => self.enter_looks(list)?,
            Item::Claim(claim) => self.claims.push((**claim).clone()),
            Item::View(view) => self.enter_view(view)?,
        }
        Ok(())
    }

    /// Adds an output. What is seen twice is seen once: a second time it would count as a measurement of its own.
    fn see(&mut self, text: String, value: NodeId, guards: Vec<Guard>) {
        match self.outputs.iter().position(|(_, known)| *known == value) {
            Some(place) => self.output_guards[place].extend(guards),
            None => {
                self.output_guards.push(guards);
                self.outputs.push((text, value));
            }
        }
    }

    pub(super) fn refuse_taken(&self, name: &Name) -> Result<(), Problem> {
        let declared = self.find_symbol(&name.text).and_then(|symbol| self.symbols.get(&symbol));
        let taken = declared.is_some_and(|info| info.kind != Kind::Imported)
            || self.definitions.contains_key(&name.text)
            || ["pi", "rank", "others"].contains(&name.text.as_str());
        if is_a_word(&name.text) {
            let message = format!("'{}' is a word of the language", name.text);
            let problem = Problem::new(Code::Name, &name.span, message, "choose another name");
            return Err(match name.text.as_str() {
                word @ ("known" | "unknown") => problem.help(format!(
                    "without ',' before it, it says that the constant is {word}, as in param a {word}, b {word}"
                )),
                word => problem.help(format!("choose another name, as in {word}_1")),
            });
        }
        if taken {
            return Err(Problem::new(
                Code::Twice,
                &name.span,
                format!("'{}' has a meaning already", name.text),
                "declared again",
            )
            .help("choose another name, or leave one of the two out"));
        }
        if name.text.contains('.') {
            let message = "a name with a dot belongs to an imported system";
            return Err(Problem::new(Code::Name, &name.span, message, "choose one without")
                .help(format!("as in {}", name.text.replace('.', "_"))));
        }
        if name.text.contains(['\'', '@']) {
            let message =
                "derivatives of signals, and what belongs to further experiments, come with what they are of";
            let plain = name.text.split(['\'', '@']).next().unwrap_or_default();
            return Err(Problem::new(Code::Name, &name.span, message, "choose a name without")
                .help(format!("as in {plain}_1; a derivative of a state along the drift f is L(f, x)")));
        }
        self.refuse_mixed(name)
    }

    pub(super) fn declare(&mut self, name: &Name, kind: Kind) -> Result<Symbol, Problem> {
        self.refuse_taken(name)?;
        Ok(self.declare_anew(&name.text, kind))
    }

    /// The same of a name that nobody else can give.
    pub(super) fn declare_anew(&mut self, name: &str, kind: Kind) -> Symbol {
        self.note_component(name);
        let symbol = self.graph.intern(name);
        let info = self.fresh_info(symbol, kind);
        self.symbols.insert(symbol, info);
        symbol
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
                    Code::Range,
                    &span,
                    format!("the range of '{}' is empty", name.text),
                    "low above high",
                )
                .help("the low end comes first, as in [0, 1]"));
            }
            // a range that came with an import may be replaced, one of this file not
            if !self.sampled.insert(symbol) {
                let message = format!("'{}' has a range already", name.text);
                return Err(Problem::new(Code::Twice, &name.span, message, "the second one")
                    .help("leave one of the two out"));
            }
            self.spread_range(symbol, &range);
            if let Some(info) = self.symbols.get_mut(&symbol) {
                info.range = Some(range);
            }
        }
        for expr in avoid {
            let value = self.scalar(expr)?;
            let text = in_one_line(&self.source, &expr.span);
            self.avoid.push((text.clone(), value));
            for (experiment, copies) in self.further_experiments() {
                let there = self.graph.substitute(&[value], &copies)[0];
                if there != value {
                    self.avoid.push((in_words(&text, experiment), there));
                }
            }
        }
        Ok(())
    }
}

/// Names that would be taken for statements.
const TAKEN: [&str; 6] =
    ["observable", "unobservable", "identifiable", "unidentifiable", "solutions", "codistribution"];

/// Whether a word has a meaning of its own where a name could stand, so that nothing can be declared under it.
pub(super) fn is_a_word(name: &str) -> bool {
    UNDECLARABLE.iter().chain(&TAKEN).any(|word| *word == name)
}

/// What comes below a codistribution that does not know of it.
fn late(what: &str, span: &Span) -> Problem {
    let message = format!("'codistribution(...)' above does not know of {what}");
    Problem::new(Code::TooLate, span, message, "declare fields and outputs before it")
}
