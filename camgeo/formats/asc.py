"""ASC: the point files of opticurv."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from camgeo.formats.format import Format, Values, no_keys, no_options


def is_a_rocker_behind_a_slider(values: Values) -> Iterator[tuple[str, str]]:
    """The points are those of a roller on a rocker behind a slider-crank."""
    if values.flat:
        yield "", "is for roller followers"
    elif not values.lacks("linkage") and (
        values.slides or values.get("linkage", "kind") == "four-bar"
    ):
        yield "", 'needs [linkage] kind = "slider-crank" and a rocker'


FORMAT: Final = Format(
    "asc",
    "1.asc",
    no_options,
    no_keys("The point files of opticurv, at the step of the value table; it has no options."),
    ("follower", "linkage"),
    (is_a_rocker_behind_a_slider,),
)
"""Behind the project's name the program puts a digit; the second file has its own."""
