"""Copies of the package, to which a test adds something new."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import camgeo


def copied(folder: Path) -> Path:
    """The package as it stands in a copy in `folder`, with what is compiled of it: times of files
    are kept, so that of the copy only what is changed is compiled again.
    """
    package = folder / "camgeo"
    ignored = shutil.ignore_patterns("*.pyc.*")  # which others are just writing
    shutil.copytree(Path(camgeo.__file__).parent, package, ignore=ignored)
    return package


def replaced(path: Path, *changes: tuple[str, str]) -> None:
    """Put other text in place of some that stands once in a file of the copy."""
    text = path.read_text(encoding="utf-8")
    for old, new in changes:
        assert text.count(old) == 1
        text = text.replace(old, new)
    path.write_text(text, encoding="utf-8")


def run_copy(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run Python on the copy in `folder`."""
    return subprocess.run(
        [sys.executable, *arguments],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(folder)},
        capture_output=True,
        text=True,
        check=False,
    )


SESSION: Final = """
import contextlib, io, json, sys
from camgeo.app.cli.main import main

def call(words):
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            code = main(words)
        except SystemExit as end:
            code = end.code
    return code or 0, out.getvalue(), err.getvalue()

print(json.dumps([call(words) for words in json.loads(sys.argv[1])]))
"""


def commands(folder: Path, *calls: Sequence[str]) -> list[tuple[int, str, str]]:
    """Exit code, output and errors of commands of the copy in `folder`, one after the other in one
    process.
    """
    done = run_copy(folder, "-c", SESSION, json.dumps(calls))
    assert done.returncode == 0, done.stderr
    return [(code, out, err) for code, out, err in json.loads(done.stdout)]


def check_refused(folder: Path, scene: str, faults: Sequence[tuple[str, str, str]]) -> None:
    """Each fault, a text of the scene with another one in its place, is refused with a message."""
    for number, (old, new, _) in enumerate(faults):
        assert old in scene
        (folder / f"wrong{number}.toml").write_text(scene.replace(old, new), encoding="utf-8")
    answers = commands(folder, *(["check", f"wrong{number}.toml"] for number in range(len(faults))))
    for (code, _, reported), (*_, expected) in zip(answers, faults, strict=True):
        assert code == 2
        assert expected in reported


def check_page(folder: Path, name: str, text: str) -> None:
    """The script of a page of docs, in the copy, writes it with a text."""
    done = run_copy(folder, f"docs/{name}_page.py")
    assert done.returncode == 0, done.stderr
    assert text in (folder / "docs" / f"{name}.md").read_text("utf-8")
