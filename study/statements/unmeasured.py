"""Rows of the ledger without a measurement.

They list misprints in the paper, claims that no computation can test, and formulas that need no check of their own.
The texts of the rows are in ``unmeasured.toml``."""

import math
import tomllib
from pathlib import Path

import pandas as pd

from study.ledger.datafiles import DataFile
from study.ledger.verdict import NO_ROW, NOT_TESTED, REPORTED, Verdict, row
from study.ledger.window import Window
from study.statements.shared.base import LISTED, Statement

ROW_TEXTS = tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8"))
"""The texts of the rows, by the name of their list."""


class Listed(Statement):
    """Base class of statements that are lists of texts without data.

    Attributes:
        texts: the name of the list in ``unmeasured.toml``. A line has a key, a place in the paper, the text at this
            place as the quantity, and a comment.
    """

    file: DataFile = LISTED
    texts: str

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        """Return one row for each line of the list. The rows are reported only, because nothing is measured."""
        none = Window(math.nan, math.nan)
        nothing = (math.nan, (math.nan, math.nan), REPORTED)
        return [
            row(self, key, quantity, none, nothing, place, expected=comment)
            for key, (place, quantity, comment) in ROW_TEXTS[self.texts].items()
        ]


class Misprints(Listed):
    """Lists places where the printed text of the paper is wrong, and how to read them."""

    label = "slips"
    claim = "misprints in the paper"
    texts = "misprints"


class Untested(Listed):
    """Lists claims of the paper about infinitely many functions or data, which computations cannot test."""

    label = NOT_TESTED
    claim = "statements that finitely many computations cannot test"
    texts = "untested"


class WithoutRow(Listed):
    """Lists formulas of the paper that need no check, such as definitions and assumptions, each with the reason."""

    label = NO_ROW
    claim = "formulas that need no row: definitions, restatements, and steps towards other statements"
    texts = "without-row"
