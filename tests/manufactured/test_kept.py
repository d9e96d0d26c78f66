"""What is kept between runs: the same text again, and never one that is damaged."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import sympy as sp

from manufactured.body import Kind, unit_square
from manufactured.compiled import derivatives
from manufactured.face_formula import FaceFormula, RoughError
from manufactured.jet import Jet
from manufactured.kept import CACHE, directory, kept
from manufactured.symbols import pos, s, t


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty directory in place of the user's."""
    monkeypatch.setenv(CACHE, str(tmp_path / "cache"))
    return tmp_path / "cache"


def never() -> str:
    raise AssertionError("made again")


def test_what_is_kept_is_not_made_again(cache: Path) -> None:
    assert kept("a formula", lambda: "its code") == "its code"
    assert kept("a formula", never) == "its code"
    assert kept("another formula", lambda: "other code") == "other code"


@pytest.mark.parametrize("damage", ["", "its", "\x00", "a seal\nits code"])
def test_a_file_that_was_cut_off_or_changed_is_made_again(cache: Path, damage: str) -> None:
    kept("a formula", lambda: "its code\n" * 9)
    (path,) = cache.iterdir()
    path.write_text(path.read_text()[:40] if damage == "its" else damage)
    assert kept("a formula", lambda: "its code") == "its code"
    assert kept("a formula", never) == "its code"


def test_where_nothing_can_be_written_nothing_is_kept(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cache.write_text("a file where the directory would be")
    assert kept("a formula", lambda: "its code") == "its code"
    monkeypatch.setenv(CACHE, "")
    assert directory() is None
    assert kept("a formula", lambda: "its code") == "its code"
    assert cache.read_text() == "a file where the directory would be"


def test_two_writers_leave_one_whole_file(cache: Path) -> None:
    program = "from manufactured.kept import kept\nfor n in range(200): kept(str(n % 3), lambda: f'{n % 3}' * 20000)"
    writers = [subprocess.Popen([sys.executable, "-c", program]) for _ in range(2)]
    assert [writer.wait() for writer in writers] == [0, 0]
    assert len([*cache.iterdir()]) == 3
    assert [kept(str(n), never) for n in range(3)] == [f"{n}" * 20000 for n in range(3)]


def test_code_that_is_kept_gives_the_values_of_code_that_was_just_made(cache: Path) -> None:
    formula, place = pos(s - t**2 / 3, 3) * sp.exp(-t) + sp.sin(2 * s), np.linspace(-1, 1, 7)[None]
    fresh = [Jet(formula), Jet(formula).rate()]
    found = [jet(place, 0.7, order) for jet in fresh for order in (0, 2)]
    assert len([*cache.iterdir()]) == 4
    again = [jet(place, 0.7, order) for jet in (Jet(formula), Jet(formula).rate()) for order in (0, 2)]
    assert len([*cache.iterdir()]) == 4
    for one, other in zip(found, again, strict=True):
        assert all(np.array_equal(one[index], other[index]) for index in one)


def test_functions_of_others_with_one_name_are_not_taken_for_each_other(cache: Path) -> None:
    def bump(power: int) -> type[sp.Function]:
        class bump(sp.Function):  # type: ignore[misc]
            def fdiff(self, argindex: int = 1) -> sp.Expr:
                return power * self.args[0] ** (power - 1)

        return bump

    assert [derivatives(bump(power)(s), (s,), [(1,)])(2.0)[0] for power in (2, 3)] == [4.0, 12.0]
    assert not cache.exists()


def test_exponents_that_were_read_off_are_kept_for_their_formula_and_its_times_alone(
    cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (floor,) = unit_square().of(Kind.CONTACT)
    gap = pos(s - t / 2, 4) + pos(s - sp.Rational(3, 4), 3)
    whole = FaceFormula(gap, floor, (s,), 0.0, 1.0)
    read = whole.fronts()
    assert read == (3, 4)
    assert whole.exponents() == read
    monkeypatch.setattr(FaceFormula, "fronts", lambda formula: (9.0, 9.0))
    assert whole.exponents() == read
    others = replace(whole, end=0.5), replace(whole, formula=gap + pos(s - t, 5)), replace(whole, begin=0.5)
    assert [other.exponents() for other in others] == [(9.0, 9.0)] * 3


def test_a_formula_that_cannot_be_read_is_refused_every_time(cache: Path) -> None:
    (floor,) = unit_square().of(Kind.CONTACT)
    for _ in range(2):
        with pytest.raises(RoughError, match="not known to be smooth"):
            FaceFormula(sp.sqrt(s), floor, (s,), 0.0, 1.0).exponents()
