"""The JSON Schema of a declaration, which lies beside its module."""

from __future__ import annotations

import json
import pathlib
from typing import Any


def schema_beside(file: str) -> dict[str, Any]:
    """The JSON Schema beside the module `file`: of its stem, beside a package schema.json."""
    path = pathlib.Path(file)
    name = "schema.json" if path.stem == "__init__" else f"{path.stem}.json"
    found: dict[str, Any] = json.loads(path.with_name(name).read_bytes())
    return found
