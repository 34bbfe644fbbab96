"""Terms and relations of a proof file, read by precedence: what is no term is refused, and nothing is handed to Python."""

import re
from itertools import islice
from operator import add, eq, ge, gt, le, lt, ne, sub, truediv

from .graph import refuse, spend

NAME = r"[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*'*"
TOKEN = re.compile(rf"(?P<number>(?:\d+\.?\d*|\.\d+)(?:e-?\d{{1,3}}\b)?)|(?P<name>{NAME})|(?P<mark>[<>!]=|[-+*/^()\[\]{{}},;=<>])"
                   r"|(?P<space>\s+)|(?P<other>.)", re.S)
HOLDS = {"=": eq, "!=": ne, "<": lt, "<=": le, ">": gt, ">=": ge}  # of two sides, or of a sign and zero
LONGEST, DEEPEST = 20_000, 40  # tokens of a term; brackets within brackets
# a word of the language that ends a term
RESERVED = {"at", "where", "within", "everywhere", "except", "on", "in", "or", "for", "carrying"}


class Parser:
    """One text, its tokens, and a `scope` that knows names, functions and matrices."""

    def __init__(self, text, scope):
        found = ((x.lastgroup, x[0]) for x in TOKEN.finditer(text) if x.lastgroup != "space")
        self.tokens = [*islice(found, LONGEST + 1)]
        self.scope, self.place, self.depth, self.met = scope, 0, 0, []
        spend(len(self.tokens))
        if len(self.tokens) > LONGEST:
            refuse("a term that is too long")
        self.tokens.append(("end", ""))

    def whole(self):
        """The terms and relations between the commas of the text."""
        found = [self.relation()]
        while self.taken(","):
            found.append(self.relation())
        return found if self.tokens[self.place][0] == "end" else refuse(f"{self.tokens[self.place][1]!r}")

    def taken(self, *marks):
        kind, text = self.tokens[self.place]
        if kind in ("mark", "name") and text in marks:
            self.place += 1
            return text
        return None

    def wanted(self, mark):
        return self.taken(mark) or refuse(f"{self.tokens[self.place][1]!r} instead of {mark!r}")

    def relation(self):
        left = self.sum()
        sign = self.taken(*HOLDS)
        if sign is None:
            return left
        right = self.sum()
        return self.scope.relation(left, sign, right) if self.taken(*HOLDS) is None else refuse("a chain of relations")

    def sum(self):
        found = self.product()
        while sign := self.taken("+", "-"):
            found = (add if sign == "+" else sub)(found, self.product())
        return found

    def signs(self):
        minus = False
        while sign := self.taken("+", "-"):
            minus ^= sign == "-"
        return minus

    def product(self):
        """Signs before the first factor belong to the product, those of a later one to it."""
        minus, found = self.signs(), self.factor()
        while sign := self.taken("*", "/"):
            negative, factor = self.signs(), self.factor()
            factor = -factor if negative else factor
            if sign == "/":
                self.met.append(factor ** self.scope.number("-1"))
            found = found * factor if sign == "*" else truediv(found, factor)
        return -found if minus else found

    def factor(self):
        """A power, perhaps at a point."""
        found = self.primary()
        if self.taken("^"):
            minus = self.signs()
            exponent = self.primary()
            found = found ** (-exponent if minus else exponent)
            if self.taken("^"):
                refuse("two exponents")
        while self.taken("at"):
            found = self.scope.at(found, self.bracketed("{", "}", self.given))
        self.met.append(found)
        return found

    def given(self):
        name = self.name()
        self.wanted("=")
        return name, self.sum()

    def name(self):
        kind, text = self.tokens[self.place]
        if kind != "name" or text in RESERVED:
            refuse(f"{text!r} instead of a name")
        self.place += 1
        return text

    def bracketed(self, left, right, one):
        """A list between brackets."""
        self.wanted(left)
        self.depth += 1
        if self.depth > DEEPEST:
            refuse("brackets that are too deep")
        found = [one()]
        while self.taken(","):
            found.append(one())
        self.wanted(right)
        self.depth -= 1
        return found

    def matrix(self):
        """Rows of entries, which may be matrices."""
        rows = [[]]
        self.wanted("[")
        self.depth += 1
        if self.depth > DEEPEST:
            refuse("brackets that are too deep")
        while True:
            rows[-1].append(self.sum())
            if self.taken(";"):
                rows.append([])
            elif not self.taken(","):
                break
        self.wanted("]")
        self.depth -= 1
        return self.scope.matrix(rows)

    def primary(self):
        kind, text = self.tokens[self.place]
        if kind == "number":
            self.place += 1
            return self.scope.number(text)
        if text == "(":
            found = self.bracketed("(", ")", self.sum)
            return found[0] if len(found) == 1 else refuse("a list in brackets")
        if text == "[":
            return self.matrix()
        name = self.name()
        return self.scope.call(name, self.bracketed("(", ")", self.sum)) if self.tokens[self.place][1] == "(" else self.scope[name]


def without_comments(text):
    """A text without comments, and with each string as one word that no statement has."""
    return re.sub(r'"[^"]*"|#[^\n]*', lambda x: '"' * (x[0][0] == '"'), text)


def compact(text):
    return "".join(re.sub(r"#[^\n]*", "", text).split())


def asked(claim):
    """What a statement without its conditions asks, and the number that it claims."""
    for name, what in (("observable(", "observable"), ("identifiable(", "observable"),
                       ("unobservable(", "unobservable"), ("unidentifiable(", "unobservable")):
        if claim.startswith(name):
            return what, ""
    depth, place = 0, None
    for at, sign in enumerate(claim):
        depth += (sign in "([{") - (sign in ")]}")
        if depth == 0 and sign in "<>!":
            return "inequality", ""
        if depth == 0 and sign == "=" and place is None:
            place = at
    if place is None:
        return "inequality", ""
    for side, other in ((claim[:place], claim[place + 1:]), (claim[place + 1:], claim[:place])):
        for begin, what in (("rank(", "rank_of_matrix"), ("pole(", "pole"), ("solutions(", "solutions")):
            if side == "rank" or side.startswith(begin):
                return ("rank_of_system" if side == "rank" else what), other
    return "equation", ""


def parts(text):
    """The parts of a statement, by which a verdict is held to its claim."""
    text = re.sub(r"#[^\n]*", "", text)
    words = {}
    for x in re.finditer(r"[\w.']+", text):
        words.setdefault(x[0], x.start())
    end = len(text)
    rest = min(words.get("except", end), words.get("everywhere", end))
    given = min(words.get("on", end), words.get("where", end), rest)
    within = words.get("within", end)
    what, claimed = asked(compact(text[:given]))
    if within < given:
        what, claimed = "tolerance", compact(text[within + len("within"):given])
    of_rank = what in ("rank_of_matrix", "rank_of_system", "observable", "unobservable")
    sense = "except" if "except" in words else "everywhere" if "everywhere" in words else "generic" if of_rank else "always"
    except_ = compact(text[words["except"]:]) if "except" in words else ""
    return {"what": what, "claimed": claimed, "sense": sense, "where": compact(text[given:rest]), "except": except_}


def texts(entry):
    """The statements of an entry that claims something, by their ids; the entry has no strings any more."""
    head, colon, body = entry.partition(":")
    kind, name = (head.split() + ["", ""])[:2]
    body = body.strip()
    if kind == "claim" and colon:
        return {name: body.rstrip('"').strip()}
    found = re.split(r"\b(?:corrected|repaired|meant)\b", re.split(r"\bconclusion\b", body)[0], maxsplit=1)
    if kind not in ("erratum", "damaged", "scan", "convention", "loose") or len(found) == 1 or not re.match(r"\w", body):
        return {}
    printed, right = re.sub(r"^\w+", "", found[0]).strip().removeprefix('"').strip(), found[1]
    printed, right = (part.strip().strip('"').strip() for part in (re.sub(r"^as\b", "", printed), right))
    return {f"{name} as printed": printed, f"{name} corrected": right} if printed else {name: right}
