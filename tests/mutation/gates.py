"""What is mutated, and which tests have to notice: for every part of the code those that were written for it.

These are chosen to take seconds. All others, and the controls, see more: a mutant that these let pass is no mutant that
the whole suite lets pass.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from mutation.mutants import Mutant, file_of, mutants
from study.run.code import imports
from study.statements import STATEMENTS
from study.statements.shared.base import ListedNumbers

RESULTS = "tests/project/test_results.py"
LEDGER = [f"{RESULTS}::test_the_committed_verdicts_follow_from_the_committed_data_and_none_fails"]
DATA = ["tests/cli/test_check.py::test_the_committed_run_is_what_it_must_be"]
NUMBERS = f"{RESULTS}::test_numbers_of_statements_measured_again_agree_with_the_committed_ones"
SAME_ROWS = f"{RESULTS}::test_rows_measured_again_agree_with_the_committed_ones"
ROWS = [f"{SAME_ROWS}[0-{case}]" for case in ("full-contact", "travelling-patch", "layered-unmet", "junction")]
BOUNDS = [f"{RESULTS}::test_bounds_measured_again_agree_with_the_committed_ones"]
STRESSES = [f"{RESULTS}::test_stresses_measured_again_agree_with_the_committed_ones"]
ENCLOSED = [
    f"tests/bound/test_{name}"
    for name in (
        "bound.py::test_between_knots_the_distance_of_both_trajectories_is_bounded_within_three_times",
        "adaptive.py::test_shares_are_not_negative_and_add_up_to_the_bound",
        "adaptive.py::test_what_comes_after_the_largest_bound_has_no_share_in_it",
    )
]
MESHES = [
    f"tests/solve/test_discrete.py::test_{name}"
    for name in (
        "a_mesh_covers_the_body_and_its_parts_and_is_regular",
        "split_cells_integrate_powers_of_the_distance_to_a_line",
        "rough_places_that_no_rule_serves_are_refused",
        "every_family_that_serves_a_layered_body_respects_its_interfaces",
        "shaken_vertices_slide_along_interfaces",
    )
]
JUDGES = [
    "tests/statements/test_propositions.py",
    "tests/statements/test_own_cases.py",
    "tests/statements/test_contact_force.py",
    "tests/statements/test_enclosure.py",
]
OF_CONTROLS = [
    "test_the_named_row_is_shown_and_any_other_one_that_fails_counts_as_well",
    "test_a_baseline_that_does_not_hold_is_no_proof",
    "test_a_mistake_in_the_code_is_undone",
    "test_a_control_can_be_sent_to_another_process",
    "test_the_command_prints_and_writes_what_caught_each_defect",
    "test_a_harmless_defect_is_not_caught_and_the_command_fails",
    "test_a_defect_that_is_caught_where_the_baseline_does_not_hold_proves_nothing",
]


@dataclass(frozen=True)
class Gate:
    """A part of the code and its tests.

    Attributes:
        name: in words.
        modules: beginnings of the names of its modules.
        tests: files, or single tests, the quickest first.
        numbers: whether the numbers of all statements that import a module are measured again, too.
    """

    name: str
    modules: tuple[str, ...]
    tests: tuple[str, ...]
    numbers: bool = False

    def tests_of(self, module: str) -> list[str]:
        """Those that have to notice a mistake in a module."""
        again = [f"{NUMBERS}[{name}]" for name in measured_with(module)] if self.numbers else []
        return [*again, *self.tests]


def ledger(*names: str) -> tuple[str, ...]:
    return tuple(f"study.ledger.{name}" for name in names)


GATES = (
    Gate(
        "windows and criteria",
        ledger("window", "criterion", "measures", "orders", "verdict", "margin", "mesh_series"),
        ("tests/ledger/test_windows.py", "tests/ledger/test_measures.py", *JUDGES[:1], *LEDGER, *DATA),
    ),
    Gate(
        "trust in data",
        ("study.run.judgement", "study.run.verification", "study.run.relations", "study.run.measured")
        + ("study.run.foreseen",),
        (*LEDGER, *DATA, "tests/cli/test_check.py"),
    ),
    Gate(
        "controls",
        tuple(f"study.controls.{name}" for name in ("run_controls", "control", "slips")),
        tuple(f"tests/controls/test_controls.py::{name}" for name in OF_CONTROLS),
    ),
    Gate("self-proof", ("manufactured.self_proof",), ("tests/manufactured/test_self_proof.py",)),
    Gate(
        "stresses of Theorem 4.2",
        ("study.statements.thm_4_2",),
        ("tests/statements/test_same_mesh.py", *JUDGES[:1], *LEDGER, *STRESSES),
        numbers=True,
    ),
    Gate(
        "errors and their verdicts",
        ("study.statements.prop_5", "study.statements.own_cases"),
        ("tests/statements/test_measurement.py", *JUDGES, *LEDGER, *ROWS),
    ),
    Gate(
        "contact force and recomputed rows",
        ("study.statements.contact_force", "study.statements.recomputed"),
        ("tests/statements/test_contact_force.py", "tests/statements/test_recomputed.py", *LEDGER),
    ),
    Gate(
        "stress spaces",
        ("study.stresses",),
        (
            *STRESSES,
            "tests/stresses/test_equilibrated.py",
            "tests/stresses/test_loads.py",
            "tests/stresses/test_oscillation.py",
        ),
    ),
    Gate(
        "enclosures",
        ("study.statements.enclosure",),
        ("tests/statements/test_enclosure.py", *BOUNDS, *LEDGER, *DATA),
    ),
    Gate(
        "statements",
        ("study.statements",),
        (
            *LEDGER,
            *DATA,
            "tests/statements/test_statements_static.py",
            "tests/statements/test_statements_evolution.py",
            "tests/statements/test_rollers.py",
            "tests/statements/test_parting.py",
            "tests/statements/test_contact_work.py",
            "tests/statements/test_other_codes.py",
        ),
        numbers=True,
    ),
    Gate(
        "measuring on meshes",
        tuple(f"study.fem.{name}" for name in ("gauge", "independent", "moments", "space", "material"))
        + ("study.fem.quadrature", "study.fem.mesh"),
        (
            *ROWS,
            *MESHES,
            "tests/fem/test_shaken.py",
            "tests/fem/test_moments.py",
            "tests/fem/test_fem_3d.py",
            "tests/run/test_pictures.py::test_the_surface_of_a_solid_is_closed_and_seen_from_outside",
            "tests/statements/test_recomputed.py",
        ),
        numbers=True,
    ),
    Gate(
        "bound",
        ("study.bound.growth", "study.bound.majorant", "study.bound.enclosing", "study.bound.sampling"),
        (
            "tests/bound/test_growth.py",
            "tests/bound/test_terms.py",
            "tests/bound/test_guaranteed.py",
            *ENCLOSED,
            *BOUNDS,
        ),
    ),
)
LEFT_OUT = ("study.statements.pictures", "study.statements.unmeasured", "study.statements.shared.estimates")
"""What is shown, listed or estimated, and neither measured nor judged."""


def gate_of(module: str) -> Gate | None:
    """The first part to which a module belongs."""
    if module.startswith(LEFT_OUT):
        return None
    return next((gate for gate in GATES if module.startswith(gate.modules)), None)


def every_mutant(root: Path) -> dict[str, list[Mutant]]:
    """All mutants by their part."""
    found: dict[str, list[Mutant]] = {gate.name: [] for gate in GATES}
    for package in ("manufactured", "study"):
        for path in sorted((root / package).rglob("*.py")):
            module = ".".join(path.relative_to(root).with_suffix("").parts).removesuffix(".__init__")
            if (gate := gate_of(module)) and (root / file_of(module)).is_file():
                found[gate.name] += mutants(root, module)
    return found


def measured_with(module: str) -> Sequence[str]:
    """The classes of the statements whose numbers may depend on a module."""
    return [
        type(statement).__name__
        for statement in STATEMENTS
        if isinstance(statement, ListedNumbers) and module in _closure(type(statement).__module__)
    ]


def _closure(module: str) -> set[str]:
    found, waiting = set(), [module]
    while waiting:
        name = waiting.pop()
        if name not in found:
            found.add(name)
            waiting += imports(name)
    return found
