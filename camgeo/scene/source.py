"""Where a scene came from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import Self


@dataclass(frozen=True, slots=True)
class Source:
    """What a scene was made from, besides its values.

    Attributes
    ----------
    file : path of the scene file as given; empty without one.
    folder : in which the files lie that the scene names, absolute; None if there is none.
    text : TOML whose comments and order the scene keeps; empty if it was made from values.
    contents : of the files that the scene names, by these names, as they were read.
    """

    file: str = ""
    folder: Path | None = None
    text: str = ""
    contents: Mapping[str, bytes] = field(default_factory=lambda: MappingProxyType({}))

    @classmethod
    def of(cls, file: str, folder: str | Path | None, text: str = "") -> Self:
        """Of a scene in `folder`, or in that of its file."""
        if folder is None:
            return cls(file, Path(file).resolve().parent if file else None, text)
        return cls(file, Path(folder).resolve(), text)

    def having(self, contents: Mapping[str, bytes]) -> Self:
        """The same with these contents of its files."""
        return replace(self, contents=MappingProxyType(dict(contents)))
