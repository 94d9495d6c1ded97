"""The result of `camgeo replay`, rendered as text, JSON, table and picture."""

from __future__ import annotations

from dataclasses import replace
from decimal import Decimal
from pathlib import Path

import numpy as np
import pytest

from camgeo.app.answers.answer import text
from camgeo.app.answers.replay import DiscReplay, FollowerReplay, Reading, replay
from camgeo.design.design import Design
from camgeo.errors import GeometryError
from camgeo.geometry.outline.replay import Jumps
from camgeo.numeric.extremes import Extreme
from camgeo.scene.scene import load_scene
from tests.answers.documents import FIXTURES, document

FOLDER = FIXTURES / "scenes"

DEGREE = Decimal(1)


def replayed(name: str) -> FollowerReplay:
    return replay(Design(load_scene(FOLDER / f"{name}.toml")), step=DEGREE)


def changed(found: FollowerReplay, disc: DiscReplay) -> FollowerReplay:
    return replace(found, discs=(disc, *found.discs[1:]))


def test_a_roller_that_falls_off_an_edge_has_no_bounds() -> None:
    found = replayed("plate_translating")
    first = found.discs[0]
    twice = Jumps(np.array([1.0, 2.0]), np.zeros(2), np.array([0.5, -0.75]))
    once = Jumps(np.array([1.0]), np.zeros(1), np.array([0.5]))
    unbounded = replace(first.velocity, actual=None)
    for drops, often in ((twice, "2 times, the largest -0.75 mm"), (once, "once, 0.5 mm")):
        other = changed(found, replace(first, drops=drops, velocity=unbounded, ripple=None))
        (reported,) = document(other)["discs"]
        assert reported["drops"]["count"] == len(drops)
        assert drops.largest is not None
        assert reported["drops"]["largest"]["value"] == drops.largest.value
        assert (reported["velocity"]["actual"], reported["ripple"]) == (None, None)
        lines = {line[:22].strip(): line[22:] for line in text(other).splitlines()}
        assert lines["falls off an edge"].startswith(often)
        assert lines["velocity"].startswith("unbounded; demanded")
        assert "ripple" not in lines


def test_a_pair_is_reported_with_its_play() -> None:
    found = replayed("conjugate_lever")
    assert found.closing is not None
    squeezed = replace(found.closing, lowest=Extreme(-0.25, 0.0))
    other = replace(found, closing=squeezed)
    assert document(other)["closing"]["smallest_play"]["travel_mm"] == -0.25
    last = text(other).splitlines()[-1]
    assert "-0.25 mm" in last
    assert last.endswith("the rollers are squeezed there")
    assert "squeezed" not in text(found)


def test_a_flat_face_is_named_as_such() -> None:
    found = replayed("flat_rocker")
    assert text(found).startswith("flat_rocker: the face on the real outline, inner flank")
    assert document(found)["discs"][0]["lift_error"]["value"] == 0.0
    contact = document(found)["discs"][0]["contact"]
    assert 60.0 < contact["from"]["place_mm"] < contact["to"]["place_mm"] < 100.0
    assert "contact" not in document(replayed("plate_translating"))["discs"][0]
    with pytest.raises(GeometryError, match="inner flank"):
        replay(Design(load_scene(FOLDER / "tappet.toml")), flank="outer")


def test_a_contact_beyond_the_face_is_reported() -> None:
    scene = load_scene(FOLDER / "tappet.toml")
    for face, leaves in (([-7.2, 8.5], False), ([-7.2, 8.4], True), ([-7.1, 8.5], True)):
        found = replay(Design(scene.with_values({"follower.face": face})), step=DEGREE)
        (disc,) = found.discs
        assert disc.contact is not None
        assert disc.contact.leaves_face == leaves == ("leaves the face" in text(found))
        assert document(found)["discs"][0]["contact"]["leaves_face"] == leaves


def test_a_tappet_on_points_that_were_measured(tmp_path: Path) -> None:
    """Points every degree replay within the sagitta of the chords between them."""
    design = Design(load_scene(FOLDER / "tappet.toml"))
    points = design.disc.pictured.curve("inner", np.radians(np.arange(360.0)))
    file = tmp_path / "measured.csv"
    file.write_text("x,y\n" + "".join(f"{x!r},{y!r}\n" for x, y in points.tolist()))
    found = replay(design, [file], reading=Reading(unit="mm"))
    (disc,) = found.discs
    assert 0.0 < disc.lost_stroke.value < 0.02
    assert len(disc.shocks) > 100
