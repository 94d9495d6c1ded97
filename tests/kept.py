"""Whole results, kept in fixtures/results and compared with what the same doors give now.

    python -m tests.kept

writes all of them anew, by running the modules `test_kept*.py` that make them; what changed is
read in the difference of the files. For texts, documents, pictures and layouts, which no second
computation is at hand for: what has a formula is tested by it.

Numbers are kept to ten digits and compared within 1e-9 of themselves. What differs from machine to
machine or from version to version is left out: times, folders, hashes, versions.
"""

from __future__ import annotations

import contextlib
import io
import json
import math
import os
import re
import sys
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest

from camgeo.cli.main import main as camgeo

FOLDER: Final = Path(__file__).parents[1] / "fixtures" / "results"

WRITTEN_ANEW: Final = "CAMGEO_WRITE_RESULTS"
"""Variable that asks for files to be written, not compared."""

CLOSE: Final = 1e-9
"""Relative difference of numbers that are the same."""

NOTHING: Final = 1e-12
"""Numbers below this are rounding errors of 0."""

LONG: Final = 5
"""Digits from which on the last one of a text may be rounded either way."""

WIDTH: Final = 100
"""Columns of a line of a document."""

NUMBER: Final = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[+-]?\d+)?(?![\w.]*\w)")

HASH: Final = re.compile(r"\b[0-9a-f]{12,64}\b")

LEFT_OUT: Final = frozenset({"camgeo", "sha256", "seconds_spent"})
"""Keys of documents."""


def short(number: float) -> str:
    """A number as it is kept."""
    return "0" if abs(number) < NOTHING else f"{number:.10g}"


def summary(array: Any) -> dict[str, Any]:
    """Of many numbers what a change of any of them would change; few are left as they are."""
    values = np.asarray(array, np.float64)
    if values.size <= LONG:
        return {"values": values.tolist()}
    found = values[np.isfinite(values)]
    steps = np.arange(1, found.size + 1) / max(found.size, 1)
    return {
        "shape": list(values.shape),
        "finite": int(found.size),
        "ends": [float(found[0]), float(found[-1])] if found.size else [],
        "range": [float(found.min()), float(found.max())] if found.size else [],
        "mean": float(found.mean()) if found.size else None,
        "moment": float(found @ steps / found.size) if found.size else None,
    }


def document(data: Any, indent: int = 0) -> str:
    """JSON of which each value that fits into a line stands in one."""
    line = _line(data)
    if len(line) + indent <= WIDTH or not isinstance(data, Mapping | list | tuple):
        return line
    inner = " " * (indent + 1)
    if isinstance(data, Mapping):
        parts = [
            f"{inner}{json.dumps(key)}: {document(each, indent + 1)}"
            for key, each in data.items()
            if key not in LEFT_OUT
        ]
        return "{\n" + ",\n".join(parts) + "}"
    return "[\n" + ",\n".join(inner + document(each, indent + 1) for each in data) + "]"


def _line(data: Any) -> str:
    if isinstance(data, bool) or data is None or isinstance(data, str):
        return json.dumps(data, ensure_ascii=False)
    if isinstance(data, int | float):
        return short(data) if math.isfinite(data) else str(data)
    if isinstance(data, Mapping):
        pairs = (f"{json.dumps(k)}: {_line(v)}" for k, v in data.items() if k not in LEFT_OUT)
        return "{" + ", ".join(pairs) + "}"
    return "[" + ", ".join(map(_line, data)) + "]"


def same(kept: str, found: str) -> bool:
    """Whether two lines say the same, numbers within `CLOSE`."""
    if NUMBER.sub("#", kept) != NUMBER.sub("#", found):
        return False
    pairs = zip(NUMBER.findall(kept), NUMBER.findall(found), strict=True)
    return all(one == other or _near(one, other) for one, other in pairs)


def _near(kept: str, found: str) -> bool:
    if "." not in kept + found and "e" not in kept + found:
        return False
    digits = len(re.sub(r"e.*|\D|^-?0\.0*", "", kept))
    exponent = int(kept.partition("e")[2] or 0) - len(kept.partition("e")[0].partition(".")[2])
    unit = 1.01 * 10.0**exponent if digits >= LONG else 0.0
    difference = abs(float(kept) - float(found))
    return difference <= max(CLOSE * abs(float(kept)), unit, NOTHING)


def compare(name: str, parts: Iterable[tuple[str, str]]) -> None:
    """Compare results, each with the head that says what it is, with the file of that name."""
    found = "".join(f"## {head}\n{text.rstrip()}\n\n" for head, text in parts)
    path = FOLDER / name
    if os.environ.get(WRITTEN_ANEW):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(found, "utf-8")
        return
    before, after = path.read_text("utf-8").splitlines(), found.splitlines()
    head = ""
    for number, (one, other) in enumerate(zip(before, after, strict=False), 1):
        head = one if one.startswith("## ") else head
        if not same(one, other):
            pytest.fail(f"{path.name}:{number}, {head}\nkept  {one}\nfound {other}", pytrace=False)
    if len(before) != len(after):
        pytest.fail(f"{path.name} has {len(before)} lines, found {len(after)}", pytrace=False)


def called(lines: str, folder: Path) -> Iterator[tuple[str, str]]:
    """Calls of camgeo, one a line, and what each returns, prints and notifies of; {} in a line is a
    folder that is written to.
    """
    for line in filter(None, map(str.strip, lines.splitlines())):
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            try:
                code: object = camgeo([word.replace("{}", str(folder)) for word in line.split()])
            except SystemExit as stop:
                code = stop.code
        shown = out.getvalue()
        if shown.startswith("{"):
            shown = document(json.loads(shown)) + "\n"
        text = f"{shown}{err.getvalue()}".replace(str(folder), "{}")
        yield f"camgeo {line}: {code}", HASH.sub("(hash)", text)


def main() -> int:
    """Write all results anew."""
    for path in FOLDER.rglob("*.txt"):
        path.unlink()
    os.environ |= {WRITTEN_ANEW: "1", "CAMGEO_EVERY_CASE": "1"}
    tests = sorted(map(str, Path(__file__).parent.rglob("test_kept*.py")))
    return int(pytest.main(["-q", "-p", "no:cacheprovider", *tests]))


if __name__ == "__main__":
    sys.exit(main())
