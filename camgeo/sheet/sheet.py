"""The whole sheet of one disc: its parts and their places."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Final

from camgeo.errors import GeometryError, SceneError
from camgeo.formats.drawing import DrawingSpec
from camgeo.product.product import Product
from camgeo.sheet import front
from camgeo.sheet.frame import (
    BLOCK_WIDTH,
    MARGIN,
    SIZES,
    block_place,
    frame,
    title_block,
)
from camgeo.sheet.ink import ink_of
from camgeo.sheet.marks import Diameter, Distance, Mark, Sheet, View
from camgeo.sheet.scales import scale_of, scales, spelled
from camgeo.sheet.symbols import edges, others, texture, texture_width
from camgeo.sheet.texts import Region, Texts
from camgeo.sheet.views import Drawn, drawn_of, front_view, section_view

BETWEEN: Final = 6.0
"""Between front view and section, with all that belongs to them, and farther where there is room,
up to `SPREAD` [mm]."""

SPREAD: Final = 20.0

DWARFED: Final = 4
"""How many times larger a part is without pitch curve and base circle for them to be left out."""

EDGE: Final = 1.5
"""Around the views [mm]."""


def sheets_of(product: Product, tolerance: float) -> tuple[Sheet, ...]:
    """The sheets of a disc, whose edges lie within `tolerance` [mm]: the views are on the first
    one, and a table that does not fit there is on the next.

    Raises
    ------
    SceneError
        With the key of `[drawing]` that is at fault, if not all of it fits.
    """
    try:
        return _sheets_of(product, tolerance)
    except GeometryError as error:
        if not error.key.startswith("drawing."):
            raise
        scene = product.scene
        fault = scene.stated.scene.fault(tuple(error.key.split(".")), error.message)
        fault = fault if fault.value else replace(fault, value=error.value)
        raise SceneError([fault], scene.source.file) from error


def _sheets_of(product: Product, tolerance: float) -> tuple[Sheet, ...]:
    spec = product.scene.drawing
    each = 2 if Texts(product, spec).is_apart else 1
    if product.is_pair:  # the sheets of its discs have their curves
        spec = replace(spec, step=0, motion=False, scale="")
    drawn = drawn_of(product, tolerance)
    texts = Texts(product, spec)
    regions, marks = texts.beside(tolerance, drawn)
    scale, views = _fitted(drawn, regions, product, spec)
    if not spec.scale and _may_fit(drawn.alone, regions, DWARFED * float(scale)):
        bare, bare_marks = texts.beside(tolerance, drawn.alone)
        larger, bare_views = _fitted(drawn.alone, bare, product, spec)
        if larger >= DWARFED * scale:
            scale, views, marks = larger, bare_views, bare_marks
    contents = [(views, marks)]
    if texts.is_apart:
        contents.append(((), texts.table_apart()))
    last = len(product.judgement.cams) * each + is_in_one_piece(product)
    first = last if product.is_pair else product.position * each + 1
    return tuple(
        _sheet(product, spec, scale, own, drawn_on, (first + number, last))
        for number, (own, drawn_on) in enumerate(contents)
    )


def is_in_one_piece(product: Product) -> bool:
    """Whether the disc is one piece with another."""
    part = product.scene.part
    return part is not None and part.pair is not None


def _sheet(
    product: Product, spec: DrawingSpec, scale: Fraction, views: tuple[View, ...],
    marks: list[Mark], numbered: tuple[int, int],
) -> Sheet:  # fmt: skip
    """A sheet with its frame and title block."""
    size = SIZES[spec.sheet]
    corner = complex(size.width - MARGIN - BLOCK_WIDTH, MARGIN)
    all_marks = [*marks, *frame(size)]
    all_marks += title_block(corner, spec, spelled(scale), product.unit, numbered)
    if spec.edges:
        all_marks += edges(corner + block_place("edges"), spec.edges)
    if spec.surface:
        at = corner + block_place("surface")
        all_marks += texture(at, spec.surface, 2.0)
        if spec.flank_surface:
            all_marks += others(at + texture_width(spec.surface, 2.0) + 4.0, 2.0)
    dashed = tuple(front.in_dashes(all_marks, 1.0))
    comma = spec.language == "de"
    return Sheet(size.width, size.height, float(scale), product.unit, comma, views, dashed)


@dataclass(frozen=True, slots=True)
class _Laid:
    """Views at a scale, by their origins: the first one's at 0 [mm of paper].

    Attributes
    ----------
    views : the front view, and of a part with thickness the section to its right, as near as may
        be.
    low, high : corners of all that they show.
    """

    views: tuple[View, ...]
    low: complex
    high: complex

    def fits(self, region: Region) -> bool:
        """Whether they fit in a region."""
        spare = self.spare(region)
        return spare.real >= 0.0 and spare.imag >= 0.0

    def spare(self, region: Region) -> complex:
        """What a region is larger."""
        return region.size - (self.high - self.low) - complex(2.0 * EDGE, 2.0 * EDGE)

    def placed(self, region: Region) -> tuple[View, ...]:
        """The views in the middle of a region, the section farther away if there is room."""
        spare = self.spare(region)
        apart = min(spare.real / 3.0, SPREAD) if len(self.views) > 1 else 0.0
        aside = 0.5 * (spare.real - apart)
        at = region.low - self.low + complex(EDGE + aside, EDGE + 0.5 * spare.imag)
        return tuple(replace(each, at=each.at + at + number * apart)
                     for number, each in enumerate(self.views))  # fmt: skip


def _laid(drawn: Drawn, scale: float, product: Product, spec: DrawingSpec) -> _Laid:
    marks = tuple(front_view(drawn, scale, product, spec))
    low, high = ink_of(marks, scale, product.unit).extent
    views = [View(0j, marks)]
    if drawn.cut:
        cut = tuple(section_view(drawn, scale, product, spec))
        left, right = ink_of(cut, scale, product.unit).extent
        at = high.real + BETWEEN - left.real
        views.append(View(complex(at), cut))
        low = complex(low.real, min(low.imag, left.imag))
        high = complex(at + right.real, max(high.imag, right.imag))
    return _Laid(tuple(views), low, high)


def _fitted(
    drawn: Drawn, regions: Sequence[Region], product: Product, spec: DrawingSpec
) -> tuple[Fraction, tuple[View, ...]]:
    """The stated scale, or the largest standard one at which the views fit, and the views."""
    asked = scale_of(spec.scale) if spec.scale else None
    tried = scales() if asked is None else (asked,)
    for scale in tried:
        if _may_fit(drawn, regions, float(scale)):
            laid = _laid(drawn, float(scale), product, spec)
            for region in filter(laid.fits, regions):
                return scale, laid.placed(region)
    if asked is None:
        message = "leaves no room for the views; leave out table or diagram, or take A3"
        raise GeometryError(message, key="drawing.sheet", value=spec.sheet)
    largest, _ = _fitted(drawn, regions, product, replace(spec, scale=""))
    message = f'does not fit on the sheet: at most "{spelled(largest)}" does'
    raise GeometryError(message, key="drawing.scale", value=spec.scale)


def _may_fit(drawn: Drawn, regions: Sequence[Region], scale: float) -> bool:
    """Whether the part itself fits, without anything around it."""
    low, high = drawn.box
    size = high - low + (drawn.shape.part.thickness if drawn.cut else 0.0)
    rooms = [region.size / scale for region in regions]
    return any(size.real <= room.real and size.imag <= room.imag for room in rooms)


def measured(sheet: Sheet) -> tuple[Distance | Diameter, ...]:
    """All dimensions of a sheet."""
    return tuple(
        mark for view in sheet.views for mark in view.marks if isinstance(mark, Distance | Diameter)
    )
