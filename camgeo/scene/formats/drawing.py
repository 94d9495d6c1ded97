"""The drawing: a sheet to hand over, as DXF, PDF and SVG."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Annotated, Final, Literal

from camgeo.numeric.checked import CheckedFields, Truth, finite, instance, one_of
from camgeo.scene.formats.format import Format, no_options

SHEETS: Final = ("A3", "A4")

LANGUAGES: Final = ("en", "de")

STEPS: Final = (5, 10, 15, 20, 30, 45, 60, 90)
"""Steps of the table on the sheet [degrees]: parts of a turn that fit."""

SheetName = Literal["A3", "A4"]
Language = Literal["en", "de"]
Text = Annotated[str, partial(instance, kind=str, what="a text")]


@dataclass(frozen=True, slots=True)
class DrawingSpec(CheckedFields, path="drawing."):
    """`[drawing]`: the sheet, and what the scene states beyond the geometry.

    A text that the scene does not give is empty, and nothing is drawn in its place: neither dates
    nor tolerances are invented.

    Attributes
    ----------
    sheet : size of the sheet, A3 lying or A4 standing (ISO 5457).
    language : of the texts.
    scale : as "1:2"; empty for the largest standard scale that fits (ISO 5455).
    owner, number, revision, date, title, creator, approver, document_type : of the title block
        (ISO 7200); the date as 2026-03-01.
    material, hardness, general_tolerances, edges, surface : as they stand on the sheet; edges is
        the size of ISO 13715, "-0.3".
    flank_surface : of the flanks, where it differs from `surface`.
    bore_fit, keyway_fit : tolerance classes (ISO 286), "H7" and "JS9".
    flank_tolerance : of the profile of the flanks [mm], to bore and keyway (ISO 1101); None if
        there is none.
    step : of the cam angle in the table [degrees]; 0 leaves the table out.
    motion : whether the motion diagram is drawn; None for on A3 only, where it takes no room from
        the views.
    """

    sheet: Annotated[SheetName, partial(one_of, choices=SHEETS)] = "A3"
    language: Annotated[Language, partial(one_of, choices=LANGUAGES)] = "en"
    scale: Text = ""
    owner: Text = ""
    number: Text = ""
    revision: Text = ""
    date: Text = ""
    title: Text = ""
    creator: Text = ""
    approver: Text = ""
    document_type: Text = ""
    material: Text = ""
    hardness: Text = ""
    general_tolerances: Text = ""
    edges: Text = ""
    surface: Text = ""
    flank_surface: Text = ""
    bore_fit: Text = ""
    keyway_fit: Text = ""
    flank_tolerance: Annotated[float, partial(finite, unit="mm")] | None = None
    step: Annotated[int, partial(one_of, choices=(0, *STEPS))] = 10
    motion: Truth | None = None

    @property
    def has_motion(self) -> bool:
        """Whether the motion diagram is drawn."""
        return self.sheet == "A3" if self.motion is None else self.motion


SCHEMA: Final = {
    "description": "The drawing has no options here: [drawing] states what is on the sheet.",
    "type": "object",
    "additionalProperties": False,
    "required": [],  # so that the table's absence states nothing, and adds nothing to identities
    "properties": {},
}

FORMAT: Final = Format("drawing", "-drawing.dxf", no_options, SCHEMA, ("follower",))
"""Its writer has companions for PDF and SVG."""
