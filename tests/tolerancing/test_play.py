"""The play between two sides that hold a follower, against distances between its sides and discs.

The independent model has the places of rollers and faces at each lift, as the scene's own machine
has them, moves them as the deviations say, and presses them on the discs one after the other: the
coordinate at which a roller's centre is as far from the curve of the nominal centres as the roller
is too large, or at which a face meets the outermost point of the disc.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pytest

from camgeo.app.answers.tolerance import tolerance
from camgeo.design.design import Design
from camgeo.kinematics.mechanism.follower import Follower
from camgeo.scene.scene import Scene, load_scene
from camgeo.studies.tolerancing.linear import Play, machine_deviations
from camgeo.studies.tolerancing.stated import (
    Deviations,
    StatedTolerances,
    machine_dimensions,
    side_machines,
)
from tests.findings import known
from tests.tolerancing.machines import FIXTURES, LEVER

Array = np.ndarray

ANGLES = np.radians(np.arange(3.7, 360.0, 36.0))

ROLLERS = {
    "follower": {
        "kind": "translating-roller", "base_radius": 40, "roller_radius": 9, "guide_angle": 40,
        "yoke": {},
    },
}  # fmt: skip
"""In place of the two faces of fixtures/scenes/constant_breadth."""

SCENES = ("conjugate_lever", "conjugate_carriage", "constant_breadth", "yoke of rollers")


def scene_of(name: str) -> Scene:
    if name != "yoke of rollers":
        return load_scene(FIXTURES / "scenes" / f"{name}.toml")
    plate = load_scene(FIXTURES / "scenes" / "constant_breadth.toml")
    return plate.with_values({"follower": None}).with_values(ROLLERS)


def toleranced(scene: Scene, **table: object) -> Scene:
    """With a tolerance of every dimension, unless the table says otherwise."""
    dimensions = [
        {"key": key, "plus_minus": 0.002 if each.is_angle else 0.01}
        for key, each in machine_dimensions(*side_machines(Design(scene))).items()
    ]
    return scene.with_values({"tolerance": {"dimension": dimensions, **table}})


def play_of(scene: Scene, angles: Array = ANGLES) -> Play:
    return Play(StatedTolerances.from_design(Design(scene)), angles)


# By distances -------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Model:
    """The machine of a scene with deviations, `by` their keys [mm or rad]."""

    scene: Scene
    by: dict[str, float]

    @cached_property
    def design(self) -> Design:
        return Design(self.scene)

    @cached_property
    def rotation(self) -> int:
        return self.design.cam.rotation

    def lift(self, phi: Array) -> Array:
        return np.asarray(self.design.drive.motion.jet(phi)[0])

    def of(self, key: str) -> float:
        return self.by.get(key, 0.0)

    @cached_property
    def axis(self) -> complex:
        return complex(self.of("shaft.x"), self.of("shaft.y"))

    def disc(self, places: Array, u: Array, key: str, phi: float) -> Array:
        """Places (n,) in the frame at lift q(u), as points of a disc that has turned by phi."""
        seat = complex(self.of(f"{key}.x"), self.of(f"{key}.y"))
        turn = np.exp(1j * self.rotation * (phi + self.of(f"{key}.angle")))
        return np.asarray(self.axis + turn * (places * np.exp(-1j * self.rotation * u) + seat))

    def play(self, phi: float) -> float:
        """How far the follower can move, at a cam angle."""
        start = float(self.lift(np.array([phi]))[0])
        found = 0.0
        for gap in self.gaps(phi):
            slope = (gap(start + 1e-4) - gap(start - 1e-4)) / 2e-4
            q = start
            for _ in range(6):
                q -= gap(q) / slope
            found -= np.sign(slope) * q
        return found

    def gaps(self, phi: float) -> list[Callable[[float], float]]:
        """How far each side is off its disc at a coordinate [mm]."""
        cams = self.design.cams
        second = known(cams[1] if len(cams) > 1 else cams[0].opposite)
        if "roller_radius" not in self.scene.values["follower"]:
            return self.of_faces(phi)
        own, other = self.rollers
        disc = "return.mounting" if len(cams) > 1 else "mounting"
        return [
            self.of_roller(phi, cams[0].follower, own, "follower", "mounting"),
            self.of_roller(phi, second.follower, other, self.second_key, disc),
        ]

    @property
    def second_key(self) -> str:
        return "follower.return" if len(self.design.cams) > 1 else "follower.yoke"

    @cached_property
    def rollers(self) -> tuple[Callable[[complex], complex], Callable[[complex], complex]]:
        """Where the centres of deviating rollers are, by where those of the scene are."""
        table = self.scene.values["follower"]
        if "pivot" in table:
            pivot = complex(*table["pivot"])
            off = complex(self.of("follower.pivot[1]"), self.of("follower.pivot[2]"))
            back = table["return"]
            turned = np.exp(1j * self.of("follower.return.arm_angle"))
            other = turned * (1.0 + self.of("follower.return.arm") / back["arm"])
            mine = 1.0 + self.of("follower.arm") / table["arm"]
            return (
                lambda place: pivot + off + (place - pivot) * mine,
                lambda place: pivot + off + (place - pivot) * other,
            )
        guide = np.exp(1j * np.radians(table["guide_angle"]))
        tilt = np.exp(1j * self.of("follower.guide_angle"))
        right = -1j * guide
        apart = self.of("follower.return.spacing") + self.of("follower.yoke.breadth")
        return (
            lambda place: (place + right * self.of("follower.offset")) * tilt,
            lambda place: (
                (place + right * self.of("follower.return.offset") - guide * apart) * tilt
            ),
        )

    def of_roller(
        self,
        phi: float,
        follower: Follower,
        place: Callable[[complex], complex],
        own: str,
        key: str,
    ) -> Callable[[float], float]:
        def centres(q: Array) -> Array:
            return np.array([complex(follower.traced_point(float(each))) for each in q])

        u = phi + np.linspace(-0.03, 0.03, 601)
        curve = self.disc(centres(self.lift(u)), u, key, phi)

        def gap(q: float) -> float:
            centre = place(complex(follower.traced_point(q)))
            near = int(np.clip(np.argmin(np.abs(curve - centre)), 1, len(u) - 2))
            # the foot on the parabola through three neighbours
            steps = curve[near - 1 : near + 2]
            bend, along = 0.5 * (steps[2] - 2.0 * steps[1] + steps[0]), 0.5 * (steps[2] - steps[0])
            t = 0.0
            for _ in range(5):
                foot = steps[1] + along * t + bend * t * t
                way = along + 2.0 * bend * t
                t += ((centre - foot) * way.conjugate()).real / abs(way) ** 2
            foot, way = steps[1] + along * t + bend * t * t, along + 2.0 * bend * t
            outward = 1j * self.rotation * way / abs(way)
            side = ((centre - foot) * outward.conjugate()).real
            return float(side - self.of(f"{own}.roller_radius"))

        return gap

    def of_faces(self, phi: float) -> list[Callable[[float], float]]:
        """The outermost points of the disc along the guide, and opposite."""
        table = self.scene.values["follower"]
        guide = np.exp(1j * np.radians(table["guide_angle"]))
        tilted = guide * np.exp(1j * self.of("follower.guide_angle"))
        u = np.linspace(0.0, 2.0 * np.pi, 20001)
        lift, velocity = self.design.drive.motion.jet(u)[:2]
        height = table["base_radius"] + lift
        points = self.disc(guide * (height - 1j * self.rotation * velocity), u, "mounting", phi)
        top = float(np.max((points * tilted.conjugate()).real))
        bottom = float(np.max(-(points * tilted.conjugate()).real))
        breadth = table["yoke"]["breadth"] + self.of("follower.yoke.breadth")
        base = table["base_radius"]
        return [lambda q: base + q - top, lambda q: breadth - base - q - bottom]


@pytest.mark.parametrize("name", SCENES)
def test_play_is_that_of_distances_between_rollers_or_faces_and_discs(name: str) -> None:
    scene = toleranced(scene_of(name))
    dimensions = machine_dimensions(*side_machines(Design(scene)))
    keys = [key for key in dimensions if not key.endswith("base_radius") and "linkage" not in key]
    rng = np.random.default_rng(40)
    play = play_of(scene)
    for _ in range(2):
        by = {
            key: rng.uniform(-1.0, 1.0) * (0.0005 if dimensions[key].is_angle else 0.05)
            for key in keys
        }
        deviations = machine_deviations(
            tuple(each for each in play.stated.sources if each.name in by),
            [np.array([[by[each.name]]]) for each in play.stated.sources if each.name in by],
        )
        found = (play.nominal_values + play.errors(deviations))[0]
        model = Model(scene, by)
        expected = [model.play(float(phi)) for phi in ANGLES]
        lift_scale = play.stated.machine.cam.follower.lift_scale
        np.testing.assert_allclose(found, expected, rtol=0, atol=2e-6 * min(lift_scale, 1.0))
        assert np.ptp(found) > 1e-5 or "breadth" in name


# What must hold -----------------------------------------------------------------------------------


@pytest.mark.parametrize("name", SCENES)
def test_exact_sensitivities_of_the_play_are_the_limits_of_differences(name: str) -> None:
    play = play_of(toleranced(scene_of(name), form=[{"plus_minus": 0.01, "waves": 6}]))
    for source in play.stated.sources:
        for unit, row in zip(source.units, play.sensitivity(source), strict=True):
            apart = []
            for step in (1e-3, 1e-2):
                sizes = unit.factor * np.array([step, -step])
                upper, lower = play.errors(Deviations(2, {unit.freedom: sizes}))
                apart.append(np.max(np.abs((upper - lower) / (2.0 * step) - row)))
            assert apart[0] <= 0.015 * apart[1] + 1e-9 * (1.0 + np.max(np.abs(row))), source.name


def largest(play: Play, *keys: str) -> float:
    """The largest play where these dimensions deviate by as much at once [per mm or rad]."""
    chosen = [each for each in play.stated.sources if each.name in keys]
    assert len(chosen) == len(keys)
    return float(np.max(np.abs(np.sum([play.sensitivity(each)[0] for each in chosen], axis=0))))


@pytest.mark.parametrize(
    ("name", "keys"),
    [
        ("conjugate_lever", ("shaft.x", "follower.pivot[1]")),
        ("conjugate_lever", ("mounting.angle", "return.mounting.angle")),
        ("conjugate_carriage", ("mounting.angle", "return.mounting.angle")),
        ("conjugate_lever", ("follower.base_radius",)),
    ],
)
def test_what_moves_both_sides_alike_leaves_no_play(name: str, keys: tuple[str, ...]) -> None:
    play = play_of(toleranced(scene_of(name)))
    assert largest(play, *keys) < 1e-12
    assert len(keys) == 1 or largest(play, keys[0]) > 1e-3


@pytest.mark.parametrize("key", ["mounting.x", "shaft.y", "mounting.angle", "follower.guide_angle"])
def test_a_cam_of_constant_breadth_fits_its_yoke_wherever_it_lies(key: str) -> None:
    assert largest(play_of(toleranced(scene_of("constant_breadth"))), key) == 0.0


@pytest.mark.parametrize(("waves", "per_height"), [(6, 2.0), (7, 0.0)])
def test_waves_of_a_cam_between_faces_add_up_if_they_are_even(
    waves: int, per_height: float
) -> None:
    scene = toleranced(scene_of("constant_breadth"), form=[{"plus_minus": 0.01, "waves": waves}])
    play = play_of(scene, np.linspace(0.0, 6.0, 50))
    amplitude = np.hypot(*play.sensitivity(play.stated.sources[-1]))
    np.testing.assert_allclose(amplitude, per_height, rtol=0, atol=1e-9)


def test_a_wider_or_narrower_yoke_has_that_play() -> None:
    scene = scene_of("constant_breadth").with_values({"follower.yoke.breadth": 66.3})
    key = {"key": "follower.yoke.breadth", "limits": [-0.1, 0.2], "distribution": "uniform"}
    found = tolerance(Design(scene.with_values({"tolerance": {"dimension": [key]}})), count=256)
    play, machines = known(found.play), known(found.machines)
    least = known(machines.least_play)
    assert play.unit == "mm"
    sigma = 0.3 / np.sqrt(12.0)
    assert play.least.value == pytest.approx(0.35 - 3.0 * sigma)
    assert play.most.value == pytest.approx(0.35 + 3.0 * sigma)
    assert least.nominal == pytest.approx(0.3)
    assert least.machines == pytest.approx((0.203, 0.35, 0.497), abs=2e-3)
    assert machines.squeezed == 0.0


def test_a_yoke_that_may_be_too_narrow_is_squeezed_as_often() -> None:
    key = {"key": "follower.yoke.breadth", "limits": [-0.01, 0.03], "distribution": "uniform"}
    scene = scene_of("constant_breadth").with_values({"tolerance": {"dimension": [key]}})
    machines = tolerance(Design(scene), count=256).machines
    assert known(machines).squeezed == pytest.approx(0.25, abs=4e-3)


def test_a_pair_of_the_return_side_changes_its_play_alone() -> None:
    scene = load_scene(LEVER.parent / "pair.toml")
    found = tolerance(Design(scene), count=0)
    of_return = [each for each in found.sources if "return" in each.name or "[2]" in each.name]
    assert len(of_return) == 6
    assert {each.share for each in of_return} == {0.0}
    play = known(found.play)
    assert min(each.share for each in play.sources) > 0.0
    assert sum(each.share for each in play.sources) == pytest.approx(1.0)
    assert play.least.value < 0.0 < play.most.value
