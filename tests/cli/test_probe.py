"""`camgeo probe`: the files it writes, and calls that are refused."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.calling import SCENES, called


@pytest.mark.parametrize(
    ("scene", "names"),
    [
        ("groove", ["p-inner.csv", "p-outer.csv"]),
        ("conjugate_lever", ["p-return.csv", "p.csv"]),
    ],
)
def test_each_flank_has_a_file(scene: str, names: list[str], tmp_path: Path) -> None:
    words = ("--spacing", "20", "-o", tmp_path / "p.csv")
    assert called("probe", SCENES / f"{scene}.toml", *words).code == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == names
