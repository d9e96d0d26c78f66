"""The list of controls: which defect, where, and which row of the ledger must fail."""

from __future__ import annotations

from typing import Any

from study.controls.control import Control
from study.controls.evidence import EVIDENCE
from study.controls.of_bounds import BOUNDS
from study.controls.of_contact import CONTACT
from study.controls.of_rates import RATES
from study.controls.of_statements import STATEMENTS
from study.controls.of_stresses import STRESSES

CONTROLS: tuple[Control[Any], ...] = (*RATES, *CONTACT, *STRESSES, *STATEMENTS, *BOUNDS, *EVIDENCE)
