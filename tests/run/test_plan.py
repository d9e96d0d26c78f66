"""What the quick and the full study measure, and the cache keys of the results: nothing is left out or confused."""

import shutil
import sys
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from commands import study

from manufactured import catalogue, named, unit_square
from manufactured.cases import plane
from manufactured.catalogue import MODULES, NAMES
from manufactured.data import Data
from study.fem.mesh import FAMILIES, MeshError, OneDiagonal
from study.fem.naming import resolve, resolve_data
from study.ledger.files import UsageError
from study.run import fingerprint as keys
from study.run.fingerprint import ROOT, fingerprint, of_data, of_everything, of_problem, problem
from study.run.plan import Plan, full, quick
from study.run.store import Store
from study.statements import STATEMENTS
from study.statements.enclosure import resolve_problem
from study.statements.pictures import Pictures
from study.statements.prop_5_4 import FirstOrder, InitialGap, Rates, RateSetting
from study.statements.shared.base import Setting
from study.statements.shared.scope import Levels
from study.statements.thm_4_2 import SameMesh
from study.statements.time_steps import FullyDiscrete, Landings
from study.statements.work_of_contact import Rollers, WorkOfContact

in_both_studies = pytest.mark.parametrize("name", ["quick", "full"])


@cache
def scope(name):
    return quick() if name == "quick" else full()


@cache
def plan(name):
    return Plan.of(scope(name))


@pytest.fixture
def jobs(name):
    """The measurements of one of both studies."""
    return plan(name).jobs


def rates(name):
    return [job.setting for job in plan(name).jobs if isinstance(job.statement, Rates)]


@in_both_studies
def test_every_case_has_enough_levels_for_its_verdict_and_both_formulations_compared(name, jobs):
    compared = {job.setting.case for job in jobs if isinstance(job.statement, SameMesh)}
    for case in scope(name).resolved():
        enough = 3 if case.regularity.satisfies_5_36 else 4
        mine = [setting for setting in rates(name) if setting.case == case.name]
        assert mine, case.name
        for family in {setting.family for setting in mine}:
            assert sum(setting.family == family for setting in mine) >= enough, (case.name, family)
        assert (case.name in compared) != case.solution.has_initial_gap


@in_both_studies
def test_another_case_or_mesh_family_adds_measurements_and_changes_none(name, monkeypatch, jobs):
    before = {job.identity for job in jobs}
    more = (*NAMES, "inserted")
    with monkeypatch.context() as patch:
        patch.setitem(MODULES, "inserted", "plane")
        patch.setattr(plane, "inserted", lambda: replace(named("advance-recede"), name="inserted"), raising=False)
        for module in ("manufactured.catalogue", "study.fem.naming"):
            patch.setattr(sys.modules[module], "NAMES", more)
        studied = tuple(case for case in more if case in (*scope(name).cases, "inserted"))
        added = {job.identity for job in Plan.of(replace(scope(name), cases=studied)).jobs} - before
        assert added
        assert all("inserted" in identity for identity in added)
    for module in ("study.statements.shared.scope", "study.fem.naming"):
        monkeypatch.setattr(f"{module}.FAMILIES", (OneDiagonal(name="another"), *FAMILIES))
    added = {job.identity for job in Plan.of(scope(name)).jobs} - before
    assert all("another" in identity for identity in added)


def test_a_case_that_names_a_family_that_cannot_mesh_its_body_is_refused():
    hexagon = replace(resolve("hexagon"), families=("shaken",))
    with pytest.raises(UsageError, match="hexagon: shaken meshes cannot fit its body; name one of unstructured"):
        scope("quick").families_of(hexagon)


def test_the_quick_study_has_a_measurement_on_every_family():
    """How many there are in the full study, the pages say."""
    assert {setting.family for setting in rates("quick")} == {family.name for family in FAMILIES}


FULL_ONLY = {FullyDiscrete(), WorkOfContact(), Landings(), Rollers()}
"""Left to the full study: nothing is claimed of them on meshes as coarse as those of the quick one."""


@in_both_studies
def test_every_statement_is_measured_on_cases_and_problems_that_exist(name, jobs):
    missing = {job.statement for job in plan("full").jobs} - {job.statement for job in jobs}
    assert missing == (FULL_ONLY if name == "quick" else set())
    for job in jobs:
        assert resolve_problem(job.setting.case).name == job.setting.case


@in_both_studies
def test_no_statement_but_its_own_is_measured_on_a_gap(name, jobs):
    gaps = {case.name for case in catalogue() if case.solution.has_initial_gap}
    about = {type(job.statement) for job in jobs if job.setting.case in gaps}
    assert about == {InitialGap, Pictures}


@in_both_studies
def test_no_two_measurements_have_one_name_or_give_the_same_rows(name, jobs):
    """Two statements may share a label, but not what they write."""
    assert len({job.key for job in jobs}) == len({job.identity for job in jobs}) == len(jobs)


@in_both_studies
def test_what_is_measured_is_judged_by_a_statement_of_the_list_and_the_others_measure_nothing(name, jobs):
    assert len(set(STATEMENTS)) == len(STATEMENTS)
    measured = {job.statement for job in jobs}
    assert measured <= set(STATEMENTS)
    for statement in set(STATEMENTS) - measured - FULL_ONLY:
        with pytest.raises(NotImplementedError, match="nothing is measured"):
            statement.measure(Setting("full-contact", "shaken", 4))


@in_both_studies
def test_a_study_begins_with_the_case_of_the_readme_and_leaves_nothing_out(name, jobs):
    first, rest = plan(name).stages()
    assert {job.case for job in first} == {"advance-recede"}
    assert {type(job.statement) for job in first} >= {FirstOrder, SameMesh}
    assert sorted(job.key for job in (*first, *rest)) == sorted(job.key for job in jobs)


def test_a_case_alone_is_measured_by_the_statements_about_every_case():
    alone = Plan.of(replace(quick(), cases=("full-contact",), statements=False))
    assert {job.statement for job in alone.jobs} == {FirstOrder(), SameMesh(), Pictures()}


ROUGH = """
from dataclasses import replace

from manufactured import named


def rough(name, *places):
    case = named(name)
    face, *others = case.solution.faces
    faces = replace(face, rough=places), *others
    return replace(case, name="mine", families=(), solution=replace(case.solution, faces=faces))


across = rough("layered", 0.3)
near = rough("no-contact", 0.30, 0.32)
solid = rough("cube-two-faces", 0.3)
"""


@pytest.mark.parametrize(
    ("case", "level", "message"),
    [
        ("across", 8, r"mine, one-diagonal, level 8: the cell around \(0\.\d+, 0\.\d+\) meets two lines"),
        ("near", 8, r"mine, one-diagonal, level 8: .* \{1 x1 = 0\.3\} and \{1 x1 = 0\.32\}.*take a finer level"),
        ("near", 128, r"mine, unstructured, level 20: .*take a finer level"),
        ("solid", 6, r"mine, one-diagonal, level 6: .*\{1 x1 = 0\.3\}.*2D only.*without `rough`"),
    ],
)
def test_rough_places_that_no_cell_rule_serves_are_refused_before_the_run(tmp_path, case, level, message):
    (tmp_path / "rough.py").write_text(ROUGH)
    levels = Levels((level,))
    small = replace(
        quick(),
        cases=(f"{tmp_path}/rough.py:{case}",),
        plane=levels,
        rough=levels,
        solid=levels,
        equivalence=(),
        solid_equivalence=(),
        statements=False,
    )
    with pytest.raises(MeshError, match=message):
        Plan.of(small).check()


SETTING = RateSetting("full-contact", "shaken", 4, "midpoint", 8)


COMPUTE = (
    "study/fem/space.py",
    "study/solve/steps.py",
    "manufactured/case.py",
    "study/statements/prop_5_4.py",
    "manufactured/cases/shared.py",
    "study/statements/shared/norms.py",
    "study/ledger/text.py",
    "manufactured/face_strain.py",
)
"""Modules on which the order of convergence for the case *full-contact* depends."""
REST = (
    "study/run/executor.py",
    "study/cli/run.py",
    "manufactured/catalogue.py",
    "manufactured/cases/plane.py",
    "study/statements/wellposed.py",
    "study/statements/__init__.py",
)
"""Other modules, among them another statement, the lists of cases and statements, and the functions that make cases."""
CACHED = ("code_hash", "measuring_code", "_common", "_modules", "_parsed")
EDITS = {
    "a window of the statement": ("positive_at_most(0.02", "positive_at_most(0.03", "study/statements/prop_5_4.py"),
    "an argument of a function with the name of a window": ("= between(", "= between(0.5 * ", COMPUTE[-1]),
    "a relative import": ("from manufactured.law", "from ..law", "manufactured/cases/shared.py"),
}


def test_a_change_of_computing_code_changes_the_key_and_a_change_of_words_does_not(tmp_path, monkeypatch):
    """Of a copy of some modules of the project, below another root."""
    every = (*COMPUTE, *REST)
    for module in every:
        (tmp_path / module).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / module, tmp_path / module)
    monkeypatch.setattr(keys, "ROOT", tmp_path)
    for name in CACHED:
        monkeypatch.setattr(keys, name, cache(getattr(keys, name).__wrapped__))

    def change(old, new, *modules):
        """Change modules; return the cache keys of a measurement, and of all that depends on any code."""
        for path in (tmp_path / module for module in modules):
            text = path.read_text(encoding="utf-8")
            assert old in text, (path, old)
            path.write_text(text.replace(old, new, 1), encoding="utf-8")
        for name in CACHED:
            getattr(keys, name).cache_clear()
        return fingerprint(FirstOrder(), SETTING), of_everything()

    before = change("", "")
    assert change('"""', '"""In other words: ', *every) == before
    assert change("\n\n", "\n# A comment.\n\n", *every) == before
    for edit, (old, new, module) in EDITS.items():
        after = change(old, new, module)
        assert after[0] != before[0], edit
        before = after
    for modules in [(module,) for module in COMPUTE] + [REST]:
        after = change("\nfrom ", "\nCHANGED = 1\nfrom ", *modules)
        assert (after[0] != before[0]) == (modules != REST), modules
        assert after[1] != before[1]
        before = after


def test_measurements_that_differ_in_one_respect_in_the_value_of_the_case_or_in_the_libraries_have_different_keys(
    monkeypatch,
):
    changes = {"case": "natural-motion", "family": "one-diagonal", "level": 5, "scheme": "bdf2", "steps": 9}
    settings = [SETTING, *(replace(SETTING, **{name: value}) for name, value in changes.items())]
    found = [fingerprint(FirstOrder(), setting) for setting in settings]
    found.append(fingerprint(SameMesh(), Setting("full-contact", "shaken", 4)))
    assert fingerprint(FirstOrder(), SETTING) == found[0]
    monkeypatch.setattr(keys, "_value_of_case", keys._value_of_case.__wrapped__)
    monkeypatch.setattr(keys, "resolve", lambda name: replace(resolve(name), pace=3.0))
    found += [fingerprint(FirstOrder(), setting) for setting in settings[:2]]
    monkeypatch.setattr(keys, "versions", lambda: {"numpy": "another"})
    found.append(fingerprint(FirstOrder(), SETTING))
    assert len(set(found)) == len(found)


HELPER = """
from manufactured import Linear, t
LOAD = 3
def moved(x):
    return lambda time: 0 * x
"""
MINE = """
'''Problems of a user.'''
from dataclasses import dataclass, replace
from functools import wraps
from sympy.utilities.lambdify import implemented_function
from helper import LOAD, moved
from manufactured import *

corners, kinds = [(0, 0), (1, 0), (1, 1), (0, 1)], [Kind.CONTACT, Kind.LOADED, Kind.CLAMPED, Kind.LOADED]
law = KelvinVoigt(isotropic(1, 0.5), isotropic(2, 3), "linear")
loads = dict(f0=(0, -LOAD * t), f2={1: (0, t)}, u0=(0, 0), lines=(((1.0, 0.0), 0.5),))
data = Data.formulas(polygon(corners, kinds, T=1.0), law, **loads)
still = static(unit_square(), plane_strain(E=1, nu=0.3), f0=(0, -1))
gap = replace(named("closing-gap"), name="mine", pace=3)

class OwnData(Data):
    pass

@dataclass(frozen=True)
class Ball(FrobeniusBall):
    def project(self, tensors):
        return 0.5 * tensors

flat = named("yield-on-a-part")
G = replace(flat.solution.law.G, convex=Ball(1.0))
own_law = replace(flat, name="mine", solution=replace(flat.solution, law=replace(flat.solution.law, G=G)))
python = replace(data)
own_load = replace(data, body_force=moved)
own_class = OwnData.formulas(data.body, law, **loads)
mixed = replace(data, body_force=Data.formulas(data.body, law, f0=(0, LOAD)).body_force)
own_function = Data.formulas(data.body, law, f0=(0, implemented_function("f", lambda x: 3 * x)(t)))
posing = Data.formulas(data.body, law, **loads)
posed = wraps(data.body_force)(lambda x: lambda time: 2 * data.body_force(x)(time))
object.__setattr__(posing, "body_force", posed)
"""


@pytest.fixture
def key_of(tmp_path, monkeypatch):
    """Returns the cache key of a problem in a file, as a process computes it that reads the file for the first time."""

    def key_of(name, mine=MINE, helper=HELPER):
        for file, text in (("mine", mine), ("helper", helper)):
            (tmp_path / f"{file}.py").write_text(text, encoding="utf-8")
            sys.modules.pop(file, None)
        for cached in (resolve, resolve_data, problem):
            cached.cache_clear()
        reference = f"{tmp_path}/mine.py:{name}"
        _, data, case = resolve_data(reference)
        if case:
            return fingerprint(FirstOrder(), RateSetting(reference, "shaken", 4, "midpoint", 8))
        return of_problem(data, None, ["midpoint"])

    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    return key_of


@pytest.mark.parametrize("name", ["data", "still", "gap"])
def test_the_key_of_a_problem_of_formulas_does_not_depend_on_words_or_on_other_problems_in_its_file(name, key_of):
    before = key_of(name)
    words = MINE.replace("of a user", "of another user").replace("\nclass", "\n# A comment.\nclass", 1)
    assert words != MINE
    for mine, helper in ((words, HELPER), (MINE + "more = 1\n", HELPER), (MINE, HELPER.replace("0 * x", "1 * x"))):
        assert key_of(name, mine, helper) == before


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("data", "(1, 1), (0, 1)", "(1, 2), (0, 2)"),
        ("data", "Kind.CLAMPED, Kind.LOADED", "Kind.CLAMPED, Kind.CLAMPED"),
        ("data", "T=1.0", "T=2.0"),
        ("data", "isotropic(1, 0.5)", "isotropic(1, 0.6)"),
        ("data", "isotropic(2, 3)", "isotropic(2, 4)"),
        ("data", "-LOAD * t", "-LOAD * t**2"),
        ("data", "{1: (0, t)}", "{3: (0, t)}"),
        ("data", "u0=(0, 0)", "u0=(0, 1 - x2)"),
        ("data", "((1.0, 0.0), 0.5)", "((1.0, 0.0), 0.25)"),
        ("data", "LOAD = 3", "LOAD = 300"),
        ("still", "nu=0.3", "nu=0.2"),
        ("gap", "closing-gap", "parabolic-gap"),
        ("gap", "pace=3", "pace=2"),
        ("posing", "2 * data", "3 * data"),
        *((name, "", "") for name in ("python", "own_load", "own_class", "own_function", "own_law", "mixed")),
    ],
)
def test_each_change_of_a_problem_changes_its_key_and_functions_of_a_user_have_a_new_key_in_each_run(
    name, old, new, key_of
):
    """What a user's function computes may depend on files that nobody knows, so its results serve one run only."""
    assert old in MINE + HELPER
    assert key_of(name) != key_of(name, MINE.replace(old, new, 1), HELPER.replace(old, new, 1))


@pytest.mark.parametrize("name", ["body_force", "surface_load", "start", "initial", "fronts"])
def test_a_function_of_another_problem_takes_the_formulas_away_and_changes_the_key(name):
    solution = named("advance-recede").solution
    data = Data.of(solution)
    other = Data.of(solution)
    mixed = replace(data, **{name: getattr(other, name)})
    python = replace(data)
    assert data.formulas_of == solution
    assert mixed.formulas_of is None
    assert len({of_data(data), of_data(mixed), of_data(python)}) == 3


class Asked(BaseException):
    """Raised instead of a computation, with its cache key."""


BOUND = {"levels": "2", "family": "one-diagonal", "scheme": "midpoint", "steps": "4", "refine": "0", "shorter": "2"}
OTHERS = {"levels": "3", "family": "criss-cross", "scheme": "bdf2", "steps": "5", "refine": "1", "shorter": "1"}


@pytest.fixture
def asked(tmp_path, monkeypatch):
    """Returns the cache key that a command asks for first."""

    def ask(store, key, fingerprint, *others):
        raise Asked(fingerprint)

    def asked(problem, options, command=""):
        words = " ".join(f"--{name} {value}" for name, value in options.items())
        with pytest.raises(Asked) as found:
            study(f"bound {problem} {words} {command} --out {tmp_path}")
        return str(found.value)

    monkeypatch.setattr(Store, "cached", ask)
    return asked


@pytest.mark.parametrize(
    ("option", "command"),
    [*((option, "") for option in BOUND), *((option, "--adapt 0.1") for option in [*BOUND][:4])],
)
def test_each_option_of_study_bound_changes_the_key(option, command, asked):
    before = asked("ramp", BOUND, command)
    assert asked("ramp", BOUND, command) == before != asked("ramp", BOUND | {option: OTHERS[option]}, command)


def test_each_array_of_a_displacement_changes_its_key(tmp_path, asked):
    mesh = OneDiagonal()(unit_square(), 2)
    inside = np.prod(mesh.p * (1 - mesh.p), axis=0)[:, None]
    arrays = {"points": mesh.p.T, "times": np.linspace(0, 1, 3), "u": np.zeros((3, 9, 2)), "triangles": mesh.t.T}
    keys = set()
    for name, change in {"": 0, "points": inside, "times": [0, 0.1, 0], "u": inside}.items():
        changed = {key: array + change if key == name else array for key, array in arrays.items()}
        np.savez(tmp_path / "mine.npz", **changed)
        keys.add(asked("full-contact", {"displacement": tmp_path / "mine.npz", "refine": 0}))
    assert len(keys) == 4
