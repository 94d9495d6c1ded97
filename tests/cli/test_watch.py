"""`camgeo watch`: what counts as a change, and a line for each run; no test waits for a clock."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from camgeo.app.cli import watch as command
from camgeo.app.cli.main import main
from camgeo.app.cli.watch import SceneFiles, watch
from camgeo.scene.values import stamp
from tests.waiting import ended

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"

LINE = re.compile(r"^\d\d:\d\d:\d\d  (.*) \(\d+\.\d s\)$")

Capture = pytest.CaptureFixture[str]


class Steps:
    """Stands for the time between two looks: the next thing happens, then the watch is stopped."""

    def __init__(self, *steps: Callable[[], object]) -> None:
        self.steps = list(steps)

    def __call__(self, _seconds: float = 0.0) -> None:
        if not self.steps:
            raise KeyboardInterrupt
        self.steps.pop(0)()


def nothing() -> None:
    """Time passes."""


def put(path: Path, text: str) -> Callable[[], object]:
    """Replaces a file as editors do: another file takes its name."""

    def replaced() -> None:
        other = path.with_suffix(".tmp")
        other.write_text(text)
        other.replace(path)

    return replaced


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    """A scene that names a file, in a folder of its own."""
    for name in ("points.toml", "points_speed.csv"):
        shutil.copy(SCENES / name, tmp_path)
    return tmp_path / "points.toml"


def runs_of(scene: Path, steps: Steps) -> int:
    done: list[int] = []
    with pytest.raises(KeyboardInterrupt):
        watch(SceneFiles(str(scene)).stamps, lambda: done.append(1), steps)
    return len(done)


def test_it_runs_at_once_and_not_again_without_a_change(scene: Path) -> None:
    assert runs_of(scene, Steps(nothing, nothing)) == 1


def test_it_runs_again_when_the_scene_or_a_file_that_it_names_changes(scene: Path) -> None:
    text, data = scene.read_text(), scene.with_name("points_speed.csv")
    assert runs_of(scene, Steps(put(scene, text + "\n"), nothing, nothing)) == 2
    other = put(data, data.read_text() + "\n")
    assert runs_of(scene, Steps(other, nothing, put(scene, text), nothing, nothing)) == 3
    assert runs_of(scene, Steps(put(scene.with_name("another.csv"), "1"), nothing)) == 1


def test_a_file_replaced_by_one_of_the_same_size_and_time_is_another(scene: Path) -> None:
    found = scene.stat()

    def replaced() -> None:
        put(scene, scene.read_text().replace("1", "2"))()
        os.utime(scene, ns=(found.st_atime_ns, found.st_mtime_ns))

    before = stamp(scene)
    replaced()
    assert before is not None
    assert stamp(scene) != before


def test_a_file_that_is_being_written_is_left_alone(scene: Path) -> None:
    """Three writings with a look between them are one change."""
    text = scene.read_text()
    parts = (text[: len(text) // 3 * count] for count in (1, 2, 3))
    steps = (lambda part=part: scene.write_text(part) for part in parts)
    assert runs_of(scene, Steps(*steps, nothing, nothing)) == 2


def test_a_broken_scene_and_a_missing_file_are_seen_to_be_mended(scene: Path) -> None:
    """The file is known from the text even while the scene does not load."""
    text, data = scene.read_text(), scene.with_name("points_speed.csv")
    content = data.read_text()
    data.unlink()
    steps = Steps(put(data, content), nothing, put(scene, "x ="), nothing, scene.unlink, nothing,
                  put(scene, text), nothing, nothing)  # fmt: skip
    assert runs_of(scene, steps) == 5


def test_each_run_is_a_line_and_the_picture_is_renewed(
    scene: Path, monkeypatch: pytest.MonkeyPatch, capsys: Capture
) -> None:
    text, target = scene.read_text(), scene.with_name("a.svg")
    broken = text.replace("camgeo = 1", "camgeo = 1\nnonsense = 2\nmore = 3")
    pictures: list[bytes] = []

    def look() -> None:
        pictures.append(target.read_bytes())

    steps = Steps(look, put(scene, broken), nothing, look, put(scene, text.replace("12", "13", 1)),
                  nothing, look)  # fmt: skip
    monkeypatch.setattr("camgeo.app.cli.watch.time.sleep", steps)
    assert main(["watch", str(scene), "motion", "-o", str(target)]) == 0
    captured = capsys.readouterr()
    found = [LINE.match(line) for line in captured.out.splitlines()]
    assert all(found)
    first, second, third = (each[1] for each in found if each)
    assert first == f"points: all limits kept, 1 warning; {target}"
    assert second.startswith(f"{scene}: line ")
    assert second.endswith("(and 1 more fault)")
    assert third.startswith("points: ")
    assert pictures[0] == pictures[1] != pictures[2]
    assert captured.err.strip() == ""


def test_broken_limits_are_named() -> None:
    """In a line, the worst first, each name once."""
    import camgeo
    from camgeo.app.answers.check import check

    scene = camgeo.load(SCENES / "setzhub.toml").scene
    hard = scene.with_values({"limits.transmission_angle": 80, "limits.radius_ratio": 0.01})
    verdict = command._verdict(check(camgeo.Design(hard)))
    assert verdict.startswith("2 bad findings: ")
    assert "transmission-angle" in verdict
    assert "radius-ratio-inner" in verdict


def test_an_existing_picture_is_not_overwritten_unasked(scene: Path, capsys: Capture) -> None:
    target = scene.with_name("points.png")
    target.write_bytes(b"mine")
    with pytest.raises(SystemExit):
        main(["watch", str(scene), "-o", str(target), "--runs", "1"])
    assert target.read_bytes() == b"mine"
    assert "--force" in capsys.readouterr().err


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 0), (signal.SIGTERM, 143)])
def test_ctrl_c_is_a_clean_end_and_other_signals_are_not(
    scene: Path, number: int, code: int
) -> None:
    words = [sys.executable, "-m", "camgeo", "watch", str(scene), "motion", "--every", "3600"]
    with subprocess.Popen(
        words, cwd=scene.parent, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        assert "points.png" in process.stdout.readline()
        process.send_signal(number)
        assert ended(process) == code
        assert "Traceback" not in process.stderr.read()
