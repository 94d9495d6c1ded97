"""Effects of followers with a yoke: forces of either side against Newton's law for free bodies.

The second side is looked for on the disc itself, where the first one is half a turn later, and not
as a follower of its own: contacts, normals and slips are found from places and velocities.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from random import Random
from typing import Any, Final

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.design.design import Design
from camgeo.errors import EffectError
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.scene.scene import load_scene, parse_scene
from camgeo.units import RPM, TURN
from tests.effects.bodies import along, cross, pull
from tests.effects.scenes import SCENES
from tests.findings import finding
from tests.long_form import examples

RIGHT: Final[Side] = "right"

REST: Final = 1e-12
"""Largest residual of a balance, as a share of the largest of its terms at any of the angles."""

HALF: Final = 0.5 * TURN

ASKED: Final = "".join(
    f"[effects.{name}]\n"
    for name in ("contact-force", "drive-torque", "reactions", "lift-off", "power-balance")
)


@dataclass(frozen=True)
class Drawn:
    """A scene with a yoke and its numbers, in mm, t, s, N and degrees.

    Without a friction there is none.
    """

    kind: str = "roller"
    rotation: int = 1
    base: float = 40.0
    radius: float = 8.0
    guide: float = 90.0
    direction: int = 1
    stroke: float = 16.0
    law: str = "modified-sine"
    rest: int = 0
    speed: float = 300.0
    mass: float = 1e-3
    fall: float = -90.0
    load: float = 5.0
    rubbing: tuple[tuple[str, float], ...] = ()
    yoke: str = ""
    moves: str = ""

    @property
    def breadth(self) -> float:
        return 2.0 * self.base + self.direction * self.stroke

    @property
    def table(self) -> dict[str, float]:
        return dict(self.rubbing)

    def text(self, more: str = ASKED) -> str:
        sides = f"roller_radius = {self.radius!r}\n" if self.kind == "roller" else ""
        rest = f"[[motion]]\ndwell = {self.rest}\n" if self.rest else ""
        move = f"[[motion]]\nlaw = '{self.law}'\nspan = {180 - self.rest}\n"
        moves = self.moves or f"{rest}{move}to = {self.stroke!r}\n{rest}{move}to = 0\n"
        friction = "\n".join(("[effects.friction]", *(f"{k} = {v!r}" for k, v in self.rubbing)))
        return (
            f"camgeo = 1\nname = 'yoke'\n[cam]\nrotation = '{'ccw' if self.rotation > 0 else 'cw'}'"
            f"\nspeed = {self.speed!r}\n[follower]\nkind = 'translating-{self.kind}'\n"
            f"base_radius = {self.base!r}\n{sides}guide_angle = {self.guide!r}\n"
            f"direction = '{'outward' if self.direction > 0 else 'inward'}'\n"
            f"[follower.yoke]\n{self.yoke}\n{moves}[effects.inertia]\nmass = {1e3 * self.mass!r}\n"
            f"[effects.gravity]\nangle = {self.fall!r}\n[effects.load]\nconstant = {self.load!r}\n"
            f"{friction if self.rubbing else ''}\n{more}"
        )

    def made(self, more: str = ASKED) -> Design:
        return Design(parse_scene(self.text(more)))


def drawn(rng: Random) -> Drawn:
    """Some yoke; only a few jam."""
    kind = rng.choice(("roller", "flat"))
    rubbing = {"guide": rng.uniform(0.02, 0.12), "guide_length": rng.uniform(60.0, 120.0)}
    rubbing["guide_overhang"] = rng.uniform(-20.0, 30.0)
    if kind == "roller":
        rubbing |= {"roller_pin": rng.uniform(1e-3, 0.1), "roller_pin_diameter": 6.0}
        rubbing["rolling"] = rng.uniform(1e-3, 0.1)
    else:
        rubbing |= {"face": rng.uniform(1e-3, 0.12), "guide_offset": rng.uniform(-6.0, 6.0)}
    return Drawn(
        kind,
        rng.choice((1, -1)),
        rng.uniform(55.0, 80.0),
        rng.uniform(4.0, 15.0),
        rng.uniform(-180.0, 180.0),
        rng.choice((1, -1)),
        rng.uniform(4.0, 16.0),
        rng.choice(("modified-sine", "polynomial-345", "cycloidal")),
        rng.choice((0, 0, 25, 60)),
        rng.uniform(100.0, 900.0),
        rng.uniform(1e-4, 3e-3),
        rng.uniform(-180.0, 180.0),
        rng.uniform(-25.0, 25.0),
        tuple(rubbing.items()),
    )


@dataclass(frozen=True)
class Bodies:
    """Cam and follower in the fixed frame at `phi`; velocities per unit of cam speed.

    A force of the cam is that per unit of its normal part.
    """

    of: Drawn
    motion: Any
    phi: FloatArray

    @property
    def out(self) -> complex:
        return complex(np.exp(1j * math.radians(self.of.guide)))

    @property
    def velocity(self) -> FloatArray:
        return np.asarray(self.of.direction * self.motion.jet(self.phi, RIGHT)[1])

    def height(self, phi: FloatArray) -> FloatArray:
        """Of the first side above the cam axis."""
        return np.asarray(self.of.base + self.of.direction * self.motion.jet(phi, RIGHT)[0])

    def side(self, sense: int) -> Any:
        """Where the cam presses, where that force acts on the follower, the force, its moment on
        the follower, and the torque of the cam.
        """
        out = sense * self.out
        height = self.height(self.phi if sense > 0 else self.phi + HALF)
        if self.of.kind == "flat":
            return self._face(out, height)
        return self._roller(out, height)

    def _face(self, out: complex, height: FloatArray) -> Any:
        sigma, right, moves = self.of.rotation, -1j * out, self.velocity * self.out
        # i sigma (h n + x r) and the velocity of the face agree along n.
        place = along(out, moves) / along(out, 1j * sigma * right)
        at = height * out + place * right
        dragged = np.sign(along(right, 1j * sigma * at - moves))
        force = out + self.of.table.get("face", 0.0) * dragged * right
        return at, at, force, np.zeros(len(self.phi)), sigma * cross(at, force)

    def _roller(self, out: complex, height: FloatArray) -> Any:
        sigma, table, moves = self.of.rotation, self.of.table, self.velocity * self.out
        centre = height * out
        ahead = moves - 1j * sigma * centre
        normal = 1j * ahead / np.abs(ahead)
        normal = normal * np.sign(along(out, normal))
        at = centre - self.of.radius * normal
        spin = np.real((1j * sigma * at - moves) / (1j * (at - centre)))
        pin = -0.5 * table.get("roller_pin", 0.0) * table.get("roller_pin_diameter", 0.0)
        pin = pin * np.sign(spin)
        rolling = -table.get("rolling", 0.0) * np.sign(spin - sigma)
        tangent = 1j * normal
        force = normal - (pin + rolling) / cross(at - centre, tangent) * tangent
        return at, centre, force, -pin, sigma * (cross(at, force) + rolling)

    def balance(self, normal: FloatArray, ends: FloatArray) -> dict[str, list[Any]]:
        """The terms of each balance of the follower with the `normal` force and those at both
        `ends` (2, n) of its guide, and of the torque on the cam without the drive.
        """
        of, table, out, right = self.of, self.of.table, self.out, -1j * self.out
        omega, size = of.speed * RPM, np.abs(normal)
        sides = [self.side(1), self.side(-1)]
        on = [np.where(normal >= 0.0, *each) for each in zip(*sides, strict=True)]
        _, at, force, moment, torque = on
        force, moment = size * force, size * moment
        weight = of.mass * pull(of.fall)
        way, rate = of.direction * out, of.direction * self.velocity
        needed = of.mass * omega**2 * self.motion.jet(self.phi, RIGHT)[2] * way
        rubs = -table.get("guide", 0.0) * np.sum(np.abs(ends), axis=0) * np.sign(rate)
        axis = self.height(self.phi) * out + table.get("guide_offset", 0.0) * right
        near = of.base + table.get("guide_overhang", 0.0)
        places = [near, near + table.get("guide_length", 0.0)]
        levers = [place - self.height(self.phi) for place in places]
        return {
            "along": [along(way, force), along(way, weight), -of.load, rubs, -along(way, needed)],
            "across": [along(right, force), along(right, weight), *ends],
            "moment": [cross(at - axis, force), moment, -levers[0] * ends[0], -levers[1] * ends[1]],
            "torque": [size * torque],
        }


def residuals(of: Drawn, made: Design, phi: FloatArray) -> dict[str, float]:
    """What is left of each balance, as a share of its largest term, the drive torque included."""
    normal = made.effect("contact-force").normal(phi, RIGHT)
    ends = made.effect("reactions").bodies.of_guide(phi, RIGHT)
    terms = Bodies(of, made.drive.motion, phi).balance(normal, ends)
    terms["torque"].append(-made.effect("drive-torque").torque(phi, RIGHT))
    return {
        name: float(np.max(np.abs(sum(each))) / max(np.max(np.abs(one)) for one in each))
        for name, each in terms.items()
    }


@settings(max_examples=examples(4, long=400), deadline=None)
@given(st.randoms(use_true_random=False))
def test_the_follower_moves_as_all_forces_on_it_have_it(rng: Random) -> None:
    of = drawn(rng)
    phi = np.random.default_rng(rng.randrange(1000)).uniform(0.0, TURN, 60)
    left = residuals(of, of.made(), phi)
    assert max(left.values()) <= REST, left


def test_both_sides_carry_in_the_scenes_of_these_tests() -> None:
    rng, sides = Random(5), set()
    for _ in range(6):
        made = drawn(rng).made()
        normal = made.effect("contact-force").normal(np.linspace(0.0, TURN, 40), RIGHT)
        sides |= {(made.cam.follower.kind, each) for each in np.sign(normal).tolist()}
    assert len(sides - {(kind, 0.0) for kind, _ in sides}) == 4


def test_a_pair_with_the_same_disc_twice_has_the_same_effects() -> None:
    """Two rollers on a carriage, as far apart as the cam is wide, whose discs are one."""
    of = Drawn(rest=30, speed=700.0, rubbing=(("guide", 0.1), ("roller_pin", 0.05),
               ("roller_pin_diameter", 7.0), ("rolling", 0.04)))  # fmt: skip
    more = (
        f"{ASKED}[effects.contact-pressure]\nwidth = 8\nlimit = 900\n"
        "cam_modulus = 210000\ncam_poisson = 0.3\nroller_modulus = 210000\nroller_poisson = 0.3\n"
    )
    yoke = of.made(more)
    pair = f"[follower.return]\nspacing = {of.breadth!r}\n"
    other = Design(parse_scene(of.text(more).replace("[follower.yoke]\n", pair)))
    phi = np.random.default_rng(2).uniform(0.0, TURN, 80)
    for name in ("contact-force", "drive-torque", "reactions", "power-balance", "contact-pressure"):
        columns = zip(yoke.effect(name).columns, other.effect(name).columns, strict=True)
        for mine, theirs in columns:
            assert mine.name.replace("opposite", "return") == theirs.name
            found, wanted = (each.values(phi, RIGHT) for each in (mine, theirs))
            assert found == pytest.approx(wanted, rel=1e-12, abs=1e-12 * np.max(np.abs(wanted)))
    changes = [each.effect("lift-off").changes for each in (yoke, other)]
    assert len(changes[0]) == len(changes[1]) > 0
    for mine, theirs in zip(*changes, strict=True):
        assert mine.leaving == pytest.approx(theirs.leaving, abs=1e-12)
        assert mine.sense == theirs.sense


def circle(play: float = 0.0, face: float = 0.0, load: float = 6.0) -> Drawn:
    """An eccentric circle between two faces."""
    rubbing = (("face", face),) if face else ()
    yoke = f"breadth = {60.0 + play!r}\n" if play else ""
    return Drawn("flat", base=18.0, stroke=24.0, law="simple-sine", speed=500.0, load=load,
                 fall=0.0, rubbing=rubbing, yoke=yoke, mass=1.5e-3)  # fmt: skip


def test_an_eccentric_between_two_faces_in_closed_form() -> None:
    """R and e of the circle: s = e (1 - cos phi), and either face slides at its distance from the
    axis, R - e cos phi or R + e cos phi.
    """
    of, R, e = circle(face=0.08), 30.0, 12.0
    made, omega = of.made(), of.speed * RPM
    phi = np.random.default_rng(4).uniform(0.0, TURN, 200)
    wanted = of.mass * omega**2 * e * np.cos(phi) + of.load
    normal = made.effect("contact-force").normal(phi, RIGHT)
    assert normal == pytest.approx(wanted, abs=1e-12 * np.max(wanted))
    slide = R - np.sign(wanted) * e * np.cos(phi)
    torque = wanted * e * np.sin(phi) + 0.08 * np.abs(wanted) * slide
    found = made.effect("drive-torque").torque(phi, RIGHT)
    assert found == pytest.approx(torque, abs=1e-12 * np.max(torque))
    changes = made.effect("lift-off").changes
    turn = math.acos(-of.load / (of.mass * omega**2 * e))
    assert [each.leaving for each in changes] == pytest.approx([turn, TURN - turn], abs=1e-12)
    assert [each.sense for each in changes] == [1, -1]
    work = {each.name: each.value for each in made.effect("power-balance").findings}
    # The integral of |a cos phi + F| (R -+ e cos phi) over the turn, a = m omega^2 e, by parts.
    a, sine, F = of.mass * omega**2 * e, math.sin(turn), of.load
    bound = 2.0 * R * (2.0 * a * sine + F * (2.0 * turn - math.pi)) - math.pi * a * e
    assert work["work-contact-friction"] == pytest.approx(0.08e-3 * bound, rel=1e-6)


UNEVEN: Final = "".join(
    f"[[motion]]\nlaw = 'modified-sine'\nspan = {span}\nto = {to}\n"
    for span, to in ((176, 16), (184, 0))
)


def uneven(breadth: float | None) -> Drawn:
    stated = "" if breadth is None else f"breadth = {breadth!r}\n"
    return Drawn(moves=UNEVEN, yoke=stated, speed=700.0)


def test_a_yoke_that_does_not_fit_is_told() -> None:
    design = uneven(None).made()
    width = design.cam.breadth
    assert width is not None
    (least, _), (most, place) = width.range
    told = {each.name: each for each in design.effects.findings("contact-force")}
    found = told["yoke-breadth"]
    assert found.value == pytest.approx(most - least)
    assert found.cam_angle == place
    assert f"squeezes its yoke by up to {0.5 * (most - least):.3g} mm" in found.sentence
    assert all(each.severity != "ok" for each in told.values())
    assert "squeezes" in design.effects.findings("lift-off")[-1].sentence
    assert "yoke-breadth" not in {each.name for each in design.effects.findings("inertia")}
    loose = {each.name for each in circle(0.05).made().effects.findings("contact-force")}
    assert "yoke-breadth" not in loose
    held = "".join(
        f"[[motion]]\n{each}\n"
        for each in (
            "law = 'cycloidal'\nspan = 60\nto = 38",
            "dwell = 240",
            "law = 'cycloidal'\nspan = 60\nto = 0",
        )
    )
    with pytest.raises(EffectError, match="so far from constant breadth"):
        Drawn(direction=-1, moves=held).made().effect("contact-force")
    tight = circle(-0.05).made().effects.findings("drive-torque")
    assert [each.value for each in tight if each.name == "yoke-breadth"] == [pytest.approx(0.05)]


def test_flights_across_an_uneven_play_end_on_the_disc_half_a_turn_on() -> None:
    design = uneven(96.6).made()
    found = {each.name: each for each in design.effects.findings("lift-off")}
    width = design.cam.breadth
    assert width is not None
    (least, _), (most, _) = width.range
    words = f"its clearance of {96.6 - most:g} to {96.6 - least:g} mm"
    assert words in found["largest-impact-speed"].sentence
    motion, omega = design.drive.motion, 700.0 * RPM
    flights = design.effect("lift-off").flights
    of = uneven(None)
    weight = along(1j, of.mass * pull(of.fall)) - of.load
    for each in flights:

        def lift(phi: float, sense: int) -> FloatArray:
            if sense > 0:
                return np.asarray(motion.jet(np.array([phi]), RIGHT)[:2, 0])
            far = motion.jet(np.array([phi + HALF]), RIGHT)[:2, 0]
            return np.asarray([96.6 - 2.0 * of.base - far[0], -far[1]])

        at, rate = lift(each.leaving, each.left)
        span = each.landing - each.leaving
        free = weight / of.mass / omega**2
        end = np.array([at + rate * span + 0.5 * free * span**2, rate + free * span])
        met = lift(each.landing, each.met)
        assert end[0] == pytest.approx(met[0], abs=1e-9)
        lever = design.cam.disc.pitch_curve.leverage(
            np.array([each.landing + (0.0 if each.met > 0 else HALF)])
        )[0]
        assert each.speed == pytest.approx(abs(omega * lever * (end[1] - met[1])), rel=1e-6)
    assert {each.left for each in flights} == {1, -1}
    crossed = finding(design.effects.findings("contact-force"), "clearance-crossed")
    assert "of its yoke" in crossed.sentence


def test_each_roller_has_a_spin_of_its_own_that_the_other_has_half_a_turn_later() -> None:
    design = Design(load_scene(SCENES.parent / "effects" / "yoke.toml"))
    spin = design.effect("roller-spin")
    phi = np.random.default_rng(3).uniform(0.0, TURN, 50)
    first, second = spin.rolling, spin.opposite.rolling
    for one, other in zip(first.spin(phi + HALF, RIGHT), second.spin(phi, RIGHT), strict=True):
        assert one == pytest.approx(other, rel=1e-12, abs=1e-9)
    normal = design.effect("contact-force").normal(phi, RIGHT)
    assert first.pressing(phi, RIGHT) - second.pressing(phi, RIGHT) == pytest.approx(normal)
    reserve = second.reserve(phi, RIGHT)[normal > 0.0]
    assert np.all(reserve <= 0.0)
    names = [each.name for each in spin.findings]
    assert "opposite-traction-reserve" in names
