"""What tests of the designer's server share."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.designer.served import Served, served


@pytest.fixture(scope="module")
def scenes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("designer") / "scenes"
    folder.mkdir()
    (folder / "cam.toml").write_bytes(b"a = 1\n")
    return folder


@pytest.fixture(scope="module")
def server(scenes: Path) -> Iterator[Served]:
    """One server for the tests of a module."""
    with served(scenes, "cam.toml") as found:
        yield found
