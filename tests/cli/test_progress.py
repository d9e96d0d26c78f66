"""The remaining time that a command shows follows from the mean speed of the work that was done."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from study.cli.common import ProgressBar, progress_bar

COST = 100


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> dict[str, float]:
    """A clock that stands still until a test sets it."""
    now = {"seconds": 1000.0}
    monkeypatch.setattr("tqdm.std.time", lambda: now["seconds"])
    return now


@pytest.fixture
def bar(clock: dict[str, float]) -> Iterator[ProgressBar]:
    with progress_bar(COST) as shown:
        shown._time = lambda: clock["seconds"]
        yield shown


def left_after(bar: ProgressBar, clock: dict[str, float], seconds: float) -> str:
    clock["seconds"] = 1000.0 + seconds
    return str(bar.format_dict["left"])


def test_no_time_is_shown_before_a_tenth_is_done(bar: ProgressBar, clock: dict[str, float]) -> None:
    bar.update(9)
    assert left_after(bar, clock, 30) == "?"


def test_the_remaining_time_follows_from_the_mean_speed_although_the_last_job_was_slow(
    bar: ProgressBar, clock: dict[str, float]
) -> None:
    bar.update(40)
    clock["seconds"] += 10
    bar.update(10)
    assert left_after(bar, clock, 42) == "00:42"


def test_stored_results_do_not_count_for_the_speed(bar: ProgressBar, clock: dict[str, float]) -> None:
    notify = bar.notify_after_stored()
    notify(80)
    notify(10)
    assert left_after(bar, clock, 20) == "00:20"
