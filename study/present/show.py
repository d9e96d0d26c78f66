"""The files of ``study show``: a storyboard and an animation of one case, and files for ParaView."""

import shutil
from collections.abc import Callable, Iterator
from functools import partial
from importlib import import_module
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement, indent, tostring

import meshio  # type: ignore[import-untyped]
import numpy as np
from matplotlib import rcParams
from matplotlib.animation import FFMpegWriter
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from PIL import Image

from manufactured.colours import BLACK, SKY, VERMILLION
from study.ledger.files import Json, Paths, write_text, write_whole
from study.ledger.pictures import Array, Numbers
from study.present.body import (
    NEGLIGIBLE_CONTACT,
    NODES,
    BodyScale,
    draw_deformed_mesh,
    draw_keys,
    draw_map,
    draw_profile,
    draw_shapes,
    ramp,
)
from study.present.drawing import RIM, column_width, dots, entry, in_style, page_width
from study.present.picture import FaceHistory, Picture, Polygon, Segment

MOMENTS = 6
COLUMNS = 3
"""The number of images of the storyboard, and the number of its columns."""
STORYBOARD_DPI = 200
FILM_DPI = 110
GIF_COLOURS = 128
"""The number of colours of a GIF; with much fewer colours, small arrows get the colour of the stress around them."""
PER_SECOND = 8
HOLD = 1000
"""The frames per second of animations, and the milliseconds for which a GIF shows its last frame."""
Fields = dict[str, Array]
TimeSeries = list[tuple[float, meshio.Mesh]]
"""Times, and a mesh with its fields at each time."""

NO_FFMPEG = "ffmpeg is missing: install it, or `python -m pip install imageio-ffmpeg`, and run the command again"


def draw_show(
    record: Json, series: TimeSeries, directory: Path, notify: Callable[[], object]
) -> tuple[Paths, list[str]]:
    """Write ``storyboard.png``, ``animation.gif``, ``animation.mp4`` and ``vtk/`` into a directory.

    Parameters:
        record: the data of the run, as in ``data/pictures/CASE.json.gz``.
        series: the mesh with the fields for ParaView.
        directory: the directory.
        notify: function that is called after each image: the storyboard, and a frame for each time.

    Returns:
        The files that were written; and the files that were left out, with the reasons. The animation in MP4 needs
        ffmpeg.

    Raises:
        StoreError: the directory cannot be written.
    """
    picture = Picture(record).at_every(1)
    with in_style():
        storyboard = draw_storyboard(picture)
        storyboard.set_dpi(STORYBOARD_DPI)
        draw = partial(FigureCanvasAgg(storyboard).print_png, metadata={"Software": None})
        written = [write_whole(directory / "storyboard.png", draw)]
        notify()
        written.append(write_gif(directory / "animation.gif", picture, notify))
        mp4 = write_mp4(directory / "animation.mp4", picture)
    left_out = []
    if mp4:
        written.append(mp4)
    else:
        (directory / "animation.mp4").unlink(missing_ok=True)  # It would show an earlier measurement.
        left_out.append(f"animation.mp4: {NO_FFMPEG}")
    return [*written, *write_vtk(directory / "vtk", picture.case, series)], left_out


def draw_storyboard(picture: Picture) -> Figure:
    """Draw the deformed body with stress and contact at ``MOMENTS`` times, evenly spaced from the first to the last."""
    picture = picture.showing(np.linspace(0, len(picture.times) - 1, MOMENTS).round().astype(int).tolist())
    rows = MOMENTS // COLUMNS
    width = (page_width() - 0.8) / COLUMNS
    figure = Figure(figsize=(page_width(), 0.8 + rows * (0.2 + width * BodyScale(picture).aspect)))
    draw_shapes(figure, figure.subplots(rows, COLUMNS).ravel(), picture, width, 4, fraction=0.04, shrink=0.8)
    return figure


def write_gif(
    path: Path, picture: Picture, notify: Callable[[], object], dpi: int = FILM_DPI, colours: int = GIF_COLOURS
) -> Path:
    """Write an animated GIF with a frame for each time in ``picture.shown``.

    Parameters:
        path: the file.
        picture: the data of the run.
        notify: function that is called after each frame.
        dpi: dots per inch.
        colours: the number of colours.
    """
    images = []
    for image in film_images(picture, dpi):
        images.append(image)
        notify()
    # All frames share a few colours, without dither, so that parts that do not move are stored once.
    together = Image.fromarray(np.concatenate([np.asarray(image) for image in images]))
    palette = together.quantize(colours, dither=Image.Dither.NONE)
    first, *others = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images]
    times = [1000 // PER_SECOND] * len(others) + [HOLD]

    def write(part: Path) -> None:
        first.save(part, "GIF", save_all=True, append_images=others, optimize=True, duration=times, loop=0)

    return write_whole(path, write)


def find_ffmpeg() -> str | None:
    """Return the path of the program ffmpeg; None if neither the system nor the package imageio-ffmpeg has it."""
    if system := shutil.which("ffmpeg"):
        return system
    try:
        return import_module("imageio_ffmpeg").get_ffmpeg_exe()
    except (ImportError, RuntimeError):
        return None


def write_mp4(path: Path, picture: Picture) -> Path | None:
    """Write an animation as MP4, with a frame for each time in ``picture.shown``, and return its path.

    Without ffmpeg nothing is written, and the result is None.
    """
    ffmpeg = find_ffmpeg()
    if not ffmpeg:
        return None
    rcParams["animation.ffmpeg_path"] = ffmpeg
    frames = _frames(picture, FILM_DPI)
    # The file has a temporary name that does not tell ffmpeg the format.
    writer = FFMpegWriter(fps=PER_SECOND, extra_args=["-f", "mp4"])

    def write(part: Path) -> None:
        with writer.saving(next(frames), str(part), FILM_DPI):
            writer.grab_frame()
            for _ in frames:
                writer.grab_frame()

    return write_whole(path, write)


def film_images(picture: Picture, dpi: int, upright: bool = False) -> Iterator[Image.Image]:
    """Yield the frames of an animation, one for each time in ``picture.shown``.

    Parameters:
        picture: the data of the run.
        dpi: dots per inch.
        upright: whether the pressure is drawn below the body, not beside it, and the body without the edges of its
            mesh, which would take most of the size of a frame.
    """
    for figure in _frames(picture, dpi, upright):
        yield image_of(figure, dpi)


def image_of(figure: Figure, dpi: int) -> Image.Image:
    """Draw a figure into an image."""
    figure.set_dpi(dpi)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")


def _film_axes(picture: Picture, dpi: int, upright: bool) -> tuple[Figure, Axes, Array]:
    """Return an empty figure for an animation, its axes for the body, and its axes for each contact face."""
    faces = len(picture.faces)
    aspect = min(BodyScale(picture).aspect, 1.2)
    if upright:
        # In inches. In 3D there is one more colour bar, and the legend has a single column.
        face, keys = (2.4, 2.6) if picture.polygons else (1.1, 1.6)
        heights = 3.2 * aspect, face * faces
        figure = Figure(figsize=(column_width(), keys + sum(heights)), dpi=dpi)
        grid = figure.add_gridspec(2, 1, height_ratios=heights)
    else:
        height = max(0.45 * page_width() * aspect, 1.2 * faces)
        figure = Figure(figsize=(page_width(), 1.2 + height), dpi=dpi)
        grid = figure.add_gridspec(1, 2, width_ratios=(3, 2))
    FigureCanvasAgg(figure)
    body = figure.add_subplot(grid[0])
    return figure, body, grid[1].subgridspec(faces, 1).subplots(squeeze=False)[:, 0]


def _frames(picture: Picture, dpi: int, upright: bool = False) -> Iterator[Figure]:
    """Draw the frames of an animation one after the other: the body, and the pressure on its contact faces.

    The parameters are those of ``film_images``.

    Yields:
        The figure, which is the same for all frames, after each frame, so that the caller can save the frame.
    """
    figure, body, panels = _film_axes(picture, dpi, upright)
    scale = BodyScale(picture)
    columns = (1 if picture.polygons else 2) if upright else 4
    draw_keys(
        figure,
        [body],
        picture,
        scale,
        columns,
        _pressure_handles(picture),
        orientation="horizontal",
        fraction=0.05,
        shrink=0.8,
        pad=0.02,
    )
    for instant in picture.shown:
        body.clear()
        draw_deformed_mesh(body, picture, instant, scale, 0.5 * page_width(), lines=not upright)
        for axes, face in zip(panels, picture.faces, strict=True):
            axes.clear()
            _draw_pressure(axes, face, picture, instant, scale)
        figure.suptitle(f"{picture.heading},  $t={picture.times[instant]:.2f}$")
        if instant == picture.shown[0]:
            # Later frames keep the layout of the first frame, so that nothing jumps.
            figure.canvas.draw()
            figure.set_layout_engine("none")
        yield figure


def _pressure_handles(picture: Picture) -> list[Artist]:
    """Return the legend entries of the pressure: lines in 2D, surfaces in 3D."""
    if not picture.polygons:
        return [
            entry("exact pressure", color=BLACK, lw=0.9),
            dots("computed pressure", color=VERMILLION, **NODES),
            Patch(color=SKY, alpha=0.35, lw=0, label="exact contact zone"),
        ]
    colour = ramp("pressure", 9)(3)
    return [
        Patch(color=colour, lw=0, label="exact pressure"),
        dots("computed pressure, same colours", mfc=colour, mec=RIM, mew=0.4, ms=3.4),
        entry("exact front", color=VERMILLION, lw=1.0),
    ]


def _draw_pressure(axes: Axes, face: FaceHistory, picture: Picture, instant: int, scale: BodyScale) -> None:
    """Draw exact and computed pressure on a contact face with the exact contact zone, at the time of index ``instant``.

    The exact pressure is a line in 2D and a surface in 3D; dots are computed pressures.
    """
    name = picture.symbol(face)
    if isinstance(face, Polygon):
        draw_map(axes, face, instant, scale.pressure or 1.0)
        axes.set(xlabel="$s_1$", ylabel=f"$s_2$ on {name}")
        return
    assert isinstance(face, Segment)
    for start, end in face.exact_zone(face.times[instant]):
        axes.axvspan(start, end, color=SKY, alpha=0.35, lw=0)
    draw_profile(axes, face, face.line_pressure[instant], face.pressure[instant], VERMILLION)
    top = max(face.pressure.max(), face.line_pressure.max())
    axes.set(ylim=(0, 1.08 * top if top > NEGLIGIBLE_CONTACT else 1), xlabel=f"$s$ on {name}", ylabel="pressure $p$")


def write_vtk(directory: Path, name: str, series: TimeSeries) -> Paths:
    """Write the files ``name-000.vtu``, ``name-001.vtu``, …, one for each time, and ``name.pvd``, which lists them.

    Parameters:
        directory: the directory of the files.
        name: the beginning of the file names.
        series: the times, and the mesh with its fields at each time.

    Returns:
        The paths of the files, with ``name.pvd`` first.
    """
    root = Element("VTKFile", type="Collection", version="0.1", byte_order="LittleEndian")
    collection = SubElement(root, "Collection")
    files = []
    for number, (time, mesh) in enumerate(series):
        files.append(write_whole(directory / f"{name}-{number:03d}.vtu", partial(mesh.write, file_format="vtu")))
        SubElement(collection, "DataSet", timestep=f"{time:.12g}", group="", part="0", file=files[-1].name)
    indent(root)
    text = tostring(root, encoding="unicode", xml_declaration=True) + "\n"
    return [write_text(directory / f"{name}.pvd", text), *files]


def vtk_mesh(vertices: Array, cells: Numbers, at_vertices: Fields, in_cells: Fields) -> meshio.Mesh:
    """Return an undeformed mesh with fields for ParaView.

    In 2D, vectors and matrices are padded with zeros to three components. So σ_33 is written as 0, although it is not
    known.

    Parameters:
        vertices: coordinates of the vertices, (d, vertices).
        cells: vertex numbers of the triangles or tetrahedra, (d + 1, cells).
        at_vertices: name ↦ scalars, (vertices,), or vectors, (d, vertices); NaN at vertices without a value.
        in_cells: name ↦ scalars, (cells,), or matrices, (d, d, cells).
    """
    return meshio.Mesh(
        _padded(vertices),
        [({2: "triangle", 3: "tetra"}[len(vertices)], cells.T)],
        point_data={name: _padded(values) for name, values in at_vertices.items()},
        cell_data={name: [_padded(values)] for name, values in in_cells.items()},
    )


def _padded(values: Array) -> Array:
    """Return values with three components, padded with zeros and point by point.

    Scalars, (n,), are unchanged; vectors (d, n) become (n, 3), matrices (d, d, n) become (n, 9).
    """
    components = values.shape[:-1]
    padded = np.pad(values, [*((0, 3 - d) for d in components), (0, 0)])
    return np.moveaxis(padded, -1, 0).reshape(values.shape[-1], -1) if components else values
