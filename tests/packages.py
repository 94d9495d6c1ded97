"""Packages (3MF files) with changed parts."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Callable, Mapping

Change = Callable[[str, str], str | None]
"""Path and content of a part -> its new content, or None to leave the part out."""


def repacked(data: bytes, change: Change, added: Mapping[str, str] | None = None) -> bytes:
    """The package `data` with its parts changed, and further parts by their paths."""
    stream = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(data)) as old, zipfile.ZipFile(stream, "w") as new:
        parts = {path: change(path, old.read(path).decode()) for path in old.namelist()}
        for path, content in {**parts, **(added or {})}.items():
            if content is not None:
                new.writestr(zipfile.ZipInfo(path, (1980, 1, 1, 0, 0, 0)), content)
    return stream.getvalue()
