"""Steady states and spectra of trains of several masses are those of the record of effects."""

from __future__ import annotations

from typing import Final

from camgeo import load
from tests.effects.recorded import FIXTURES, differences
from tests.effects.recorded_scenes import of_fixture, small

TRAINS: Final = (
    "train of two under load", "elastic train under load", "elastic train", "resonance",
    "jumps of the velocity",
)  # fmt: skip


def test_trains_have_the_results_of_the_record() -> None:
    made = {name: small(name) for name in TRAINS}
    made["rocker before a train of moments"] = of_fixture("rocker before a train of moments")
    made["valve_train"] = load(FIXTURES / "effects" / "valve_train.toml")
    assert not [each for name, design in made.items() for each in differences(name, design)]
