"""The JSON Schema of a declaration, stored next to its module."""

from __future__ import annotations

import json
import pathlib
from typing import Any


def schema_beside(file: str, name: str = "") -> dict[str, Any]:
    """The JSON Schema `name` in the folder of the module `file`.

    By default the one with the module's stem, or schema.json for a package.
    """
    path = pathlib.Path(file)
    stem = name or ("schema" if path.stem == "__init__" else path.stem)
    found: dict[str, Any] = json.loads(path.with_name(f"{stem}.json").read_bytes())
    return found
