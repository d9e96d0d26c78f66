"""The gallery: every case of the catalogue with its film, prediction and measured orders.

Thumbnails and films are drawn from ``results/data/pictures``, numbers come from ``results/data``; nothing is solved. A
picture is drawn again only if its data have changed. With FILMS=no in the environment films are left out, which saves
minutes while a page is written.
"""

import hashlib
import os
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from sphinx.application import Sphinx

from manufactured.case import Case
from manufactured.catalogue import MODULES, catalogue, function_of
from study.ledger.datafiles import read_csv
from study.present.body import BodyScale, draw_deformed_mesh
from study.present.drawing import in_style
from study.present.picture import Picture, picture_path, read_record
from study.present.show import write_gif
from study.present.templates import typeset

INSTRUCTIVE = (
    "advance-recede",
    "merging-patches",
    "hexagon",
    "cube-disc",
    "parabolic-gap",
    "rough-1.75",
    "yield-on-a-part",
    "layered",
)
"""The cases that come first: moving fronts, several faces, space, a gap, a rough solution, and other laws."""
CHOICES = {
    "dimension": ("dim", {"2": "2", "3": "3"}),
    "law": ("law", {"linear": "linear", "nonlinear": "nonlinear"}),
    "moving front": ("front", {"yes": "yes", "no": "no"}),
    "predicted order": ("order", {"one": "1", "less": "below 1"}),
}
"""The properties by which cases are chosen: label ↦ (key, value ↦ text); ``chosen_by`` has the values of a case."""
DOCS = Path(__file__).parents[1]
ROOT = DOCS.parent
GENERATED = DOCS / "generated"


def drawn_once(data: Path, suffix: str, draw: Callable[[Path, Picture], object]) -> str:
    """Draws a picture unless it exists; returns its file name, which contains a hash of the data."""
    name, content = data.name.partition(".json")[0], data.read_bytes()
    image = GENERATED / "films" / f"{name}-{hashlib.sha256(content).hexdigest()[:8]}.{suffix}"
    if not image.exists():
        image.parent.mkdir(parents=True, exist_ok=True)
        with in_style():
            draw(image, Picture(read_record(data)).at_every(1))
    return image.name


def write_film(path: Path, picture: Picture) -> None:
    write_gif(path, picture, lambda: None)


def write_thumbnail(path: Path, picture: Picture) -> None:
    """Writes the deformed body at the time of the largest contact pressure."""
    largest = [max(float(face.pressure[n].max()) for face in picture.faces) for n in picture.shown]
    instant = picture.shown[largest.index(max(largest))]
    figure = Figure(figsize=(2.0, 1.6), dpi=150)
    axes = figure.subplots()
    # The colours and the scale of this time alone: a film has to show the largest values of all times.
    picture = picture.showing([instant])
    draw_deformed_mesh(axes, picture, instant, BodyScale(picture), 2.0)
    FigureCanvasAgg(figure).print_png(path)


def orders(case: Case) -> str:
    """The orders over the last two refinements, over all mesh families."""
    rates = read_csv(ROOT / "results", "rates.csv", ["case", "family", "level", "h", "error"])
    logs = np.log(rates.set_index("family").loc[rates["case"].to_numpy() == case.name, ["h", "error"]])
    steps = logs.groupby("family").diff(2).groupby("family").last()
    found = steps["error"] / steps["h"]
    return f"{found.min():.2f} to {found.max():.2f}"


def chosen_by(case: Case) -> dict[str, str]:
    """Returns the properties by which a case can be chosen; the script of the page reads them from the class names."""
    return {
        "dim": str(case.solution.body.dim),
        "law": "linear" if case.solution.law.name.startswith("linear") else "nonlinear",
        "front": "yes" if case.regularity.moving else "no",
        "order": "one" if case.order == 1 else "less",
    }


def choice() -> str:
    """Returns the selection lists above the cards; gallery.js reads them."""
    lists = []
    for label, (key, values) in CHOICES.items():
        options = "".join(f'<option value="{value}">{text}</option>' for value, text in {"": "all", **values}.items())
        lists.append(f'<label>{label} <select data-key="{key}">{options}</select></label>')
    return "\n".join(
        ['<div class="filter" role="group" aria-label="Choose cases">', *lists, "<output></output>", "</div>\n"]
    )


def sentence(case: Case) -> str:
    """Returns the summary of a case with a capital letter and typeset formulas."""
    return str(typeset(case.summary[0].upper() + case.summary[1:]))


def card(case: Case, thumbnail: str) -> str:
    """Returns the card of a case: picture and name, with a link to its entry."""
    classes = " ".join(f"{key}-{value}" for key, value in chosen_by(case).items())
    return f"""::::{{grid-item-card}} {case.name}
:img-top: /generated/films/{thumbnail}
:img-alt: Deformed body on its foundation, {case.summary}
:link: "#{re.sub(r"[^a-z0-9]+", "-", case.name)}"
:class-item: case {classes}
::::
"""


def entry(case: Case, film: str) -> str:
    """Returns the entry of a case: film, summary, orders, and a link to the function with its formulas."""
    return f"""### {case.name}

```{{image}} /generated/films/{film}
:alt: Film of the deforming body and of its contact pressure, {case.summary}
:class: film
:loading: lazy
```

{sentence(case)}. Law: {case.solution.law.name}.
Predicted order {case.order:.3g}: {typeset(case.reason)}. Observed: {orders(case)}.
Formulas: [`{function_of(case.name)}`](../manufactured/cases/{MODULES[case.name]}.py)
"""


def write_gallery(app: Sphinx) -> None:
    every = {case.name: case for case in catalogue()}
    cases = [every[name] for name in dict.fromkeys([*INSTRUCTIVE, *every])]
    cards, entries = [], []
    for case in cases:
        data = picture_path(ROOT / "results", case.name)
        thumbnail = drawn_once(data, "png", write_thumbnail)
        cards.append(card(case, thumbnail))
        film = thumbnail if os.environ.get("FILMS") == "no" else drawn_once(data, "gif", write_film)
        entries.append(entry(case, film))
    grid = ":::::{grid} 2 3 4 4\n:gutter: 2\n:class-container: cases\n\n" + "".join(cards) + ":::::\n"
    text = f"{choice()}\n{grid}\n" + "\n".join(entries)
    (GENERATED / "gallery.md").write_text(text, encoding="utf-8")


def setup(app: Sphinx) -> dict[str, bool]:
    app.connect("builder-inited", write_gallery)
    return {"parallel_read_safe": True}
