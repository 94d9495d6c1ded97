"""A plan that recalls its last answers gives the same as one that does not; laws are made once."""

from __future__ import annotations

import pickle
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

from camgeo import load
from camgeo.kinematics.laws import law_of
from camgeo.kinematics.laws.law import characteristic
from camgeo.kinematics.plan import MotionPlan
from camgeo.numeric import kept
from camgeo.numeric.kept import kept_with_owner
from camgeo.units import TURN
from tests.effects.scenes import SCENES


@pytest.fixture(scope="module")
def plan() -> MotionPlan:
    return load(SCENES / "groove.toml").cam.drive.plan


@pytest.fixture
def recalling(plan: MotionPlan) -> MotionPlan:
    return MotionPlan(plan.segments)


PHI = np.linspace(-1.0, TURN + 1.0, 101)


def test_the_same_question_is_answered_once(recalling: MotionPlan) -> None:
    first = recalling.jet(PHI)
    assert recalling.jet(PHI.copy()) is first
    assert recalling.jet(PHI, "left") is not first
    assert recalling.jet(PHI) is first
    recalling.jet(PHI[1:])
    assert recalling.jet(PHI) is first


def test_what_was_asked_the_longest_time_ago_is_forgotten(
    recalling: MotionPlan, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(kept, "MOST_KEPT", 2 * len(PHI))
    first, second = recalling.jet(PHI), recalling.jet(PHI, "left")
    assert recalling.jet(PHI) is first
    recalling.jet(PHI + 0.1)
    assert recalling.jet(PHI) is first
    assert recalling.jet(PHI, "left") is not second


def test_of_a_plan_the_last_answer_is_kept(plan: MotionPlan) -> None:
    asked = []

    @kept_with_owner
    def reported(plan: MotionPlan, factor: float, *, offset: float = 0.0) -> float:
        asked.append(factor)
        return factor * float(plan.joints_deg[-1]) + offset

    own, other = MotionPlan(plan.segments), MotionPlan(plan.segments)
    assert [reported(own, 2.0), reported(own, 2.0), reported(own, 3.0)] == [720.0, 720.0, 1080.0]
    assert asked == [2.0, 3.0]
    assert reported(own, 3.0, offset=1.0) == 1081.0
    assert reported(other, 3.0) == 1080.0
    assert asked == [2.0, 3.0, 3.0, 3.0]
    assert pickle.loads(pickle.dumps(own)).kept == {}


def test_what_is_recalled_cannot_be_changed(recalling: MotionPlan, plan: MotionPlan) -> None:
    phi = PHI.copy()
    found = recalling.jet(phi)
    assert not found.flags.writeable
    phi += 0.5  # by whoever asked, in place
    assert np.array_equal(recalling.jet(phi), plan.jet(PHI + 0.5))


def test_much_is_not_kept(recalling: MotionPlan, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kept, "MOST_KEPT", 10)
    assert recalling.jet(PHI) is not recalling.jet(PHI)
    assert recalling.jet(PHI[:10]) is recalling.jet(PHI[:10])


def test_threads_get_the_answers_to_their_own_questions(recalling: MotionPlan) -> None:
    """Eight of them ask for one of four sets of angles each, over and over."""
    questions = [PHI + 0.1 * number for number in range(4)]
    expected = [MotionPlan(recalling.segments).jet(phi).tobytes() for phi in questions]

    def ask(number: int) -> bool:
        return all(
            recalling.jet(questions[k % 4]).tobytes() == expected[k % 4]
            for k in range(number, number + 200)
        )

    with ThreadPoolExecutor(8) as pool:
        assert all(pool.map(ask, range(8)))


def test_a_law_asked_for_again_is_the_same_one() -> None:
    given = {"inflection": 0.3}
    law = law_of("modified-sine", "R-R", given)
    assert law_of("modified-sine", "R-R", dict(given)) is law
    assert law_of("modified-sine", "R-R", {"inflection": 0.31}) is not law
    assert characteristic(law) is characteristic(law)
    law = law_of("polynomial-5", "B-B", {"v0": 0.5, "v1": 2.0})
    half = replace(law, regions=law.regions[:1])
    assert half == law  # regions are made of what is compared
    assert characteristic(half).velocity.value < characteristic(law).velocity.value
