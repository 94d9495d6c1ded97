"""Whole results, kept in fixtures/results and compared with what the same doors give now.

    python -m tests.kept

writes all of them anew, by running the tests that make them, `test_..._as_kept`; what changed is
read in the difference of the files. For texts, documents, pictures and layouts, which no second
computation is at hand for: what has a formula is tested by it.

Numbers are kept to ten digits and compared within 1e-9 of themselves. What differs from machine to
machine or from version to version is left out: times, folders, hashes, versions. All is written
twice, the second time as an older processor computes: of numbers that differ, such as the places of
equal extremes, `~` is kept, which any number is equal to. Of a line with a rounding error, such as
2e-15 degrees at a joint, only the words count: whose error is the largest is up to the processor.
"""

from __future__ import annotations

import contextlib
import io
import itertools
import json
import math
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from html.parser import HTMLParser
from pathlib import Path
from typing import Any, Final
from unittest import mock

import numpy as np
import pytest

from camgeo.app.cli.main import main as camgeo

FOLDER: Final = Path(__file__).parents[1] / "fixtures" / "results"

WRITTEN_ANEW: Final = "CAMGEO_WRITE_RESULTS"
"""Variable with the folder that files are written to, not compared."""

MAKERS: Final = "as_kept"
"""How the names of the tests end that make them."""

CLOSE: Final = 1e-9
"""Relative difference of numbers that are the same."""

PLACES: Final = re.compile("cam.angle")
ROUGH: Final = 1e-7
"""What lines name cam angles; there numbers are the same within this: where a value is largest is
known to half of its digits."""

NOTHING: Final = 1e-11
"""Numbers below this are rounding errors of 0."""

LONG: Final = 5
"""Digits from which on the last one of a text may be rounded either way."""

WIDTH: Final = 100
"""Columns of a line of a document."""

ROUNDING: Final = 1e-10
"""Numbers below this in a text are rounding errors of something else."""

HEAD: Final = "## "
"""Begins the line that says what a result is."""

ANY: Final = "~"
"""Stands for a number that differs between processors."""

NUMBER: Final = re.compile(r"~|(?<![\w.])-?\d+(?:\.\d+)?(?:e[+-]?\d+)?(?![\w.]*\w)")

HASH: Final = re.compile(
    r"\b(?=\w*[a-f])[0-9a-f]{12,64}\b|\b[\d,]+(?= bytes)|(?<=camgeo )\d+\.\d+\.\d+"
)

USAGE: Final = re.compile(r"^usage: .*?\n(?=\S)", re.DOTALL)
"""Words of argparse, which break lines as each version of Python likes."""

LEFT_OUT: Final = frozenset({"camgeo", "sha256", "bytes"})
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


def marks(value: Any, indent: int = 0) -> str:
    """Data classes, one a line: their fields that differ from the default, arrays in short."""
    if isinstance(value, np.ndarray):
        pairs = value.view(np.float64) if np.iscomplexobj(value) else value
        parts = (f"{_line(each)}" for each in summary(pairs).values())
        return f"<{' '.join(parts)}>"
    if isinstance(value, complex):
        return f"({short(value.real)}, {short(value.imag)})"
    if isinstance(value, tuple):
        found = [marks(each, indent + 1) for each in value]
        if any(map(is_dataclass, value)):
            return "[" + "".join(f"\n{' ' * (indent + 1)}{each}" for each in found) + "]"
        return "[" + ", ".join(found) + "]"
    if not is_dataclass(value):
        return _line(value)
    stated = (
        f"{each.name}={marks(own, indent)}"
        for each in fields(value)
        if (own := getattr(value, each.name)) is not each.default
        and (isinstance(own, np.ndarray) or own != each.default)
    )
    return f"{type(value).__name__}({', '.join(stated)})"


def same(kept: str, found: str) -> bool:
    """Whether two lines say the same, numbers within `CLOSE`, places of extremes within `ROUGH`."""
    pairs = _pairs(kept, found)
    if pairs is None:
        return False
    if any(map(_is_rounding, itertools.chain(*pairs))):
        return True
    close = ROUGH if PLACES.search(kept) else CLOSE
    return all(_equal(*each, close) for each in pairs)


def common(line: str, other: str) -> str:
    """What two processors agree on of a line; ValueError if their words differ."""
    pairs = _pairs(line, other)
    if pairs is None:
        raise ValueError(f"{line}\n{other}")
    if same(line, other):
        return line
    numbers = iter([one if _equal(one, two, CLOSE) else ANY for one, two in pairs])
    return NUMBER.sub(lambda _: next(numbers), line)


def _pairs(kept: str, found: str) -> list[tuple[str, str]] | None:
    """The numbers of two lines; None if their words differ.

    Beside a rounding error, which is longer than a 0, columns may be wider.
    """
    numbers = NUMBER.findall(kept), NUMBER.findall(found)
    words = NUMBER.sub(ANY, kept), NUMBER.sub(ANY, found)
    if any(map(_is_rounding, itertools.chain(*numbers))):
        words = re.sub(" +", " ", words[0]), re.sub(" +", " ", words[1])
    return list(zip(*numbers, strict=True)) if words[0] == words[1] else None


def _equal(kept: str, found: str, close: float) -> bool:
    return kept in (ANY, found) or _near(kept, found, close)


def _is_rounding(number: str) -> bool:
    return number != ANY and 0.0 < abs(float(number)) < ROUNDING


def _near(kept: str, found: str, close: float) -> bool:
    if "." not in kept + found and "e" not in kept + found:
        return False
    digits = len(re.sub(r"e.*|\D|^-?0\.0*", "", kept))
    exponent = int(kept.partition("e")[2] or 0) - len(kept.partition("e")[0].partition(".")[2])
    unit = 1.01 * 10.0**exponent if digits >= LONG else 0.0
    difference = abs(float(kept) - float(found))
    return difference <= max(close * abs(float(kept)), unit, NOTHING)


def compare(name: str, parts: Iterable[tuple[str, str]], *, whole: bool = True) -> None:
    """Compare results, each with the head that says what it is, with the file of that name; of
    which there are others, too, where `parts` are not the `whole`.
    """
    found = "".join(f"{HEAD}{head}\n{text.rstrip()}\n\n" for head, text in parts)
    found = HASH.sub("(...)", found.replace(f"{FOLDER.parents[1]}/", ""))
    path = Path(os.environ.get(WRITTEN_ANEW, FOLDER)) / name
    if WRITTEN_ANEW in os.environ:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(found, "utf-8")
        return
    before, after = path.read_text("utf-8").splitlines(), found.splitlines()
    if not whole:
        heads = {line for line in after if line.startswith(HEAD)}
        before = [line for head, line in _under_heads(before) if head in heads]
    pairs = zip(_under_heads(before), after, strict=False)
    for number, ((head, one), other) in enumerate(pairs, 1):
        if not same(one, other):
            pytest.fail(f"{path.name}:{number}, {head}\nkept  {one}\nfound {other}", pytrace=False)
    if len(before) != len(after):
        pytest.fail(f"{path.name} has {len(before)} lines, found {len(after)}", pytrace=False)


def _under_heads(lines: Iterable[str]) -> Iterator[tuple[str, str]]:
    """Each line with the head that it stands under."""
    head = ""
    for line in lines:
        head = line if line.startswith(HEAD) else head
        yield head, line


def compare_documents(name: str, parts: Mapping[str, Any], *, whole: bool = True) -> None:
    """Compare documents with the file of that name, in which small letters and digits stand."""
    path = re.sub(r"[^a-z0-9/]+", "_", name.lower())
    compare(f"{path}.txt", ((head, document(each)) for head, each in parts.items()), whole=whole)


def called(
    lines: str, folder: Path, judge: Callable[[dict[str, Any]], None] = lambda _: None
) -> Iterator[tuple[str, str]]:
    """Calls of camgeo, one a line, and what each returns, prints and notifies of.

    {} in a line is a folder that is written to. The clock goes on by a second each time it is read.
    Documents are judged before anything is left out of them.
    """
    for line in filter(None, map(str.strip, lines.splitlines())):
        out, err = io.StringIO(), io.StringIO()
        ticks = map(float, itertools.count())
        with (
            contextlib.redirect_stdout(out),
            contextlib.redirect_stderr(err),
            mock.patch("time.perf_counter", lambda ticks=ticks: next(ticks)),
            mock.patch("time.process_time", lambda ticks=ticks: next(ticks)),
        ):
            try:
                code: object = camgeo([word.replace("{}", str(folder)) for word in line.split()])
            except SystemExit as stop:
                code = stop.code
        shown = out.getvalue()
        if shown.startswith("{"):
            data = json.loads(shown)
            judge(data)
            shown = document(data) + "\n"
        notes = USAGE.sub("", err.getvalue())
        yield f"camgeo {line}: {code}", f"{shown}{notes}".replace(str(folder), "{}")


def elements(page: str) -> str:
    """The elements of a page in lines, with the texts in them; of long ones the length."""
    lines: list[str] = []

    class Reader(HTMLParser):
        program = False

        def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
            self.program = tag in ("script", "style")
            own = (f" {name}={_cut(value or '')}" for name, value in attrs if name != "content")
            lines.append(f"<{tag}{''.join(own)}>")

        def handle_data(self, data: str) -> None:
            if not self.program and data.strip():
                lines.append(data.strip().replace("\n", "|"))

        def handle_endtag(self, tag: str) -> None:
            self.program = False
            lines.append(f"</{tag}>")

    Reader().feed(page)
    # Elements that hold one text stand in a line.
    return re.sub(r"(<[^/\n][^\n]*>)\n([^<\n]*)\n?(</[^\n]*>)", r"\1\2\3", "\n".join(lines))


def _cut(text: str) -> str:
    return text if len(text) <= WIDTH else f"{len(text)} characters"


def files(folder: Path) -> Iterator[tuple[str, str]]:
    """The files that calls have written into a folder: of long tables the sums."""
    for path in sorted(each for each in folder.rglob("*") if each.is_file()):
        text = path.read_text("utf-8")
        if path.suffix == ".json":
            text = document(json.loads(text))
        elif path.suffix == ".csv":
            head, *rows = text.splitlines()
            if len(rows) > LONG:
                cells = [[each or "nan" for each in row.split(",")] for row in rows]
                text = f"{head}\n{document(summary(cells))}"
            else:
                text = "\n".join((head, *(NUMBER.sub(_shortened, each) for each in rows)))
        yield path.name, text


def _shortened(found: re.Match[str]) -> str:
    return short(float(found[0])) if "." in found[0] else found[0]


def main() -> int:
    """Write all results anew, by this processor and by an older one."""
    from tests.end_to_end.repeats import BLAS, LIBM, NUMPY

    modules = sorted(Path(__file__).parent.rglob("test_*.py"))
    tests = [str(path) for path in modules if MAKERS in path.read_text("utf-8")]
    words = ["-m", "pytest", "-q", "-n", "auto", "-p", "no:cacheprovider", "-k", MAKERS, *tests]
    with tempfile.TemporaryDirectory() as place:
        folders = [Path(place) / "this", Path(place) / "older"]
        for folder, features in zip(folders, ({}, {**NUMPY, **BLAS, **LIBM}), strict=True):
            own = {WRITTEN_ANEW: str(folder), "CAMGEO_EVERY_CASE": "1"}
            subprocess.run([sys.executable, *words], env=os.environ | own | features, check=True)
        for path in FOLDER.rglob("*.txt"):
            path.unlink()
        for path in sorted(folders[0].rglob("*.txt")):
            name = path.relative_to(folders[0])
            both = [(each / name).read_text("utf-8").splitlines() for each in folders]
            (FOLDER / name).parent.mkdir(parents=True, exist_ok=True)
            try:
                lines = [common(*each) for each in zip(*both, strict=True)]
            except ValueError as error:
                sys.exit(f"{name} differs between processors: {error}")
            (FOLDER / name).write_text("".join(f"{each}\n" for each in lines), "utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
