"""Draws the matrix of faults: rows are faults by equation, columns are cases, the shade says what notices the fault."""

import pandas as pd
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from manufactured.colours import BLUE, DARK, GREY, SKY
from study.ledger.faults import INVISIBLE
from study.present.drawing import dots, legend, page_width

ABSENT, UNNOTICED, BY_OTHERS, BY_ERRORS_IF_LARGE, BY_ERRORS = range(5)
SHADES = {
    BY_ERRORS: (BLUE, "by errors, at the smallest size"),
    BY_ERRORS_IF_LARGE: (SKY, "by errors, at a larger size"),
    BY_OTHERS: ("#D6E6F2", "by other checks only"),
    UNNOTICED: ("#FFFFFF", "by no check"),
    ABSENT: ("#EEEEEE", "cannot occur"),
}
"""What notices a fault in a case ↦ the colour of the cell and its text in the legend."""
ROW, MARGIN = 0.155, 1.9
"""Height of a row and of the margins above and below the rows, in inches."""


def shade(rows: pd.DataFrame) -> int:
    """Return what notices a fault in a case, from the rows of the matrix for all sizes of the fault."""
    smallest = rows.loc[rows["size"].abs().idxmin()]
    if smallest["by_error"] != "":
        return BY_ERRORS
    if (rows["by_error"] != "").any():
        return BY_ERRORS_IF_LARGE
    return BY_OTHERS if (rows["by_others"] != "").any() else UNNOTICED


def draw_faults(matrix: pd.DataFrame) -> Figure:
    """Draw the matrix of faults.

    Parameters:
        matrix: the table ``faults.csv``.
    """
    faults, cases = matrix["fault"].unique().tolist(), matrix["case"].unique().tolist()
    shades = pd.DataFrame(ABSENT, faults, cases)
    invisible = []
    for (fault, case), rows in matrix.groupby(["fault", "case"], sort=False):
        shades.loc[fault, case] = shade(rows)
        if (rows["distance"] < INVISIBLE * rows["error"]).all():
            invisible.append((cases.index(case), faults.index(fault)))
    figure = Figure(figsize=(page_width(), MARGIN + ROW * len(faults)), layout="constrained")
    axes = figure.subplots()
    colours = ListedColormap([SHADES[level][0] for level in sorted(SHADES)])
    axes.pcolormesh(
        shades.to_numpy(), cmap=colours, vmin=-0.5, vmax=len(SHADES) - 0.5, edgecolors="white", linewidth=0.5
    )
    if invisible:
        x, y = zip(*invisible, strict=True)
        axes.plot([place + 0.5 for place in x], [place + 0.5 for place in y], ".", color=GREY, markersize=3)
    axes.invert_yaxis()
    axes.set_xticks([n + 0.5 for n in range(len(cases))], cases, rotation=90)
    equations = matrix.drop_duplicates("fault").set_index("fault")["equation"]
    axes.set_yticks([n + 0.5 for n in range(len(faults))], [f"{fault}   {equations[fault]}" for fault in faults])
    axes.tick_params(length=0, labelsize="x-small")
    patches = [Patch(facecolor=colour, edgecolor=DARK, linewidth=0.3, label=text) for colour, text in SHADES.values()]
    legend(figure, [*patches, dots("invisible", marker=".", color=GREY)], 3, "upper", wide=True)
    return figure


def caption_faults(matrix: pd.DataFrame) -> str:
    """Return the caption of the matrix of faults."""
    by_fault = matrix[matrix["by_error"] != ""].groupby("fault")["case"].nunique()
    never = [fault for fault in matrix["fault"].unique() if fault not in by_fault]
    fewest = by_fault.min()
    told = f"errors notice every fault, in {fewest} cases or more" if fewest > 1 else "errors notice every fault"
    if never:
        told = f"errors notice all faults but {len(never)}: {', '.join(never)}"
    return (
        f"Deliberate faults of the program (rows, with the equation that they violate) and cases (columns). The shade "
        "says which checks fail. A dot: the fault does not change the discrete solution of this case. "
        f"What to see: {told}."
    )
