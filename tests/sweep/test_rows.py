"""Rows: each depends on its design alone; work can be sent to other processes."""

from __future__ import annotations

import pickle
from dataclasses import replace
from pathlib import Path

import pytest

from camgeo.design.design import Design
from camgeo.errors import VersionError
from camgeo.scene.scene import load_scene
from camgeo.studies.sweep.family import Family
from camgeo.studies.sweep.rows import MOST_IN_CHUNK, Pace, Work, compute_rows, parse_questions
from tests.sweep.families import FIXTURES, family

ASK = ("transmission-angle", "radius-ratio-inner", "peak:kappa", "peak:a", "diameter")


def work_on(found: Family, *ask: str) -> Work:
    return Work.for_family(found, parse_questions(Design(found.scene), ask or ASK))


def test_a_row_depends_on_its_design_alone() -> None:
    """Its bits are the same alone, in any order, from pickled work, and from the scene itself."""
    found = family("follower.base_radius=45:60:3", "motion.2.law=modified-sine,no-such-law")
    work, points = work_on(found), list(found.points())
    together = compute_rows(work, points)
    backwards = compute_rows(work, points[::-1])[::-1]
    sent = pickle.loads(pickle.dumps(work))
    alone = [sent.rows([point])[0] for point in points]
    assert list(together) == list(backwards) == alone
    assert [row.failed for row in together] == [False, True] * 3
    angle = next(f.value for f in Design(found.design_scene(points[0])).findings
                 if f.name == "transmission-angle")  # fmt: skip
    assert together[0].values[0] == angle


def test_a_design_that_there_is_not_is_a_row_with_the_reason() -> None:
    found = family("follower.base_radius=50,-1", "cam.rotation=cw,sideways")
    rows = compute_rows(work_on(found), found.points())
    assert [row.failed for row in rows] == [False, True, True, True]
    assert rows[1].reason.startswith('cam.rotation = "sideways": must be')
    assert "follower.base_radius = -1: must be" in rows[3].reason
    assert "; cam.rotation" in rows[3].reason or "; follower" in rows[3].reason
    assert rows[3].values == (None,) * len(ASK)


def test_workers_need_no_file(tmp_path: Path) -> None:
    """Scene and data are sent along: without the folder the row is the same."""
    folder = FIXTURES / "scenes"
    for name in ("measured.toml", "measured.csv"):
        (tmp_path / name).write_bytes((folder / name).read_bytes())
    found = family("follower.base_radius=50,52", scene=load_scene(tmp_path / "measured.toml"))
    work = work_on(found, "largest-acceleration")
    here = compute_rows(work, found.points())
    assert not any(row.failed for row in here)
    for each in tmp_path.iterdir():
        each.unlink()
    sent = pickle.loads(pickle.dumps(work))
    assert tuple(sent.rows([*found.points()])) == here


@pytest.mark.parametrize(
    ("name", "label"), [("camgeo", "camgeo"), ("numpy", "numpy"), ("python", "Python")]
)
def test_a_worker_of_another_version_is_refused_by_name(name: str, label: str) -> None:
    found = family()
    work = work_on(found)
    other = replace(work, versions=replace(work.versions, **{name: "0.1"}))
    with pytest.raises(VersionError, match=rf"a worker has {label} \S+, .* started with 0\.1;"):
        compute_rows(other, found.points())


def test_chunks_grow_to_a_second_and_shrink_again() -> None:
    pace, sizes = Pace(), []
    points = iter([(k,) for k in range(100_000)])
    for _ in range(6):
        chunk = pace.take(points)
        sizes.append(len(chunk))
        pace.note(len(chunk), 0.005 * len(chunk))
    assert sizes == [1, 8, 64, 200, 200, 200]
    pace.note(200, 1.0, least=6.0)  # many workers
    assert len(pace.take(points)) == MOST_IN_CHUNK
    pace.note(200, 1.0, least=0.012)
    assert len(pace.take(points)) == 200
    pace.note(200, 1e-6)
    assert len(pace.take(points)) == MOST_IN_CHUNK
    pace.note(MOST_IN_CHUNK, 1e6)
    assert len(pace.take(points)) == 1
    assert pace.take(iter(())) == ()


def test_workers_share_the_last_designs() -> None:
    pace = Pace(2)
    pace.note(1, 1e-6)
    pace.note(8, 1e-6)
    points = iter([(k,) for k in range(21)])
    sizes = []
    while chunk := pace.take(points):
        sizes.append(len(chunk))
    assert sizes == [11, 5, 3, 1, 1]
