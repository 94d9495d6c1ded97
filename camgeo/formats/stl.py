"""STL: the part as a body of triangles, in single precision."""

from __future__ import annotations

from typing import Final

from camgeo.formats.format import Format, no_keys, no_options
from camgeo.formats.solid import groove_has_a_depth

FORMAT: Final = Format(
    "stl",
    ".stl",
    no_options,
    no_keys("The part as a body of triangles, in single precision; it has no options."),
    ("follower", "part.thickness"),
    (groove_has_a_depth,),
)
