"""The balance of energy over time, from ``pictures/CASE.json``."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from study.present.charts.palette import BLACK, BLUE, GREEN, GREY, VERMILLION
from study.present.figures.drawing import COLUMN, legend
from study.present.picture.picture import Energy, Picture

CURVES = (
    ("work", r"work of the load", BLACK, "-"),
    ("dissipated", r"dissipated by $\mathcal{A}$", VERMILLION, "-"),
    ("stored", r"stored in $\mathcal{G}$", BLUE, "-"),
    ("contact", "work of contact", GREEN, "--"),
)
TINY = 1e-12
"""Relative to the largest energy: what is smaller is round-off."""


def draw_energy(picture: Picture) -> Figure:
    """Above, work of the load, dissipation, stored energy and work of contact since t = 0; below, their defect.

    The defect is relative to the largest of them.
    """
    energy = picture.energy
    figure = Figure(figsize=(COLUMN, 3.4))
    above, below = figure.subplots(2, sharex=True, height_ratios=(3, 1))
    handles = []
    for name, label, colour, style in CURVES:
        values = getattr(energy, name)
        values = values - values[0] if name == "stored" else values
        handles += above.plot(energy.times, values, color=colour, ls=style, label=label)
    below.plot(energy.times, 100 * energy.defect / largest(energy), color=GREY)
    below.axhline(0, color=BLACK, lw=0.4)
    for axes in (above, below):
        axes.grid(True)
    above.set_ylabel("energy since $t=0$")
    below.set(xlabel="time $t$", ylabel="defect in %", xlim=(energy.times[0], energy.times[-1]))
    figure.align_ylabels()
    figure.suptitle(picture.heading)
    legend(figure, handles, columns=2)
    return figure


def caption_energy(picture: Picture) -> str:
    """What to see."""
    energy = picture.energy
    worst = int(np.argmax(abs(energy.defect)))
    scale = largest(energy)
    return (
        f"Balance of energy ({picture.place}, BDF2). Up to t = {energy.times[-1]:.3g} the load has done the work "
        f"{energy.work[-1]:.3g}; {energy.dissipated[-1]:.3g} is dissipated by the viscosity, the stored energy has "
        f"changed by {_or_zero(energy.stored[-1] - energy.stored[0], scale)} and contact has done the work "
        f"{_or_zero(energy.contact[-1], scale)}. What to see: the parts add up to the work of the load but for a "
        f"defect of at most {100 * abs(energy.defect[worst]) / scale:.2g} % of the largest energy (at "
        f"t = {energy.times[worst]:.3g}), which is due to the trapezoidal rule and the time scheme and of second "
        "order in the step. The foundation is rigid and frictionless: contact does work only where a vertex "
        "changes between contact and release."
    )


def largest(energy: Energy) -> float:
    """The largest of the terms of the balance over time, 1 where all vanish."""
    moved = (energy.stored - energy.stored[0], energy.dissipated, energy.contact, energy.work)
    return float(max(abs(values).max() for values in moved)) or 1.0


def _or_zero(value: float, scale: float) -> str:
    return f"{value:.3g}" if abs(value) > TINY * scale else "0"
