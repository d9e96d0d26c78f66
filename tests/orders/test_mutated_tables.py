"""No table of a scheme whose order is clearly wrong holds, however it is written, stacked and damaged."""

import random

import pytest
from costly_cases import slow
from table_forms import FORMS

EXPECTED = 2.0
WRONG = (0.0, 0.5, 1.0, 1.4, 2.6, 3.0)


SIZES = {"h": "{h:.6g}", "dt": "{h:.6g}", "n": "{n}", "$n \\times n$": "${n} \\times {n}$", "cells": "{cells}"}
SIZES |= {"dofs": "{dofs}", "level": "{level}"}
"""Name of a column of sizes ↦ the form of its cells."""


def table(draw, orders):
    """A table with a series of errors of each order, one below the other, in a random form."""
    levels = draw.randint(3, 6)
    first = draw.choice([4, 5, 10])
    size = draw.choice([*SIZES, ""])
    printed = draw.choice(["eoc", "eoc", "", "", ""])
    label = draw.choice(["", "scheme", "degree", "k"]) if len(orders) > 1 else ""
    names = [name for name in (label, size, "L2", printed) if name]
    rows = [names]
    for series, order in enumerate(orders, start=1):
        start = draw.choice([first, first + 1])
        for level in range(levels):
            n = start * 2**level
            row = {label: f"scheme{series}" if label == "scheme" else str(series)}
            numbers = {"h": 1 / n, "n": n, "cells": n**2, "dofs": (n + 1) ** 2, "level": level}
            row |= {name: form.format(**numbers) for name, form in SIZES.items()}
            row["L2"] = f"{3.7 * n**-order * draw.uniform(0.99, 1.01):.3e}"
            row["eoc"] = f"{order + draw.uniform(-0.02, 0.02):.2f}" if level else "-"
            rows.append([row[name] for name in names])
    return draw.choice(FORMS)(rows)


STRAY = ["", "---", "mean 2.0", "# solver 2", "Elapsed 12.3", "\\hline", "refined:"]
ENDS = [" ok", " | 7", ",", " (coarse)", " \\\\"]
SIGNS = ["", "x", "-", " ", "\0", "\u2212", "\x1b[31m"]


def damage(draw, text):
    """The text with one random change of a line or a sign."""
    lines = text.split("\n")
    i = draw.randrange(len(lines))
    j = draw.randrange(len(lines))
    line = lines[i]
    header = lines[0]
    k = draw.randrange(len(line) + 1)
    kind = draw.randrange(9)
    if kind == 0:
        lines[i] = lines[j]
        lines[j] = line
    elif kind == 1:
        lines[0] = draw.choice(["", "a b c", header.upper(), header.replace("L2", "error in time")])
    elif kind == 2:
        lines[i + 1 :] = [other for other in lines[i + 1 :] if draw.random() < 0.9]
    else:
        changes = {
            3: [],
            4: [line, lines[j]],
            5: [draw.choice(STRAY), line],
            6: [line.replace(*draw.choices(" |,;&\t=", k=2))],
            7: [line + draw.choice(ENDS)],
            8: [line[:k] + draw.choice(SIGNS) + line[k + 1 :]],
        }
        lines[i : i + 1] = changes[kind]
    return "\n".join(lines)


@pytest.mark.parametrize("seed", [0, slow(1)])
def test_500_damaged_tables_of_a_wrong_order_never_hold_and_never_end_with_a_traceback(seed, rates):
    draw = random.Random(seed)
    for _ in range(500):
        orders = [EXPECTED] * draw.choice([0, 0, 1, 2])
        orders.insert(draw.randint(0, len(orders)), draw.choice(WRONG))
        text = table(draw, orders)
        for _ in range(draw.choice([0, 1, 1, 2, 3])):
            text = damage(draw, text)
        rates(text, f"--expected {EXPECTED} {draw.choice(['', '', '--ratio 2', '--in n', '--dim 1'])}", 1, 2, 3)
