"""How the discs of a conjugate pair stand to each other, as it is told."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import camgeo
from camgeo.check.finding import Finding
from camgeo.design.judged_part import findings_on, part_of, poor_in, relation_of
from camgeo.design.product import bodies_of, with_pair
from tests.findings import known

FIXTURES = Path(__file__).parents[2] / "fixtures"

LEVER = FIXTURES / "scenes" / "conjugate_lever.toml"
PAIR = FIXTURES / "pairs" / "conjugate_pair.toml"

KEYWAY = {"width": 8, "depth": 3.3}
BOLTS = {"count": 3, "circle": 50, "hole": 5}


def design(path: Path, **part: Any) -> camgeo.Design:
    edits = {f"part.{key}": value for key, value in part.items()}
    return camgeo.Design(camgeo.load(path).scene.with_values(edits))


def of(found: tuple[Finding, ...], name: str) -> Finding:
    (finding,) = (each for each in found if each.name == name)
    return finding


@pytest.mark.parametrize(
    ("part", "severity", "said"),
    [
        ({"keyway": {**KEYWAY, "angle": 30}}, "ok", "in line on both discs: keyway at 30 deg"),
        ({"keyway": None}, "warning", "nothing on the discs shows it"),
        ({"keyway": None, "d_shaft": {"across": 20}}, "ok", "flat of the bore at 0 deg"),
        ({"keyway": None, "mark": {"radius": 30, "width": 2, "depth": 1}}, "ok", "timing mark at"),
        ({"keyway": None, "bolt_circle": BOLTS}, "warning", "fit in 3 positions, of which one is"),
        ({"keyway": None, "bolt_circle": {**BOLTS, "count": 1}}, "ok", "first bolt hole at 0 deg"),
        ({"bolt_circle": BOLTS}, "ok", "keyway at 0 deg and first bolt hole at 0 deg"),
    ],
)
def test_two_pieces_belong_at_0_degrees(part: dict[str, Any], severity: str, said: str) -> None:
    main, other = design(LEVER, **part).discs
    (found,) = relation_of(main)
    assert (found.name, found.value, found.unit) == ("disc-angle", 0.0, "deg")
    assert found.severity == severity
    assert "the return disc belongs at 0 deg to the main disc" in found.sentence
    assert said in found.sentence
    assert relation_of(other) == ()
    assert (found in poor_in(main)) == (severity != "ok")
    assert found in findings_on(main)


def test_the_angle_that_may_be_off_is_that_of_the_closing_error() -> None:
    """Found again by turning the return disc, for which the lift is that of the angle ahead."""
    made = design(LEVER)
    limit, reach = made.scene.limits.closing_error, abs(made.cam.follower.reach)
    sentence = relation_of(made.disc)[0].sentence
    off = math.radians(float(sentence.split("off by ")[1].split()[0]))
    phi = np.linspace(0.0, 2.0 * math.pi, 20_001)
    lift = [made.drive.motion.jet(each)[0] for each in (phi, phi + off)]
    assert reach * np.max(np.abs(lift[1] - lift[0])) == pytest.approx(limit, rel=2e-3)


def test_masses_of_two_pieces_are_added() -> None:
    made = design(LEVER, material="steel")
    bodies = [part_of(each).body for each in made.discs]
    found = of(findings_on(made.disc), "mass-of-both-discs")
    masses = [each.mass for each in bodies if each is not None and each.mass is not None]
    assert found.value == pytest.approx(math.fsum(masses), rel=1e-12)
    assert len(masses) == 2
    assert not any(each.name == found.name for each in findings_on(made.discs[1]))


def test_the_pair_is_a_piece_of_its_own() -> None:
    """Discs stay what they are, without the hub; bodies are of the pair alone."""
    made = design(PAIR)
    main, other, pair = with_pair(made.discs)
    assert [each.name for each in (main, other, pair)] == [
        "conjugate_pair", "conjugate_pair-return", "conjugate_pair-pair",
    ]  # fmt: skip
    assert bodies_of(main) == bodies_of(pair) == (pair,)
    assert bodies_of(other) == ()
    assert relation_of(main) == ()
    assert [each.boundaries[0].name for each in main.drawn.part.layers] == ["outline", "outline"]
    told = of(relation_of(pair), "disc-angle")
    assert told.severity == "ok"
    assert (
        "the return disc at 0 deg to the main disc, below it, with a gap of 9 mm" in told.sentence
    )
    whole = known(part_of(pair).body)
    parts = [part_of(each).body for each in (main, other)]
    assert whole.solid.volume > sum(each.solid.volume for each in parts if each is not None)
    two = design(PAIR, pair=None)
    assert [bodies_of(each) for each in two.discs] == [(each,) for each in two.discs]
    assert with_pair(two.discs) == two.discs


@pytest.mark.parametrize(
    ("width", "severity"), [(None, "ok"), (12, "ok"), (28, "ok"), (28.1, "broken")]
)
def test_rollers_need_room_beside_the_other_disc(width: float | None, severity: str) -> None:
    """Discs 10 mm thick, 9 mm apart: a roller in the middle of one is clear up to 28 mm."""
    made = design(PAIR, pair={"gap": 9, "spacer": 54, **({"roller_width": width} if width else {})})
    pair = known(made.disc.pair)
    found = of(relation_of(pair), "roller-width")
    assert found.severity == severity
    assert found.value == (width or 28.0)
    assert (found in poor_in(pair)) == (severity != "ok")


def test_rollers_beside_each_other_need_more_room() -> None:
    """On a short lever their circles overlap, seen along the shaft: then 19 mm is the most."""
    made = design(PAIR)
    one, two = (each.follower for each in made.cams)
    apart = abs(one.traced_point(0.0) - two.traced_point(0.0))
    assert apart > one.roller_radius + two.roller_radius
    radius = apart - one.roller_radius + 0.1
    wide = camgeo.Design(made.scene.with_values({"follower.return.roller_radius": radius}))
    found = of(relation_of(known(wide.disc.pair)), "roller-width")
    assert found.limit == pytest.approx(19.0)
    assert "the rollers reach each other" in found.sentence
