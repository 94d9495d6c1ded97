"""The suite as a program: table, JSON, picture and exit code."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest

from camgeo.app.cli.main import COMMANDS
from camgeo.app.cli.main import main as camgeo
from tests.stability import suite
from tests.stability.__main__ import known_names, main
from tests.stability.measure import Reading
from tests.stability.quick import CASES

Capture = pytest.CaptureFixture[str]

FEW = ["--only", "scca, b 0.3, d 0.2", "place of a cusp", "--quick"]
"""A law and the cusps: what is quick to run, with places of both kinds."""


def call(*words: str) -> int:
    return main(words)


def reading(error: float, conditioning: float = 1.0, quantity: str = "curvature") -> Reading:
    return Reading(quantity, "cams", "made up", math.pi, 0.25, error, conditioning)


@pytest.fixture
def found(monkeypatch: pytest.MonkeyPatch) -> list[Reading]:
    """The readings of the suite in a test that runs none of it; filled by the test."""
    readings: list[Reading] = []
    monkeypatch.setattr(suite, "run", lambda *_, **__: tuple(readings))
    monkeypatch.setattr(suite, "all_cases", tuple)
    return readings


@pytest.fixture(autouse=True)
def _cases_made_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Those of the suite, which take longer to make than commands to look through."""
    monkeypatch.setattr(suite, "all_cases", lambda: CASES)


def test_the_command_says_where_it_is(capsys: Capture) -> None:
    assert "stability" not in COMMANDS
    assert camgeo(["stability", "--quick"]) == 2
    assert "python -m tests.stability" in capsys.readouterr().err


def test_the_table(capsys: Capture) -> None:
    assert call(*FEW) == 0
    captured = capsys.readouterr()
    assert captured.err == ""
    lines = captured.out.splitlines()
    assert lines[0].split() == ["quantity", "values", "error", "conditioning", "at", "ratio"]
    quantities = {line.split("  ")[0] for line in lines[1 : lines.index("")]}
    assert quantities == {"f", "1 - f", "f'", "f''", "f'''", "place of a cusp"}
    assert lines[-1] == "limit of the ratio 64: kept"
    cusp = next(line for line in lines if line.startswith("place of a cusp"))
    assert "too large" in cusp
    assert " deg " in cusp


def test_json_has_the_same(capsys: Capture) -> None:
    assert call("--only", FEW[1], "--quick", "--json") == 0
    document: dict[str, Any] = json.loads(capsys.readouterr().out, parse_constant=pytest.fail)
    assert (document["kept"], document["quick"], document["limit"]) == (True, True, suite.LIMIT)
    by_name = {row["quantity"]: row for row in document["quantities"]}
    assert by_name["f"]["values"] == 2
    assert by_name["f"]["largest_error"]["case"] == FEW[1]
    assert 0.0 < by_name["f"]["largest_error"]["at"]["z"] < 1.0


def test_a_broken_limit_is_reported(found: list[Reading], capsys: Capture) -> None:
    found += [reading(65.0), reading(100.0, 2.0), reading(3.0, quantity="pitch curve Z")]
    assert call() == 1
    out = capsys.readouterr().out
    assert "limit of the ratio 64: broken" in out
    assert "  curvature: ratio 65 at made up, 180 deg, error 65, conditioning 1" in out


@pytest.mark.parametrize(
    ("name", "found"),
    [
        ("HC14", {f"HC14 return in 1e-6 degrees, {way}" for way in ("rise", "return")}),
        ("curvature", {"curvature"}),
        ("extremes", {"extremes"}),
    ],
)
def test_names_and_beginnings_of_cases(name: str, found: set[str]) -> None:
    assert known_names([name], suite.names(CASES)) == found


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--only", "curvatur e"], "there is no 'curvatur e'; did you mean \"curvature\"?"),
        (["-o", "stability.bmp"], "'stability.bmp' must end in one of .png, .svg, .pdf"),
    ],
)
def test_wrong_words(words: list[str], message: str, capsys: Capture) -> None:
    with pytest.raises(SystemExit) as end:
        main(words)
    assert end.value.code == 2
    assert message in capsys.readouterr().err


# The picture --------------------------------------------------------------------------------------

READINGS = (
    reading(0.0, 0.0),
    reading(3.0, 0.5),
    reading(2e15, 8e15, "curvature slope"),
    reading(70.0, 1.0, "pitch curve Z"),
)


def test_the_picture_is_written_next_to_the_table(
    found: list[Reading], tmp_path: Path, capsys: Capture
) -> None:
    found += [*READINGS[:3], reading(math.inf, 1.0, "Z'")]
    target = tmp_path / "stability.svg"
    assert call("-o", str(target)) == 1
    captured = capsys.readouterr()
    assert captured.out.startswith("quantity")
    assert captured.err == f"{target}: 2 points\n"
    assert target.read_bytes().startswith(b"<?xml")
