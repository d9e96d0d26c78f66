"""No table of a scheme whose order is clearly wrong holds, however it is written, stacked and damaged."""

import random

import pytest
from table_forms import FORMS

from convergence_orders.command import main

EXPECTED = 2.0
WRONG = (0.0, 0.5, 1.0, 1.4, 2.6, 3.0)


SIZES = {
    "h": lambda n, level: f"{1 / n:.6g}",
    "dt": lambda n, level: f"{1 / n:.6g}",
    "n": lambda n, level: str(n),
    "$n \\times n$": lambda n, level: f"${n} \\times {n}$",
    "cells": lambda n, level: str(n**2),
    "dofs": lambda n, level: str((n + 1) ** 2),
    "level": lambda n, level: str(level),
}
"""Name of a column of sizes ↦ its cell for n cells along a side and a level."""


def table(draw: random.Random, orders: list[float]) -> str:
    """A table with a series of errors of each order, one below the other, in a random form."""
    levels, size, printed = draw.randint(3, 6), draw.choice([*SIZES, ""]), draw.choice(["eoc", ""])
    label = draw.choice(["", "scheme", "degree"]) if len(orders) > 1 else ""
    names = [name for name in (label, size, "L2", printed) if name]
    rows = [names]
    for series, order in enumerate(orders, start=1):
        first = draw.choice([4, 5, 10])
        for level in range(levels):
            n = first * 2**level
            row = {name: cell(n, level) for name, cell in SIZES.items()}
            row |= {"scheme": f"scheme{series}", "degree": str(series), "eoc": f"{order:.2f}" if level else "-"}
            row["L2"] = f"{3.7 * n**-order * draw.uniform(0.99, 1.01):.3e}"
            rows.append([row[name] for name in names])
    return draw.choice(FORMS)(rows)


LINES = ["", "---", "mean 2.0", "# solver 2", "Elapsed 12.3", "\\hline", "refined:", "a b c"]
SIGNS = [*" |,;&\t=x-\0", "\u2212", "\x1b[31m", "", " ok", " | 7", " (coarse)", " \\\\"]


def damage(draw: random.Random, text: str) -> str:
    """The text in which a line is lost, copied, moved or inserted, or a sign replaced or inserted."""
    lines = text.split("\n")
    number = draw.randrange(len(lines))
    line = lines.pop(number)
    place = draw.randrange(len(line) + 1)
    changed = line[:place] + draw.choice(SIGNS) + line[place + draw.randint(0, 1) :]
    for new in draw.choice([[], [line], [line, line], [line, draw.choice(LINES)], [changed], [changed]]):
        lines.insert(draw.choice([number, number, draw.randint(0, len(lines))]), new)
    return "\n".join(lines)


@pytest.mark.parametrize("seed", [0, 1, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(2, 10))])
def test_200_damaged_tables_of_a_wrong_order_never_hold_and_never_end_with_a_traceback(seed, tmp_path, capsys):
    draw = random.Random(seed)
    for _ in range(200):
        orders = [EXPECTED] * draw.choice([0, 0, 1, 2])
        orders.insert(draw.randint(0, len(orders)), draw.choice(WRONG))
        text = table(draw, orders)
        for _ in range(draw.choice([0, 1, 1, 2, 3])):
            text = damage(draw, text)
        (tmp_path / "table").write_text(text, encoding="utf-8")
        options = draw.choice([[], [], ["--ratio", "2"], ["--in", "n"], ["--dim", "1"]])
        code = main([str(tmp_path / "table"), "--expected", str(EXPECTED), *options])
        said = capsys.readouterr()
        assert code in (1, 2, 3), f"{options}\n{text}\n{said.out}"
