"""Drawings of many entities: memory, progress, and an error with its line."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from pathlib import Path

import pytest

from camgeo.errors import FileError
from camgeo_export.dxf.reader import READER

HEAD = "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n"

MOST = 20.0
"""Bytes of memory for a byte of the file."""

CHILD = """
import json, sys
from pathlib import Path
import scipy.sparse.csgraph, scipy.spatial
from camgeo_export.dxf.reader import READER
def peak():
    rows = Path("/proc/self/status").read_text().splitlines()
    return 1024.0 * float(next(row for row in rows if row.startswith("VmHWM")).split()[1])
data = Path(sys.argv[1]).read_bytes()
before = peak() - len(data)
read = READER.read(data, "a.dxf", layer=None, unit=None, gap=1e-3)
print(json.dumps([(peak() - before) / len(data), len(read.contours[0]), len(read.notes)]))
"""


def line(x: float, y: float, u: float, v: float) -> str:
    ends = f"10\n{x:.9f}\n20\n{y:.9f}\n30\n0.0\n11\n{u:.9f}\n21\n{v:.9f}\n31\n0.0\n"
    return f"0\nLINE\n8\nCONTOUR\n62\n7\n{ends}"


def drawing(count: int) -> str:
    """A circle of `count` lines, and as many that are loose."""
    turn = 2.0 * math.pi / count
    places = [(100.0 * math.cos(turn * k), 100.0 * math.sin(turn * k)) for k in range(count)]
    round_lines = [line(*places[k - 1], *places[k]) for k in range(count)]
    loose = [line(k, 200.0 + k % 7, k + 0.5, 200.0) for k in range(count)]
    return "".join((HEAD, *round_lines, *loose, "0\nENDSEC\n0\nEOF\n"))


def test_progress_and_the_line_of_an_error() -> None:
    text = drawing(5_000)
    steps: list[str] = []
    read = READER.read(
        text.encode(), "a.dxf", layer=None, unit=None, gap=0.0, progress=steps.append
    )
    (circle,) = read.contours
    assert len(circle) == 5_000
    assert "5,000 pieces left out" in read.notes[0]
    assert steps[0] == "a.dxf, 0 % read"
    assert any(step == "a.dxf, 0 entities taken" for step in steps)
    place = text.rindex("\n21\n200.0")
    broken = text[:place] + "\n21\n200,0" + text[place + len("\n21\n200.0") :]
    number = text[: place + 4].count("\n") + 1
    with pytest.raises(FileError, match=rf"a.dxf, line {number}: '200,0.*' is not a finite number"):
        READER.read(broken.encode(), "a.dxf", layer=None, unit=None, gap=0.0)


@pytest.mark.long  # of 100 MB and a million entities
@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="states no peak of memory")
def test_memory_is_in_proportion_to_the_file(tmp_path: Path) -> None:
    file = tmp_path / "large.dxf"
    file.write_text(drawing(500_000))
    assert file.stat().st_size > 80_000_000
    done = subprocess.run(
        [sys.executable, "-c", CHILD, str(file)], capture_output=True, text=True, check=True
    )
    share, pieces, notes = json.loads(done.stdout)
    assert share <= MOST
    assert (pieces, notes) == (500_000, 1)
