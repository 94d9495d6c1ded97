"""What the kinds of flat-faced followers declare alike."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any


def face_has_a_length(table: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """A face ends behind its beginning."""
    face = table.get("face")
    if face is not None and not face[0] < face[1]:
        yield "face", "must end beyond where it begins, [from, to]"
