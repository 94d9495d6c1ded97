"""The files of the last build, for download."""

from __future__ import annotations

import base64
import io
import re
import zipfile
from collections.abc import Iterable, Mapping
from typing import Any, Final
from urllib.parse import quote

ALL: Final = "all.zip"
"""The name under which all files are downloaded as one."""

EARLIEST: Final = (1980, 1, 1, 0, 0, 0)
"""Time of files in an archive: always the same, so that the same files give the same bytes."""


class Files:
    """The files of the last build, by their names."""

    def __init__(self) -> None:
        self._data: dict[str, bytes] = {}
        self._build = 0

    def take(self, built: Iterable[Mapping[str, Any]]) -> list[dict[str, Any]]:
        """Replace the files by those of a build; return what pages are told about them."""
        self._data = {str(each["name"]): base64.b64decode(each["bytes"]) for each in built}
        self._build += 1
        return [
            {**_told(each), "url": f"/files/{quote(str(each['name']))}?build={self._build}"}
            for each in built
        ]

    def get(self, name: str, build: str) -> bytes | None:
        """The file of that name, if it is of the last build; `build` may be empty."""
        if build and build != str(self._build):
            return None
        if name == ALL and self._data and ALL not in self._data:
            return self._archive()
        return self._data.get(name)

    def _archive(self) -> bytes:
        stream = io.BytesIO()
        with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, data in self._data.items():
                archive.writestr(zipfile.ZipInfo(name, EARLIEST), data)
        return stream.getvalue()


def disposition(name: str) -> str:
    """The header that makes a browser save a file under its name."""
    plain = re.sub(r"[^A-Za-z0-9._-]", "_", name)
    return f"attachment; filename=\"{plain}\"; filename*=UTF-8''{quote(name, safe='')}"


def _told(each: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in each.items() if key != "bytes"}
