"""Rows of contours and solids: they agree with the fits, the writers and the replay of one cam."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path
from typing import Any

import pytest

import camgeo
from camgeo.design.design import Design
from camgeo.design.writing import find_writer
from camgeo.errors import ToleranceError
from camgeo.geometry.outline.replay import replay_contour
from camgeo.part.part import WRITTEN_SHARE, written_contour
from camgeo.scene.formats.dxf import FORMAT
from camgeo.studies.accuracy import contours as measuring
from camgeo.studies.accuracy import survey
from camgeo.studies.accuracy.contours import (
    EFFORTS,
    FORMS,
    ContourRow,
    contour_rows,
    flank_boundaries,
    forced_pieces,
    with_contour_form,
)
from tests.findings import known

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"

TOLERANCES = (1e-2, 1e-3)

ROUNDING = 1e-12


def load(name: str) -> Design:
    return camgeo.load(SCENES / f"{name}.toml")


@cache
def rows() -> tuple[ContourRow, ...]:
    return contour_rows(
        load("setzhub"), TOLERANCES, ripple=True, progress=lambda _: None, timed=False
    )


def found(form: str, effort: str, tolerance: float) -> ContourRow:
    key = (form, effort, tolerance)
    return next(row for row in rows() if (row.form, row.effort, row.tolerance) == key)


def test_every_form_effort_and_tolerance_has_its_row() -> None:
    keys = [(row.form, row.effort, row.tolerance) for row in rows()]
    assert keys == [(f, e, t) for f in FORMS for e in EFFORTS for t in TOLERANCES]
    assert [row.fault for row in rows()] == [""] * len(keys)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("effort", EFFORTS)
@pytest.mark.parametrize("tolerance", TOLERANCES)
def test_counts_files_and_proofs(form: str, effort: str, tolerance: float) -> None:
    row = found(form, effort, tolerance)
    count, drawing = known(row.count), known(row.drawing)
    assert 0.0 < count.deviation <= tolerance
    assert known(drawing.deviation) <= tolerance
    assert count.forced == (0 if form == "polyline" else 2)  # Two rests of the motion plan.
    # A limit for small tolerances; where pieces are few it is passed a little.
    assert 0.7 < known(count.ratio) < 4.0
    assert min(count.fit_seconds, count.proof_seconds) > 0.0
    assert (row.program is not None) == (form == "arcs")
    # Of the boundaries of the part only the bore is no flank.
    facts = drawing.facts
    entities = int(facts.get("cubics", 0)) + int(facts["arcs"]) + int(facts["lines"])
    (bore,) = (each for each in load("setzhub").disc.drawn.part.boundaries if each.name == "bore")
    own: Any = (form, effort, tolerance)
    assert entities == count.pieces + len(written_contour(bore, *own).contour)
    assert row.decimals == 4
    if row.program is not None:
        assert row.program.facts["decimals"] == row.decimals


@pytest.mark.parametrize("effort", EFFORTS)
def test_pieces_are_those_of_the_boundary(effort: Any) -> None:
    (flank,) = flank_boundaries(load("setzhub"))
    for tolerance in TOLERANCES:
        count = known(found("arcs", effort, tolerance).count)
        assert count.pieces == len(written_contour(flank, "arcs", effort, tolerance).contour)
        assert count.forced == forced_pieces(flank.path, math.pi)


def test_the_round_takes_at_least_its_length_over_the_feed() -> None:
    """Feed of the scene, 300 mm/min = 5 mm/s, from rest to rest at 508 mm/s^2."""
    (flank,) = flank_boundaries(load("setzhub"))
    # The controller sees 50 arcs ahead, which bend with more than 0.05 mm.
    for tolerance in TOLERANCES:
        length = flank.arcs(WRITTEN_SHARE * tolerance, "fewest").contour.length
        seconds = known(found("arcs", "fewest", tolerance).round_seconds)
        # An axis has 508 mm/s^2, a line at an angle up to sqrt(2) of it.
        assert 5.0 / 508.0 / 1.5 < seconds - length / 5.0 < 5.0 / 508.0 * (1.0 + ROUNDING)
        assert found("spline", "fewest", tolerance).round_seconds is None


def test_the_ripple_is_that_of_the_replay() -> None:
    design = load("setzhub")
    (flank,) = flank_boundaries(design)
    contour = flank.arcs(WRITTEN_SHARE * 1e-3, "fewest").contour.split(math.pi)
    ripple = replay_contour(design.cam.disc.pitch_curve, contour).ripple
    assert found("arcs", "fewest", 1e-3).ripple == ripple
    assert found("spline", "fewest", 1e-3).ripple is None
    ripples = [found("arcs", "fewest", tolerance).ripple for tolerance in TOLERANCES]
    assert known(ripples[1]) < known(ripples[0])


def test_no_ripple_unless_it_is_asked_for() -> None:
    only: dict[str, Any] = {"forms": ("arcs",), "efforts": ("fast",), "timed": False}
    reported: list[str] = []
    made = contour_rows(load("ring"), (1e-2,), ripple=False, progress=reported.append, **only)
    assert [row.ripple for row in made] == [None]
    assert reported == ["arcs, fast, 0.01 mm"]


def test_what_cannot_be_reached_is_reported_in_the_row(monkeypatch: pytest.MonkeyPatch) -> None:
    def some(flank: Any, form: Any, effort: Any, tolerance: float) -> Any:
        if tolerance < 1e-2:
            raise ToleranceError("the arithmetic is too coarse", tolerance, 1.0)
        return written_contour(flank, form, effort, tolerance)

    only: dict[str, Any] = {"forms": ("arcs",), "efforts": ("fast",), "timed": False}
    monkeypatch.setattr(measuring, "written_contour", some)
    made = contour_rows(load("ring"), TOLERANCES, ripple=False, progress=lambda _: None, **only)
    assert [row.fault for row in made] == ["", "the arithmetic is too coarse"]
    assert made[0].count is not None
    assert made[1].count is None
    assert made[1].drawing is None


def test_a_file_that_cannot_be_written_leaves_the_count(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(_: object, __: object, tolerance: float, *___: object, **____: object) -> None:
        raise ToleranceError("a program is too coarse", tolerance, 1.0)

    only: dict[str, Any] = {"forms": ("polyline",), "efforts": ("fast",), "timed": False}
    monkeypatch.setattr(measuring, "file_cost", refuse)
    (row,) = contour_rows(load("ring"), (1e-2,), ripple=False, progress=lambda _: None, **only)
    assert row.count is not None
    assert row.round_seconds is not None
    assert row.drawing is None
    assert row.fault == "a program is too coarse"


def test_a_design_drawn_in_another_form() -> None:
    design = load("setzhub")
    drawn = with_contour_form(design, "polyline", "fast")
    form, before = drawn.disc.options[FORMAT], design.disc.options[FORMAT]
    assert (form.entity, drawn.disc.drawn.effort) == ("polyline", "fast")
    assert form.auxiliary == before.auxiliary
    assert before.entity == "arcs"
    writer = find_writer("dxf")
    assert int(writer.write(drawn.disc, 1e-2).facts["lines"]) > 50


def test_flanks_are_what_the_roller_runs_on() -> None:
    assert [flank.name for flank in flank_boundaries(load("groove"))] == [
        "inner flank",
        "outer flank",
    ]
    assert [flank.hole for flank in flank_boundaries(load("ring"))] == [True]


def test_rings_and_grooves_are_replayed_on_their_flanks() -> None:
    design = load("groove")
    flanks = flank_boundaries(design)
    ripple = measuring._ripple(design, flanks, [f.arcs(1e-3, "fast").contour for f in flanks])
    assert 0.0 < known(ripple) < 1.0


def test_solids_and_what_single_precision_cannot_hold(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(survey, "SOLIDS", ("stl",))
    reported: list[str] = []
    coarse, fine = survey.solid_rows(load("setzhub"), (1e-2, 1e-7), progress=reported.append)
    assert (coarse.format, coarse.tolerance) == ("stl", 1e-2)
    assert coarse.file is not None
    assert coarse.file.size == 84 + 50 * int(coarse.file.facts["triangles"])
    assert known(coarse.file.deviation) <= 1e-2
    assert fine.file is None
    assert "too coarse" in fine.fault
    assert reported == ["stl, 0.01 mm", "stl, 1e-07 mm"]
    assert math.isfinite(coarse.file.write_seconds)


def test_solids_are_of_all_formats_and_one_that_is_too_large_is_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A groove within 1e-6 mm ended the whole survey."""
    monkeypatch.setattr("camgeo_export.solid.prism.FACETS", 100)
    rows = survey.solid_rows(load("setzhub"), (0.01,), progress=lambda _: None)
    found = {row.format: row for row in rows}
    assert list(found) == ["stl", "3mf", "step"]
    for name in ("stl", "3mf"):
        assert found[name].file is None
        assert "at most 100 are allowed" in found[name].fault
    assert int(known(found["step"].file).facts["faces"]) > 10


def test_each_row_fits_and_proves_anew_and_not_what_tells_contours_apart() -> None:
    """As the ledger of the design records it: for warming up at the loosest tolerance, and in each
    row, the fit; and the proof of the finished contour and of what was read.
    """
    only: dict[str, Any] = {"forms": ("polyline",), "efforts": ("fast",), "programs": False}
    design = with_contour_form(load("setzhub"), "polyline", "fast")
    runs, arcs = flank_boundaries(design)[0].ledger.runs, []

    def started(_: str) -> None:
        arcs.append([run.name for run in runs].count("arcs of outline"))

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(measuring, "with_contour_form", lambda each, *_: each)
        contour_rows(
            design, (*TOLERANCES, 1e-4), ripple=False, progress=started, timed=False, **only
        )
    names = [run.name for run in runs]
    assert names.count("chords of outline") == 1 + 3
    assert names.count("proof of outline") == 1 + 2 * 3
    started("")
    assert len(set(arcs)) == 1
