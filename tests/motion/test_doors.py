"""Every part of motion is data: it checks its values at its own door, and it travels.

A door gives a right answer, or the key and why. Whatever is handed in, no error but camgeo's own
comes out, and no warning of numpy's (the tests make errors of them); what is accepted gives finite
values. Pickles and copies give the same values bit for bit, and so does what a plan recalls of its
last answers.
"""

from __future__ import annotations

import copy
import math
import pickle
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from functools import cache, partial
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgeo import load
from camgeo.app.answers.table import law_table
from camgeo.errors import GeometryError, VersionError
from camgeo.kinematics.laws import FAMILIES, build_law, make_law
from camgeo.kinematics.laws.comparison import Running, compare
from camgeo.kinematics.laws.law import Law, characteristic
from camgeo.kinematics.mechanism.linkage import LinkedMotion
from camgeo.kinematics.motion import Motion
from camgeo.kinematics.plan import Dwell, MotionPlan, Move, SplineMove, breaks, joints
from camgeo.kinematics.planning.build import balanced
from camgeo.kinematics.planning.planner import plan_motion
from camgeo.kinematics.planning.requests import MoveRequest, PointsRequest, TableRequest
from camgeo.kinematics.splines import Spline
from camgeo.kinematics.tables import TwoColumns
from camgeo.kinematics.time_course import ConstantSpeed, SpeedCurve, plan_extremes, time_extremes
from camgeo.numeric import kept
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.kept import kept_with_owner
from camgeo.scene.scene import load_scene
from camgeo.units import TURN
from tests.long_form import examples
from tests.motion.planning import wishes

NUMBERS: tuple[Any, ...] = (
    *(math.nan, math.inf, -math.inf, -1.0, 0.0, -0.0, 5e-324, -5e-324, 1e-310, 1e-30, 1e-9, 0.5),
    *(1.0 - 2.0**-53, 1.0, 1.0 + 2.0**-52, 3.0, 60.0, 1e6, 1e12, 1e30, 1e50, 1e100, 1e308, -1e308),
    *(np.float64(0.3), np.float32(0.3), np.int64(1), 3, Fraction(1, 3), 10**400),
    *(Decimal("0.5"), Decimal("NaN"), Decimal("sNaN"), Decimal("1e-7"), Decimal("1e400")),
)
NASTY = (*NUMBERS, "1", b"x", None, True, 1j, [1.0], {}, object(), np.ones(3))


def some_of(key: str) -> tuple[Any, ...]:
    """All that is no number; of numbers, which cost more as they may be accepted, every fifth, from
    another one on for each key.
    """
    step = examples(5, long=1)
    return (*NUMBERS[sum(map(ord, key)) % step :: step], math.nan, *NASTY[len(NUMBERS) :])


LAW = make_law("polynomial-345")
PHI = np.linspace(0.0, TURN, 37)
X, Y = [0.0, 1.0, 2.0, 3.0], [0.0, 1.0, 0.0, 2.0]
PLAN = MotionPlan((Dwell(Decimal(60)), Move(Decimal(150), 5.0, LAW), Move(Decimal(150), 0.0, LAW)))


def used(plan: MotionPlan) -> None:
    """Ask a plan for all that it is asked for."""
    assert np.all(np.isfinite(plan.jet(PHI)))
    plan.jet_and_bounds(PHI[:-1], PHI[:-1] + 1e-9)
    breaks(plan)
    for found in (
        time_extremes(plan, ConstantSpeed(9.0)),
        plan_extremes(plan, ConstantSpeed(9)),
    ):
        assert math.isfinite(found.jerk.magnitude)


def finite(spline: Spline) -> None:
    assert np.all(np.isfinite(spline.values(np.linspace(spline.knots[0], spline.knots[-1], 9))))


def planned(move: MoveRequest | PointsRequest | TableRequest) -> None:
    rest = Decimal(300) - move.span
    used(plan_motion([Dwell(Decimal(60)), move, MoveRequest(rest, 0.0, "polynomial-5")]))


def changed(values: list[float], place: int, value: Any) -> Any:
    return [*values[:place], value, *values[place + 1 :]]


DOORS: dict[str, Callable[[Any], object]] = {
    "dwell": Dwell,
    "move.span": lambda v: used(MotionPlan((Move(v, 5.0, LAW), Move(Decimal(300), 0.0, LAW)))),
    "move.to": lambda v: used(
        MotionPlan((Move(Decimal(60), v, LAW), Move(Decimal(300), 0.0, LAW)))
    ),
    "move.law": lambda v: Move(Decimal(60), 1.0, v),
    "move.scale": lambda v: Move(Decimal(60), 1.0, LAW, v),
    "spline move": lambda v: SplineMove(Decimal(60), 1.0, v),
    "plan": MotionPlan,
    "plan of it": lambda v: MotionPlan((v,)),
    "planned": plan_motion,
    "planned of it": lambda v: plan_motion([v]),
    "request.span": lambda v: planned(MoveRequest(v, 5.0, "auto")),
    "request.to": lambda v: planned(MoveRequest(Decimal(90), v, "modified-sine")),
    "request.velocity": lambda v: planned(MoveRequest(Decimal(90), 5.0, "auto", velocity=v)),
    "request.jerk": lambda v: planned(MoveRequest(Decimal(90), 5.0, "polynomial-7", jerk=v)),
    "request.inflection": lambda v: planned(
        MoveRequest(Decimal(90), 5.0, "auto", parameters={"inflection": v})
    ),
    "request.weights": lambda v: planned(
        MoveRequest(Decimal(90), 5.0, "auto", optimise={"jerk": v})
    ),
    "points.share": lambda v: planned(
        PointsRequest(Decimal(90), 5.0, changed([0.3, 0.6], 1, v), np.array([1.0, 2.0]))
    ),
    "points.position": lambda v: planned(
        PointsRequest(Decimal(90), 5.0, np.array([0.3, 0.6]), changed([1.0, 2.0], 1, v))
    ),
    "points.given": lambda v: planned(
        PointsRequest(Decimal(90), 5.0, np.array([0.3]), np.array([1.0]), {0: (v, None)})
    ),
    "table.share": lambda v: planned(
        TableRequest(Decimal(90), changed([0.0, 0.3, 0.6, 1.0], 2, v), np.array(Y))
    ),
    "table.lift": lambda v: planned(
        TableRequest(Decimal(90), np.array([0.0, 0.3, 0.6, 1.0]), changed(Y, 2, v))
    ),
    "speed": lambda v: time_extremes(PLAN, ConstantSpeed(v)),
    "curve.t": lambda v: time_extremes(
        PLAN, SpeedCurve(changed([0.0, 0.1, 0.2, 0.3, 0.4], 1, v), np.linspace(0.0, TURN, 5))
    ),
    "curve.phi": lambda v: SpeedCurve(np.arange(5.0), changed([0.0, 2.0, 3.0, 5.0, TURN], 2, v)),
    "spline": lambda v: Spline(v, v),
    "spline.taylor": lambda v: Spline(np.arange(2.0), changed([0.0] * 6, 3, v)),
    "spline.rise": lambda v: Spline(np.arange(2.0), np.ones((1, 6)), periodic=True, rise=v),
    "points.x": lambda v: finite(Spline.clamped(changed(X, 1, v), np.array(Y))),
    "points.y": lambda v: finite(Spline.closed(np.array(X), changed(Y, 1, v), 4.0)),
    "points.start": lambda v: finite(Spline.clamped(np.array(X), np.array(Y), (v, None))),
    "points.end": lambda v: finite(Spline.clamped(np.array(X), np.array(Y), end=v)),
    "points.inner": lambda v: finite(Spline.clamped(np.array(X), np.array(Y), inner={1: (v, v)})),
    "points.period": lambda v: finite(Spline.closed(np.array(X), np.array(Y), v)),
    "points.rise": lambda v: finite(Spline.closed(np.array(X), np.array(Y), 4.0, v)),
    "points.gap": lambda v: finite(Spline.closed(np.array(X), np.array(Y), 4.0, gap=v)),
    "smoothing": lambda v: Spline.smooth_clamped(np.array(X), np.array(Y), largest_deviation=v),
    "lift file": lambda v: TwoColumns.of_lifts(v, "a.csv"),
    "lift file.span": lambda v: TwoColumns.of_lifts("0;0\n3;1\n", "a.csv", v),
    "speed file": lambda v: SpeedCurve.read(v, "a.csv"),
    "law.name": make_law,
    "law.task": lambda v: make_law("polynomial-5", v),
    "table of values": lambda v: law_table(LAW, v),
    "running.speed": lambda v: Running(v, 1.0, 1.0).physical("jerk", 5.0),
    "running.span": lambda v: Running(1.0, v, 1.0).physical("moment", 5.0),
    "compare.given": lambda v: compare("R-R", {"inflection": v}, ("modified-sine",)),
    "compare.names": lambda v: compare("R-R", {}, v),
    "compare.task": lambda v: compare(v, {}),
    "balance.quantity": lambda v: balanced("scca", "R-R", v, {}),
    "balance.task": lambda v: balanced("scca", v, "jerk", {}),
}


def refusal(call: Callable[[], object]) -> GeometryError | None:
    """Why a call is refused; None if it is not."""
    try:
        call()
    except GeometryError as error:
        return error
    return None


@pytest.mark.parametrize("name", DOORS)
def test_a_door_answers_or_explains_its_refusal(name: str) -> None:
    tried = some_of(name)
    refused = [refusal(partial(DOORS[name], value)) for value in tried]
    assert any(refused)
    for value, why in zip(tried, refused, strict=True):
        if why is not None:
            assert why.key or "a.csv, line" in why.message, (value, why)
            assert why.message, value


def tried_law(name: str, task: str, given: dict[str, Any]) -> None:
    """Make a law, and ask it for its values."""
    law = make_law(name, task, **given)
    assert np.all(np.isfinite(law(np.linspace(0.0, 1.0, 41))))
    characteristic(law)


@pytest.mark.parametrize(
    ("name", "task"), [(name, task) for name, each in FAMILIES.items() for task in each.tasks]
)
def test_a_law_takes_a_parameter_or_names_it(name: str, task: str) -> None:
    taken = FAMILIES[name].parameters[task]
    for key in taken:
        for value in some_of(f"{name} {task} {key}"):
            why = refusal(partial(tried_law, name, task, {key: value}))
            assert why is None or why.key, value
    rng = np.random.default_rng(1)
    numbers = [value for value in NUMBERS if isinstance(value, float)]
    for _ in range(examples(3, long=20)):
        given = {key: numbers[rng.integers(len(numbers))] for key in taken if rng.random() < 0.7}
        why = refusal(partial(tried_law, name, task, given))
        assert why is None or why.message, given


# What travels -------------------------------------------------------------------------------------
ROOT = Path(__file__).parents[2] / "fixtures"
SCENES = sorted((*ROOT.glob("scenes/*.toml"), *ROOT.glob("effects/*.toml")))
Z = np.concatenate((np.linspace(0.0, 1.0, 201), [1e-9, 1.0 - 1e-9]))

AROUND_TURN = np.concatenate((np.linspace(-0.1, TURN + 0.1, 501), [0.0, TURN]))

Travel = Callable[[Any], Any]

TRAVELS: dict[str, Travel] = {
    "pickle": lambda value: pickle.loads(pickle.dumps(value)),
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
}


def bits(law: Law) -> list[bytes]:
    """All that a law says of itself."""
    turns = [np.array(region.turns()).tobytes() for region in law.regions]
    return [np.array(law(Z)).tobytes(), law.complement(Z).tobytes(), *turns]


def arrays_of(value: Any) -> list[FloatArray]:
    """The arrays in an object of camgeo."""
    names = [name for each in type(value).__mro__ for name in getattr(each, "__slots__", ())]
    held = [getattr(value, name) for name in (*names, *getattr(value, "__dict__", ()))]
    return [each for each in held if isinstance(each, np.ndarray)]


@pytest.mark.parametrize(
    ("name", "task", "way"),
    [(name, task, "pickle") for name, each in FAMILIES.items() for task in each.tasks]
    + [(name, FAMILIES[name].tasks[0], way) for name in FAMILIES for way in ("copy", "deepcopy")],
)
def test_a_law_of_every_family_travels(name: str, task: str, way: str) -> None:
    travel = TRAVELS[way]
    taken = FAMILIES[name].parameters[task]
    given_values = {key: 0.7 for key in taken if key in ("v0", "v1", "curved")}
    given_values |= {key: 0.2 for key in taken if key in ("sine", "cosine")}
    given_values |= {key: 0.4 for key in taken if key == "inflection"}
    if name.startswith("polynomial") and "inflection" not in taken:
        given_values |= {key: 0.3 for key in taken if key[0] in "aj"}
    law = make_law(name, task, **given_values)
    found = travel(law)
    assert found == law
    assert dict(found.parameters) == dict(law.parameters)
    assert bits(found) == bits(law)


def test_a_law_of_no_family_is_not_lost_silently() -> None:
    law = make_law("inclined-sine")
    own = Law("own", "R-R", law.regions, (), law.start, law.end)
    with pytest.raises(TypeError, match="the law own has no recipe"):
        pickle.dumps(own)


STAYS = "without stroke"

MOTIONS: dict[str, Path | None] = {path.stem: path for path in SCENES}
MOTIONS |= {
    f"{path.stem} linked": path for path in SCENES if "[linkage]" in path.read_text("utf-8")
}
MOTIONS[STAYS] = None
"""The plan of every scene there is, also behind its linkage, by name."""


@cache
def motion_of(name: str) -> Motion:
    path = MOTIONS[name]
    if path is None:
        return plan_motion(
            [wishes.move(60, 10.0), wishes.move(120, 10.0, "polynomial-5"), wishes.move(180, 0.0)]
        )
    scene = load_scene(path)
    linkage = scene.linkage if name != path.stem else None
    return scene.plan if linkage is None else LinkedMotion(scene.plan, linkage)


SOME = ("plate_translating", "points", "measured", "schnitt linked", STAYS)
"""Plans of each kind that are copied, too: a copy is made as a pickle is."""


@pytest.mark.parametrize(
    ("name", "way"),
    [(name, "pickle") for name in MOTIONS] + list(product(SOME, ("copy", "deepcopy"))),
)
def test_a_motion_travels(name: str, way: str) -> None:
    travel = TRAVELS[way]
    motion = motion_of(name)
    assert isinstance(motion, LinkedMotion) == name.endswith(" linked")
    before = [motion.jet(AROUND_TURN, side).tobytes() for side in ("right", "left")]
    found = travel(motion)
    assert [found.jet(AROUND_TURN, side).tobytes() for side in ("right", "left")] == before
    assert found.borders.tobytes() == motion.borders.tobytes()
    assert found.breaks.tobytes() == motion.breaks.tobytes()
    assert found.dwells == motion.dwells
    cells = np.unique(np.concatenate((motion.borders, [0.0, TURN])))
    bounds = zip(
        found.jet_and_bounds(cells[:-1], cells[1:]),
        motion.jet_and_bounds(cells[:-1], cells[1:]),
        strict=True,
    )
    assert all(one.tobytes() == other.tobytes() for one, other in bounds)
    if isinstance(found, MotionPlan):
        splines = [each.spline for each in found.segments if isinstance(each, SplineMove)]
        assert all(not array.flags.writeable for each in splines for array in arrays_of(each))


def test_a_plan_travels_without_what_was_computed_and_names_its_version(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    plan = MotionPlan(
        plan_motion([wishes.rest(60), wishes.move(120, 10.0), wishes.move(180, 0.0)]).segments
    )
    fresh = pickle.dumps(plan)
    plan.jet(AROUND_TURN)
    data = pickle.dumps(plan)
    assert data == fresh
    assert type(pickle.loads(data)) is MotionPlan
    monkeypatch.setattr("camgeo.record.__version__", "99.0")
    with pytest.raises(VersionError, match="a MotionPlan pickled by camgeo"):
        pickle.loads(data)


@pytest.mark.parametrize("travel", TRAVELS.values(), ids=TRAVELS)
def test_time_courses_and_tables_travel(travel: Travel) -> None:
    t = np.linspace(0.0, 2.0, 9)
    phi = TURN * t / 2.0 + 0.1 * np.sin(TURN * t / 2.0)
    curve = SpeedCurve(t, phi)
    found = travel(curve)
    assert found.rates(AROUND_TURN).tobytes() == curve.rates(AROUND_TURN).tobytes()
    assert found.time(AROUND_TURN).tobytes() == curve.time(AROUND_TURN).tobytes()
    assert len(arrays_of(found)) == 2
    assert not any(array.flags.writeable for array in (*arrays_of(found), *arrays_of(found.spline)))
    assert travel(ConstantSpeed(20.0)) == ConstantSpeed(20.0)
    table: TwoColumns = travel(TwoColumns.of_lifts("0;0\n30;1\n60;2\n", "a.csv", 60.0))
    assert table.second.tolist() == [0.0, 1.0, 2.0]
    assert not any(array.flags.writeable for array in arrays_of(table))
    plan = motion_of("plate_translating")
    assert isinstance(plan, MotionPlan)
    for joint in travel(joints(plan)):
        assert not joint.left.flags.writeable


@pytest.mark.parametrize("span", [3, 3.0, np.float64(3.0), Decimal("3")])
def test_spans_are_the_same_however_they_are_given(span: Any) -> None:
    law = make_law("inclined-sine")
    plan = MotionPlan((Dwell(Decimal(300)), Move(span, 2, law), Move(57, 0, law)))  # type: ignore[arg-type]  # any number is allowed
    assert plan.joints_deg == tuple(map(Decimal, (0, 300, 303, 360)))
    move = plan.segments[1]
    assert isinstance(move, Move)
    assert type(move.to) is float


# What was asked for lately is recalled ------------------------------------------------------------


@pytest.fixture(scope="module")
def plan() -> MotionPlan:
    return load(ROOT / "scenes" / "groove.toml").cam.drive.plan


@pytest.fixture
def recalling(plan: MotionPlan) -> MotionPlan:
    return MotionPlan(plan.segments)


AROUND = np.linspace(-1.0, TURN + 1.0, 101)


def test_the_same_question_is_answered_once(recalling: MotionPlan) -> None:
    first = recalling.jet(AROUND)
    assert recalling.jet(AROUND.copy()) is first
    assert recalling.jet(AROUND, "left") is not first
    assert recalling.jet(AROUND) is first
    recalling.jet(AROUND[1:])
    assert recalling.jet(AROUND) is first


def test_what_was_asked_the_longest_time_ago_is_forgotten(
    recalling: MotionPlan, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(kept, "MOST_ANGLES", 2 * len(AROUND))
    first, second = recalling.jet(AROUND), recalling.jet(AROUND, "left")
    assert recalling.jet(AROUND) is first
    recalling.jet(AROUND + 0.1)
    assert recalling.jet(AROUND) is first
    assert recalling.jet(AROUND, "left") is not second


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
    phi = AROUND.copy()
    assert not recalling.jet(phi).flags.writeable
    phi += 0.5  # by whoever asked, in place
    assert np.array_equal(recalling.jet(phi), plan.jet(AROUND + 0.5))


def test_much_is_not_kept(recalling: MotionPlan, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kept, "MOST_ANGLES", 10)
    assert recalling.jet(AROUND) is not recalling.jet(AROUND)
    assert recalling.jet(AROUND[:10]) is recalling.jet(AROUND[:10])


def test_threads_get_the_answers_to_their_own_questions(recalling: MotionPlan) -> None:
    """Eight of them ask for one of four sets of angles each, over and over."""
    questions = [AROUND + 0.1 * number for number in range(4)]
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
    law = build_law("modified-sine", "R-R", given)
    assert build_law("modified-sine", "R-R", dict(given)) is law
    assert build_law("modified-sine", "R-R", {"inflection": 0.31}) is not law
    assert characteristic(law) is characteristic(law)
    law = build_law("polynomial-5", "B-B", {"v0": 0.5, "v1": 2.0})
    half = replace(law, regions=law.regions[:1])
    assert half == law  # regions are made of what is compared
    assert characteristic(half).velocity.value < characteristic(law).velocity.value
