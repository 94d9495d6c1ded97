"""The result of `camgeo tolerance`, rendered as text, as a table, as JSON and as a picture."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from camgeo.app.answers.answer import figure, table, text
from camgeo.app.answers.tolerance import ToleranceAnalysis, tolerance
from camgeo.design.design import Design
from camgeo.scene.scene import load_scene
from camgeo.units import MM_PER
from tests.answers.documents import document
from tests.tolerancing.machines import LEVER

COUNT = 128


@pytest.fixture(scope="module")
def answer() -> ToleranceAnalysis:
    return tolerance(Design(load_scene(LEVER)), count=COUNT)


def test_all_renderings_say_the_same(answer: ToleranceAnalysis) -> None:
    reported, words, rows = document(answer), text(answer), table(answer)
    worst = reported["worst"]
    assert (reported["of"], reported["flank"], reported["unit"]) == ("follower", "inner", "deg")
    assert f"{worst['value']:+.4g} deg at cam angle {worst['cam_angle_deg']:g}" in words
    assert reported["within"] is True
    assert answer.exit_code == 0
    machines = reported["machines"]
    assert machines["count"] == COUNT
    assert f"{machines['kept']:.2%} keep the limit at all cam angles" in words
    quantiles = np.abs([rows.columns[f"{each} quantile [deg]"] for each in ("1%", "99%")])
    assert np.max(quantiles) == pytest.approx(abs(machines["quantile"]["value"]), rel=1e-12)
    edges = np.abs([rows.columns[f"mean {sign} 3 sigma [deg]"] for sign in "+-"])
    # The table has the band at whole degrees; between two of them it rises by the square of half of
    # one, 7.6e-5, times half its relative curvature.
    assert np.max(edges) == pytest.approx(abs(worst["value"]), rel=1e-3)
    assert np.max(edges) <= abs(worst["value"])
    assert sum(each["share"] for each in reported["sources"]) == pytest.approx(1.0)
    roller = reported["sources"][0]
    assert roller["limits"] == pytest.approx([-0.0065, 0.0])  # half of h6 of 20 mm
    assert roller["sensitivity_unit"] == "deg/mm"
    assert [each["name"] for each in reported["sources"][-2:]] == ["clearance[1] H7/g6", "form[1]"]
    errors, shares = figure(answer).panels
    assert errors.y.limits[1] > answer.limit  # type: ignore[operator]  # the scene states one
    assert shares.legend is not None
    assert len(shares.legend.entries) == len(reported["sources"])


def test_the_play_of_a_pair_in_all_renderings() -> None:
    pair = tolerance(Design(load_scene(LEVER.parent / "pair.toml")), count=COUNT)
    reported, words = document(pair), text(pair)
    play, machines = reported["play"], reported["machines"]
    for each in (play["least"], play["most"]):
        assert f"{each['value']:+.4g} deg at cam angle {each['cam_angle_deg']:g}" in words
    assert [each["name"] for each in play["sources"]] == [
        each["name"] for each in reported["sources"]
    ]
    assert play["least"]["value"] < machines["least_play"]["machines"][1] < 0.0
    assert f"{machines['squeezed']:.2%} of machines squeeze the follower somewhere" in words
    assert "largest_force" not in machines
    low, high = (table(pair).columns[f"play {sign} 3 sigma [deg]"] for sign in "-+")
    assert np.min(low) == pytest.approx(play["least"]["value"], rel=0.01)
    assert np.all(low < high)


def test_a_limit_that_is_too_narrow(answer: ToleranceAnalysis) -> None:
    stated = replace(answer.linear.stated, limit=0.9 * abs(answer.linear.worst.value))
    narrow = replace(answer, linear=replace(answer.linear, stated=stated))
    assert narrow.exit_code == 1
    assert document(narrow)["within"] is False
    assert "BROKEN" in text(narrow)


def test_a_scene_in_inches_means_the_same() -> None:
    """All lengths over 25.4: errors of a lever in degrees are the same."""
    left_out = {"effects": None, "part.material": None, "tolerance.dimension[4]": None}
    metric = load_scene(LEVER).with_values(left_out)
    own = {"follower.arm": 70, "follower.base_radius": 40, "follower.roller_radius": 10,
           "part.bore": 20, "part.thickness": 12, "follower.pivot[1]": 80,
           "tolerance.dimension[2].plus_minus": 0.03, "tolerance.dimension[3].plus_minus": 0.02,
           "tolerance.form[1].plus_minus": 0.01}  # fmt: skip
    inches = {key: each / MM_PER["inch"] for key, each in own.items()}
    other = metric.with_values({"units.length": "inch", **inches})
    found = [tolerance(Design(each), count=0).linear.sigma for each in (metric, other)]
    np.testing.assert_allclose(found[0], found[1], rtol=1e-12)


def test_setting_takes_away_what_is_the_same_all_round() -> None:
    """A machine set at 0 degrees has no error there, and none of a pushed-back lift anywhere."""
    scene = load_scene(LEVER)
    setting = {"tolerance.set_at": 0, "tolerance.dimension[1].key": "follower.base_radius",
               "tolerance.dimension[1].plus_minus": 0.1,
               "tolerance.dimension[1].class": None}  # fmt: skip
    found = tolerance(Design(scene.with_values(setting)), count=0).linear
    assert found.sigma[0] == 0.0
    assert np.max(found.sigma) > 0.0
    assert np.max(found.variances[0]) == 0.0
