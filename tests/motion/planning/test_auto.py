"""law = "auto" compared with an independent choice from all laws of the registry."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.kinematics.laws import FAMILIES, make_law
from camgeo.kinematics.laws.law import Law, acceleration_jumps
from camgeo.kinematics.planning.build import best_law, equal_accelerations
from camgeo.kinematics.planning.requests import CRITERIA
from tests.motion.planning.wishes import laws, move, move_of, planned, rest
from tests.strategies import attack

Known = Mapping[str, float]

MESH = np.linspace(0.0, 1.0, 4001)


def sizes(law: Law) -> dict[str, float]:
    """Largest magnitudes on a mesh, both sides of each border: within 1e-5 of the exact ones."""
    z = np.concatenate([MESH, [x - 1e-12 for x in law.borders]])
    _, f1, f2, f3 = law(z)
    values = {"velocity": f1, "acceleration": f2, "jerk": f3, "moment": f1 * f2}
    return {name: float(np.max(np.abs(each))) for name, each in values.items()}


def overshoots(law: Law) -> bool:
    f = law(MESH)[0]
    return bool(np.max(f) > 1.0 + 1e-7 or np.min(f) < -1e-7)


def smooth(law: Law, known: Known) -> bool:
    """The boundary values are met, and f'' has no jump inside."""
    met = (law.start.velocity, law.start.acceleration, law.end.velocity, law.end.acceleration)
    wanted = [known.get(key, 0.0) for key in ("v0", "a0", "v1", "a1")]
    if not np.allclose(met, wanted, rtol=1e-9, atol=1e-9):
        return False
    jumps = [abs(law(np.array([x]))[2][0] - law(np.array([x - 1e-12]))[2][0]) for x in law.borders]
    return max(jumps, default=0.0) < 1e-6 * max(1.0, sizes(law)["acceleration"])


def candidates(task: str, known: Known) -> list[Law]:
    """Every law of the registry that can be made for the task with these boundary values."""
    found = []
    for name, family in FAMILIES.items():
        if task not in family.tasks or name == "polynomial":
            continue
        taken = family.parameters[task]
        given: dict[str, Any] = {key: value for key, value in known.items() if key in taken}
        try:
            if "inflection" in taken and task in ("R-G", "G-R", "G-G"):
                given["inflection"] = equal_accelerations(name, task, given)
            law = make_law(name, task, **given)
        except GeometryError:
            continue
        if smooth(law, known):
            found.append(law)
    return [law for law in found if not overshoots(law)] or found


TASKS: list[tuple[str, tuple[str, ...]]] = [
    ("R-R", ()),
    ("R-U", ("a1",)),
    ("U-R", ("a0",)),
    ("U-U", ("a0", "a1")),
    ("R-G", ("v1",)),
    ("G-U", ("v0", "a1")),
    ("G-G", ("v0", "v1")),
    ("B-B", ("v0", "a0", "v1", "a1")),
]


@attack
@given(data=st.data(), criterion=st.sampled_from(CRITERIA))
def test_nothing_is_better(data: st.DataObject, criterion: str) -> None:
    task, keys = data.draw(st.sampled_from(TASKS))
    signs = {"a0": 1.0, "a1": -1.0, "v0": 1.0, "v1": 1.0}
    known = {key: signs[key] * data.draw(st.floats(0.2, 12.0)) for key in keys}
    chosen = best_law(task, known, {}, {criterion: 1.0})
    assert smooth(chosen, known)
    least = min(sizes(law)[criterion] for law in candidates(task, known))
    assert sizes(chosen)[criterion] <= least * (1.0 + 1e-4)


@pytest.mark.parametrize(
    ("criterion", "law"),
    [
        # Tafel 2 of VDI 2143-1, without the laws that jerk: least C_v and C_Mdyn modified sine,
        # least C_a modified trapezoid. The least f''' is the inclined sine's, 4 pi^2.
        ("velocity", "modified-sine"),
        ("acceleration", "modified-trapezoid"),
        ("jerk", "inclined-sine"),
        ("moment", "modified-sine"),
    ],
)
def test_from_rest_to_rest_it_is_the_one_the_guideline_names(criterion: str, law: str) -> None:
    plan = planned(rest(60), move(120, 20.0, optimise={criterion: 1.0}), rest(60), move(120, 0.0))
    assert laws(plan)[1] == f"{law} R-R"
    assert laws(plan)[3] == "modified-trapezoid R-R", "without a wish the acceleration counts"


def test_weights_trade_one_quantity_for_another() -> None:
    """Each counts as a multiple of the least there is; all weight on one end is that criterion."""
    jerk = best_law("R-R", {}, {}, {"jerk": 1.0, "acceleration": 1e-6})
    acceleration = best_law("R-R", {}, {}, {"jerk": 1e-6, "acceleration": 1.0})
    assert (jerk.name, acceleration.name) == ("inclined-sine", "modified-trapezoid")
    both = best_law("R-R", {}, {}, {"jerk": 0.5, "acceleration": 0.5})
    cost = {
        law.name: sizes(law)["jerk"] / (4.0 * math.pi**2)
        + sizes(law)["acceleration"] / sizes(acceleration)["acceleration"]
        for law in candidates("R-R", {})
    }
    assert cost[both.name] <= min(cost.values()) * (1.0 + 1e-4)


def test_a_stated_inflection_is_honoured() -> None:
    plan = planned(
        rest(60), move(120, 20.0, parameters={"inflection": 0.4}), rest(60), move(120, 0.0)
    )
    law = move_of(plan, 1).law
    assert law.parameters["inflection"] == 0.4
    assert law.inflection == 0.4


@pytest.mark.parametrize(
    ("name", "task"),
    [
        ("modified-trapezoid", "R-U"),
        ("modified-trapezoid", "U-R"),
        ("harmonic-combination", "U-R"),
        ("sine-straight", "U-U"),
        ("modified-sine", "R-R"),
    ],
)
@pytest.mark.parametrize("side", [0.0, 1.0])
def test_a_lopsided_law_has_no_jump(name: str, task: str, side: float) -> None:
    """Nor is one reported where a border, off by rounding, lies next to a steep acceleration."""
    for distance in np.geomspace(1e-6, 0.5, 60):
        law = make_law(name, task, inflection=float(abs(side - distance)))
        assert not acceleration_jumps(law)
    assert acceleration_jumps(make_law("quadratic-parabola", inflection=1e-6))
