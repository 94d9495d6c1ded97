"""The plots of a design by name, and several of them one above the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from importlib import import_module
from importlib.metadata import entry_points
from typing import Protocol

from camgeo.errors import UnknownNameError
from camgeo.figure.layout import Size, rooms
from camgeo.figure.model import Figure
from camgeo.product.product import Product

GROUP = "camgeo.plots"
"""Entry points of plots from other distributions, each a `Builder` by the plot's name."""


class Builder(Protocol):
    """Makes a figure of a design: of its own size, or of the size available on a page."""

    def __call__(self, product: Product, size: Size = ..., /) -> Figure: ...


OWN = {
    "motion": "motion:figure",
    "cam": "cam:figure",
    "mechanism": "mechanism:figure",
    "curvature": "diagrams:curvature",
    "transmission-angle": "diagrams:transmission_angle",
    "effects": "effects:figure",
    "backplot": "backplot:figure",
}
"""Each plot with its module in this package and its builder there."""


def names() -> list[str]:
    """Names of all plots, ours and others, in alphabetical order."""
    return sorted({*OWN, *entry_points(group=GROUP).names})


def find(name: str) -> Builder:
    """The plot of that name; UnknownNameError if there is none."""
    if name in OWN:
        module, _, builder = OWN[name].partition(":")
        own: Builder = getattr(import_module(f"camgeo.figure.{module}"), builder)
        return own
    for entry in entry_points(group=GROUP, name=name):
        other: Builder = entry.load()
        return other
    raise UnknownNameError("plot", name, names())


def stacked(product: Product, wanted: Sequence[str]) -> Figure:
    """The plots `wanted` of `product`, one above the other, all as wide as the widest."""
    builders = [find(name) for name in wanted]
    figures = [build(product) for build in builders]
    width = max(each.size[0] for each in figures)
    heights = [each.size[1] for each in figures]
    rows = [
        each if each.size == room else replace(build(product, room), size=(width, each.size[1]))
        for each, build, room in zip(figures, builders, rooms(width, heights), strict=True)
    ]
    return Figure((width, sum(heights)), rows=tuple(rows))
