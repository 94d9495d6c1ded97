"""The nearest value of a size at which a fault is gone, and no limit that held is broken.

The scenes of fixtures/found are public reports: a remedy was denied, or a nearer one missed.
"""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any

import pytest

import camgeo
from camgeo.check.cures.search import Cure
from camgeo.design.design import Design
from tests.draws.remedies import BAD, cases, complaints

FIXTURES = Path(__file__).parents[2] / "fixtures"

NEAR = 1e-6
"""Share of the base radius."""


def bad(design: Design) -> set[str]:
    return {each.name for each in design.findings if each.severity in BAD}


def works(design: Design, fault: str, knob: str) -> Cure:
    found = {(each.fault, each.knob): each for each in design.judgement.cures}
    assert found[fault, knob].works, found[fault, knob].sentence
    return found[fault, knob]


def with_value(design: Design, key: str, value: Any) -> Design:
    return Design(design.scene.with_values({key: value}))


@pytest.mark.parametrize(
    ("name", "knob", "nearest", "known"),
    [
        ("cure_window", "base radius", 22.62, 67.86),  # up to about 89 mm
        ("cure_skips_window", "offset", 16.787, -9.456),  # down to -15 mm, then from -48 mm on
        ("cure_offset_denied", "offset", 4.186, 0.0),
    ],
)
def test_the_nearest_window_is_found(name: str, knob: str, nearest: float, known: float) -> None:
    design = camgeo.load(FIXTURES / "found" / f"{name}.toml")
    assert not bad(with_value(design, f"follower.{knob.replace(' ', '_')}", known))
    cure = works(design, "undercut", knob)
    assert cure.limit is not None
    assert min(nearest, known) <= cure.limit <= max(nearest, known)
    assert not bad(with_value(design, cure.key, cure.value_to))
    short = cure.limit + NEAR * design.cam.follower.base_radius * (1 if known < nearest else -1)
    assert bad(with_value(design, cure.key, short))


def test_a_radius_ratio_and_an_angle_have_remedies() -> None:
    design = camgeo.load(FIXTURES / "scenes" / "plate_translating.toml")
    limits = {"limits.transmission_angle": 70.0, "limits.radius_ratio": 0.15}
    broken = Design(design.scene.with_values(limits))
    assert bad(broken) == {"transmission-angle", "radius-ratio-inner"}
    assert {each.fault for each in broken.judgement.cures} == {"transmission angle", "radius ratio"}
    for cure in broken.judgement.cures:
        if cure.works and cure.knob not in ("longer segment", "other law"):
            left = bad(with_value(broken, cure.key, cure.value_to))
            assert not any(name.startswith(cure.fault.replace(" ", "-")) for name in left)
            assert left < bad(broken)


def test_a_remedy_keeps_the_bore_inside_the_disc() -> None:
    """With 54.5 mm the return disc does not undercut, and is smaller than its bore."""
    design = camgeo.load(FIXTURES / "refused" / "return_undercut.toml")
    cure = works(design, "undercut", "base radius")
    assert cure.breaks == ()
    assert cure.limit is not None
    other = with_value(design, cure.key, cure.value_to)
    assert other.discs[1].drawn.part is not None
    short = with_value(design, cure.key, cure.limit + 1e-3)
    with pytest.raises(camgeo.CamgeoError, match="bore"):
        _ = short.discs[1].drawn.part
    # No smaller roller leaves room for it, which is said.
    roller = works(design, "undercut", "roller radius")
    assert roller.breaks == ("part",)
    assert "breaks part (part.bore = 24: the bore reaches" in roller.sentence


def test_no_remedy_of_a_drawn_mechanism_is_denied_or_beaten() -> None:
    for values in itertools.islice(cases(8), 2):
        assert [*complaints(values)] == []
