"""The effects that a scene names over the cam angle, with their limits, and shock spectra."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import cycle
from typing import TYPE_CHECKING, Final, Protocol

import numpy as np

from camgeo.design.product import Product
from camgeo.dynamics.oscillator.steady import QUIET
from camgeo.errors import EffectError
from camgeo.kinematics.plan import breaks
from camgeo.numeric.arrays import FloatArray, merged
from camgeo.pictures.model import (
    BOTTOM,
    LEFT,
    LIMIT_STYLE,
    LINE,
    MARGINS,
    RIGHT,
    TOP,
    ZERO,
    Axis,
    Figure,
    Frame,
    Legend,
    Line,
    Mark,
    Panel,
    Rule,
    Size,
    Style,
    Text,
    cam_angles,
    entries,
    grid,
    joint_marks,
    limits,
    over,
    turn_axis,
)
from camgeo.units import TURN, LengthUnit, listed, unit_and_divisor

if TYPE_CHECKING:
    from camgeo.dynamics.effects.effect import Column
    from camgeo.dynamics.effects.graph import Effects


WIDTH: Final = 7.0
"""Width of the figure [inch]."""

PANEL: Final = 1.7
"""Height of a panel [inch]."""

ROWS: Final = 7
"""Largest number of panels one above the other, as many as a screen shows; others are in further
columns."""

NARROW, COLUMN_GAP = 4.2, 1.0
"""Width of a panel if there are several columns, and the gap between columns [inch]."""

GAP: Final = 0.2
"""Gap between panels one above the other [inch], with room for a power of ten."""

NAME_PLACE: Final = 0.6
"""Distance of the names of the vertical axes to the left of these [inch]."""

PLAIN: Final = (-3, 5)
"""Powers of ten between which numbers are written in full; longer ones would overlap the name."""

ABREAST: Final = (3, 2)
"""Largest number of curve names in a row: with one column of panels, and with several."""

HEADROOM: Final = 0.17
"""Space above the curves for each row of names, as a fraction of their range."""

CURVES: Final = (
    Style(LINE),
    Style("#c27c0e", dashes=(6.0, 1.5)),
    Style("#3f8f6b", dashes=(4.0, 1.5, 1.0, 1.5)),
    Style("#7a7a7a", dashes=(1.0, 1.0)),
)
"""Styles of the curves of a panel, which has no more curves than there are styles."""


def figure(product: Product, size: Size | None = None) -> Figure:
    """The columns of all effects; adjacent ones of equal unit share a panel, ordered downwards.

    Curves jump where the effects do: both sides of joints of the motion and of breaks of the
    effects are drawn.
    """
    groups = panels(product.columns())
    count = max(1, len(groups))
    columns = -(-count // ROWS)
    rows = -(-count // columns)
    if size is None:
        across = LEFT + RIGHT + columns * NARROW + (columns - 1) * COLUMN_GAP
        width = WIDTH if columns == 1 else across
        size = width, TOP + rows * PANEL + (rows - 1) * GAP + BOTTOM
    panel = (size[0] - LEFT - RIGHT - (columns - 1) * COLUMN_GAP) / columns
    grid_frames = grid(size, MARGINS, rows, columns, (GAP / PANEL, COLUMN_GAP / panel))
    # Frames are in order of rows, while panels are read downwards.
    frames = [
        grid_frames[row * columns + column] for column in range(columns) for row in range(rows)
    ]
    title = f"{product.name}: effects"
    if not groups:
        words = "no effect in the scene has values over the cam angle"
        whole = Axis((0.0, 1.0))
        text = Text(words, (0.5, 0.5), 9.0, across="center")
        return Figure(size, (Panel(frames[0], whole, whole, (text,), title, bare=True),))
    places = np.array([joint.cam_angle for joint in breaks(product.cam.drive.plan)])
    abreast = ABREAST[min(columns, 2) - 1]
    # The lowest panel of each column has the numbers of the cam angle.
    ends = {*range(rows - 1, count, rows), count - 1}
    effect_panels = tuple(
        _panel(product, frame, group, places, last=number in ends, abreast=abreast)
        for number, (frame, group) in enumerate(zip(frames, groups, strict=False))
    )
    if columns == 1:
        return Figure(size, (replace(effect_panels[0], title=title), *effect_panels[1:]))
    title_place = 0.5, 1.0 - 0.1 / size[1]
    return Figure(
        size, effect_panels, (Text(title, title_place, 11.0, "figure", across="center", up="top"),)
    )


def panels(columns: Sequence[Column]) -> list[list[Column]]:
    """The columns in groups of adjacent ones with equal unit, at most one per curve style."""
    groups: list[list[Column]] = []
    for column in columns:
        if groups and groups[-1][0].unit == column.unit and len(groups[-1]) < len(CURVES):
            groups[-1].append(column)
        else:
            groups.append([column])
    return groups


def _panel(
    product: Product,
    frame: Frame,
    group: Sequence[Column],
    places: FloatArray,
    *,
    last: bool,
    abreast: int,
) -> Panel:
    unit, scale = display_unit(group[0].unit, product.unit)
    marks: list[Mark] = [ZERO]
    curves: list[FloatArray] = []
    for column, style in zip(group, CURVES, strict=False):
        phi, values = sampled(column, places)
        curves.append(values * scale)
        marks.append(Line(over(np.degrees(phi), curves[-1]), style, column.name))
    named = {column.limit: column.name for column in group if column.limit is not None}
    for limit, name in named.items():
        label = f"limit {limit * scale:.5g}" if len(group) == 1 else f"limit, {name}"
        marks.append(Rule("y", limit * scale, LIMIT_STYLE, label))
    legend_entries = entries(marks)
    low, high = limits([0.0, *curves], [limit * scale for limit in named])
    rows = -(-len(legend_entries) // abreast)  # of names, in a strip above the curves
    return Panel(
        frame,
        turn_axis(numbered=last),
        Axis(
            (low, high + HEADROOM * rows * (high - low)),
            f"[{unit}]" if unit else "",
            powers=PLAIN,
            label_place=NAME_PLACE,  # aligned over all panels, whatever the width of the numbers
        ),
        (*marks, *joint_marks(product.cam.drive.joints)),
        legend=Legend(
            legend_entries, "upper right", None, min(len(legend_entries), abreast), 7.5, pad=0.3
        ),
    )


def display_unit(unit: str, length: LengthUnit) -> tuple[str, float]:
    """The unit in which a column with `unit` is shown, and the factor to it."""
    unit, divisor = unit_and_divisor(unit, length)
    for power, raised in (("^2", "²"), ("^3", "³")):
        unit = unit.replace(power, raised)
    return unit, 1.0 / divisor


def sampled(column: Column, places: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Cam angles [rad] over one turn, ascending, and values (n,), (n,) of `column`.

    Each of `places` [rad] and of the column's own breaks occurs twice: with the left-hand value,
    then with the right-hand one. So does the start of the turn, with the value of its end.
    """
    ends = np.array([0.0, TURN])
    borders = np.concatenate((places, column.borders))
    borders = merged(np.concatenate((ends, borders[(borders > 0.0) & (borders < TURN)])))
    samples = cam_angles()
    inside = merged(np.concatenate((samples, borders)))[:-1]
    right = column.values(inside, "right")
    left = column.values(borders[1:], "left")
    phi = np.concatenate((ends[:1], borders[1:], inside))
    values = np.concatenate((left[-1:], left, right))
    # Left-hand values come first, and a stable sort keeps this order.
    order = np.argsort(phi, kind="stable")
    return phi[order], values[order]


# -- shock spectrum -------------------------------------------------------------------------------
# The shock spectra of the moves: largest and residual deflection over the ratio of the move's
# duration to the natural period.
#
# Both axes are logarithmic. Moves with the same spectrum share their curves. If the scene names the
# vibration of a train, its lowest natural frequency is marked for each move.


SIZE: Final = (7.0, 4.6)

VIBRATION: Final = "vibration"
FREQUENCY: Final = "natural-frequency"
"""Names of the effect, and of its findings that state natural frequencies [Hz]."""

COLOURS: Final = (LINE, "#c27c0e", "#3f8f6b", "#8c5aa8", "#7a7a7a", "#2f7fc1")

DASHES: Final = (4.0, 1.5)
"""Dashes of the curve of the largest deflection."""

LEAST: Final = 0.1
"""Lowest ratio drawn: below, the train lags behind by the whole stroke."""

POINTS: Final = 241
"""Number of ratios in a decade."""

FLOOR, CEILING = 1e-3, 300.0
"""Range of the amplitudes shown [% of the stroke]; a move with a kick deflects a train by up to
twice the stroke."""

SAME: Final = 1e-7
"""Spectra that differ by less than this [% of the stroke] are those of the same law."""

DIGITS: Final = 9
"""Decimals to which ratios are compared."""

DOTTED: Final = (1.0, 1.5)

BEYOND: Final = 1.25
"""Factor by which the axis reaches beyond the highest natural frequency marked."""


class Moved(Protocol):
    """A move from rest to rest, see `camgeo.dynamics.effects.shock_spectrum.RestToRest`."""

    @property
    def start(self) -> float: ...
    @property
    def span(self) -> float: ...
    @property
    def duration(self) -> float: ...


class SpectrumCurves(Protocol):
    """The spectrum of a move, see `camgeo.dynamics.effects.shock_spectrum.Spectrum`."""

    @property
    def move(self) -> Moved: ...
    def residual(self, ratios: FloatArray) -> FloatArray: ...
    def largest(self, ratios: FloatArray) -> FloatArray: ...


@dataclass(frozen=True, slots=True, eq=False)
class Curves:
    """The curves of moves that have the same spectrum.

    Attributes
    ----------
    spectra : the spectra of these moves.
    remains, largest : (n,) residual and largest deflection [% of the stroke].
    """

    spectra: tuple[SpectrumCurves, ...]
    remains: FloatArray
    largest: FloatArray

    @property
    def label(self) -> str:
        """The cam angles of the moves."""
        return listed([_range(spectrum) for spectrum in self.spectra], 4)


def lowest_frequency(effects: Effects) -> float | None:
    """Lowest natural frequency [Hz] of the scene's train; None if it is not known."""
    if VIBRATION not in effects.names:
        return None
    try:
        findings = effects.result(VIBRATION).findings
    except EffectError:  # which the findings report
        return None
    known = [finding.value for finding in findings if finding.name == FREQUENCY and finding.value]
    return min(known, default=None)


def spectrum_figure(
    name: str,
    spectra: Sequence[SpectrumCurves],
    highest_ratio: float,
    frequency: float | None = None,
    size: Size = SIZE,
) -> Figure:
    """The spectra in one panel.

    Parameters
    ----------
    name : of the design.
    highest_ratio : least upper end of the horizontal axis.
    frequency : natural frequency of the train [Hz], marked for each move; None without a train.
    """
    frame = grid(size, MARGINS)[0]
    title = f"{name}: shock spectra of the moves"
    if not spectra:
        whole = Axis((0.0, 1.0))
        words = Text("no move is from rest to rest", (0.5, 0.5), 9.0, across="center")
        return Figure(size, (Panel(frame, whole, whole, (words,), title, bare=True),))
    marked = (
        [] if frequency is None else [spectrum.move.duration * frequency for spectrum in spectra]
    )
    end = max(highest_ratio, *(BEYOND * ratio for ratio in marked), 10.0 * LEAST)
    ratios = np.geomspace(LEAST, end, math.ceil(POINTS * math.log10(end / LEAST)))
    marks: list[Mark] = []
    for curves, colour in zip(grouped(spectra, ratios), cycle(COLOURS)):
        styles = Style(colour, 1.3), Style(colour, 1.1, DASHES)
        remains = np.maximum(curves.remains, 0.1 * FLOOR)
        marks.append(Line(over(ratios, curves.largest), styles[1], f"largest, {curves.label}"))
        marks.append(Line(over(ratios, remains), styles[0], f"residual, {curves.label}"))
        if frequency is not None:
            marks += _frequency_marks(curves.spectra, frequency, colour)
    marks.append(Rule("y", 100.0 * QUIET, LIMIT_STYLE, f"{100.0 * QUIET:g} % of the stroke"))
    panel = Panel(
        frame,
        Axis((LEAST, end), "natural periods a move, t_move / T_n", log=True),
        Axis((FLOOR, CEILING), "deflection [% of the stroke]", log=True),
        tuple(marks),
        title,
        legend=Legend(entries(marks), "lower left", size=7.5),
    )
    return Figure(size, (panel,))


def grouped(spectra: Sequence[SpectrumCurves], ratios: FloatArray) -> list[Curves]:
    """The curves at `ratios` (n,), with moves of the same spectrum together."""
    groups: list[Curves] = []
    for spectrum in spectra:
        remains = 100.0 * spectrum.residual(ratios)
        for number, other in enumerate(groups):
            if np.allclose(remains, other.remains, rtol=0.0, atol=SAME):
                groups[number] = replace(other, spectra=(*other.spectra, spectrum))
                break
        else:
            groups.append(Curves((spectrum,), remains, 100.0 * spectrum.largest(ratios)))
    return groups


def _frequency_marks(
    spectra: Sequence[SpectrumCurves], frequency: float, colour: str
) -> Iterator[Line | Rule]:
    """Marks at the natural `frequency` [Hz] of the train, a line for each duration of a move."""
    durations: dict[float, SpectrumCurves] = {}
    for spectrum in spectra:
        durations.setdefault(round(spectrum.move.duration * frequency, DIGITS), spectrum)
    for number, (ratio, spectrum) in enumerate(durations.items()):
        label = "" if number else f"natural frequency, {frequency:.4g} Hz"
        yield Rule("x", ratio, Style(colour, 0.9, DOTTED), label)
        heights = [
            100.0 * float(deflection(np.array([ratio]))[0])
            for deflection in (spectrum.residual, spectrum.largest)
        ]
        points = Style(colour, 0.0, marker="o", size=5.0, face="white", edge=colour)
        yield Line(over([ratio, ratio], heights), points)


def _range(spectrum: SpectrumCurves) -> str:
    """The range of cam angles of a move, in words."""
    start = math.degrees(spectrum.move.start)
    return f"{start:.4g} to {start + math.degrees(spectrum.move.span):.4g}°"
