"""The extra that the designer needs: what is missing is named, and nothing else asks for it."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from camgeo.app.cli.main import main
from tests.designer.conftest import MISSING
from tests.imported import imported_anew

SETZHUB = str(Path(__file__).parents[2] / "fixtures" / "scenes" / "setzhub.toml")


@pytest.mark.skipif(
    bool(MISSING), reason=f"not installed: {', '.join(MISSING)}; see the extra design"
)
def test_the_extra_is_installed() -> None:
    """Without it the tests of the server are left out, and this one says so."""
    assert MISSING == []


@pytest.mark.parametrize("package", ["starlette", "uvicorn", "websockets"])
def test_a_missing_extra_names_its_pip_line(
    package: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    needed = {"camgeo_export", "starlette", "uvicorn", "websockets"}
    with imported_anew(lambda name: name.split(".")[0] in needed), monkeypatch.context() as without:
        without.setitem(sys.modules, package, None)
        with pytest.raises(SystemExit) as stopped:
            main(["design", SETZHUB, "--no-browser"])
    assert stopped.value.code == 2
    told = capsys.readouterr().err
    assert package in told
    assert "pip install 'camgeo[design]'" in told
