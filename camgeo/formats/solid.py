"""What the formats have in common that take the disc for a body."""

from __future__ import annotations

from collections.abc import Iterator

from camgeo.formats.format import Values


def groove_has_a_depth(values: Values) -> Iterator[tuple[str, str]]:
    """The depth of a groove is given."""
    if values.get("follower", "contact") == "groove" and values.lacks("part", "groove_depth"):
        yield "", "needs [part] groove_depth, for the cam is a groove"
