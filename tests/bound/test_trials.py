"""What is on record of bounds that were tried: no error outside, effectivities bounded, and the page says so."""

from __future__ import annotations

import pandas as pd
import pytest

from benchmarks.trials import random_problems, stiff
from benchmarks.trials.record import OUT, PAGE
from study.present.pages import put

RANDOM, EFFECTIVITY = (pd.read_csv(OUT / name) for name in ("random.csv", "effectivity.csv"))


def test_no_error_on_record_lies_outside() -> None:
    assert len(RANDOM) == RANDOM["trial"].nunique() >= 100
    assert RANDOM["trial"].isin(range(random_problems.COUNT)).all()
    refused = RANDOM["outcome"].str.startswith(random_problems.REFUSED)
    assert (refused | (RANDOM["outcome"] == random_problems.ENCLOSED)).all()
    inside = RANDOM[~refused]
    assert (inside["low"] <= inside["error"] * 1.01).all()
    assert (inside["error"] <= inside["high"] * 1.01).all()


def test_they_are_as_rough_as_it_is_said() -> None:
    assert RANDOM["width"].min() < 0.02
    assert RANDOM["periods"].max() > 50
    assert set(RANDOM["family"]) == {"one-diagonal", "shaken", "unstructured"}
    assert RANDOM["slope"].nunique() == 3
    assert (RANDOM["zone"] == 1).mean() > 0.5
    assert (RANDOM["blind"] == random_problems.OUTSIDE).sum() > 0


def test_effectivities_are_bounded_for_all_materials_and_were_not_before() -> None:
    assert list(EFFECTIVITY["trial"]) == sorted(stiff.trials())
    wide = stiff.wide(EFFECTIVITY)
    assert wide["enclosure"].max() < 2
    assert wide["plain"].max() < 3
    assert wide["plain_before"].max() > 100
    assert (wide[["enclosure", "plain"]] >= 1).all(axis=None)


@pytest.mark.slow
@pytest.mark.parametrize("trial", ["G 10000 10000", "A 1 1"])
def test_the_record_is_what_the_program_gives(trial: str) -> None:
    (kept,) = EFFECTIVITY[EFFECTIVITY["trial"] == trial].itertuples()
    found = dict(zip(("low", "high", "plain"), stiff.bounds(trial, stiff.USUAL), strict=True))
    assert {name: getattr(kept, name) for name in found} == pytest.approx(found, rel=1e-3)


def test_the_page_shows_the_record() -> None:
    text = PAGE.read_text(encoding="utf-8")
    tables = {"effectivity": stiff.summary(EFFECTIVITY), "random-trials": random_problems.summary(RANDOM)}
    for name, table in tables.items():
        assert put(text, name, table) == text, "run: make trials"
        assert f"<!-- {name} -->" in text
