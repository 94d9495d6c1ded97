"""`camgeo probe` and `camgeo inspect`: the files that they write and read."""

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


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (None, "MEASURED = "),
        (b"1,2\n", "p.csv, line 1: 1 row of numbers; allowed: 12 to 50,000"),
        (b"x;y;nx;ny\n" + b"1,5;2;0;0\n" * 12, "p.csv, line 13: fewer than 12 different points"),
        (bytes(16_000_001), "at most 16,000,000 are allowed"),
    ],
)
def test_wrong_files_are_refused(content: bytes | None, message: str, tmp_path: Path) -> None:
    path = tmp_path / "p.csv"
    if content is not None:
        path.write_bytes(content)
    found = called("inspect", SCENES / "plate_translating.toml", path)
    assert found.code == 2
    assert message in found.err
