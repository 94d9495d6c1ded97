"""The commands, called as the console script calls them."""

from __future__ import annotations

import csv
import io
import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Final

import numpy as np
import pytest

import camgeo
from camgeo.app.cli.main import COMMANDS, main
from camgeo.app.cli.progress import CLEARED, Progress, clear
from camgeo.design import writing
from camgeo.scene.toml import TEMPLATE_KINDS
from camgeo.units import MM_PER
from tests.waiting import until

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"

SETZHUB = str(SCENES / "setzhub.toml")

NAMES = (
    "new", "check", "build", "verify", "lint", "table", "plot", "setup", "replay", "accuracy",
    "laws", "explain", "slotted-lever", "import", "size",
    "machines", "probe", "inspect", "watch", "report", "design", "sweep", "compare", "optimise",
    "tolerance",
)  # fmt: skip

Capture = pytest.CaptureFixture[str]


@pytest.mark.parametrize("name", NAMES)
def test_help_has_an_example(name: str, capsys: Capture) -> None:
    with pytest.raises(SystemExit) as stopped:
        main([name, "--help"])
    assert stopped.value.code == 0
    assert f"example:\n  camgeo {name} " in capsys.readouterr().out


def test_help_names_all_commands(capsys: Capture) -> None:
    assert len(COMMANDS) == len(NAMES)
    with pytest.raises(SystemExit):
        main(["--help"])
    out = capsys.readouterr().out
    assert all(re.search(rf"^    {name}\s", out, re.MULTILINE) for name in NAMES)


def test_help_loads_no_command() -> None:
    code = (
        "import sys; from camgeo.app.cli.main import COMMANDS, main\n"
        "try:\n    main(['--help'])\nfinally:\n    print(*sys.modules, file=sys.stderr)"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = set(run.stderr.split())
    assert "numpy" not in loaded
    assert not loaded & {f"camgeo.app.cli.{name.replace('-', '_')}" for name in COMMANDS}


def test_version_and_module() -> None:
    run = subprocess.run(
        [sys.executable, "-m", "camgeo", "--version"], capture_output=True, text=True, check=True
    )
    assert run.stdout == f"camgeo {camgeo.__version__}\n"


def test_check_of_a_good_scene_is_0(capsys: Capture) -> None:
    assert main(["check", SETZHUB]) == 0
    captured = capsys.readouterr()
    assert "BROKEN" not in captured.out
    assert captured.err == ""


def test_check_of_a_broken_limit_is_1(tmp_path: Path, capsys: Capture) -> None:
    scene = tmp_path / "strict.toml"
    text = Path(SETZHUB).read_text()
    assert text.count("transmission_angle = 41") == 1
    scene.write_text(text.replace("transmission_angle = 41", "transmission_angle = 45"))
    assert main(["check", str(scene)]) == 1
    (line,) = [line for line in capsys.readouterr().out.splitlines() if "BROKEN" in line]
    # 41.2 degrees is the least transmission angle of the thesis's own cam.
    assert "transmission-angle" in line
    assert "41.2" in line
    assert "45" in line
    # A broken limit is reported, but the files are the designer's decision.
    assert main(["build", str(scene), "-o", str(tmp_path / "out"), "--only", "csv"]) == 1
    captured = capsys.readouterr()
    assert "BROKEN" in captured.err
    assert (tmp_path / "out" / "setzhub.csv").exists()


def test_build_reports_what_it_wrote(tmp_path: Path, capsys: Capture) -> None:
    call = ["build", SETZHUB, "-o", str(tmp_path), "--only", "dxf,csv", "--tolerance", "0.01"]
    assert main(call) == 0
    captured = capsys.readouterr()
    assert {path.name for path in tmp_path.iterdir()} == {
        "setzhub.dxf", "setzhub.csv", "certificate.json",
    }  # fmt: skip
    assert len(captured.out.splitlines()) == 3
    assert "(tolerance 0.01 mm)" in captured.out
    assert captured.err == ""  # not a terminal: no progress
    # The same again needs no force, another tolerance does.
    assert main([*call, "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert [record["file"] for record in document["files"]] == ["setzhub.dxf", "setzhub.csv"]
    assert main([*call[:-1], "0.02"]) == 2
    assert "--force" in capsys.readouterr().err
    assert main([*call[:-1], "0.02", "--force"]) == 0


WHOLE: Final = frozenset((TEMPLATE_KINDS[0], "groove", "conjugate-lever", "milled"))
"""Kinds of new scenes that are built in every format, the others as drawings."""


@pytest.mark.parametrize("kind", TEMPLATE_KINDS)
def test_new_scene_checks_and_builds(kind: str, tmp_path: Path, capsys: Capture) -> None:
    scene = tmp_path / "my-cam.toml"
    assert main(["new", kind, "-o", str(scene)]) == 0
    assert main(["new", kind]) == 0
    assert capsys.readouterr().out == scene.read_text()
    assert main(["check", str(scene)]) == 0
    build = ["build", str(scene), "-o", str(tmp_path / "out"), "--tolerance", "0.01"]
    assert main([*build, *(() if kind in WHOLE else ("--only", "dxf"))]) == 0
    assert (tmp_path / "out" / "certificate.json").exists()
    scene.write_text("mine")
    assert main(["new", kind, "-o", str(scene)]) == 2
    assert scene.read_text() == "mine"
    assert main(["new", kind, "-o", str(scene), "--force"]) == 0


def test_table_has_a_row_for_each_step(tmp_path: Path, capsys: Capture) -> None:
    assert main(["table", SETZHUB, "--step", "0.2"]) == 0
    text = capsys.readouterr().out
    rows = list(csv.reader(io.StringIO(text)))
    assert len(rows) == 1 + 1800  # a counted-up float would give 1801
    degrees = [float(row[0]) for row in rows[1:]]
    assert degrees == [number * 2 / 10 for number in range(1800)]
    target = tmp_path / "table.csv"
    assert main(["table", SETZHUB, "--step", "0.2", "-o", str(target)]) == 0
    assert target.read_text() == text
    assert main(["table", SETZHUB, "--step", "90", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["columns"]["phi [deg]"] == [0.0, 90.0, 180.0, 270.0]


def test_table_in_inches(capsys: Capture) -> None:
    scene = SCENES / "inch.toml"
    assert main(["table", str(scene), "--step", "45"]) == 0
    rows = list(csv.reader(io.StringIO(capsys.readouterr().out)))
    column = rows[0].index("inner x [inch]")
    x = camgeo.load(scene).disc.pictured.curve("inner", np.radians([45.0]))[0, 0]
    assert float(rows[2][column]) == pytest.approx(x / MM_PER["inch"], rel=1e-15)


def test_plot(tmp_path: Path, capsys: Capture) -> None:
    target = tmp_path / "cam.svg"
    assert main(["plot", SETZHUB, "cam", "-o", str(target)]) == 0
    assert b"<svg" in target.read_bytes()
    assert main(["plot", SETZHUB, "cams", "-o", str(tmp_path / "b.svg")]) == 2
    assert 'did you mean "cam"?' in capsys.readouterr().err
    with pytest.raises(SystemExit) as stopped:
        main(["plot", SETZHUB, "cam", "-o", str(tmp_path / "b.gif")])
    assert stopped.value.code == 2
    assert not (tmp_path / "b.gif").exists()


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize("stream", [io.StringIO, Terminal])
def test_progress_only_on_a_terminal_and_late(
    stream: type[io.StringIO], monkeypatch: pytest.MonkeyPatch
) -> None:
    seconds = iter([0.0, 0.5, 1.5, 2.5])
    monkeypatch.setattr("camgeo.app.cli.progress.time.monotonic", lambda: next(seconds))
    terminal = stream()
    monkeypatch.setattr(sys, "stderr", terminal)
    progress = Progress()
    for step in ("early", "dxf: computing", "stl"):
        progress(step)
    clear()
    text = terminal.getvalue()
    assert "early" not in text
    assert ("dxf: computing" in text) == (stream is Terminal)
    # What was written over is taken away at the end.
    assert text.endswith(f"stl{CLEARED}") or text == ""


def test_a_long_step_is_seen_to_go_on(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("camgeo.app.cli.progress.EVERY", 0.001)
    monkeypatch.setattr("camgeo.app.cli.progress.PATIENCE", 0.0)
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    progress = Progress()
    progress.begin()
    progress("a long step")
    until("the step", lambda: terminal.getvalue().count("a long step") >= 5)
    progress.end()
    text = terminal.getvalue()
    assert text.endswith(CLEARED)
    progress("the next one")
    assert terminal.getvalue() == text


def test_interrupted_build_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    from camgeo_export.stl import WRITER

    def interrupted(*arguments: object) -> None:
        raise KeyboardInterrupt

    out = tmp_path / "out"
    with monkeypatch.context() as patch:
        patch.setattr(type(WRITER), "write", interrupted)
        assert main(["build", SETZHUB, "-o", str(out), "--only", "csv,stl"]) == 130
    assert "interrupted" in capsys.readouterr().err
    assert not any(tmp_path.iterdir())
    monkeypatch.setattr(writing, "_write_durably", interrupted)
    assert main(["build", SETZHUB, "-o", str(out), "--only", "csv"]) == 130
    assert not any(tmp_path.iterdir())


def test_reader_that_has_had_enough() -> None:
    """`camgeo table ... | head -1` is no error."""
    command = f"{sys.executable} -m camgeo table {SETZHUB} --step 0.05 | head -1"
    run = subprocess.run(["sh", "-c", command], capture_output=True, text=True, check=True)
    assert run.stdout.startswith("phi [deg],")
    assert run.stderr == ""


def test_an_outline_that_crosses_itself_is_refused(tmp_path: Path, capsys: Capture) -> None:
    """HC22: every check of the curvature holds, and yet there is no such disc."""
    scene = str(SCENES.parent / "refused" / "global_undercut.toml")
    assert main(["check", scene]) == 1
    out = capsys.readouterr().out
    assert "global undercut" in out
    assert "roller radius at most 13.5309 mm instead of 16 mm" in out
    assert main(["build", scene, "-o", str(tmp_path / "out")]) == 1
    assert "global undercut" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
