"""A case tests contact if a row that compares with the exact solution notices a defect of the contact solver."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest

from study.controls.contact_test import DEFECTS, OF_THE_PROGRAM, contact_tests, write_contact_test
from study.fem.naming import resolve
from study.present.outcome import contact_test_text
from study.run.plan import Plan, quick
from study.run.store import Store
from study.statements import contact_force, prop_5_4
from study.statements.shared.experiment import Experiment
from study.statements.shared.scope import Levels

CASES = """
from dataclasses import replace
from sympy import Rational
from manufactured import Case, ContactFace, ExactSolution, KelvinVoigt, Kind, Regularity
from manufactured import isotropic, named, polygon, pos, s, t

good = replace(named("advance-recede"), name="good")
apart = replace(named("no-contact"), name="apart")
solid = replace(named("cube-disc"), name="solid")

kinds = [Kind.CONTACT, Kind.LOADED, Kind.LOADED, Kind.LOADED, Kind.CLAMPED, Kind.LOADED]
body = polygon([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)], kinds)
law = KelvinVoigt(isotropic(1, 0.5), isotropic(2, 3), "linear")
(floor,) = body.of(Kind.CONTACT)
zone = Rational(1, 64) - (s - Rational(1, 2) - t / 5) ** 2
face = ContactFace.linear(floor, law, body.T, pos(-zone, 4), 40 * pos(zone, 2), level=zone)
weak = Case(
    name="weak",
    summary="a small pressure on a narrow patch, and a large gap beyond",
    solution=ExactSolution(body, law, (face,)),
    regularity=Regularity(gap=4, pressure=2, moving=True),
    order=1,
    reason="α = 4 > 7/2 and m = 2 > 3/2 give (5.36)",
)
"""


@pytest.fixture(scope="module")
def cases(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path: Path = tmp_path_factory.mktemp("cases") / "cases.py"
    path.write_text(CASES, encoding="utf-8")
    return path


def plan_of(reference: str) -> Plan:
    scope = replace(quick(), cases=(reference,), plane=Levels((4, 8, 16)), every_family=False, statements=False)
    return Plan.of(scope)


def outcome(reference: str, directory: Path) -> tuple[pd.DataFrame, str]:
    """The rows of ``contact-test.csv``, and what a run prints about them."""
    plan, store = plan_of(reference), Store(directory)
    (test,) = contact_tests(plan)
    for job in (*test.jobs, *(job for defect in DEFECTS for job in test.defective(defect))):
        store.save(job.key, job.fingerprint(), dict(job.run()))
    (path,) = write_contact_test([test], store)
    return pd.read_csv(path, keep_default_na=False), " ".join(contact_test_text(directory).split())


@pytest.mark.slow
def test_a_front_under_a_large_pressure_notices_both_defects(cases: Path, tmp_path: Path) -> None:
    rows, text = outcome(f"{cases}:good", tmp_path)
    assert (rows["noticed"] > 0).all()
    assert "contact force, order-pressure" in rows.set_index("defect").loc["contact in places", "noticed_by"]
    assert "weak" not in text
    assert "contact forces times 1.1: by contact force" in text


@pytest.mark.slow
def test_a_small_pressure_on_a_narrow_patch_is_a_weak_test_with_advice(cases: Path, tmp_path: Path) -> None:
    rows, text = outcome(f"{cases}:weak", tmp_path)
    assert (rows["noticed"] == 0).all()
    assert (rows["holding"] > 0).all()
    assert text.startswith("weak test of contact: weak, unstructured meshes, n = 4 8 16")
    assert "larger pressure relative to moduli and gap, a contact zone that is wider in cells, or finer levels" in text


def test_only_cases_of_users_that_touch_are_tested(cases: Path) -> None:
    assert contact_tests(plan_of("advance-recede")) == contact_tests(plan_of(f"{cases}:apart")) == []
    assert resolve(contact_tests(plan_of(f"{cases}:solid"))[0].reference).solution.body.dim == 3


def test_rows_about_the_program_do_not_count_and_the_defect_ends_with_the_job(cases: Path) -> None:
    assert {"penetration", "pulling", "residual"} <= OF_THE_PROGRAM
    job = contact_tests(plan_of(f"{cases}:good"))[0].defective("contact in places")[0]
    assert job.run() != super(type(job), job).run()
    assert vars(prop_5_4)["Experiment"] is vars(contact_force)["Experiment"] is Experiment
    assert len({job.key, super(type(job), job).key}) == 2
