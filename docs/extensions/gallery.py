"""The gallery: every case of the catalogue with its film, formulas, prediction and measured orders.

Films are drawn from ``results/data/pictures``, numbers come from ``results/data``; nothing is solved. A film is drawn
again only if its picture has changed.
"""

import hashlib
import inspect
import json
import re
import sys
from pathlib import Path

from formulas import prose, with_formulas
from sphinx.application import Sphinx

from manufactured.case import Case
from manufactured.catalogue import catalogue
from study.ledger.datafiles import read_csv
from study.present.drawing import in_style
from study.present.picture import with_every_shape
from study.present.show import write_gif

HEAD = """The films show every exact solution of the catalogue, computed on one mesh with n cells along a unit length.
One part shows the body with the contact pressure; its displacement is multiplied by the factor in the legend. The other
part shows the pressure along the contact face, exact (line) and computed (dots), over the exact contact zone (blue). A
body in space is turned so that its contact faces can be seen through the foundation. Its maps show the contact faces
from inside the body: the exact pressure as a surface, and the computed pressure as dots in the same colours, which are
invisible if both agree.

A and G are the viscosity tensor and the elasticity tensor of the law; α and m are the exponents of gap and pressure at
a contact front; (5.36) is the smoothness that Proposition 5.4 assumes. [A first exact
solution](/tutorials/first-solution.md) shows how to evaluate a case. [How the exact solutions are
made](/explanation/exact-solutions.md) explains the exponents, and [Notation](/explanation/notation.md) lists the
letters.
"""
DOCS = Path(__file__).parents[1]
ROOT = DOCS.parent


def draw_film(picture: Path, directory: Path) -> str:
    """Draws the film of a picture unless it exists; returns its file name, which contains a hash of the picture."""
    text = picture.read_bytes()
    film = directory / f"{picture.stem}-{hashlib.sha256(text).hexdigest()[:8]}.gif"
    if not film.exists():
        directory.mkdir(parents=True, exist_ok=True)
        with in_style():
            write_gif(film, with_every_shape(json.loads(text)), lambda: None)
    return film.name


def orders(case: Case) -> str:
    """The last consecutive orders measured, over all mesh families."""
    rates = read_csv(ROOT / "results", "rates.csv", ["case", "family", "level", "order"])
    mine = rates[rates["case"] == case.name].dropna(subset=["order"]).sort_values("level")
    last = mine.groupby("family")["order"].last()
    return f"{last.min():.2f} … {last.max():.2f}"


def formulas(case: Case) -> tuple[str, str, str]:
    """Module, formulas and prediction of a case, from the docstring of the module."""
    stem = re.sub(r"\W", "_", case.name)
    module = sys.modules[f"manufactured.cases.{stem}"]
    text = inspect.getdoc(module) or ""
    title, *rest = text.split("\n\n")
    lifted = "\n\n".join(rest)
    return f"manufactured.cases.{stem}", title, with_formulas(lifted)


def entry(case: Case, film: str) -> str:
    module, title, body = formulas(case)
    return f"""## {case.name}

```{{image}} /generated/films/{film}
:alt: {case.summary}
:class: film
:loading: lazy
```

{case.summary[0].upper()}{case.summary[1:]}. Law: {case.solution.law.name}. Regularity: {prose(str(case.regularity))}.

Predicted order {case.order:g}: {prose(case.reason)}. Last orders measured: {orders(case)}.

```{{dropdown}} Formulas
{prose(title)}

{body}
```

`named("{case.name}")`, written in {{api}}`{module.replace(".", "/")}.py <{module}>`.
"""


def write_gallery(app: Sphinx) -> None:
    directory = Path(app.srcdir) / "generated"
    pages = [
        entry(case, draw_film(ROOT / "results" / "data" / "pictures" / f"{case.name}.json", directory / "films"))
        for case in catalogue()
    ]
    (directory / "gallery.md").write_text(f"# Gallery\n\n{HEAD}\n" + "\n".join(pages), encoding="utf-8")


def setup(app: Sphinx) -> dict[str, bool]:
    app.connect("builder-inited", write_gallery)
    return {"parallel_read_safe": True}
