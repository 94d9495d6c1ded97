"""A drawing as PDF and SVG: ezdxf's drawing add-on draws it with matplotlib, at true scale."""

from __future__ import annotations

import io
import pathlib
from collections import defaultdict
from collections.abc import Iterable

import matplotlib as mpl
from ezdxf.addons.drawing.backend import BkPath2d, BkPoints2d
from ezdxf.addons.drawing.config import (
    BackgroundPolicy,
    ColorPolicy,
    Configuration,
    LinePolicy,
)
from ezdxf.addons.drawing.frontend import Frontend
from ezdxf.addons.drawing.matplotlib import MatplotlibBackend
from ezdxf.addons.drawing.properties import BackendProperties, RenderContext
from ezdxf.document import Drawing
from ezdxf.entities.dxfgfx import DXFGraphic
from ezdxf.fonts import fonts
from ezdxf.math import Vec2
from ezdxf.npshapes import to_matplotlib_path
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.path import Path

from camgeo.sheet.marks import Hatched, Sheet
from camgeo.sheet.section import hatching
from camgeo.units import MM_PER
from camgeo_export.drawing.document import FONT, HATCHING, LAYERS
from camgeo_export.plots.render import METADATA, RC

INCH = 25.4
POINTS = 72.0 / INCH
"""Points for each millimetre, in which matplotlib states widths of lines."""


def know_the_font() -> None:
    """Make our font known to ezdxf, which looks only at those of the system."""
    if not fonts.font_manager.has_font(FONT):
        folder = pathlib.Path(mpl.get_data_path()) / "fonts" / "ttf"
        fonts.font_manager.build([str(folder)], support_dirs=False)


class Collected(MatplotlibBackend):
    """Draws all lines of the same width at once, and all filled areas: a sheet has thousands.

    Everything is black, so the order does not matter.
    """

    def __init__(self, axes: Axes) -> None:
        super().__init__(axes, adjust_figure=False)
        self._lines: dict[float, list[Path]] = defaultdict(list)
        self._areas: list[Path] = []

    def draw_line(self, start: Vec2, end: Vec2, properties: BackendProperties) -> None:
        """Collect a line."""
        self._lines[self.get_lineweight(properties)].append(
            Path([(start.x, start.y), (end.x, end.y)])
        )

    def draw_solid_lines(
        self, lines: Iterable[tuple[Vec2, Vec2]], properties: BackendProperties
    ) -> None:
        """Collect lines."""
        for start, end in lines:
            self.draw_line(start, end, properties)

    def draw_path(self, path: BkPath2d, properties: BackendProperties) -> None:
        """Collect a curve."""
        self._lines[self.get_lineweight(properties)].append(to_matplotlib_path([path]))

    def draw_filled_paths(self, paths: Iterable[BkPath2d], properties: BackendProperties) -> None:
        """Collect letters, whose strokes may overlap: their sense tells what is a hole."""
        self._areas.append(to_matplotlib_path(paths))

    def draw_filled_polygon(self, points: BkPoints2d, properties: BackendProperties) -> None:
        """Collect a polygon."""
        corners = [(point.x, point.y) for point in points.vertices()]
        self._areas.append(Path([*corners, corners[0]], closed=True))

    def flush(self) -> None:
        """Draw what was collected, as artists that do not widen the limits of the axes: to find
        those of a patch takes matplotlib five times as long as to write it.
        """
        for width, paths in sorted(self._lines.items()):
            made = Path.make_compound_path(*paths)
            self.ax.add_artist(PathPatch(made, fill=False, linewidth=width, edgecolor="black"))
        if self._areas:
            made = Path.make_compound_path(*self._areas)
            self.ax.add_artist(PathPatch(made, linewidth=0.0, facecolor="black"))


def _is_no_hatch(entity: DXFGraphic) -> bool:
    """Whether an entity is left to ezdxf, which moves the lines of hatches by random distances."""
    return entity.dxftype() != "HATCH"


def _hatch(backend: Collected, sheet: Sheet) -> None:
    """Draw the lines of cut faces."""
    thin = BackendProperties(lineweight=LAYERS["HATCH"][2] / 100.0)
    for view in sheet.views:
        shift = (view.at - sheet.views[0].at) / sheet.scale
        for mark in view.marks:
            if isinstance(mark, Hatched):
                for ends in hatching(mark, HATCHING / sheet.scale):
                    moved = [(end + shift) / MM_PER[sheet.unit] for end in ends]
                    first, last = (Vec2(end.real, end.imag) for end in moved)
                    backend.draw_line(first, last, thin)


def page(document: Drawing, sheet: Sheet, kind: str) -> bytes:
    """The document as a file of `kind` "pdf" or "svg", of the sheet's size."""
    low = -sheet.views[0].at / sheet.scale / MM_PER[sheet.unit]
    paper = 1.0 / (sheet.scale * MM_PER[sheet.unit])
    with rc_context({**RC, "path.simplify": False, "axes.grid": False}):
        figure = Figure(figsize=(sheet.width / INCH, sheet.height / INCH))
        FigureCanvasAgg(figure)
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        context = RenderContext(document)
        config = Configuration(
            line_policy=LinePolicy.ACCURATE,
            color_policy=ColorPolicy.BLACK,
            background_policy=BackgroundPolicy.WHITE,
            lineweight_scaling=POINTS,
            min_lineweight=0.0,
        )
        backend = Collected(axes)
        Frontend(context, backend, config=config).draw_layout(
            document.modelspace(), finalize=False, filter_func=_is_no_hatch
        )
        _hatch(backend, sheet)
        backend.flush()
        axes.set_aspect("auto")
        axes.set_xlim(low.real, low.real + sheet.width * paper)
        axes.set_ylim(low.imag, low.imag + sheet.height * paper)
        stream = io.BytesIO()
        figure.savefig(stream, format=kind, metadata=METADATA[kind])
    return stream.getvalue()
