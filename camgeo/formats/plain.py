"""The formats without options: bodies, pictures, cut drawings, and the point files of opticurv."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from camgeo.formats.format import Format, Rule, Values, groove_has_a_depth, no_keys, no_options


def is_a_rocker_behind_a_slider(values: Values) -> Iterator[tuple[str, str]]:
    """The points are those of a roller on a rocker behind a slider-crank."""
    if values.flat:
        yield "", "is for roller followers"
    elif not values.lacks("linkage") and (
        values.slides or values.get("linkage", "kind") == "four-bar"
    ):
        yield "", 'needs [linkage] kind = "slider-crank" and a rocker'


def _plain(
    name: str,
    suffix: str,
    description: str,
    also: tuple[str, ...] = (),
    rules: tuple[Rule, ...] = (),
    *,
    later: bool = False,
) -> Format[None]:
    """A format that needs a follower, and the keys of `also`; one that came `later` does not change
    the hashes of scenes.
    """
    schema = no_keys(f"{description}; it has no options.")
    if later:
        schema["x-added"] = True
    return Format(name, suffix, no_options, schema, ("follower", *also), rules)


SVG: Final = _plain("svg", ".svg", "The picture of the cam")
PNG: Final = _plain("png", ".png", "The picture of the cam")

CUT_SVG: Final = _plain(
    "cut-svg",
    ".cut.svg",
    "The part as a drawing at true size for laser cutters, in mm: closed contours of lines and arcs"
    " as hairlines, grouped by the layers of [output.dxf], those of CUT red and the others blue;"
    " UTF-8",
    later=True,
)

BODY: Final = (("part.thickness",), (groove_has_a_depth,))
"""The needs and rules of formats of solid bodies."""

STL: Final = _plain(
    "stl",
    ".stl",
    "The part as a body of triangles, in single precision, its header in ASCII",
    *BODY,
)

ASC: Final = _plain(
    "asc",
    "1.asc",
    "The point files of opticurv, at the step of the value table, in ASCII",
    ("linkage",),
    (is_a_rocker_behind_a_slider,),
)
"""The program appends a digit to the project's name; the second file has another digit."""
