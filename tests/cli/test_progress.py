"""The remaining time that a command shows follows from the mean speed of the work that was done."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from study.cli.common import ProgressBar, progress_bar

COST = 100


@pytest.fixture
def bar(monkeypatch: pytest.MonkeyPatch) -> Iterator[ProgressBar]:
    """A progress bar whose clock stands still until a test sets it."""
    monkeypatch.setattr("tqdm.std.time", lambda: 0.0)
    with progress_bar(COST) as shown:
        yield shown


def left_after(bar: ProgressBar, seconds: float) -> str:
    bar._time = lambda: seconds
    return str(bar.format_dict["left"])


def test_no_time_is_shown_before_a_tenth_is_done(bar: ProgressBar) -> None:
    bar.update(9)
    assert left_after(bar, 30) == "?"


def test_the_remaining_time_follows_from_the_mean_speed_although_the_last_job_was_slow(bar: ProgressBar) -> None:
    bar.update(40)
    bar._time = lambda: 10.0
    bar.update(10)
    assert left_after(bar, 42) == "00:42"


def test_stored_results_do_not_count_for_the_speed(bar: ProgressBar) -> None:
    notify = bar.notify_after_stored()
    notify(80)
    notify(10)
    assert left_after(bar, 20) == "00:20"
