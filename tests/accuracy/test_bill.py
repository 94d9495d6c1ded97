"""The bill of a build: its stages are the build, and its files those of `camgeo build`."""

from __future__ import annotations

import math
import time
from pathlib import Path

import pytest

import camgeo
from camgeo.app.answers.build import build
from camgeo.lazy import Ledger
from camgeo.studies.accuracy.survey import STAGES, bill_rows, staged
from tests.answers.documents import FIXTURES
from tests.findings import known


def test_own_seconds_go_to_their_stages_and_the_rest_to_writing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    now = [0.0]
    monkeypatch.setattr(time, "perf_counter", lambda: now[0])

    def took(name: str, seconds: float) -> None:
        with ledger.entry(name):
            now[0] += seconds

    ledger = Ledger()
    took("findings", 8.0)
    with ledger.entry("dxf file"):
        now[0] += 1.0
        took("arcs of outline", 2.0)
        took("proof of outline", 4.0)
    took("dxf of cam-return file, measured of the return disc", 16.0)
    now[0] += 32.0
    found = staged(ledger.runs, now[0])
    assert found == {"evaluate": 8.0, "fit": 2.0, "prove": 4.0, "write": 33.0, "read": 16.0}
    assert math.fsum(found.values()) == now[0]


@pytest.mark.parametrize(
    "scene", ["tappet", pytest.param("conjugate_lever", marks=pytest.mark.long)]
)
def test_a_bill_is_of_the_files_of_a_build(scene: str, tmp_path: Path) -> None:
    design = camgeo.load(FIXTURES / "scenes" / f"{scene}.toml")
    loose, tight = bill_rows(design, (1e-1, 1e-2))
    made = build(design, tmp_path, tolerance=1e-2)
    assert tight.size == sum(path.stat().st_size for path in tmp_path.iterdir())
    arcs = [int(each.facts["arcs"]) for each in made.files if each.format == "dxf"]
    assert 0 < known(loose.pieces) <= known(tight.pieces) <= sum(arcs) + len(arcs) * 100
    for row in (loose, tight):
        assert tuple(row.stages) == STAGES
        assert all(seconds >= 0.0 for seconds in row.stages.values())
        assert row.total == math.fsum(row.stages.values())
        assert row.stages["fit"] > 0.0
        assert row.stages["read"] > 0.0


def test_a_tolerance_that_cannot_be_reached_says_why() -> None:
    design = camgeo.load(FIXTURES / "scenes" / "tappet.toml")
    (row,) = bill_rows(design.with_output({"formats": ["stl"]}), (1e-8,))
    assert row.fault
    assert not row.stages
    assert row.total is None
