"""The files that the scene on a desk names, and whether they have changed."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Final

from camgeo.scene.named import Stamp, named, stamp

LONGEST: Final = 200_000
"""Most characters of a text that is searched for names; searching holds up other threads."""


class NamedFiles:
    """The files that a text names, checked at intervals."""

    def __init__(self) -> None:
        self._text = ""
        self._files: tuple[Path, ...] = ()
        self._seen: dict[Path, Stamp] = {}

    async def changed(self, text: str, folder: Path) -> bool:
        """Whether a file that the `text` names has changed since the last call; not on the first.

        While the text is not TOML, the last known names count.
        """
        if text != self._text and len(text) <= LONGEST:
            self._text = text
            found = await asyncio.to_thread(named, text, folder)
            self._files = self._files if found is None else found
        now = {path: stamp(path) for path in self._files}
        seen, self._seen = self._seen, now
        return any(seen.get(path, now[path]) != now[path] for path in now)
