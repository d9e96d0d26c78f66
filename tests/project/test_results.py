"""The committed results are what the code gives: measured again at small levels, judged again, drawn.

They were measured by an older commit: cases, statements and columns that came later are not among them.
"""

import shutil

import pandas as pd
import pytest
from costly_cases import slow, slow_unless
from places import DATA, RESULTS

from study.fem.naming import resolve
from study.ledger.datafiles import read_claims
from study.ledger.schema import COUNT, SCHEMA, TEXT
from study.ledger.verdict import HOLDS, ROW_KEY, UNCLAIMED
from study.run.judgement import judge
from study.run.plan import full
from study.solve import multigrid
from study.solve.tableau import MIDPOINT
from study.statements import STATEMENTS
from study.statements.contact_force import ContactForce
from study.statements.enclosure import BOUNDS as BOUNDS_FILE
from study.statements.enclosure import Bounds
from study.statements.other_solvers import SECOND_ERRORS as OF_SECOND
from study.statements.other_solvers import Recomputed
from study.statements.prop_5_4 import FirstOrder, RateSetting
from study.statements.shared.base import ListedNumbers, Setting
from study.statements.thm_4_2 import RELATIVE_TO, OwnSpace, SameMesh

RATES = pd.read_csv(DATA / "rates.csv")
CASES = [*RATES["case"].unique()]
EQUIVALENCE = pd.read_csv(DATA / "equivalence.csv")
STATEMENT_NUMBERS = pd.read_csv(DATA / "statements.csv")
BOUNDS = [statement for statement in STATEMENTS if isinstance(statement, Bounds)]
MEASURED = ["h", "error", "at", "interpolation_error", "discrete_error", "time_share", "predicted_interpolation"]
MEASURED += ["quadrature_change"]


def assert_agree(again, row, columns, rel=1e-5, **options):
    """Assert that some columns of a row that was measured again are those of a committed row."""
    found, committed = ([each[column] for column in columns] for each in (again, row))
    assert found == pytest.approx(committed, rel=rel, **options), row


def measured_again(statement, row):
    """The measurement that gave a committed row."""
    return statement.run(Setting(row["case"], row["family"], int(row["level"])))


def slow_except(quick, names, *more):
    """Parameters of a test, of which only a few are quick; the nightly job tests all."""
    return [slow_unless(name in quick, name, *more) for name in names]


FEW = ("advance-recede", "yield-on-a-part", "layered", "re-entrant")
"""Cases that are measured again in a second each: a law that is not linear, layers, and a corner with graded meshes."""


@pytest.mark.parametrize(("case", "place"), [*slow_except(FEW, CASES, 0), *slow_except((), CASES, 2)])
def test_rows_measured_again_agree_with_the_committed_ones(case, place):
    """The coarsest level and the third, on the first and the last family; of solids the coarsest level on the last."""
    mine = RATES[RATES["case"] == case]
    committed = mine[mine["level"] == sorted(mine["level"].unique())[place]]
    families = [-1] if place == 0 and resolve(case).solution.body.dim == 3 else [0, -1]
    for row in committed.iloc[families].drop_duplicates().to_dict("records"):
        again = FirstOrder().run(RateSetting(case, row["family"], row["level"], MIDPOINT.name, row["steps"]))
        assert again["dofs"] == row["dofs"]
        # Multigrid, in space, stops when this residual is reached; another processor may need another iteration.
        assert_agree(again, row, MEASURED, abs=max(1e-9, multigrid.residual(row["dim"], row["dofs"])))


WITH_SEVERAL_LAWS = ("advance-recede", "layered", "softening", "yield-on-a-part")


@pytest.mark.parametrize("case", slow_except(WITH_SEVERAL_LAWS, EQUIVALENCE["case"].unique()))
def test_both_formulations_agree_again(case):
    committed = EQUIVALENCE.query(f"case == '{case}'").iloc[0]
    statement = SameMesh()
    place = Setting(case, committed["family"], int(committed["level"]))
    ((_, row),) = statement.records(place, statement.run(place))
    assert row["steps"] == committed["steps"]
    assert row["h"] == pytest.approx(committed["h"])
    assert {verdict.verdict for verdict in SameMesh().judge(pd.DataFrame([row]))} == {HOLDS}


def test_stresses_measured_again_agree_with_the_committed_ones():
    """Level 8, on some of the cases."""
    committed = pd.read_csv(DATA / "stresses.csv").query("level == 8")
    for row in committed.iloc[::16].to_dict("records"):
        assert_agree(
            measured_again(OwnSpace(), row), row, ("unknowns", "h", "steps", *RELATIVE_TO, "stress_sup", "time_share")
        )


@pytest.mark.parametrize("statement", BOUNDS)
def test_bounds_measured_again_agree_with_the_committed_ones(statement):
    """One of those that cost least, and one with a law that is not linear."""
    committed = pd.read_csv(DATA / "bounds.csv").set_index(list(BOUNDS_FILE.key))
    planned = sorted(statement.planned(full()), key=statement.cost)
    every = [
        setting
        for setting in planned
        if (statement.label, setting.case, setting.family, setting.scheme, setting.level) in committed.index
    ]
    settings = [every[0], next(setting for setting in every if setting.case == "yield-and-release")]
    for setting in settings:
        again = statement.run(setting)["row"]
        row = committed.loc[tuple(again[name] for name in BOUNDS_FILE.key)]
        assert_agree(again, row, committed.columns, abs=1e-9, nan_ok=True)


DEAR = ("Landings", "WorkOfContact", "SolutionDivergence", "NoPotential", "Rollers", "BackwardEuler",
        "FullyDiscrete")  # fmt: skip
"""Statements whose coarsest setting takes some seconds and more."""
LISTS = [
    slow_unless(name not in DEAR, statement, id=name)
    for statement in STATEMENTS
    for name in [type(statement).__name__]
    if isinstance(statement, ListedNumbers) and statement.label in {*STATEMENT_NUMBERS["label"]}
]


def fewest_settings(statement, numbers):
    """Yield settings that together have all quantities: the cheapest of the settings with most new quantities."""
    missing = {quantity for values in numbers.values() for quantity in values.index}
    while missing:
        place = min(numbers, key=lambda one: (-len(missing & {*numbers[one].index}), statement.cost(one), one))
        yield place
        missing -= {*numbers[place].index}


@pytest.mark.parametrize("statement", LISTS)
def test_numbers_of_statements_measured_again_agree_with_the_committed_ones(statement):
    """Every quantity on one setting in the plane; what is rounding on one machine is rounding on another."""
    committed = STATEMENT_NUMBERS[STATEMENT_NUMBERS["label"] == statement.label]
    everywhere = {
        Setting(case, family, int(level)): rows.set_index("quantity")["value"]
        for (case, family, level), rows in committed.groupby(["case", "family", "level"])
    }
    assert {*everywhere} <= {*statement.planned(full())}
    numbers = {place: values for place, values in everywhere.items() if place.dim == 2}
    again = set[str]()
    for place in fewest_settings(statement, numbers):
        for _, row in statement.records(place, statement.run(place)):
            expected = numbers[place].get(row["quantity"], row["value"])
            assert row["value"] == pytest.approx(expected, rel=1e-5, abs=1e-9), (place, row["quantity"])
            again.add(row["quantity"])
    assert again >= set(committed["quantity"])


@pytest.mark.parametrize("case", ["advance-recede", slow("corner")])
def test_errors_of_the_second_solver_measured_again_agree_with_the_committed_ones(case):
    """Differences of both solvers are quadrature errors of the load, and belong to the rules of both."""
    steps = RATES[["case", "family", "level", "steps"]]
    committed = pd.read_csv(DATA / "recomputed.csv").merge(steps).query("case == @case and family == 'one-diagonal'")
    row = committed.sort_values("level").iloc[0]
    again = Recomputed().run(RateSetting(case, row["family"], int(row["level"]), MIDPOINT.name, int(row["steps"])))
    assert_agree(again, row, OF_SECOND, rel=1e-6)
    assert_agree(again, row, ("displacement", "multipliers"), rel=1e-2)


def test_contact_forces_measured_again_agree_with_the_committed_ones():
    """On a body with three contact faces, two of which meet the clamped side."""
    committed = pd.read_csv(DATA / "contact.csv").query("case == 'hexagon'")
    row = committed.sort_values("level").iloc[0]
    assert row["clamped"] == 2
    again = measured_again(ContactForce(), row)
    assert_agree(again, row, again, abs=1e-9)


def test_every_column_of_the_committed_tables_has_a_unit_and_a_meaning():
    for path in DATA.glob("*.csv"):
        described = SCHEMA[path.name].columns
        assert set(pd.read_csv(path, nrows=0)) <= {*described}
        assert all(column.unit in (TEXT, COUNT, "1") and column.meaning for column in described.values())


def test_the_committed_verdicts_follow_from_the_committed_data_and_none_fails(tmp_path):
    shutil.copytree(DATA, tmp_path / "data", ignore=shutil.ignore_patterns("jobs", "pictures"))
    shutil.copytree(RESULTS / "codes", tmp_path / "codes")
    judge(tmp_path)
    again, committed = (read_claims(directory).set_index([*ROW_KEY]) for directory in (tmp_path, RESULTS))
    pd.testing.assert_frame_equal(again.loc[committed.index], committed, rtol=1e-6)
    assert committed["verdict"].isin((HOLDS, *UNCLAIMED)).all()
