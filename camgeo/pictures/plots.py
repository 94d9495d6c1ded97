"""The plots of a design by name, several of them one above the other, and its diagrams."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from importlib import import_module
from importlib.metadata import entry_points
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, Protocol

import numpy as np

from camgeo.design.product import Product
from camgeo.errors import Fault, SceneError, UnknownNameError, meant
from camgeo.pictures import effects, motion
from camgeo.pictures.model import Figure, Size
from camgeo.pictures.motion import MOST_CURVES, CurveExtremes, format_value, plain

if TYPE_CHECKING:
    from camgeo.design.design import Design

GROUP = "camgeo.plots"
"""Entry points of plots from other distributions, each a `Builder` by the plot's name."""


class Builder(Protocol):
    """Makes a figure of a design: of its own size, or of the size available on a page."""

    def __call__(self, product: Product, size: Size = ..., /) -> Figure: ...


MOTION: Final = "motion"
CAM: Final = "cam"
"""The plot that shows both discs of a conjugate pair."""

EFFECTS: Final = "effects"
"""The plot of the effects that a scene names."""

SPECTRUM: Final = "shock-spectrum"
"""The plot of the effect of that name, drawn if the scene names it."""

BACKPLOT: Final = "backplot"
"""The plot of the milling program, drawn only if it is asked for; the others are of the cam."""

OWN = {
    MOTION: "motion:figure",
    CAM: "cam:figure",
    "mechanism": "mechanism:figure",
    "curvature": "motion:curvature",
    "transmission-angle": "motion:transmission_angle",
    EFFECTS: "effects:figure",
    BACKPLOT: "backplot:figure",
}
"""Each plot with its module in this package and its builder there."""


def names() -> list[str]:
    """Names of all plots, ours and others, in alphabetical order."""
    return sorted({*OWN, SPECTRUM, *entry_points(group=GROUP).names})


def find(name: str) -> Builder:
    """The plot of that name; UnknownNameError if there is none."""
    if name in OWN:
        module, _, builder = OWN[name].partition(":")
        figure_builder: Builder = getattr(import_module(f"camgeo.pictures.{module}"), builder)
        return figure_builder
    for entry in entry_points(group=GROUP, name=name):
        other: Builder = entry.load()
        return other
    raise UnknownNameError("plot", name, names())


def check_names(what: Iterable[str]) -> None:
    """SceneError for the first name that is no plot."""
    known = names()
    for name in what:
        if name not in known:
            hint = meant(name, known, '"')
            raise SceneError([Fault("plot", name, f"can draw {', '.join(known)}", hint)])


def of_design(design: Design, what: Sequence[str] = ()) -> tuple[Figure, list[str]]:
    """The plots `what` of a design as one figure, by default all that it has, and their names.

    Raises
    ------
    SceneError
        If one of them is no plot, or the scene lacks what it shows.
    """
    check_names(what)
    scene = design.scene
    if EFFECTS in what and not scene.effects:
        raise SceneError([Fault("effects", "", "names no effect: there is none to draw")])
    if SPECTRUM in what and SPECTRUM not in scene.effects:
        message = "is not named: there is no spectrum to draw"
        raise SceneError([Fault(f"effects.{SPECTRUM}", "", message)])
    if BACKPLOT in what and not scene.states_milling:
        raise SceneError([Fault("tool", "", "is not stated: there is no program to draw")])
    possible = [name for name in names() if name not in (EFFECTS, BACKPLOT, SPECTRUM)]
    possible += [EFFECTS] if scene.effects else []
    possible += [SPECTRUM] if SPECTRUM in scene.effects else []
    possible.sort()
    if scene.follower is None:
        possible = [MOTION]
    wanted = list(what) or possible
    if wanted == possible == [MOTION]:
        return motion_diagram(design), wanted
    extra_builders: dict[str, Builder] = {}
    if SPECTRUM in wanted:

        def spectra(product: Product, size: Size = effects.SIZE, /) -> Figure:
            spectrum = design.effect(SPECTRUM)
            frequency = effects.lowest_frequency(design.effects)
            ends = spectrum.spectra, spectrum.highest_ratio
            return effects.spectrum_figure(product.name, *ends, frequency, size)

        extra_builders[SPECTRUM] = spectra
    return stacked(design.disc, wanted, extra_builders), wanted


def stacked(
    product: Product,
    wanted: Sequence[str],
    extra_builders: Mapping[str, Builder] = MappingProxyType({}),
) -> Figure:
    """The plots `wanted` of `product`, one above the other, all as wide as the widest.

    `extra_builders` are builders by name that need more than a product.
    """
    builders = [extra_builders.get(name) or find(name) for name in wanted]
    figures = [build(product) for build in builders]
    width = max(figure.size[0] for figure in figures)
    heights = [figure.size[1] for figure in figures]
    rows = [
        figure
        if figure.size == room
        else replace(build(product, room), size=(width, figure.size[1]))
        for figure, build, room in zip(figures, builders, rooms(width, heights), strict=True)
    ]
    return Figure((width, sum(heights)), rows=tuple(rows))


def rooms(width: float, heights: Sequence[float]) -> list[Size]:
    """The space for each of several rows of one page: their `heights` [inch] up to rounding.

    They are rounded as matplotlib does when it divides a page of 100 dots per inch, because names
    inside SVG files depend on the last digits of positions.
    """
    count, total = len(heights), sum(heights)
    down = np.cumsum([0.0, *(high * (1.0 / count * count / total) for high in heights)])
    edges = (1.0 - down) * (total * 100.0)
    return [(width, float(high)) for high in (edges[:-1] - edges[1:]) / 100.0]


# -- charts ---------------------------------------------------------------------------------------
# Diagrams of a design over the cam angle, and what they show in words and numbers.


TOGETHER: Final = 6
"""Largest number of panels of effects in a diagram, as many as fit on a sheet."""

MOTION_TITLE: Final = "motion plan and diagrams"
"""Title of the first diagram."""


@dataclass(frozen=True, slots=True, eq=False)
class Chart:
    """A diagram over the cam angle.

    Attributes
    ----------
    title : what it shows.
    figure : the diagram.
    readings : the extremes of its curves.
    """

    title: str
    figure: Figure
    readings: tuple[CurveExtremes, ...]

    @property
    def sentence(self) -> str:
        """The extremes of the first curves in words."""
        extremes = [
            f"{plain(reading.name)} from {format_value(reading.low)} at"
            f" {math.degrees(reading.low_angle):.1f}° to {format_value(reading.high)} at"
            f" {math.degrees(reading.high_angle):.1f}°"
            for reading in self.readings[:MOST_CURVES]
        ]
        more = len(self.readings) - MOST_CURVES
        return "; ".join(extremes) + (f"; {more} more in the table" if more > 0 else "") + "."


def motion_diagram(design: Design) -> Figure:
    """The motion plan, and the motion over the cam angle."""
    scene = design.scene
    return motion.drive_figure(design.name, scene.unit, design.drive, scene.lift_unit)


def disc_diagrams(design: Design) -> Iterator[tuple[str, str, partial[Figure]]]:
    """Name, title and function that makes it, for each diagram of a disc, disc by disc."""
    for disc in design.discs:
        name, suffix = ("", "") if disc is design.disc else ("-return", f" of {disc.name}")
        angle = partial(motion.transmission_angle, disc)
        yield f"transmission{name}", f"transmission angle{suffix}", angle
        yield f"curvature{name}", f"curvature{suffix}", partial(motion.curvature, disc)


def of_effects(disc: Product) -> Iterator[tuple[str, partial[Figure]]]:
    """Title and function that makes it, for each diagram of effects of at most TOGETHER panels."""
    groups = effects.panels(disc.columns())
    parts = [groups[k : k + TOGETHER] for k in range(0, len(groups), TOGETHER)]
    for number, part in enumerate(parts, start=1):
        chosen = tuple(column for group in part for column in group)
        share = f", {number} of {len(parts)}" if len(parts) > 1 else ""
        one = replace(disc, columns=partial(tuple, chosen))
        yield f"forces and effects{share}", partial(effects.figure, one)
