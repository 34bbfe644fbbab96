"""Terms of the language as text, each with how strongly it binds, so that brackets stand where they are needed and nowhere else."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction
from typing import Any, NamedTuple

from .errors import Error

SUM, PRODUCT, POWER, PRIMARY = range(4)


class Term(NamedTuple):
    """A text of the language."""

    text: str
    binding: int

    def within(self, binding: int) -> str:
        """The text where something that binds so strongly is needed."""
        return self.text if self.binding >= binding else f"({self.text})"


def name(text: str) -> Term:
    return Term(text, PRIMARY)


def exactly(value: Any) -> Fraction:
    """A number as a fraction. A float is the decimal that Python prints, not the fraction that its bits are."""
    if isinstance(value, bool):
        raise Error(f"{value} is not a number")
    try:
        if isinstance(value, float):
            return Fraction(repr(float(value)))
        if isinstance(value, (int, Fraction, Decimal, str)):
            return Fraction(value)
        if getattr(value, "is_Float", False):
            return Fraction(repr(float(value)) if value._prec == 53 else str(value))
        if hasattr(value, "item"):  # numpy's scalars
            return exactly(value.item())
        return Fraction(str(value))
    except (ValueError, OverflowError, ZeroDivisionError) as why:
        raise Error(f"'{value}' is not a number", "such as 2, 0.5 or '1/3'") from why


def number(value: Any) -> Term:
    """An exact number: whole, a decimal that ends, or a fraction."""
    value = exactly(value)
    sign, size = ("-" if value < 0 else ""), abs(value)
    if size.denominator == 1:
        text, binding = str(size.numerator), PRIMARY
    elif (places := _places(size.denominator)) is not None:
        digits = str(size.numerator * 10**places // size.denominator).rjust(places + 1, "0")
        text, binding = f"{digits[:-places]}.{digits[-places:]}", PRIMARY
    else:
        text, binding = f"{size.numerator}/{size.denominator}", PRODUCT
    return Term(sign + text, SUM if sign else binding)


def _places(denominator: int) -> int | None:
    """How many decimals such fractions have at most; None where these do not end."""
    counts = []
    for prime in (2, 5):
        count = 0
        while denominator % prime == 0:
            denominator, count = denominator // prime, count + 1
        counts.append(count)
    return max(counts) if denominator == 1 else None


def call(function: str, *arguments: Term) -> Term:
    return Term(f"{function}({', '.join(argument.text for argument in arguments)})", PRIMARY)


def negative(term: Term) -> Term:
    return Term(f"-{term.within(PRODUCT)}", SUM)


def total(terms: list[Term]) -> Term:
    """A sum: a term that begins with a minus is subtracted."""
    if not terms:
        return number(0)
    # what is added stands before what is subtracted
    first = next((term for term in terms if not term.text.startswith("-")), terms[0])
    place = terms.index(first)
    terms = [first, *terms[:place], *terms[place + 1 :]]
    text = first.text
    for term in terms[1:]:
        # what binds as a sum begins with the sign of its first summand alone where it is one product
        if term.text.startswith("-") and not _has_summands(term.text):
            text += f" - {term.text[1:]}"
        else:
            text += f" + {term.within(PRODUCT)}"
    return Term(text, SUM if len(terms) > 1 else terms[0].binding)


def _has_summands(text: str) -> bool:
    """Whether a text has a plus or minus outside of brackets, beside a leading sign."""
    depth = 0
    for place, sign in enumerate(text):
        depth += (sign in "([{") - (sign in ")]}")
        if depth == 0 and place > 0 and sign in "+-":
            return True
    return False


def product(above: list[Term], below: list[Term] | None = None) -> Term:
    """A product, over another one; the signs of its factors stand before it as one."""
    minus = False
    factors = []
    for term in above:
        if term.text.startswith("-") and not _has_summands(term.text):
            minus, term = not minus, Term(term.text[1:], PRODUCT)
        if term.text != "1":
            factors.append(term)
    if not below and len(factors) < 2:
        found = factors[0] if factors else number(1)
        return negative(found) if minus else found
    text = "*".join(term.within(PRODUCT) for term in factors) or "1"
    if below:
        under = "*".join(term.within(POWER) for term in below)
        text += f"/({under})" if len(below) > 1 else f"/{under}"
    return negative(Term(text, PRODUCT)) if minus else Term(text, PRODUCT)


def power(base: Term, exponent: Term) -> Term:
    plain = exponent.text.isdigit() or exponent.text.isidentifier()
    return Term(f"{base.within(PRIMARY)}^{exponent.text if plain else f'({exponent.text})'}", POWER)
