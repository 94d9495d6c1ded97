"""The JSON Schema of a declaration, which lies beside its module."""

from __future__ import annotations

import json
import pathlib
from typing import Any


def schema_beside(file: str, name: str = "") -> dict[str, Any]:
    """The JSON Schema `name` beside the module `file`.

    Without a name that of its stem, beside a package schema.json.
    """
    path = pathlib.Path(file)
    stem = name or ("schema" if path.stem == "__init__" else path.stem)
    found: dict[str, Any] = json.loads(path.with_name(f"{stem}.json").read_bytes())
    return found
