"""How texts are made: notation in LaTeX and HTML, and templates with the data of a full run.

The plain Unicode text of the data files becomes LaTeX or HTML: ‖u − u^h‖_V becomes \\(\\|u-u^{h}\\|_{V}\\). A word
becomes part of a LaTeX formula if it contains a mathematical character, a superscript or a subscript, as u^h and max_n
do. Single letters and numbers between two such words belong to the same formula. All other words are prose, in which
special characters are escaped.

Papers, README, documentation and report are made by templates. In a template, ``checks(label, key)`` are the rows of
``claims.csv`` with this label and key, and a filter makes a text from them: ``{{ checks("Prop. 5.4", "order")|span }}``
is "0.92 to 1.00". Extreme values are rounded outwards, a smallest value down and a largest value up, so that no
sentence claims more than was measured.
"""

from __future__ import annotations

import re
import tomllib
import unicodedata
from collections.abc import Sequence
from functools import cache
from itertools import accumulate, groupby
from json import loads
from math import floor, log10
from operator import itemgetter
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape
from markupsafe import Markup, escape
from pandas import DataFrame, Series

from study.ledger.codes import MARCHES, Codes
from study.ledger.controls import LARGEST_RATE, FalseAlarms, SeedRecord, in_words, missed, seeds_needed
from study.ledger.datafiles import (
    DataError,
    count_verdicts,
    planned_keys,
    read_claims,
    read_csv,
    read_rates,
)
from study.ledger.files import Json
from study.ledger.text import above, below, outwards
from study.ledger.verdict import NO_ROW, NOT_TESTED, UNCLAIMED, agreement
from study.ledger.window import STEEPER


def read_page(name: str) -> Json:
    """Return the texts in ``page/NAME.toml``."""
    return tomllib.loads((Path(__file__).parent / "page" / f"{name}.toml").read_text(encoding="utf-8"))


def _greek(letter: str) -> str:
    r"""Return the LaTeX command of a Greek letter, such as \\Gamma for GREEK CAPITAL LETTER GAMMA."""
    _, size, _, name = unicodedata.name(letter).split()
    return "\\" + (name.capitalize() if size == "CAPITAL" else name.lower())


_LATEX = read_page("notation")
_GREEK = "ΓΔΘΠΣΦΨΩαβγδζηθκμνξπρστχψω"
"""Letters whose names are LaTeX commands; others are in ``page/notation.toml``."""
_SIGNS = _LATEX["formulas"].split()
_SCRIPTS = "0123456789-+n"
_SYMBOLS: dict[str, str] = {letter: _greek(letter) for letter in _GREEK}
_SYMBOLS |= dict(zip(_SIGNS[::2], _SIGNS[1::2], strict=True))
_SYMBOLS |= {raised: f"^{{{script}}}" for raised, script in zip("⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺ⁿ", _SCRIPTS, strict=True)}
_SYMBOLS |= {lowered: f"_{{{script}}}" for lowered, script in zip("₀₁₂₃₄₅₆₇₈₉₋₊ₙ", _SCRIPTS, strict=True)}
_ACCENTS = {"\u0307": r"\dot", "\u0308": r"\ddot", "\u0303": r"\tilde", "\u0302": r"\hat", "\u0304": r"\bar"}
_PROSE: dict[str, str] = _LATEX["prose"]

# Γ3,i, L∞ and e∞ have no script marks in plain text but scripts in a formula.
_LITERAL = re.compile(r"Γ\d(?:,\w)?|L∞|\be∞")
_LITERALS = {"Γ": "Γ_{{{}}}", "L": "L^{}", "e": "e_{}"}
_SCRIPT = re.compile(
    r"(?:^|[^A-Za-z])(?:[A-Za-z][\u0300-\u036f]?|max|min|sup|inf|lim)[\^_]|\d\^|[)\]}][\^_]|^O\(|^[=<>]$|^\[-?[\d.]|^-[\d.]+[,;]?$"
)
# A reference such as (2.5) is no part of a formula.
_SHORT = re.compile(
    r"(?!\(\d\.\d+\))(?:\(?[B-HJ-Zb-z][)\]]?|[+/|]|\(?[-+]?[\d./]+[)\]]?|[A-Z]?\((?!.*[a-z]{2})[^()]*\))[,;]?"
)
_TAIL = re.compile(r"[.,;:]+$")
_SIGNED_NUMBER = re.compile(r"(-?)(?:[\d.]+|(inf))")
# The subscript of u_lin is a word; elsewhere a script without braces is one character, as in P_hu.
_TOKEN = re.compile(r"[\^_]\{(?:[^{}]|\{[^{}]*\})*\}|_lin\b|[\^_].|[A-Za-z]{2,}|.", re.DOTALL)

_SPELLINGS = {"u̇(t)": "u̇", "~": "∼", "ᵀ": "^{T}", "𝓛": "L", "½": "^{1/2}", "Nv": "N v"}
_PATTERNS = {
    re.compile(r"\^(\d+(?:\.\d+)?)"): r"^{\1}",
    re.compile(r"(?<![\d.])1e(?:\+|(-))0*(\d+)"): r"10^{\1\2}",
    re.compile(r"(\d)e(?:\+|(-))0*(\d+)"): r"\1·10^{\2\3}",
}
"""Numbers in superscripts, powers of ten and their multiples, and how they are written with braces."""
_RANGE = re.compile(r"-?[\d.]+–-?[\d.]+")
_LETTER = re.compile(r"(?:[|(]*[A-HJ-Zb-z]|[|(]+a)(?:[(|);,:]+[A-Za-z0-9.]*)*|a[)|]+[;,]?")
_TWO = re.compile(r"[a-z]{2}")


@cache
def encode(text: str) -> str:
    """Return a line of plain Unicode text as LaTeX, with formulas where the text has mathematical words or letters.

    Results are cached, because the columns of tables repeat few texts.
    """
    if _RANGE.fullmatch(text):
        return "--".join(map(encode, text.split("–")))
    if number := _SIGNED_NUMBER.fullmatch(text):
        sign, infinity = number.groups()
        return rf"\({sign}\infty\)" if infinity else rf"\({text}\)" if sign else text
    for spelling, usual in _SPELLINGS.items():
        text = text.replace(spelling, usual)
    for pattern, braced in _PATTERNS.items():
        text = pattern.sub(braced, text)
    words = _LITERAL.sub(lambda match: _LITERALS[match[0][0]].format(match[0][1:]), text).split(" ")
    parts = []
    marked = zip(_kinds(words), _clauses(words), words, strict=True)
    for (mathematical, _), run in groupby(marked, key=itemgetter(0, 1)):
        text = " ".join(word for *_, word in run)
        parts.append(_run(text) if mathematical else prose(text))
    return " ".join(parts)


def prose(text: str) -> str:
    """Return text without formulas, such as a name, as LaTeX; characters that are not Latin are shown by their code."""
    latin = {c for c in text if c.isascii() or ("LATIN" in unicodedata.name(c, "") and ord(c) < 0x180)}
    return "".join(_PROSE.get(c) or (c if c in latin else rf"\texttt{{U+{ord(c):04X}}}") for c in text)


def counted(number: int, noun: str) -> str:
    """Return a number followed by a noun, in the plural if the number is not 1: "1 case", "2 cases"."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def folding(width: float) -> str:
    """Return the LaTeX alignment of a column whose text is folded at a width, given as a fraction of the line width."""
    return rf">{{\raggedright\arraybackslash}}p{{{width}\linewidth}}"


def _kinds(words: Sequence[str]) -> list[bool]:
    """Return whether each word of a line belongs to a formula.

    It does if it contains mathematics, or if it is short and its neighbour belongs to a formula.
    """
    kinds = []
    for word in words:
        marked = any(c in _SYMBOLS for c in word) or _SCRIPT.search(word)
        dotted = any(c in "\u0307\u0303" for c in unicodedata.normalize("NFD", word))
        few_letters = len(_TAIL.sub("", word)) <= 3
        kinds.append(bool(marked or (dotted and few_letters) or _LETTER.fullmatch(word)))
    short = [bool(_SHORT.fullmatch(word)) for word in words]
    for i in range(1, len(words)):
        before = words[i - 1]
        kinds[i] |= short[i] and kinds[i - 1] and (before.startswith("[") or not _TAIL.search(before))
    for i in reversed(range(len(words) - 1)):
        kinds[i] |= short[i] and kinds[i + 1] and not words[i].endswith((";", ":"))
    return kinds


def _clauses(words: Sequence[str]) -> list[int]:
    """Return the number of the clause of each word; a semicolon or a colon outside of parentheses ends a clause."""
    ends = [word.endswith((";", ":")) and word.count("(") == word.count(")") for word in words]
    return list(accumulate(ends[:-1], initial=0))


def _run(text: str) -> str:
    """Return words of mathematics as one formula, with the final punctuation outside."""
    formula = text.rstrip(".,;:")
    return rf"\({_formula(formula)}\){text[len(formula) :]}"


def _formula(text: str) -> str:
    """Return the content of a LaTeX formula from mathematical Unicode text."""
    out: list[str] = []
    for token in _TOKEN.findall(unicodedata.normalize("NFD", text)):
        if token in _ACCENTS and out:
            out[-1] = f"{_ACCENTS[token]}{{{out[-1]}}}"
        elif token[0] in "^_" and len(token) > 1:
            script = token[2:-1] if token[1] == "{" else token[1:]
            # Two letters are two variables, as in e^{ct} and u^{hk}, not a word.
            out.append(f"{token[0]}{{{script if _TWO.fullmatch(script) else _formula(script)}}}")
        else:
            out.append(_atom(token))
    return _joined(out)


def _atom(token: str) -> str:
    if token in _SYMBOLS:
        return _SYMBOLS[token]
    if token in {"max", "min", "sup", "inf", "lim", "log", "exp"}:
        return rf"\{token}"
    if len(token) > 1:
        return rf"\mathrm{{{token}}}"
    return token if token in " ^'<>" else _PROSE.get(token, token)


def _joined(atoms: list[str]) -> str:
    r"""Return a LaTeX formula from its parts, where \nu and h become \nu h, not \nuh.

    Superscripts that follow each other are merged, and so are subscripts.
    """
    merged: list[str] = []
    for atom in atoms:
        # x² ³ or q_{3}_{1} would be a double script.
        if merged and atom[:2] in ("^{", "_{") and merged[-1][:2] == atom[:2]:
            merged[-1] = merged[-1][:-1] + atom[2:]
        else:
            merged.append(atom)
    text = ""
    for atom in merged:
        if re.search(r"\\[A-Za-z]+$", text) and atom[:1].isalnum():
            text += " "
        text += atom
    return re.sub(r" +", " ", text).strip()


_HTML_SCRIPT = re.compile(r"(?<=\S)([\^_])(\{(?:[^{}]|\{[^{}]*\})*\}|\([^()]*\)|\d+(?:\.\d+)?|(?<=_)[a-z]{3,}|[\w+−∞])")
_TAGS = {"^": "sup", "_": "sub"}


def typeset(text: str) -> Markup:
    """Return a line of plain Unicode text as HTML with superscripts and subscripts.

    Scripts are written as in x^y, x_y, x_word, x^∞, x^{yz}, x^1.5 and x^(1+s).
    """
    return Markup(_HTML_SCRIPT.sub(_tagged, escape(text)))


def _tagged(match: re.Match[str]) -> str:
    """Return a superscript or subscript, and scripts in it, in HTML."""
    mark, script = match.groups()
    tag = _TAGS[mark]
    if script.startswith("{"):
        script = script[1:-1]
    return f"<{tag}>{_HTML_SCRIPT.sub(_tagged, script)}</{tag}>"


# Templates, and the data that they show

NAMED_CASES = {"advance-recede", "natural-front", "rough-trace", "moving-rough", "cube-disc"}
"""The cases that the papers name. If a run lacks one of them, the papers are not made from it."""
MISPRINTS = "slips"
"""The label of the checks that list misprints."""
EVIDENCE_TITLES: dict[str, str] = read_page("article")["evidence"]
"""Name ↦ title of each kind of evidence. Every row of the ledger belongs to exactly one of them."""
ENVIRONMENT = Environment(
    loader=PackageLoader("study.present", "page"),
    autoescape=select_autoescape(["html", "svg"], default_for_string=False),
    undefined=StrictUndefined,
    trim_blocks=True,
)


def least(rows: DataFrame, decimals: int = 2, scale: float = 1) -> str:
    """Return the smallest value in the column ``low`` of rows of ``claims.csv`` as text, rounded down.

    Parameters:
        rows: the rows.
        decimals: the number of decimals.
        scale: a factor, for example 100 for per cent.
    """
    return below(scale * rows.low.min(), decimals)


def most(rows: DataFrame, decimals: int = 2, scale: float = 1) -> str:
    """Return the largest value in the column ``high`` of rows of ``claims.csv`` as text, rounded up.

    Parameters:
        rows: the rows.
        decimals: the number of decimals.
        scale: a factor, for example 100 for per cent.
    """
    return above(scale * rows.high.max(), decimals)


def span(rows: DataFrame) -> str:
    """Return the range of the results in rows of ``claims.csv`` as text, such as "0.92 to 1.00", rounded outwards."""
    return outwards(rows.low.min(), rows.high.max())


def spans(rows: DataFrame) -> str:
    """Return the name of each case in rows of ``claims.csv`` and the range of its results, as text."""
    return "; ".join(f"{case}: {span(part)}" for case, part in rows.groupby("case", sort=False))


def spread(values: Sequence[float]) -> str:
    """Return the smallest and the largest value as text, or the only value."""
    return " … ".join(dict.fromkeys(digits(value) for value in (min(values), max(values))))


def digits(value: float, count: int = 3) -> str:
    """Return a number as text with a number of significant digits."""
    return f"{value:.{count}g}"


def deviation(rows: DataFrame) -> float:
    """Return the largest difference of the results in rows of ``claims.csv`` (columns ``low`` and ``high``) from 1."""
    return (rows[["low", "high"]] - 1).abs().max(axis=None)


def two_digits_up(value: float) -> float:
    """Return a value rounded up to two significant digits. A value with fewer digits, such as 1e-5, is unchanged."""
    return float(above(value, 1 - floor(log10(value)))) if value else 0.0


def percent(value: float) -> str:
    """Return a share in per cent as LaTeX, rounded up to two significant digits."""
    return rf"{two_digits_up(100 * value):.2g}\,\%"


def power(value: float) -> str:
    """Return a number as LaTeX with a power of ten, rounded up to two significant digits."""
    return encode(f"{two_digits_up(value):.1e}") if value else "0"


def plain(text: str) -> str:
    """Return a text in which characters that have a meaning in Markdown are escaped."""
    return re.sub(r"([\\|*_<#])", r"\\\1", text)


FILTERS = (
    plain,
    encode,
    least,
    most,
    span,
    spans,
    spread,
    digits,
    deviation,
    two_digits_up,
    percent,
    power,
    typeset,
    counted,
)
ENVIRONMENT.filters |= {function.__name__: function for function in FILTERS} | {"down_to": below, "up_to": above}


def evidence(row: Series) -> str:
    """Return the kind of evidence of a check, that is, what it can show; it is a key of ``EVIDENCE_TITLES``.

    Parameters:
        row: the row of ``claims.csv``.

    Returns:
        If the check judges a claim: its kind, claim, consequence, accuracy or identity (see ``CheckKind``). For a
        prediction that no statement claims: met, undecided or wrong. For other numbers without a claim: numbers. For
        rows without a number, such as misprints: lines.
    """
    if row.label in (NO_ROW, NOT_TESTED, MISPRINTS):
        return "lines"
    if row.verdict in UNCLAIMED:
        return agreement(row) if row.expected.startswith("predicted") else "numbers"
    return row.kind


class FullRun:
    """The contents of the data files of a full run; ``cases`` is indexed by the names of the cases.

    ``codes`` has the results of other people's contact codes, and ``marches`` their results if they use the midpoint
    rule in time; both are None if their files are missing. ``faults`` is the matrix of deliberate faults.
    ``alarms`` has the false-alarm rate on random meshes.

    Parameters:
        directory: the result directory.
        provenance, cases: the contents of ``provenance.json`` and of ``cases.csv``.

    Raises:
        DataError: a file is missing or lacks a column.
    """

    def __init__(self, directory: Path, provenance: Json, cases: DataFrame) -> None:
        self.rates = read_rates(directory)
        self.claims = read_claims(directory)
        self.cases = cases.set_index("case", drop=False).rename_axis(None)
        self.bounds = read_csv(directory, "bounds.csv")
        self.equivalence = read_csv(directory, "equivalence.csv")
        self.faults = read_csv(directory, "faults.csv")
        self.alarms = FalseAlarms(SeedRecord.read(directory))
        self.provenance = provenance
        self.codes = Codes.read(directory)
        self.marches = Codes.read(directory, MARCHES)

    @classmethod
    def read(cls, directory: Path) -> FullRun | None:
        """Return the data of a result directory; None if it has no full run with deliberate faults and random meshes.

        Raises:
            DataError: a file is missing or lacks a column.
        """
        needed = [directory / "data" / name for name in ("provenance.json", "faults.csv", "seeds.csv")]
        if not all(path.is_file() for path in needed):
            return None
        made = loads(needed[0].read_text(encoding="utf-8"))
        cases = read_csv(directory, "cases.csv")
        is_full = made.get("plan") == "full" and set(cases.case) >= NAMED_CASES
        return cls(directory, made, cases) if is_full else None

    def labelled(self, label: str) -> DataFrame:
        """Return the rows of the ledger with a label."""
        return self.claims[self.claims.label == label]

    def checks(self, label: str, *keys: str, case: str = "") -> DataFrame:
        """Return the rows of the ledger with a label and one of the keys, of all cases or of one case.

        Raises:
            DataError: there is no row for one of the keys.
        """
        chosen = self.labelled(label)
        chosen = chosen[chosen.key.isin(keys)]
        chosen = chosen[chosen.case == case] if case else chosen
        if lacking := sorted(set(keys) - set(chosen.key)):
            raise DataError(
                f"claims.csv has no row {label}, {', '.join(lacking)}, {case or 'any case'}: make it with "
                "`study run --full`"
            )
        return chosen


def context(data: FullRun) -> Json:
    """Return the names that templates use: the tables of a full run, its checks, and what is counted in them."""
    counts = data.claims.apply(evidence, axis=1).value_counts()
    orders = data.checks("(5.36)", "order")
    return dict(
        vars(data),
        checks=data.checks,
        evidence={name: counts.get(name, 0) for name in EVIDENCE_TITLES},
        missed_faults=missed(data.faults),
        without_5_36=orders[orders.case.map(data.cases.expected_order) == 1],
        discrete_scheme=data.labelled("beyond: fully discrete").apply(agreement, axis=1).tolist(),
        STEEPER=STEEPER,
        LARGEST_RATE=LARGEST_RATE,
        seeds_needed=seeds_needed(),
        count_verdicts=count_verdicts,
        planned_keys=planned_keys,
        in_words=in_words,
    )


def render(template: str, /, *tables: Json, **values: object) -> str:
    """Return the text that a template makes from values.

    Parameters:
        template: the name of its file in the folder ``page``.
        tables, values: the values, as dicts (name in the template ↦ value) and as keywords.
    """
    return ENVIRONMENT.get_template(template).render(*tables, **values)
