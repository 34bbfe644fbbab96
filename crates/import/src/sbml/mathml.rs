//! MathML as SBML has it. `log` is to the base ten here, and `ln` is the natural logarithm.

use super::super::expression::{DEEPEST, ForeignExpr, ForeignKind, ForeignOrder, Span};
use super::super::functions::{call, case, constant, fraction};
use super::super::script::MOST_CASES;
use super::super::too_much;
use super::xml::{elements, is, place};
use palmistry_io::foreign::Budget;
use palmistry_lang::{Code, Problem};
use palmistry_math::number::parse_decimal;
use roxmltree::Node;
use std::collections::BTreeMap;

/// Formulas that grow beyond this when functions are put in are refused.
const LARGEST: usize = 200_000;

/// A condition of more parts is refused: each nests the case.
const MOST_PARTS: usize = 40;

/// Values with more parts than these are not written twice.
const TWICE: usize = 40;

/// Avogadro's number, as SBML level 3 fixes it.
const AVOGADRO: &str = "6.02214179e23";

/// What formulas of a model mean.
pub(super) struct Formulas<'b> {
    /// The functions of the model: their arguments and what they are of them.
    pub functions: BTreeMap<String, (Vec<String>, ForeignExpr)>,
    /// What time is called.
    pub time: String,
    /// What functions may cost that are put in where they are used.
    pub budget: &'b Budget,
}

type Meant = Result<ForeignExpr, Problem>;

fn unread(node: Node<'_, '_>, what: &str, help: &str) -> Problem {
    Problem::new(Code::Foreign, &place(node), what.to_owned(), "this").help(help)
}

impl Formulas<'_> {
    /// What a `math` element means. Its names are those of the file; time has a name of its own.
    pub fn meaning(&self, math: Node<'_, '_>) -> Meant {
        match elements(math).next() {
            Some(node) => self.of(node, 0),
            None => Err(unread(math, "an empty formula", "write the formula, or take the element out")),
        }
    }

    /// What an element of a formula means.
    pub fn meaning_of(&self, node: Node<'_, '_>) -> Meant {
        self.of(node, 0)
    }

    fn of(&self, node: Node<'_, '_>, depth: usize) -> Meant {
        if depth > DEEPEST {
            return Err(unread(
                node,
                "a formula that is nested too deeply",
                "give its parts names by assignment rules",
            ));
        }
        let span = place(node);
        match node.tag_name().name() {
            "cn" => number(node, &span),
            "ci" => Ok(ForeignExpr::name(text_of(node), &node.range())),
            "csymbol" => self.symbol(node, &span),
            "pi" => Ok(ForeignExpr::new(ForeignKind::Pi, &span)),
            "exponentiale" => constant("exponentiale", &span)
                .ok_or_else(|| unread(node, "a constant that is not known", "")),
            "apply" => self.apply(node, depth),
            "piecewise" => self.piecewise(node, depth),
            "semantics" | "math" => match elements(node).next() {
                Some(inner) => self.of(inner, depth + 1),
                None => Err(unread(node, "an empty formula", "write the formula")),
            },
            other => Err(unread(
                node,
                &format!("'{other}' is not read as a number"),
                "what can be read: numbers, names, arithmetic, powers, roots, elementary functions, cases of one comparison",
            )),
        }
    }

    fn symbol(&self, node: Node<'_, '_>, span: &Span) -> Meant {
        let url = node.attribute("definitionURL").unwrap_or_default();
        match url.rsplit('/').next().unwrap_or_default() {
            "time" => Ok(ForeignExpr::name(&self.time, span)),
            "avogadro" => ForeignExpr::number(AVOGADRO, span),
            "delay" => Err(unread(node, "delays are not read", "a system with delays has no finite state")),
            other => {
                Err(unread(node, &format!("the symbol '{other}' is not read"), "write what it stands for"))
            }
        }
    }

    fn apply(&self, node: Node<'_, '_>, depth: usize) -> Meant {
        let span = place(node);
        let mut parts = elements(node);
        let Some(head) = parts.next() else {
            return Err(unread(node, "an empty 'apply'", "write the formula"));
        };
        let (mut qualifier, mut arguments) = (None, Vec::new());
        for part in parts {
            if is(part, "degree") || is(part, "logbase") {
                let inner = elements(part).next();
                qualifier = inner.map(|inner| self.of(inner, depth + 1)).transpose()?;
            } else {
                arguments.push(self.of(part, depth + 1)?);
            }
        }
        let name = head.tag_name().name();
        let count = arguments.len();
        let listed = |kind: fn(Vec<(bool, ForeignExpr)>) -> ForeignKind, list: Vec<ForeignExpr>| {
            Ok(ForeignExpr::new(kind(list.into_iter().map(|one| (false, one)).collect()), &span))
        };
        let wrong = || unread(node, &format!("'{name}' of {count} arguments"), "give it as many as it takes");
        let one = |arguments: &mut Vec<ForeignExpr>| arguments.pop().ok_or_else(wrong);
        match (name, count) {
            ("plus", 0) => Ok(ForeignExpr::integer(0, &span)),
            ("times", 0) => Ok(ForeignExpr::integer(1, &span)),
            ("plus" | "times", 1) => one(&mut arguments),
            ("plus", _) => listed(ForeignKind::Sum, arguments),
            ("times", _) => listed(ForeignKind::Product, arguments),
            ("minus", 1) => Ok(one(&mut arguments)?.negative()),
            ("minus" | "divide" | "power", 2) => {
                let (right, left) = (one(&mut arguments)?, one(&mut arguments)?);
                Ok(match name {
                    "minus" => left.minus(right),
                    "divide" => left.over(right),
                    _ => left.to(right),
                })
            }
            ("root", 1) => {
                let inner = one(&mut arguments)?;
                Ok(match qualifier {
                    None => inner.under("sqrt"),
                    Some(degree) if degree.as_number().is_some_and(|n| *n == 2.into()) => inner.under("sqrt"),
                    Some(degree) => inner.to(ForeignExpr::integer(1, &span).over(degree)),
                })
            }
            ("log", 1) => {
                let base = qualifier.unwrap_or_else(|| ForeignExpr::integer(10, &span));
                Ok(one(&mut arguments)?.under("log").over(base.under("log")))
            }
            ("minus" | "divide" | "power" | "root" | "log", _) => Err(wrong()),
            ("ci", _) => self.function(head, arguments, node),
            ("csymbol", _) => self.symbol(head, &span),
            ("lt" | "leq" | "gt" | "geq" | "eq" | "neq" | "and" | "or" | "not" | "xor", _) => {
                Err(unread(node, "a condition stands where a number is meant", "put it into 'piecewise'"))
            }
            _ => call(name, arguments, &span),
        }
    }

    /// A function of the model, with its arguments put in.
    fn function(&self, head: Node<'_, '_>, arguments: Vec<ForeignExpr>, node: Node<'_, '_>) -> Meant {
        let name = text_of(head);
        let Some((parameters, body)) = self.functions.get(&name) else {
            return Err(unread(
                node,
                &format!("nothing says what the function '{name}' is"),
                "define it above its use",
            ));
        };
        if parameters.len() != arguments.len() {
            let message =
                format!("'{name}' takes {} arguments, and has {} here", parameters.len(), arguments.len());
            return Err(unread(node, &message, ""));
        }
        // how large it becomes, before it does
        let sizes: Vec<usize> = arguments.iter().map(ForeignExpr::size).collect();
        let mut size = body.size();
        body.names(&mut |used, _| {
            let at = parameters.iter().position(|parameter| parameter == used);
            size = size.saturating_add(at.map_or(0, |at| sizes[at]));
        });
        if size > LARGEST || body.depth() > DEEPEST {
            return Err(unread(node, "a formula that becomes too large", "write it as assignment rules"));
        }
        self.budget.nodes(size).map_err(|spent| too_much(&place(node), spent))?;
        let mut whole = body.clone();
        let by_name: BTreeMap<&str, &ForeignExpr> =
            parameters.iter().map(String::as_str).zip(&arguments).collect();
        whole.replace(&|name| by_name.get(name).map(|value| (*value).clone()));
        whole.span = place(node);
        Ok(whole)
    }

    fn piecewise(&self, node: Node<'_, '_>, depth: usize) -> Meant {
        let mut result: Option<ForeignExpr> = None;
        let mut pieces = Vec::new();
        for part in elements(node) {
            let inner: Vec<Node<'_, '_>> = elements(part).collect();
            match (part.tag_name().name(), inner.as_slice()) {
                ("otherwise", [value]) => result = Some(self.of(*value, depth + 1)?),
                ("piece", [value, condition]) => pieces.push((*value, *condition)),
                _ => {
                    return Err(unread(
                        part,
                        "this case cannot be read",
                        "a piece has a value and a condition",
                    ));
                }
            }
        }
        if pieces.len() > MOST_CASES {
            let help = "a table of values is no model: say it as a formula";
            return Err(unread(node, &format!("more than {MOST_CASES} cases"), help));
        }
        for (value, condition) in pieces.into_iter().rev() {
            let then = self.of(value, depth + 1)?;
            let Some(otherwise) = result else {
                let help =
                    "add <otherwise>: a value that exists on a part of the states alone cannot be said";
                return Err(unread(node, "nothing is said of what is so elsewhere", help));
            };
            result = Some(self.chosen(condition, then, otherwise, depth + 1)?);
        }
        result.ok_or_else(|| unread(node, "no case", "write the cases"))
    }

    fn chosen(
        &self,
        condition: Node<'_, '_>,
        then: ForeignExpr,
        otherwise: ForeignExpr,
        depth: usize,
    ) -> Meant {
        if depth > DEEPEST {
            return Err(unread(condition, "a condition that is nested too deeply", "write it shorter"));
        }
        let parts: Vec<Node<'_, '_>> = elements(condition).collect();
        match (condition.tag_name().name(), parts.as_slice()) {
            ("true", _) => Ok(then),
            ("false", _) => Ok(otherwise),
            ("apply", [not, inner]) if is(*not, "not") => self.chosen(*inner, otherwise, then, depth + 1),
            // of one part alone it is that part
            ("apply", [head, only]) if is(*head, "and") || is(*head, "or") => {
                self.chosen(*only, then, otherwise, depth + 1)
            }
            // both values would stand there several times: one comparison of a number that is one or zero
            ("apply", [head, _, _, ..])
                if ["and", "or", "eq", "neq"].iter().any(|name| is(*head, name))
                    && then.size() + otherwise.size() > TWICE =>
            {
                let span = place(condition);
                let number = |value: i64| ForeignExpr::integer(value, &span);
                let holds = self.chosen(condition, number(1), number(0), depth + 1)?;
                let half = number(1).over(number(2));
                Ok(case(holds, ForeignOrder::Greater, half, then, otherwise))
            }
            ("apply", [head, parts @ ..]) if (is(*head, "and") || is(*head, "or")) && !parts.is_empty() => {
                if parts.len() > MOST_PARTS {
                    let message = format!("a condition of more than {MOST_PARTS} parts");
                    return Err(unread(condition, &message, "write cases within cases"));
                }
                let all = is(*head, "and");
                let mut value = if all { then.clone() } else { otherwise.clone() };
                for part in parts.iter().rev() {
                    value = match all {
                        true => self.chosen(*part, value, otherwise.clone(), depth + 1)?,
                        false => self.chosen(*part, then.clone(), value, depth + 1)?,
                    };
                }
                Ok(value)
            }
            // equal is not less and not greater
            ("apply", [head, left, right]) if is(*head, "eq") || is(*head, "neq") => {
                let (then, otherwise) = if is(*head, "eq") { (then, otherwise) } else { (otherwise, then) };
                let (left, right) = (self.of(*left, depth + 1)?, self.of(*right, depth + 1)?);
                let inner = case(left.clone(), ForeignOrder::AtLeast, right.clone(), then, otherwise.clone());
                Ok(case(left, ForeignOrder::AtMost, right, inner, otherwise))
            }
            ("apply", [head, left, right]) => {
                let order = match head.tag_name().name() {
                    "lt" => ForeignOrder::Less,
                    "leq" => ForeignOrder::AtMost,
                    "gt" => ForeignOrder::Greater,
                    "geq" => ForeignOrder::AtLeast,
                    other => {
                        let help = "comparisons with lt, leq, gt, geq, eq or neq, joined by and, or, not";
                        return Err(unread(condition, &format!("cases by '{other}' are not read"), help));
                    }
                };
                Ok(case(self.of(*left, depth + 1)?, order, self.of(*right, depth + 1)?, then, otherwise))
            }
            _ => Err(unread(
                condition,
                "this condition cannot be read",
                "one comparison with lt, leq, gt or geq",
            )),
        }
    }
}

/// The text of an element without blanks around it.
pub(super) fn text_of(node: Node<'_, '_>) -> String {
    node.text().unwrap_or_default().trim().to_owned()
}

fn number(node: Node<'_, '_>, span: &Span) -> Meant {
    let kind = node.attribute("type").unwrap_or("real").trim();
    let bad = |text: &str| {
        unread(
            node,
            &format!("'{text}' is no number that can be read"),
            "decimals of at most 4096 digits; INF and NaN are none",
        )
    };
    if node.attribute("base").is_some_and(|base| base.trim() != "10") {
        return Err(unread(node, "a number that is no decimal", "write it in decimal digits"));
    }
    let texts: Vec<&str> = node
        .children()
        .filter(|child| child.is_text())
        .filter_map(|child| child.text())
        .map(str::trim)
        .collect();
    match (kind, texts.as_slice()) {
        ("integer" | "real" | "double", [text]) => ForeignExpr::number(text, span).map_err(|_| bad(text)),
        ("e-notation", [mantissa, exponent]) => {
            let text = format!("{mantissa}e{}", exponent.trim_start_matches('+'));
            ForeignExpr::number(&text, span).map_err(|_| bad(&text))
        }
        ("rational", [top, bottom]) => {
            let both = (!top.contains('/') && !bottom.contains('/'))
                .then(|| Some((parse_decimal(top)?, parse_decimal(bottom)?)));
            both.flatten()
                .and_then(|(top, bottom)| fraction(&top, &bottom, span))
                .ok_or_else(|| bad(&format!("{top}/{bottom}")))
        }
        _ => Err(bad(texts.join(" ").as_str())),
    }
}
