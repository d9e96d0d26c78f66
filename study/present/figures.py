"""All figures of a run, and the functions that draw bounds, energies, adapted meshes and the sketch of the problem.

Charts are drawn by ``study.present.charts``, deformed bodies by ``study.present.body``, and contact zones, gaps and
pressures by ``study.present.contact``.
"""

import re
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib import patches
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation
from numpy.typing import NDArray

from manufactured.colours import BLACK, BLUE, DARK, GREEN, GREY, VERMILLION
from study.ledger.codes import Codes
from study.ledger.datafiles import expected_orders, read_csv, read_rates, read_table
from study.ledger.files import UsageError
from study.present import body, charts, contact, fault_matrix
from study.present.body import GAP
from study.present.charts import Chart, draw_chart
from study.present.drawing import SHEET, Drawing, caption, column_width, dots, entry, is_slide, legend, page_width
from study.present.notation import counted
from study.present.palette import FOUNDATION, FOUNDATION_EDGE, RAMPS, Style
from study.present.picture import Array, Picture, read_pictures

PICTURES: dict[str, tuple[Callable[[Picture], Figure], Callable[[Picture], str], str]] = {
    "body": (body.draw_body, body.caption_body, "The deformed body on its foundation, with stresses and contact"),
    "zone": (contact.draw_zone, contact.caption_zone, "The contact zone in space and time, exact and computed"),
    "fronts": (contact.draw_fronts, contact.caption_fronts, "Maps of the contact zone, exact and computed"),
    "profiles": (contact.draw_profiles, contact.caption_profiles, "Gap and pressure along the contact boundary"),
    "maps": (contact.draw_maps, contact.caption_maps, "Maps of gap and pressure on the contact boundary"),
}
"""Kind of a figure of one run ↦ the function that draws it, the function that returns its caption, and its summary."""


def drawings(directory: Path) -> list[Drawing]:
    """Return all figures of a result directory without drawing them: figures over all cases, and of each case.

    The figures over all cases are those of ``overview``. A case has the figure ``convergence-CASE`` if it is in
    ``rates.csv``, ``enclosure-CASE`` if its error has two-sided bounds, and ``body-CASE``, ``zone-CASE``,
    ``profiles-CASE`` and
    ``energy-CASE`` if it has a file in ``pictures``.

    Raises:
        DataError: a data file is missing or damaged.
    """
    found, rates = overview(directory), read_rates(directory)
    orders = expected_orders(directory, rates)
    for (scheme, case), rows in rates.groupby(["scheme", "case"], sort=False):
        name = f"convergence-{case}" + f"-{scheme}" * (rates["scheme"].nunique() > 1)
        found.append(_of_chart(name, charts.convergence_chart(rows, orders[str(case)]), str(case)))
    columns = ("trajectory", "case", "family", "level", "time", "error", "distance", "bound")
    enclosed = charts.enclosure_charts(read_csv(directory, "enclosures.csv", columns))
    found += [_of_chart(f"enclosure-{case}", chart, case) for case, chart in enclosed]
    for picture in read_pictures(directory):
        # Contact faces are lines in 2D and maps in 3D.
        zone, profiles = ("zone", "profiles") if picture.segments else ("fronts", "maps")
        kinds = {"body": PICTURES["body"], "zone": PICTURES[zone], "profiles": PICTURES[profiles]}
        kinds["energy"] = draw_energy, caption_energy, "The balance of energy over time, and its defect"
        for kind, (draw, describe, summary) in kinds.items():
            name, about = f"{kind}-{picture.case}", f"{summary}: {picture.case}"
            found.append(Drawing(name, partial(draw, picture), describe(picture), about, picture.case))
    return found


def drawings_of(
    directory: Path, cases: Sequence[str] = (), names: Sequence[str] = (), slides: bool = False
) -> list[Drawing]:
    """Return the figures of the named cases, or the figures with some names, without drawing them.

    Parameters:
        directory: a result directory.
        cases, names: names of cases and of figures; without both, all figures are returned.
        slides: whether only figures that can be read on a slide are returned.

    Raises:
        UsageError: there is no figure of a case, or with a name.
        DataError: a data file is missing or damaged.
    """
    # A figure with a subplot for each of many cases cannot be read on a slide.
    found = [drawing for drawing in drawings(directory) if not (slides and drawing.sheet)]
    for option, kind, of, wanted in (("--case", "case", "case", cases), ("--only", "figure", "name", names)):
        known = list(dict.fromkeys(getattr(drawing, of) for drawing in found if getattr(drawing, of)))
        if unknown := [name for name in wanted if name not in known]:
            raise UsageError(f"{option} {unknown[0]}: {directory} has no such {kind}, only {', '.join(known)}")
        found = [drawing for drawing in found if not wanted or getattr(drawing, of) in wanted]
    return found


def overview(directory: Path) -> list[Drawing]:
    """Return the figures over all cases of a result directory without drawing them.

    The figures are ``problem``, a sketch; ``collapsed``, ``orders`` and ``convergence`` for the cases of Prop. 5.4 and
    ``convergence-prop-5-3`` for the cases of Prop. 5.3; ``contact-work`` and ``rollers`` if they were measured;
    ``effectivity`` from ``bounds.csv``; ``growth`` from ``benchmarks/growth.csv`` and ``codes`` from ``codes/``, if
    these exist.

    Raises:
        DataError: a data file is missing or damaged.
    """
    found: dict[str, Chart | None] = {}
    rates = read_rates(directory)
    orders = expected_orders(directory, rates)
    for scheme, rows in rates.groupby("scheme", sort=False):
        suffix = f"-{scheme}" * (rates["scheme"].nunique() > 1)
        # The largest figure comes first, because it takes longest to draw and would otherwise delay the end.
        for claim, of_claim in sorted(rows.groupby("claim"), key=lambda group: -len(group[1])):
            name = "" if claim == "Prop. 5.4" else "-" + re.sub(r"[^a-z0-9]+", "-", str(claim).lower()).strip("-")
            found[f"convergence{name}{suffix}"] = charts.overview_chart(of_claim, orders)
        smooth = rows[rows["claim"] == "Prop. 5.4"]
        found[f"collapsed{suffix}"] = charts.collapsed_chart(smooth) if len(smooth) else None
        found[f"orders{suffix}"] = charts.orders_chart(rows, orders)
    # Runs of a user's own cases have no statements.csv.
    if (directory / "data" / "statements.csv").is_file():
        columns = ("label", "case", "family", "level", "h", "quantity", "value")
        statements = read_csv(directory, "statements.csv", columns)
        found |= {"contact-work": charts.work_chart(statements), "rollers": charts.rollers_chart(statements)}
    path = directory / "benchmarks" / "growth.csv"
    if path.is_file():
        needed = ["n", "dofs", "factor_seconds", "step_seconds", "level_seconds", "peak_bytes", "dim", "solver"]
        found["growth"] = charts.growth_chart(read_table(path, needed, "make bench-growth").dropna(subset=needed))
    codes = Codes.read(directory)
    found["codes"] = charts.codes_chart(codes) if codes else None

    figures = [_of_chart(name, chart) for name, chart in found.items() if chart]
    bounds = read_csv(directory, "bounds.csv", ("case", "scheme", "trajectory", "level", "upper", "lower"))
    known = bounds[bounds["upper"].notna()]
    if len(known):
        about = "Bounds of the error divided by the error, for each case"
        figures.append(Drawing("effectivity", partial(draw_effectivity, known), caption_effectivity(known), about))
    if (directory / "data" / "faults.csv").is_file():
        matrix = read_csv(directory, "faults.csv")
        draw = partial(fault_matrix.draw_faults, matrix)
        figures.append(Drawing("faults", draw, fault_matrix.caption_faults(matrix), "The matrix of deliberate faults"))
    return [*figures, Drawing("problem", draw_sketch, caption("problem"), "Sketch of a body on a rigid foundation")]


def enclosure(name: str, series: pd.DataFrame, title: str) -> Drawing:
    """Return the figure of the bounds of an error over time.

    Parameters:
        name: the name of the files of the figure.
        series: the bounds, as for ``charts.enclosure_chart``.
        title: the title of the figure.
    """
    return _of_chart(name, charts.enclosure_chart(series, title))


def _of_chart(name: str, chart: Chart, case: str = "") -> Drawing:
    return Drawing(name, partial(draw_chart, chart), chart.caption, chart.summary, case, len(chart.subplots) > SHEET)


SCHEMES = {"backward-euler": Style(VERMILLION, "s"), "bdf2": Style(GREEN, "^"), "midpoint": Style(BLUE, "o")}


def draw_effectivity(known: pd.DataFrame) -> Figure:
    """Draw the bounds of the error divided by the error, a line for each case.

    The left axes show the upper bound from u_h alone, the right axes both ends of the enclosure. A line has a marker
    for each time scheme, mesh family and level; markers of finer levels are larger.

    Parameters:
        known: the rows of ``bounds.csv`` whose error is known. ``upper`` and ``lower`` are the worst ratios of the
            bounds to the error in the second half of time.
    """
    # A slide has room for a line per scheme.
    line, shift = ("scheme", 0.0) if is_slide() else ("case", 0.22)
    names = list(dict.fromkeys(known[line]))
    row = {name: len(names) - 1 - i for i, name in enumerate(names)}
    used = {scheme: style for scheme, style in SCHEMES.items() if (known["scheme"] == scheme).any()}
    figure = Figure(figsize=(page_width(), 1.2 + 0.15 * len(names)))
    left, right = figure.subplots(1, 2, sharey=True)
    for axes, trajectory, columns in ((left, "bound", ("upper",)), (right, "enclosure", ("lower", "upper"))):
        for scheme, style in used.items():
            rows = known[(known["trajectory"] == trajectory) & (known["scheme"] == scheme)]
            # The markers of each scheme are shifted vertically, because they would hide each other.
            y = rows[line].map(row) + shift * (list(SCHEMES).index(scheme) - 1)
            for column in columns:
                look: dict[str, Any] = {"s": _marker_area(rows["level"]), "marker": style.marker, "linewidth": 0.6}
                face = style.colour if column == "upper" else "white"
                axes.scatter(rows[column], y, edgecolor=style.colour, facecolor=face, zorder=3, **look)
        axes.axvline(1, color=BLACK, lw=0.7)
        axes.grid(True)
    left.set_xscale("log")
    candidates = (1, 2, 5, 10, 20, 50) if is_slide() else (1, 1.5, 2, 3, 5, 7, 10, 20, 50)
    ticks = [tick for tick in candidates if tick <= 1.1 * left.get_xlim()[1]]
    left.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    left.minorticks_off()
    left.set_yticks(list(row.values()), list(row))
    left.set(ylim=(-0.7, len(names) - 0.3), xlabel="bound / error" if is_slide() else "bound from $u_h$ alone / error")
    right.set(xlim=(0, None), xlabel="enclosure / error" if is_slide() else "ends of the enclosure / error")
    handles = [dots(scheme, color=style.colour, marker=style.marker) for scheme, style in used.items()]
    ends = ("upper", DARK), ("lower", "white")
    handles += [dots(f"{end} end of the bound", color=DARK, mfc=fill) for end, fill in ends]
    levels = sorted(known["level"].unique())[:: max(1, known["level"].nunique() - 1)]
    handles += [dots(f"$n={n}$", color=DARK, ms=float(np.sqrt(_marker_area(n))), mew=0) for n in levels]
    legend(figure, [*handles, entry("the error itself", color=BLACK, lw=0.7)], columns=4)
    return figure


def caption_effectivity(known: pd.DataFrame) -> str:
    """Return the caption of ``draw_effectivity``."""
    plain, enclosed = (known[known["trajectory"] == name] for name in ("bound", "enclosure"))
    wrong = int((known["upper"] < 1).sum() + (enclosed["lower"] > 1).sum())
    seen = [f"{counted(wrong, 'bound') if wrong else 'no bounds'} on the wrong side of the error"]
    if len(plain):
        medians = [f"{rows['upper'].median():.3g} with {scheme}" for scheme, rows in plain.groupby("scheme")]
        seen.append(
            f"from u_h alone the bound is {plain['upper'].min():.3g} … {plain['upper'].max():.3g} times the error, the "
            f"median {', '.join(medians)}"
        )
    if len(enclosed):
        seen.append(
            f"an enclosure by a more accurate displacement has its lower end at {enclosed['lower'].min():.3g} … "
            f"{enclosed['lower'].max():.3g} and its upper end at {enclosed['upper'].min():.3g} … "
            f"{enclosed['upper'].max():.3g} times the error"
        )
    return caption("effectivity", cases=counted(known["case"].nunique(), "case"), seen="; ".join(seen))


def _marker_area(level: Any) -> Any:
    """Return the area of the marker of a level in square points."""
    return 5.0 * np.log2(level) - 8


def draw_energy(picture: Picture) -> Figure:
    """Draw the terms of the energy balance over time and, below, its defect.

    The terms are the work of the load, the dissipated energy, the stored energy and the work of contact since t = 0.
    The defect, which would be zero without discretisation in time, is relative to the largest of these terms.
    """
    energy = picture.energy
    figure = Figure(figsize=(column_width(), 3.4))
    above, below = figure.subplots(2, sharex=True, height_ratios=(3, 1))
    handles = [
        *above.plot(energy.times, energy.work, color=BLACK, label=r"work of the load"),
        *above.plot(energy.times, energy.dissipated, color=VERMILLION, label=r"dissipated by $\mathcal{A}$"),
        *above.plot(energy.times, energy.stored - energy.stored[0], color=BLUE, label=r"stored in $\mathcal{G}$"),
        *above.plot(energy.times, energy.contact, color=GREEN, ls="--", label="work of contact"),
    ]
    below.plot(energy.times, 100 * energy.defect / energy.largest, color=GREY)
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
    """Return the caption of ``draw_energy``."""
    energy, scale = picture.energy, picture.energy.largest
    worst = int(np.argmax(abs(energy.defect)))
    stored, of_contact = (
        # Smaller values are round-off.
        f"{value:.3g}" if abs(value) > 1e-12 * scale else "0"
        for value in (energy.stored[-1] - energy.stored[0], energy.contact[-1])
    )
    return caption(
        "energy",
        picture=picture,
        end=energy.times[-1],
        work=energy.work[-1],
        dissipated=energy.dissipated[-1],
        stored=stored,
        contact=of_contact,
        defect=100 * abs(energy.defect[worst]) / scale,
        worst=energy.times[worst],
    )


def adapted_mesh(
    name: str,
    *,
    norm: str,
    mesh: Triangulation,
    edges: Array,
    closed: NDArray[np.bool_],
    rows: pd.DataFrame,
    uniform: pd.DataFrame,
) -> Drawing:
    """Return the figure ``adaptive``: the last adapted mesh, and the bounds of the error over the number of unknowns.

    Parameters:
        name: the name of the problem.
        norm: the error that is bounded, as text.
        mesh: the last mesh of an adaptive refinement.
        edges: coordinates of the ends of the edges on Γ3, (2, 2, edges).
        closed: whether an edge is in contact at the last time, (edges,).
        rows: the content of ``adaptive.csv``, a row for each mesh of the refinement.
        uniform: the content of ``levels.csv``, a row for each uniform mesh; empty if there are none.
    """
    against = ", for meshes refined everywhere as well" if len(uniform) else ""
    contact = "with what of Γ3 is in contact at the last time in colour, " if closed.size else ""
    text = caption("adaptive", name=name, contact=contact, norm=norm, against=against)
    summary = f"An adapted mesh, and the bound of the error over the unknowns: {name}"
    draw = partial(_draw_adapted, adapted=mesh, edges=edges, closed=closed, rows=rows, uniform=uniform)
    return Drawing("adaptive", draw, text, summary)


def _draw_adapted(
    adapted: Triangulation, edges: Array, closed: NDArray[np.bool_], rows: pd.DataFrame, uniform: pd.DataFrame
) -> Figure:
    figure, thick = Figure(figsize=(page_width(), 0.5 * page_width()), layout="constrained"), 2.5
    mesh, bounds = figure.subplots(1, 2)
    mesh.triplot(adapted, color=DARK, lw=0.25)
    for which, colour in ((closed, VERMILLION), (~closed, BLUE)):
        lines = np.moveaxis(edges[:, :, which], 2, 0).transpose(0, 2, 1)
        mesh.add_collection(LineCollection(list(lines), colors=colour, linewidths=thick, zorder=3))
    mesh.set_aspect("equal")
    mesh.set_axis_off()
    mesh.set_title(f"mesh {rows['mesh'].iloc[-1]}, {rows['cells'].iloc[-1]} cells")

    contact = [
        entry(r"$\Gamma_3$ in contact", color=VERMILLION, lw=thick),
        entry(r"$\Gamma_3$ open", color=BLUE, lw=thick),
    ]
    handles = [*(contact if closed.size else []), entry("adaptive", color=BLUE, marker="o")]
    bounds.loglog(rows["dofs"], rows["bound"], color=BLUE, marker="o")
    if len(uniform):
        bounds.loglog(uniform["dofs"], uniform["plain"], color=GREY, marker="s")
        handles.append(entry("refined everywhere", color=GREY, marker="s"))
    if rows["error"].notna().all():
        bounds.loglog(rows["dofs"], rows["error"], color=BLUE, ls=":")
    ends = np.array([rows["dofs"].iloc[0], rows["dofs"].iloc[-1]], dtype=float)
    x = np.array([ends[0], np.sqrt(ends.prod()), ends[1]])
    y = 0.7 * rows["bound"].iloc[-1] * (x / ends[-1]) ** -0.5
    bounds.loglog(ends, y[::2], color=DARK, ls="--", lw=0.8)
    text: dict[str, Any] = {"textcoords": "offset points", "xytext": (-5, -5), "ha": "right", "va": "top"}
    bounds.annotate("slope $-1/2$", (x[1], y[1]), **text)
    bounds.set(xlabel="unknowns", ylabel="bound of the error")
    legend(figure, handles, len(handles))
    return figure


def draw_sketch() -> Figure:
    """Draw a sketch of a body on a foundation with Γ1, Γ2, Γ3, forces, gap and pressure; nothing is computed.

    The drawn gap is (s − c)_+² and the drawn pressure (c − s)_+, where c is the position of the contact front.
    """
    wide, high, front = 1.5, 0.62, 0.75
    figure = Figure(figsize=(column_width(), 1.75))
    axes = figure.subplots()
    s = np.linspace(0, wide, 61)
    gap = 0.28 * np.maximum(s - front, 0) ** 2
    outline = np.vstack([np.column_stack([s, gap]), [[wide, high], [0, high]]])
    axes.add_patch(patches.Polygon(outline, facecolor=RAMPS["stress"][0], edgecolor=BLACK, linewidth=0.8))
    clamp: dict[str, Any] = {"facecolor": "none", "edgecolor": DARK, "linewidth": 0, "hatch": "/////"}
    axes.add_patch(patches.Rectangle((0, high), wide, 0.05, **clamp))
    axes.plot([0, wide], [high, high], color=DARK, lw=1.6)
    axes.plot(s, gap, color=BLUE, lw=1.6)

    ground: dict[str, Any] = {"facecolor": FOUNDATION, "edgecolor": "none", "zorder": 0.5}
    axes.add_patch(patches.Rectangle((-0.12, -0.09), wide + 0.24, 0.09, **ground))
    axes.plot([-0.12, wide + 0.12], [0, 0], color=FOUNDATION_EDGE, lw=0.6, zorder=0.6)
    axes.fill_between(s, 0 * s, gap, **GAP)
    for at in np.arange(0.06, front, 0.12):
        _arrow(axes, (at, -0.26 * (1 - at / front) - 0.015), (at, 0), VERMILLION)
    _arrow(axes, (front + 0.32, 0.028), (front + 0.32, -0.17), BLACK)
    for at in (0.22, 0.36, 0.5):
        _arrow(axes, (wide + 0.2, at + 0.05), (wide, at), GREEN)
        _arrow(axes, (-0.2, at), (0, at), GREEN)
    _arrow(axes, (1.25, 0.57), (1.25, 0.42), GREEN)

    for x, y, text, colour, side in (
        (wide / 2, high + 0.1, r"$\Gamma_1$: clamped, $u=0$", BLACK, "center"),
        (0.24, 0.33, r"$\Omega$", BLACK, "center"),
        (0.75, 0.33, r"$\sigma=\mathcal{A}\varepsilon(\dot u)+\mathcal{G}\varepsilon(u)$", BLACK, "center"),
        (0.34, 0.075, r"$\Gamma_3$", BLUE, "center"),
        (wide + 0.03, 0.06, "gap $w$", BLUE, "left"),
        (0.33, -0.235, "pressure $p$", VERMILLION, "left"),
        (front + 0.36, -0.14, r"$\nu$", BLACK, "left"),
        (wide + 0.12, -0.15, "foundation", BLACK, "right"),
        (wide + 0.22, 0.41, r"$\Gamma_2$: $\sigma\nu=f_2$", GREEN, "left"),
        (-0.2, 0.14, r"$\Gamma_2$", GREEN, "left"),
        (1.28, 0.5, "$f_0$", GREEN, "left"),
    ):
        axes.text(x, y, text, color=colour, ha=side, va="center")
    axes.set(xlim=(-0.3, wide + 0.42), ylim=(-0.36, high + 0.14), aspect="equal")
    axes.axis("off")
    return figure


def _arrow(axes: Axes, start: tuple[float, float], end: tuple[float, float], colour: str) -> None:
    style: dict[str, Any] = {"arrowstyle": "-|>", "color": colour, "lw": 0.9, "mutation_scale": 6}
    axes.annotate("", end, start, arrowprops=style | {"shrinkA": 0, "shrinkB": 0})
