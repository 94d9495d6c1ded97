"""SVG: a picture of the cam."""

from __future__ import annotations

from typing import Final

from camgeo.formats.format import Format, no_keys, no_options

FORMAT: Final = Format(
    "svg",
    ".svg",
    no_options,
    no_keys("The picture of the cam; it has no options."),
    ("follower",),
)
