"""What the quick and the full study measure: nothing that the ledger promises is left out."""

from __future__ import annotations

from dataclasses import replace

import pytest

from manufactured import catalogue
from study.fem.mesh import FAMILIES, MeshError
from study.fem.naming import resolve
from study.run.collect import statement_rows
from study.run.job import EquivalenceJob, RateJob, StatementJob
from study.run.plan import Levels, full, quick
from study.statements import ORDERS, STATEMENTS, position
from study.statements.fully_discrete import FullyDiscrete

PLANS = {"quick": quick(), "full": full()}


@pytest.mark.parametrize("name", PLANS)
def test_every_case_has_enough_levels_for_its_verdict_and_both_formulations_compared(name: str) -> None:
    jobs = PLANS[name].jobs
    for case in catalogue():
        enough = 3 if case.regularity.satisfies_5_36 else 4
        rates = [job for job in jobs if isinstance(job, RateJob) and job.case == case.name]
        for family in {job.family for job in rates}:
            assert sum(job.family == family for job in rates) >= enough, (case.name, family)
        assert any(isinstance(job, EquivalenceJob) and job.case == case.name for job in jobs), case.name


def test_the_full_study_uses_every_family_that_can_mesh_a_body_and_the_quick_one_every_family_somewhere() -> None:
    found = {(job.case, job.family) for job in PLANS["full"].jobs if isinstance(job, RateJob)}
    expected = {(c.name, f.name) for c in catalogue() for f in FAMILIES if f.serves(c.solution.body)}
    assert found == expected
    assert {job.family for job in PLANS["quick"].jobs if isinstance(job, RateJob)} == {f.name for f in FAMILIES}


def test_every_case_of_the_quick_study_is_on_one_family_and_a_twin_on_that_of_its_twin() -> None:
    found: dict[str, set[str]] = {}
    for job in PLANS["quick"].jobs:
        if isinstance(job, RateJob):
            found.setdefault(job.case, set()).add(job.family)
    refined = {case.name for case in catalogue() if case.solution.body.refine}
    assert {name for name, families in found.items() if len(families) > 1} == refined
    for case in catalogue():
        if case.twin:
            assert found[case.name] == found[case.twin]


def test_cases_with_levels_of_their_own_have_those_unless_levels_are_asked_for() -> None:
    own = {name: levels.of(0) for name, levels in PLANS["full"].own}
    for job in PLANS["full"].jobs:
        if isinstance(job, RateJob):
            assert job.level in own.get(job.case, (*range(6, 129),))
    asked = replace(PLANS["full"], plane=Levels((4, 8)), own=())
    assert asked.levels_of(resolve("layered")).of(0) == (4, 8)


@pytest.mark.parametrize("name", PLANS)
def test_every_numbered_statement_is_measured_on_cases_that_exist(name: str) -> None:
    jobs = [job for job in PLANS[name].jobs if isinstance(job, StatementJob)]
    missing = {statement.label for statement in STATEMENTS if statement.settings(True)} - {job.label for job in jobs}
    # What the source leaves open is for the full study.
    assert missing == ({FullyDiscrete.label} if name == "quick" else set())
    assert len({job.key for job in jobs}) == len(jobs)
    for job in jobs:
        resolve(job.setting.case)


def test_labels_are_unique_and_have_a_place_in_the_ledger() -> None:
    labels = [statement.label for statement in STATEMENTS]
    assert len(set(labels)) == len(labels)
    assert [position(label) for label in ORDERS] == list(range(len(ORDERS)))


def test_a_measurement_becomes_one_row_per_quantity() -> None:
    result = {"label": "x", "case": "a", "family": "f", "level": 8, "measured": {"h": 0.1, "p": 1.0, "q": 2.0}}
    rows = statement_rows([result])
    assert [(row["quantity"], row["value"], row["h"]) for row in rows] == [("p", 1.0, 0.1), ("q", 2.0, 0.1)]


def test_a_twin_is_a_case_of_the_catalogue_and_is_measured_beside_it() -> None:
    names = {case.name for case in catalogue()}
    assert {case.twin for case in catalogue()} - {""} <= names


ROUGH = """
from dataclasses import replace

from manufactured import catalogue

found = {case.name: case for case in catalogue()}


def rough(name, *places):
    case = found[name]
    face, *others = case.solution.faces
    faces = replace(face, rough=places), *others
    return replace(case, name="mine", solution=replace(case.solution, faces=faces))


across = rough("layered", 0.3)
near = rough("no-contact", 0.30, 0.32)
solid = rough("cube-two-faces", 0.3)
"""


@pytest.mark.parametrize(
    ("case", "level", "message"),
    [
        ("across", 8, r"mine, one-diagonal, level 8: the cell around \(0\.\d+, 0\.\d+\) meets two lines"),
        ("near", 8, r"mine, one-diagonal, level 8: .* \{1 x1 = 0\.3\} and \{1 x1 = 0\.32\}.*take a finer level"),
        ("near", 128, r"mine, unstructured, level 24: .*take a finer level"),
        ("solid", 6, r"mine, one-diagonal, level 6: .*2D only.*\{1 x1 = 0\.3\}.*without `rough`"),
    ],
)
def test_rough_places_that_no_cell_rule_serves_are_refused_before_the_run(tmp_path, case, level, message) -> None:
    (tmp_path / "rough.py").write_text(ROUGH)
    levels = Levels((level,))
    mine = replace(quick(), cases=(f"{tmp_path}/rough.py:{case}",), plane=levels, rough=levels, solid=levels)
    small = replace(mine, equivalence=(), solid_equivalence=(), every_family=False, statements=False)
    with pytest.raises(MeshError, match=message):
        small.check()
