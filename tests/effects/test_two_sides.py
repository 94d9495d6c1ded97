"""Followers that are held from two sides, by a conjugate pair or a yoke: the force of either side
against Newton's law for free bodies, and energies.

Contact normals and ways of rollers come from differences of places. The second side of a yoke is
looked for on the disc itself, where the first one is half a turn later, and not as a follower of
its own: contacts, normals and slips are found from places and velocities.
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
from camgeo.kinematics.mechanism.rollers import OscillatingRoller
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.scene.scene import load_scene, parse_scene
from camgeo.units import RPM, TURN
from tests.effects.bodies import (
    DIFFERENCE,
    PIVOT,
    ROLLER,
    ROUNDING,
    Bodies,
    along,
    cross,
    friction,
    inside,
    lift,
    omega,
    pull,
    slope,
)
from tests.effects.scenes import SCENES, design
from tests.effects.test_physics import assert_zero, powers
from tests.findings import finding
from tests.long_form import examples

RIGHT: Final[Side] = "right"

MOMENT: Final = 14.0
MASS: Final = 1.6e-3
ROLLING: Final = 0.1e-3
LOAD: Final = {"conjugate_lever": 2.0e3, "conjugate_carriage": 60.0}
"""In N mm, and in N."""

OWN: Final = {
    "conjugate_lever": f"moment_of_inertia = {1e-3 * MOMENT}",
    "conjugate_carriage": f"mass = {1e3 * MASS}",
}

TELLING: Final = """
[effects.contact-force]
[effects.lift-off]
[effects.drive-torque]
"""


def forces(scene: str, load: float) -> str:
    scale = 1e-3 if scene == "conjugate_lever" else 1.0
    inertia = f"[effects.inertia]\n{OWN[scene]}\nroller_mass = {1e3 * ROLLING}\n"
    return f"{inertia}[effects.load]\nconstant = {scale * load!r}\n"


def inertia_of(made: Design) -> float:
    follower: Any = made.cam.follower
    if isinstance(follower, OscillatingRoller):
        return MOMENT + ROLLING * follower.arm**2
    return MASS + ROLLING


def both(made: Design, phi: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The force of main and return disc, as the tables have them."""
    names = [column.name for column in made.effect("contact-force").columns]
    assert names == ["main contact force", "return contact force"]
    main, back = (column.values(phi, RIGHT) for column in made.effect("contact-force").columns)
    return main, back


@pytest.mark.parametrize("scene", OWN)
@pytest.mark.parametrize("load", [-2.5, 0.0, 0.7])
@pytest.mark.parametrize("rev", [40.0, 430.0])
def test_one_disc_pushes_and_both_together_do_the_work(scene: str, load: float, rev: float) -> None:
    """N_1 dn_1/dq + N_2 dn_2/dq = J d^2q/dt^2 + load, neither pulls, one of them is at rest."""
    asked = load * LOAD[scene]
    now = {"conjugate_lever": 240, "conjugate_carriage": 120}[scene]
    change = (f"speed = {now}\n", f"speed = {rev!r}\n")
    made = design(scene, forces(scene, asked) + TELLING, change)
    phi = inside(made)
    phi = phi[np.abs(made.cam.drive.motion.jet(phi)[1]) > 1e-6]
    main, back = both(made, phi)
    assert np.all(main >= 0.0)
    assert np.all(back >= 0.0)
    assert np.all((main == 0.0) | (back == 0.0))
    _, rate, bent = made.cam.drive.motion.jet(phi)[:3]
    # Way of either roller along its outward normal a unit of q, by vectors; it moves.
    first, second = (
        along(body.outward, body.velocity) / rate
        for body in (Bodies(each.cam, phi, np.ones(len(phi))) for each in made.discs)
    )
    assert np.all(first * second < 0.0)
    expected = inertia_of(made) * omega(made) ** 2 * bent + asked
    scale = np.max(np.abs(expected)) + inertia_of(made) * omega(made) ** 2 * np.max(np.abs(bent))
    assert np.max(np.abs(main * first + back * second - expected)) <= 2.0 * DIFFERENCE * scale
    if load == 0.0 or inertia_of(made) * omega(made) ** 2 * np.max(np.abs(bent)) > 2.0 * abs(asked):
        assert np.max(main) > 0.0
        assert np.max(back) > 0.0


def test_with_friction_the_drive_gives_what_is_stored_done_and_lost() -> None:
    table = {**ROLLER, **PIVOT}
    scene = "conjugate_lever"
    effects = forces(scene, LOAD[scene]) + friction(table) + TELLING + "[effects.reactions]"
    made = design(scene, effects)
    phi, speed, bodies = inside(made), omega(made), made.effect("reactions").bodies
    losses, jet = np.zeros(len(phi)), made.cam.drive.motion.jet(phi)
    follower: Any = made.cam.follower
    turn = 1j * follower.swing_sense
    arm = follower.start_arm * np.exp(turn * jet[0])
    other = -ROLLING * arm * (turn * jet[2] - jet[1] ** 2) * speed**2
    for disc, force in zip(made.discs, both(made, phi), strict=True):
        carries = force > 0.0
        assert np.any(carries)
        at, load = Bodies(disc.cam, phi[carries], force[carries]), other[carries]
        losses[carries] += at.losses(table, load)
        held = bodies.of_pivot(at.phi, RIGHT) + at.load(table) + load
        assert np.max(np.abs(held)) <= ROUNDING * 10.0 * np.max(force)
    velocity = slope(lambda x: lift(made, x), phi)
    losses += 1e3 * table["pivot_viscous"] * speed * velocity**2

    def energy(x: FloatArray) -> FloatArray:
        of_lift = slope(lambda y: lift(made, y), x)
        return np.asarray(
            0.5 * inertia_of(made) * (speed * of_lift) ** 2 + LOAD[scene] * lift(made, x)
        )

    torque = made.effect("drive-torque").torque(phi, RIGHT)
    scale = np.max(np.abs(torque)) + np.ptp(energy(phi))
    assert np.max(np.abs(torque - slope(energy, phi) - losses)) <= DIFFERENCE * scale
    assert np.max(losses) > 0.01 * np.max(np.abs(torque))


def test_each_disc_has_the_pressure_of_its_own_roller_and_flank() -> None:
    """p = sqrt(F E / (pi L R)), with the curvature of its flank.

    Johnson, Contact Mechanics, section 4.2, eq. (4.45): line contact of cylinders.
    """
    scene = "conjugate_lever"
    contact = "[effects.contact-pressure]\nwidth = 6\ncam_modulus = 210000\ncam_poisson = 0.3\n"
    contact += "roller_modulus = 100000\nroller_poisson = 0.25\n"
    made = design(scene, forces(scene, LOAD[scene]) + TELLING + contact)
    phi, columns = inside(made), made.effect("contact-pressure").columns
    modulus = 1.0 / ((1.0 - 0.3**2) / 210000.0 + (1.0 - 0.25**2) / 100000.0)
    for disc, force, column in zip(made.discs, both(made, phi), columns[::2], strict=True):
        assert column.name.endswith("contact pressure")
        bend = disc.cam.disc.inner_curve.curvature(phi)
        relative = 1.0 / disc.cam.follower.roller_radius + bend
        expected = np.sqrt(force * modulus * relative / (math.pi * 6.0))
        found = column.values(phi, RIGHT)
        assert np.max(np.abs(found - expected)) <= 1e-11 * np.max(expected)
        assert np.max(found) > 0.0


def test_discs_that_push_in_one_sense_carry_nothing_the_other_way() -> None:
    scene = "conjugate_lever"
    made = design(scene, forces(scene, 100.0) + TELLING, ("arm_angle = 84", "arm_angle = 8"))
    assert "form-closure" in [each.name for each in made.findings if each.severity == "broken"]
    with pytest.raises(EffectError) as caught:
        made.effect("contact-force")
    assert caught.value.finding == "jamming"


def test_a_limit_holds_either_disc() -> None:
    scene = "conjugate_lever"
    free = design(scene, forces(scene, 0.0) + TELLING)
    found = {each.name: each for each in free.effect("contact-force").findings}
    most = found["largest-contact-force"].value
    main, back = (found[f"largest-contact-force-{name}"].value for name in ("main", "return"))
    assert most is not None
    assert main is not None
    assert back is not None
    assert most == max(main, back) > min(main, back) > 0.0
    text = forces(scene, 0.0) + f"[effects.contact-force]\nlimit = {0.99 * most!r}\n"
    (largest, *_) = design(scene, text).effect("contact-force").findings
    assert largest.severity == "broken"


def test_a_weight_across_the_guide_rubs_alike_on_either_disc() -> None:
    """The side force of the return roller counts in the direction in which the weight's does."""
    scene = "conjugate_carriage"
    table = {"guide": 0.15}
    across = "[effects.gravity]\nangle = -30\n[effects.reactions]\n"
    made = design(scene, forces(scene, -2.0) + across + friction(table) + TELLING)
    phi = inside(made)
    main, back = both(made, phi)
    assert np.any(main > 0.0)
    assert np.any(back > 0.0)
    assert_zero(*powers(made, table, phi))


def test_a_trimmed_return_disc_does_not_have_a_motion_of_its_own() -> None:
    """Both sides move as demanded: what one of two discs has lost, the other one still holds."""
    limits, larger = ("[output]", '[limits]\nundercut = "trim"\n\n[output]'), "roller_radius = 46"
    made = design(
        "conjugate_lever",
        "[effects.load]\nconstant = 3\n[effects.contact-force]\n",
        limits,
        ("arm_angle = 84\narm = 70\nroller_radius = 12", f"arm_angle = 84\narm = 70\n{larger}"),
    )
    subject = made.effects.subject
    assert subject.returning is not None
    assert subject.returning.cam.disc.outline("inner").is_trimmed
    assert subject.returning.state.model == subject.state.model == "demanded"
    assert "trimmed-motion" in {each.name for each in made.effects.findings("contact-force")}


# Yokes --------------------------------------------------------------------------------------------


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
class OnYoke:
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
    terms = OnYoke(of, made.drive.motion, phi).balance(normal, ends)
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


def uneven(breadth: float | None) -> Drawn:
    stated = "" if breadth is None else f"breadth = {breadth!r}\n"
    return Drawn(
        moves="".join(
            f"[[motion]]\nlaw = 'modified-sine'\nspan = {span}\nto = {to}\n"
            for span, to in ((176, 16), (184, 0))
        ),
        yoke=stated,
        speed=700.0,
    )


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
    assert np.all(second.reserve(phi, RIGHT)[normal > 0.0] <= 0.0)
    assert "opposite-traction-reserve" in [each.name for each in spin.findings]
