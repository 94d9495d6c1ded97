"""The result of `camgeo lint`, rendered as text and as JSON."""

from __future__ import annotations

import errno
import json
import os
from dataclasses import replace
from pathlib import Path

import pytest

from camgeo.app.answers.answer import BROKEN, FINE, WRONG, text
from camgeo.app.answers.lint import Lint, lint
from camgeo.app.cli.main import main
from camgeo.design.linting import WorkData
from tests.answers.documents import document
from tests.interpreter.programs import GOOD


def of(folder: Path, *texts: str, machine: str = "linuxcnc") -> Lint:
    paths = [folder / f"{k}.nc" for k in range(len(texts))]
    for path, each in zip(paths, texts, strict=True):
        path.write_text(each)
    return lint(paths, machine, WorkData(clearance=5.0))


@pytest.mark.parametrize("machine", GOOD)
def test_nothing_is_found_in_a_good_program(machine: str, tmp_path: Path) -> None:
    found = of(tmp_path, GOOD[machine], machine=machine)
    assert found.exit_code == FINE
    assert document(found)["clean"] is True
    assert "no findings" in text(found)


def test_text_and_document_are_of_one_result(tmp_path: Path) -> None:
    found = of(tmp_path, GOOD["grbl"].replace("M2\n", ""), machine="grbl")
    (program,) = found.programs
    assert program.linted is not None
    (finding,) = program.linted.findings
    two = (replace(finding, what="the moon"), replace(finding, what="the sun"))
    changed = replace(program.linted, findings=two, complete=False)
    other = replace(found, programs=(replace(program, linted=changed),))
    assert document(other)["programs"][0]["findings"][0]["what"] == "the moon"
    assert "line" not in document(other)["programs"][0]["findings"][0]
    assert "the program\n            no-end: the moon" in text(other)
    assert text(other).count("the program\n") == 1 == text(other).count("no-end: the sun")
    assert "rest of the program was not read" in text(other)


def test_a_file_that_cannot_be_read_takes_nothing_from_the_others(tmp_path: Path) -> None:
    (tmp_path / "0.nc").write_text(GOOD["linuxcnc"])
    (tmp_path / "large.nc").write_bytes(b"G0\n" * 300_000)
    paths = [tmp_path / name for name in ("none.nc", "0.nc", "large.nc")]
    found = lint(paths, "linuxcnc", WorkData(clearance=5.0))
    assert found.exit_code == WRONG
    programs = document(found)["programs"]
    assert os.strerror(errno.ENOENT) in programs[0]["refused"]
    assert "refused" not in programs[1]
    assert "200,000" in programs[2]["refused"]


def test_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "a.nc"
    path.write_text(GOOD["fanuc"])
    assert main(["lint", str(path), "--machine", "fanuc", "--clearance", "5"]) == FINE
    capsys.readouterr()
    assert main(["lint", str(path), "--machine", "fanuc", "--clearance", "6", "--json"]) == BROKEN
    assert json.loads(capsys.readouterr().out)["clearance_mm"] == 6.0
    wear = ["--machine", "fanuc", "--clearance", "5", "--radius", "1=-0.2"]
    assert main(["lint", str(path), *wear]) == FINE
