"""The texts of a sheet around its views, and the room that they leave."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from camgeo.formats.drawing import DrawingSpec, SheetName
from camgeo.product.product import Product
from camgeo.sheet import course, notes
from camgeo.sheet.frame import BLOCK_HEIGHT, BLOCK_WIDTH, LEFT, MARGIN, SIZES
from camgeo.sheet.marks import Mark
from camgeo.sheet.views import Drawn
from camgeo.sheet.words import WORDS
from camgeo.units import MM_PER

FURTHER: Final = 36
"""Most rows of the table beside the views on A4; a longer one has a further sheet."""

DIAGRAM: Final[dict[SheetName, float]] = {"A3": 48.0, "A4": 36.0}
"""Height of the motion diagram [mm]."""


@dataclass(frozen=True, slots=True)
class Region:
    """A rectangle of the sheet by two corners [mm]."""

    low: complex
    high: complex

    @property
    def size(self) -> complex:
        """Width and height."""
        return self.high - self.low


@dataclass(frozen=True, slots=True)
class Texts:
    """Notes, table and motion diagram of a disc, around its views."""

    product: Product
    spec: DrawingSpec

    @property
    def _low(self) -> complex:
        return complex(LEFT, MARGIN)

    @property
    def _high(self) -> complex:
        size = SIZES[self.spec.sheet]
        return complex(size.width - MARGIN, size.height - MARGIN)

    @property
    def _left(self) -> float:
        return self._high.real - BLOCK_WIDTH

    @property
    def _is_wide(self) -> bool:
        return self.spec.sheet == "A3"

    @property
    def is_apart(self) -> bool:
        """Whether the table is on a sheet of its own."""
        return not self._is_wide and bool(self.spec.step) and 360 // self.spec.step > FURTHER

    def beside(self, tolerance: float, drawn: Drawn) -> tuple[tuple[Region, ...], list[Mark]]:
        """The regions that are left for the views, the better one first, and all other marks."""
        spec, words, width = self.spec, WORDS[self.spec.language], BLOCK_WIDTH - 4.0
        stated = notes.notes_of(self.product, spec, tolerance, self._length, apart=self.is_apart,
                                drawn=drawn)  # fmt: skip
        lines = notes.lines_of(stated, width)
        top = complex(self._left + 2.0, MARGIN + BLOCK_HEIGHT + notes.height_of(lines) + 1.0)
        marks = notes.marks_of(lines, words.notes, top, width)
        floor, ceiling = top.imag + 1.0, self._high.imag - 2.0
        if spec.step and not self.is_apart:
            table = self._table(centre=self._is_wide)
            groups = 2 if self._is_wide else 3
            needed = table.height(groups)
            upper = ceiling if self._is_wide else floor + needed
            marks += course.table_marks(table, words.table, complex(top.real, upper), width, groups)
            ceiling, floor = (upper - needed, floor) if self._is_wide else (ceiling, floor + needed)
        low = self._low.imag if self._is_wide else floor
        if spec.has_motion:
            size = complex(width, DIAGRAM[spec.sheet])
            corner = complex(top.real, floor)
            if self._is_wide and ceiling - floor < size.imag + 4.0:
                corner, low = self._low + complex(3.0, 5.0), self._low.imag + 5.0 + size.imag
            elif not self._is_wide:
                low += size.imag
            else:
                corner += 0.5j * (ceiling - floor - size.imag)
            marks += course.diagram(self.product, words, corner, size, self._written)
        right = self._left if self._is_wide else self._high.real
        found = Region(complex(self._low.real, low), complex(right, self._high.imag))
        if self._is_wide and not spec.step and not spec.has_motion:
            return (Region(complex(self._low.real, floor), self._high), found), marks
        return (found,), marks

    def table_apart(self) -> list[Mark]:
        """The table on a sheet of its own, with all that it can state."""
        title = WORDS[self.spec.language].table
        corner = complex(self._left + 2.0, self._high.imag - 2.0)
        return course.table_marks(self._table(centre=True), title, corner, BLOCK_WIDTH - 4.0, 2)

    def _table(self, *, centre: bool) -> course.Table:
        words = WORDS[self.spec.language]
        return course.table_of(self.product, words, self.spec.step, self._written, centre=centre)

    def _written(self, value: float, decimals: int) -> str:
        text = f"{value + 0.0:.{decimals}f}"
        text = text.removeprefix("-") if float(text) == 0.0 else text
        return text.replace(".", ",") if self.spec.language == "de" else text

    def _length(self, value: float) -> str:
        decimals = 4 if self.product.unit == "mm" else 5
        text = self._written(value / MM_PER[self.product.unit], decimals).rstrip("0")
        return text.rstrip(".,")
