"""The shock spectra of the moves: what is deflected at most, and what remains, over the ratio.

Both axes are logarithmic. Moves with the same spectrum share their curves. Where the scene names
the vibration of a train, its lowest natural frequency is marked for each move.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import cycle
from typing import TYPE_CHECKING, Final, Protocol

import numpy as np

from camgeo.errors import EffectError
from camgeo.figure.layout import Size, grid
from camgeo.figure.marks import Line, Mark, Rule, Style, Text, over
from camgeo.figure.model import Axis, Figure, Legend, Panel, entries
from camgeo.figure.style import LIMIT_STYLE, LINE, MARGINS
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.oscillator.spectrum import QUIET
from camgeo.wording import listed

if TYPE_CHECKING:
    from camgeo.effects.graph import Effects

SIZE: Final = (7.0, 4.6)

VIBRATION: Final = "vibration"
FREQUENCY: Final = "natural-frequency"
"""Names of an effect, and of its findings that state frequencies [Hz]."""

COLOURS: Final = (LINE, "#c27c0e", "#3f8f6b", "#8c5aa8", "#7a7a7a", "#2f7fc1")

DASHES: Final = (4.0, 1.5)
"""Of the largest deflection."""

LEAST: Final = 0.1
"""Lowest ratio drawn: below, the train is left behind by the whole stroke."""

POINTS: Final = 241
"""Ratios in a decade."""

FLOOR, CEILING = 1e-3, 300.0
"""Amplitudes shown [% of the stroke]; a move with a kick deflects a train by up to twice the
stroke."""

SAME: Final = 1e-7
"""Spectra [% of the stroke] this close are those of the same law."""

DIGITS: Final = 9
"""Decimals to which ratios of durations are told apart."""

DOTTED: Final = (1.0, 1.5)

BEYOND: Final = 1.25
"""The axis reaches so much farther than a natural frequency."""


class Moved(Protocol):
    """A move, see `camgeo.effects.shock_spectrum.moves.RestToRest`."""

    @property
    def start(self) -> float: ...
    @property
    def span(self) -> float: ...
    @property
    def duration(self) -> float: ...


class Spectrum(Protocol):
    """The spectrum of a move, see `camgeo.effects.shock_spectrum.result.Spectrum`."""

    @property
    def move(self) -> Moved: ...
    def residual(self, ratios: FloatArray) -> FloatArray: ...
    def largest(self, ratios: FloatArray) -> FloatArray: ...


@dataclass(frozen=True, slots=True, eq=False)
class Curves:
    """The spectra of moves that have the same one.

    Attributes
    ----------
    spectra : of these moves.
    remains, largest : (n,) residual and largest deflection [% of the stroke].
    """

    spectra: tuple[Spectrum, ...]
    remains: FloatArray
    largest: FloatArray

    @property
    def label(self) -> str:
        """The cam angles of the moves."""
        return listed([_range(each) for each in self.spectra], 4)


def frequency_of(effects: Effects) -> float | None:
    """Lowest natural frequency [Hz] of the train that the scene names; None if none is known."""
    if VIBRATION not in effects.names:
        return None
    try:
        findings = effects.result(VIBRATION).findings
    except EffectError:  # which the findings report
        return None
    known = [each.value for each in findings if each.name == FREQUENCY and each.value]
    return min(known, default=None)


def figure(
    name: str,
    spectra: Sequence[Spectrum],
    highest_ratio: float,
    frequency: float | None = None,
    size: Size = SIZE,
) -> Figure:
    """The spectra in one panel.

    Parameters
    ----------
    name : of the design.
    highest_ratio : upper end of the spectra, at least.
    frequency : of the train [Hz], marked for each move; None for none.
    """
    frame = grid(size, MARGINS)[0]
    title = f"{name}: shock spectra of the moves"
    if not spectra:
        whole = Axis((0.0, 1.0))
        words = Text("no move is from rest to rest", (0.5, 0.5), 9.0, across="center")
        return Figure(size, (Panel(frame, whole, whole, (words,), title, bare=True),))
    marked = [] if frequency is None else [each.move.duration * frequency for each in spectra]
    end = max(highest_ratio, *(BEYOND * ratio for ratio in marked), 10.0 * LEAST)
    ratios = np.geomspace(LEAST, end, math.ceil(POINTS * math.log10(end / LEAST)))
    marks: list[Mark] = []
    for curves, colour in zip(grouped(spectra, ratios), cycle(COLOURS)):
        styles = Style(colour, 1.3), Style(colour, 1.1, DASHES)
        remains = np.maximum(curves.remains, 0.1 * FLOOR)
        marks.append(Line(over(ratios, curves.largest), styles[1], f"largest, {curves.label}"))
        marks.append(Line(over(ratios, remains), styles[0], f"residual, {curves.label}"))
        if frequency is not None:
            marks += _at_frequency(curves.spectra, frequency, colour)
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


def grouped(spectra: Sequence[Spectrum], ratios: FloatArray) -> list[Curves]:
    """The curves at `ratios` (n,), those of equal moves together."""
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


def _at_frequency(
    spectra: Sequence[Spectrum], frequency: float, colour: str
) -> Iterator[Line | Rule]:
    """Where the train with that natural `frequency` [Hz] is, a line for each duration."""
    durations: dict[float, Spectrum] = {}
    for each in spectra:
        durations.setdefault(round(each.move.duration * frequency, DIGITS), each)
    for number, (ratio, each) in enumerate(durations.items()):
        label = "" if number else f"natural frequency, {frequency:.4g} Hz"
        yield Rule("x", ratio, Style(colour, 0.9, DOTTED), label)
        heights = [100.0 * float(of(np.array([ratio]))[0]) for of in (each.residual, each.largest)]
        points = Style(colour, 0.0, marker="o", size=5.0, face="white", edge=colour)
        yield Line(over([ratio, ratio], heights), points)


def _range(spectrum: Spectrum) -> str:
    """The cam angles of a move."""
    start = math.degrees(spectrum.move.start)
    return f"{start:.4g} to {start + math.degrees(spectrum.move.span):.4g}°"
