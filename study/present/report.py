"""The report page: one HTML file with ledger, tables, charts and animated cases, made from the data files of a run."""

import re
from base64 import b64encode
from collections.abc import Sequence
from io import BytesIO, StringIO
from itertools import repeat
from math import nan
from pathlib import Path

from markupsafe import Markup
from matplotlib import rcParams
from pandas import DataFrame
from PIL import Image

from study.ledger.datafiles import (
    by_claim,
    count_verdicts,
    expected_orders,
    read_claims,
    read_csv,
    read_rates,
)
from study.ledger.files import Json, write_text
from study.ledger.text import cell
from study.present import tables
from study.present.charts import enclosed_series
from study.present.drawing import Drawing, Output, RunMap, in_style
from study.present.figures import figure
from study.present.outcome import finest_orders, order_differences, orders_text, printed
from study.present.picture import Picture, read_picture
from study.present.show import film_images, image_of
from study.present.templates import counted, read_page, render, typeset

CHECKS = ["case", "quantity", "expected", "observed", "low", "high", "verdict"]
FRAME_STEP = 4
FRAME_DPI = 110
ZONE_DPI = 160
QUALITY = 25
"""Animations show every fourth time; dots per inch of their images and of contact zones; WebP quality, 0 to 100."""
WEB = Output("web")

PAGE_TEXTS = read_page("texts")
"""Texts of the page: ``meanings``, verdict ↦ its meaning, and ``letters``, table or place ↦ symbol ↦ its meaning."""


def write_report(directory: Path, provenance: Json, run_map: RunMap = map) -> Path:
    """Write the report page ``directory/report.html`` from the files in ``directory/data``, and return its path.

    Parameters:
        directory: the directory of a run.
        provenance: the content of ``data/provenance.json``, which the command has read and checked.
        run_map: ``map``, or the method ``map`` of an executor, which draws several cases at a time.

    Raises:
        StoreError: the directory cannot be written.
        DataError: a data file is missing, damaged or written by an older version; then nothing is written.
    """
    claims = read_claims(directory)
    rates = read_rates(directory)
    smooth = rates[rates.claim == "Prop. 5.4"]
    predicted = expected_orders(directory, rates)
    statements = provenance.get("statements", {})
    # A statement with the code files that judge it and its checks. A label with two statements gives two groups.
    groups: list[Json] = [
        dict(
            label=label,
            says=says,
            counts=count_verdicts(rows),
            judges=statements.get(label, {"code": []})["code"],
            rows=rows[CHECKS].to_numpy().tolist(),
        )
        for label, says, rows in by_claim(tables.all_checks(directory).map(cell))
    ]
    cases = case_pages(directory, claims, rates, run_map)
    counts = count_verdicts(claims)
    page = render(
        "page.html",
        PAGE_TEXTS,
        counts=counts,
        conclusion=printed("conclusion", count=counts, orders=orders_text(directory)),
        # The page opens with the 2D case that has the most contact faces.
        shown=max(cases, key=lambda case: (case["facts"]["dimension"] == 2) * case["faces"]),
        collapsed=svg_chart(figure("collapsed", smooth)) if len(smooth) else "",
        orders=svg_chart(figure("orders", rates, predicted)) if len(order_differences(rates, predicted)) else "",
        groups=groups,
        cases=cases,
        bounds=tables.bounds(directory),
        faults=tables.faults(directory),
        provenance=provenance,
    )
    return write_text(directory / "report.html", f"{page}\n")


def case_pages(directory: Path, claims: DataFrame, rates: DataFrame, run_map: RunMap) -> list[Json]:
    """Return the texts, pictures and tables of each case on the report page, in the order of ``cases.csv``.

    The entries of a case are

    * ``name``; ``facts``, the properties of the case; ``counts``, the number of checks with each verdict;
    * ``observed``: the smallest and the largest observed order as text;
    * the pictures of ``draw_case``; ``tables`` with their captions.

    Parameters:
        directory: the directory of a run.
        claims, rates: the contents of ``claims.csv`` and ``rates.csv``.
        run_map: ``map``, or the method ``map`` of an executor, which draws several cases at a time.

    Raises:
        DataError: a data file is missing or damaged.
    """
    enclosures = read_csv(directory, "enclosures.csv")
    shown = [
        ("Errors on every mesh", tables.rates(directory)),
        ("The stress problem on its own space", tables.stresses(directory)),
        ("The stress problem on the strains of V^h", tables.equivalence(directory)),
        ("Bounds of the error", tables.bounds(directory)),
    ]
    pages = []
    cases = read_csv(directory, "cases.csv")
    # No order is proved for some cases, which the template writes as an empty text.
    for fact in cases.replace({"proved_order": {nan: None}}).to_dict("records"):
        name = fact["case"]
        errors = rates[rates.case == name]
        orders = sorted(finest_orders(errors, refinements=2).values())
        charts = [figure("convergence", errors, fact["expected_order"], name=name)] if len(errors) else []
        enclosed = enclosed_series(enclosures[enclosures.case == name])
        charts += [figure("enclosure", rows, title, name=title) for _, rows, title in enclosed]
        of_case = [(caption, table.of_case(name)) for caption, table in shown]
        pages.append(
            dict(
                name=name,
                facts=fact,
                counts=count_verdicts(claims[claims.case == name]),
                observed=" – ".join(dict.fromkeys(f"{order:.3f}" for order in orders[:1] + orders[-1:])),
                charts=charts,
                tables=[(caption, table) for caption, table in of_case if table.rows],
            )
        )
    pictures = run_map(draw_case, repeat(directory), cases.case, [page["charts"] for page in pages])
    return [page | drawn for page, drawn in zip(pages, pictures, strict=True)]


def draw_case(directory: Path, case: str, charts: Sequence[Drawing]) -> Json:
    """Return the pictures of a case, ``charts``, ``frames`` and ``zone``, and its number of contact ``faces``.

    ``charts`` are texts in HTML. ``frames`` are the images of the animation, each as a pair: a text for readers who
    cannot see it, and a data URL, which contains the image. ``zone`` is the picture of the contact zone, as a pair of
    its caption and a data URL.

    Parameters:
        directory: the directory of a run.
        case: the name of the case.
        charts: the charts of the case, not drawn yet.

    Raises:
        DataError: the file of the case is missing or damaged, or an older version wrote it without displacements over
            time.
    """
    picture = read_picture(directory, case)
    film = picture.at_every(FRAME_STEP)
    drawing = figure("zone" if picture.segments else "fronts", picture)
    with in_style(WEB):
        images = film_images(film, FRAME_DPI, upright=True)
        frames = [(_frame_text(film, at), _address(image)) for at, image in zip(film.shown, images, strict=True)]
        zone = drawing.caption, _address(image_of(drawing.draw(), ZONE_DPI))
    return dict(charts=[*map(svg_chart, charts)], faces=len(picture.faces), frames=frames, zone=zone)


def _frame_text(picture: Picture, instant: int) -> str:
    """Return the text for readers who cannot see an image of an animation."""
    touching = sum(face.touching[instant].sum() for face in picture.faces)
    return f"t = {picture.times[instant]:.3g}, {counted(touching, 'node')} in contact"


def _address(image: Image.Image) -> str:
    """Return a data URL that contains an image."""
    content = BytesIO()
    image.save(content, "WEBP", quality=QUALITY, method=6)
    return f"data:image/webp;base64,{b64encode(content.getvalue()).decode('ascii')}"


def svg_chart(drawing: Drawing) -> Markup:
    """Return a figure with its caption in HTML.

    Parameters:
        drawing: the figure. No other figure of the page may have its name, from which ids in the SVG are made.
    """
    content = StringIO()
    with in_style(WEB):
        rcParams["svg.fonttype"] = "none"
        rcParams["svg.hashsalt"] = drawing.name
        drawing.draw().savefig(content, format="svg")
    image = content.getvalue()
    image = image[image.index("<svg") :]
    # Matplotlib gives elements of two figures the same names, and writes its version and unnecessary digits.
    image = re.sub(r'(?s)<metadata>.*?</metadata>| id="[a-zA-Z0-9.]+_\d+"|<!--.*?-->', "", image)
    image = re.sub(r"(\.\d\d)\d+", r"\1", re.sub(r"\n\s*", "\n", image))
    image = image.replace("<svg", Markup('<svg role="img" aria-label="{}"').format(drawing.summary), 1)
    template = Markup('<figure class="chart">\n{}<figcaption>{}</figcaption>\n</figure>\n')
    return template.format(Markup(image), typeset(drawing.caption))
