"""What cannot be read on a sheet: texts with lines across them, outlines that are mere dots."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.sheet.ink import ink_of, number_of
from camgeo.sheet.marks import DIAMETER, Chain, Diameter, Distance, Label, Sheet, View
from camgeo.units import MM_PER
from camgeo.wording import counted, listed

READABLE: Final = "drawing-readable"

DOT: Final = 1.0
"""Width of an outline on paper below which it is a dot: twice the width of its line [mm]."""

SEEN: Final = ("OUTLINE", "HIDDEN")
"""Layers of the outlines of the part."""

NAMED: Final = 3
"""Most texts that a sentence names."""


def findings_of(sheet: Sheet) -> Iterator[Finding]:
    """Warnings of what cannot be read, with what helps."""
    texts = [text for view in sheet.views for text in across(view, sheet)]
    if texts:
        names = listed([f'"{text}"' for text in texts], NAMED)
        what = f"the drawing has lines across {counted(len(texts), 'text')} ({names})"
        yield Finding(READABLE, "warning", f"{what}: it needs a larger sheet or scale")
    small = list(dots(sheet))
    if small:
        width, at = min(small, key=lambda each: each[0])
        mm = MM_PER[sheet.unit]
        place = f"({at.real / mm:.4g} / {at.imag / mm:.4g})"
        what = f"the drawing shows {counted(len(small), 'outline')} as a dot"
        sentence = f"{what}, {width:.2g} mm wide on paper, at {place}: a larger scale shows more"
        yield Finding(READABLE, "warning", sentence, width, DOT, "mm")


def across(view: View, sheet: Sheet) -> Iterator[str]:
    """The texts of a view that something is drawn across."""
    ink = ink_of(view.marks, sheet.scale, sheet.unit)
    over = ink.texts.overlap(ink.texts)
    np.fill_diagonal(over, val=False)
    lines = np.concatenate([ink.wide, ink.thin])
    written = [mark for mark in view.marks if isinstance(mark, Label | Distance | Diameter)]
    for mark, poor in zip(written, ink.texts.hit(lines) | over.any(axis=1), strict=True):
        if poor:
            text = mark.text if isinstance(mark, Label) else number_of(mark, sheet.unit)
            yield text.replace(DIAMETER, "Ø")


def dots(sheet: Sheet) -> Iterator[tuple[float, complex]]:
    """The outlines of the part that are mere dots: width on paper, and middle [mm of the part]."""
    for view in sheet.views[:1]:
        for mark in view.marks:
            if isinstance(mark, Chain) and mark.closed and mark.layer in SEEN:
                low, high = ink_of([mark], sheet.scale, sheet.unit).extent
                size = high - low
                if max(size.real, size.imag) < DOT:
                    yield max(size.real, size.imag), 0.5 * (low + high) / sheet.scale
