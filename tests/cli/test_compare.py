"""`camgeo compare`: scenes, files, messages."""

from __future__ import annotations

import pytest

from camgeo.app.answers.compare import labels_of
from tests.sweep.families import FIXTURES

Capture = pytest.CaptureFixture[str]

SCENE = str(FIXTURES / "scenes" / "setzhub.toml")


def test_labels_tell_designs_apart() -> None:
    assert labels_of(["a/x.toml", "b/y.toml"]) == ["x", "y"]
    assert labels_of(["a/x.toml", "b/x.toml"]) == ["a/x.toml", "b/x.toml"]
