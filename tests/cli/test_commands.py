"""The commands, called as the console script calls them."""

from __future__ import annotations

import csv
import io
import re
import subprocess
import sys
from pathlib import Path
from typing import Final

import pytest

import camgeo
from camgeo.app.cli.command import CLEARED, Progress, clear
from camgeo.app.cli.main import COMMANDS
from camgeo.design import writing
from camgeo.scene.toml import TEMPLATE_KINDS
from tests.cli.calling import SCENES, called
from tests.waiting import until

SETZHUB = SCENES / "setzhub.toml"


def python(code: str) -> subprocess.CompletedProcess[str]:
    """A process of its own."""
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)


@pytest.mark.parametrize("name", COMMANDS)
def test_help_has_an_example(name: str) -> None:
    found = called(name, "--help")
    assert found.code == 0
    assert f"example:\n  camgeo {name} " in found.out
    assert re.search(rf"^    {name}\s", called("--help").out, re.MULTILINE)


def test_help_loads_no_command() -> None:
    run = python(
        "import sys; from camgeo.app.cli.main import COMMANDS, main\n"
        "try:\n    main(['--help'])\nfinally:\n    print(*sys.modules, file=sys.stderr)"
    )
    loaded = set(run.stderr.split())
    assert "numpy" not in loaded
    names = [name.replace("-", "_") for name in COMMANDS]
    assert not loaded & {
        f"camgeo.app.{room}.{name}" for room in ("answers", "cli") for name in names
    }


@pytest.mark.parametrize("words", ["laws", "slotted-lever --frame 150 --swing 60 --speed 90"])
def test_without_a_picture_nothing_that_draws_is_loaded(words: str) -> None:
    run = python(
        f"import sys; from camgeo.app.cli.main import main; main({words.split()});"
        "print(*{name.partition('.')[0] for name in sys.modules}, file=sys.stderr)"
    )
    assert not {"matplotlib", "scipy", "camgeo_export"} & {*run.stderr.split()}


def test_version_and_module() -> None:
    run = subprocess.run(
        [sys.executable, "-m", "camgeo", "--version"], capture_output=True, text=True, check=True
    )
    assert run.stdout == f"camgeo {camgeo.__version__}\n"


WHOLE: Final = frozenset((TEMPLATE_KINDS[0], "groove", "conjugate-lever", "milled"))
"""Kinds of new scenes that are built in every format, the others as drawings."""


@pytest.mark.parametrize("kind", TEMPLATE_KINDS)
def test_new_scene_checks_and_builds(kind: str, tmp_path: Path) -> None:
    scene, out = tmp_path / "my-cam.toml", tmp_path / "out"
    assert called("new", kind, "-o", scene).code == 0
    assert called("new", kind).out == scene.read_text()
    assert called("check", scene).code == 0
    only = () if kind in WHOLE else ("--only", "dxf")
    assert called("build", scene, "-o", out, "--tolerance", "0.01", *only).code == 0
    assert (out / "certificate.json").exists()
    scene.write_text("mine")
    assert called("new", kind, "-o", scene).code == 2
    assert scene.read_text() == "mine"
    assert called("new", kind, "-o", scene, "--force").code == 0


def test_table_has_a_row_for_each_step() -> None:
    rows = list(csv.reader(io.StringIO(called("table", SETZHUB, "--step", "0.2").out)))
    assert len(rows) == 1 + 1800  # a counted-up float would give 1801
    assert [float(row[0]) for row in rows[1:]] == [number * 2 / 10 for number in range(1800)]


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize("stream", [io.StringIO, Terminal])
def test_progress_only_on_a_terminal_and_late(
    stream: type[io.StringIO], monkeypatch: pytest.MonkeyPatch
) -> None:
    seconds = iter([0.0, 0.5, 1.5, 2.5])
    monkeypatch.setattr("camgeo.app.cli.command.time.monotonic", lambda: next(seconds))
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
    monkeypatch.setattr("camgeo.app.cli.command.EVERY", 0.001)
    monkeypatch.setattr("camgeo.app.cli.command.PATIENCE", 0.0)
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


def test_interrupted_build_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from camgeo_export.stl import WRITER

    def interrupted(*arguments: object) -> None:
        raise KeyboardInterrupt

    call = ("build", SETZHUB, "-o", tmp_path / "out", "--only")
    with monkeypatch.context() as patch:
        patch.setattr(type(WRITER), "write", interrupted)
        found = called(*call, "csv,stl")
    assert found.code == 130
    assert "interrupted" in found.err
    assert not any(tmp_path.iterdir())
    monkeypatch.setattr(writing, "_write_durably", interrupted)
    assert called(*call, "csv").code == 130
    assert not any(tmp_path.iterdir())


def test_reader_that_has_had_enough() -> None:
    """`camgeo table ... | head -1` is no error."""
    command = f"{sys.executable} -m camgeo table {SETZHUB} --step 0.05 | head -1"
    run = subprocess.run(["sh", "-c", command], capture_output=True, text=True, check=True)
    assert run.stdout.startswith("phi [deg],")
    assert run.stderr == ""
