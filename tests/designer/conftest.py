"""What tests of the designer's server share; without the extra, `test_extra.py` says so."""

from __future__ import annotations

from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Final

import pytest

if TYPE_CHECKING:
    from tests.designer.served import Served

MISSING: Final = [name for name in ("starlette", "uvicorn", "websockets") if not find_spec(name)]
"""Packages of the extra that are not installed."""

HERE: Final = Path(__file__).parent

collect_ignore = [each.name for each in HERE.glob("test_*.py") if each.name != "test_extra.py"]
if not MISSING:
    collect_ignore.clear()


@pytest.fixture(scope="module")
def scenes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("designer") / "scenes"
    folder.mkdir()
    (folder / "cam.toml").write_bytes(b"a = 1\n")
    return folder


@pytest.fixture(scope="module")
def server(scenes: Path) -> Iterator[Served]:
    """One server for the tests of a module."""
    from tests.designer.served import served  # needs the extra

    with served(scenes, "cam.toml") as found:
        yield found
