"""Commands as the console script calls them, in this process."""

from __future__ import annotations

import io
import json
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import pytest

from camgeo.app.cli.main import main

FIXTURES: Final = Path(__file__).parents[2] / "fixtures"

SCENES: Final = FIXTURES / "scenes"


@dataclass(frozen=True)
class Called:
    """How a call ended, and what it printed and notified of."""

    code: int
    out: str
    err: str

    @property
    def document(self) -> dict[str, Any]:
        """What it printed with `--json`, in which every number is finite."""
        found: dict[str, Any] = json.loads(self.out, parse_constant=pytest.fail)
        return found


def called(*words: object) -> Called:
    """A call of camgeo, whether or not argparse ends it."""
    out, err = io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(err):
        try:
            code = main([str(word) for word in words])
        except SystemExit as stopped:
            code = int(stopped.code or 0)
    return Called(code, out.getvalue(), err.getvalue())


def changed(scene: Path, target: Path, *changes: tuple[str, str], more: str = "") -> Path:
    """A copy of a scene in which each text, which stands there once, is replaced by another."""
    text = scene.read_text("utf-8")
    for old, new in changes:
        assert text.count(old) == 1
        text = text.replace(old, new)
    target.write_text(text + more, "utf-8")
    return target
