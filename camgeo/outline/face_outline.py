"""The disc that remains when a flat face cuts it: the intersection of the half planes below it.

With h(psi) the distance of the face from the cam axis and psi the angle by which its normal has
turned in the cam, the disc is the largest convex one whose support function H does not exceed h.
Where p = tau h + (h'/tau)' < 0 the envelope of the face runs back, and H < h: there H is the sine

    S(psi) = Re(conj(n(psi)) P)

of a corner P, in which the envelope crosses itself: Z(x) = Z(y) = P. So H is for sines what the
lower convex hull of a graph is for straight lines, and is found in the same way. The stretches with
p > 0 are convex arcs. Between two of them there is one common sine at most, tangent to h at x on
the first and at y on the second: as x grows, S rises everywhere ahead within half a turn. An arc
that its sines to the left and to the right touch in the wrong order lies above the sine that passes
it by, and is left out (Graham's scan, round the turn).

With the arcs in order, stretches and corners form a closed curve whose tangent turns one way by one
turn, which is convex. It is the boundary: no larger H has these tangent sines. As long as h > 0,
something is left about the cam axis, and p is positive somewhere: over the turn its mean is that of
h.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np

from camgeo.curve.circles import centres_at
from camgeo.curve.extremes import curvature_extremes
from camgeo.curve.pieces import halves, turn_cells
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.curve.working_curve import WorkingCurve
from camgeo.errors import GeometryError, UndercutError
from camgeo.mechanism.face import flat_follower
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.numeric.quadrature import gauss
from camgeo.outline.convex import SMALLEST, Convexity, touch
from camgeo.outline.cusps import CUSP, PASSES, deep_ranges, with_places
from camgeo.outline.path import Element, Path, Pivot, Stretch
from camgeo.units import TURN

HALVINGS: Final = 14
"""Rounds of halving, to cells of less than 1e-5 rad, in which a motion has no features."""

STEPS: Final = 60
"""Most Newton steps; from the guess six suffice."""

SETTLED: Final = 1e-7
"""After a Newton step of this fraction of the tail's width the next one is mere rounding."""

SHORT: Final = 0.05
"""Width [rad] of a tail up to which its ends are compared by quadrature: their points differ by
less than is left of their digits."""

NODES: Final = 12
"""Nodes of the quadrature over each smooth part; of a part this short it has all digits."""

SAMPLES: Final = 257
"""Places of an arc among which a common sine is sought where Newton's method does not find it."""

ROUNDS: Final = 4
"""Rounds of this search, each on the part between two of the places before."""

BISECTIONS: Final = 40
"""Halvings of the other arc."""

END: Final = 1e-9
"""Fraction of an arc next to its ends that counts as the end."""

LOST: Final = 16.0
"""Units in the last place of how far a face is moved out, by which p / tau is off at the ends of
the ranges that are found on it, at most; seen are 2.
"""


@dataclass(frozen=True, slots=True)
class _Bridge:
    """The sine that two arcs have in common.

    Attributes
    ----------
    x, y : cam angles [rad] where it touches the first and the second one.
    exact : False where it touches the end of an arc, beyond which it would go on.
    """

    x: float
    y: float
    exact: bool


Arc = tuple[float, float]
"""Cam angles [rad] between which p > 0, the end above the start."""


def trimmed_path(flank: WorkingCurve, found: Convexity) -> Path:
    """The boundary of what is left of a flat face's disc, `found` being its `convexity`.

    Raises
    ------
    UndercutError
        If there is no such disc: the face turns back in the cam, its contact jumps, or it comes
        over the cam axis.
    GeometryError
        If it cannot be decided what is left.
    """
    if found.turn[0] <= 0.0 or found.jumps or found.clearance[0] <= SMALLEST * found.size:
        raise UndercutError("a flat face touches only a convex cam, and this one is not")
    ranges = backward_angles(flank.pitch, found.turn[0])
    if not ranges:
        return Path((Stretch(flank, 0.0, TURN),))
    arcs = [
        (end - TURN, start) if end > start else (end, start)
        for (_, end), (start, _) in zip([ranges[-1], *ranges[:-1]], ranges, strict=True)
    ]
    arcs = sorted((start % TURN, start % TURN + (end - start)) for start, end in arcs)
    return _path(flank, _scanned(_Face(flank.pitch), arcs))


def backward_angles(pitch: PitchCurve, turn: float) -> list[tuple[float, float]]:
    """Ranges of cam angle (start, end) [rad] with p < 0, ends in [0, 2 pi); the whole turn is
    (0, 2 pi).

    `turn` is the smallest tau, above 0. Moved out by more than a bound of |p| over it, the face has
    a regular outline, whose parallel inwards is this one: p < 0 where that undercuts. None is
    missed, because cells are halved until p keeps its sign over each, or is that of the known
    ranges.

    Raises
    ------
    GeometryError
        If the face is so fast somewhere that too few digits are left elsewhere to find all.
    """
    follower: Any = pitch.follower  # a frozen dataclass
    names = [key.removeprefix("follower.") for key in flat_follower(follower).raised_by]
    out = _fastest(pitch) / turn + follower.base_radius
    moved = replace(follower, **{name: getattr(follower, name) + out for name in names})
    parallel = WorkingCurve(replace(pitch, follower=moved), -out)
    bends = curvature_extremes(parallel.pitch)
    for _ in range(PASSES):
        ranges = deep_ranges(parallel, bends)
        missed = _missed(pitch, ranges, out)
        if not len(missed):
            return sorted(ranges)
        bends = with_places(parallel.pitch, bends, missed)
    raise _undecided(pitch)


def _undecided(pitch: PitchCurve) -> GeometryError:
    """The error for a face of which nothing is decided, with the place where it is fastest."""
    low, high = turn_cells(pitch)
    middles = 0.5 * (low + high)
    place = float(middles[np.argmax(pitch.speed_bounds(middles, middles)[0])])
    return GeometryError(
        "it cannot be decided what a flat face leaves of the disc: its contact runs too fast for"
        f" the digits of a number near cam angle {math.degrees(place % TURN):.6f} deg; give the"
        " move there a larger span or a smaller way",
        "motion",
    )


def _fastest(pitch: PitchCurve) -> float:
    """A bound of |p| [mm] over the turn, at most twice its largest value, so that few digits of the
    lift are lost where the face is moved out by it.
    """
    low, high = turn_cells(pitch)
    known = fastest = 0.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        known = max(known, float(np.max(pitch.speed_bounds(middle, middle)[0])))
        bounds = pitch.speed_bounds(low, high)[0]
        wide = ~(bounds <= 2.0 * known)
        fastest = max(fastest, float(np.max(bounds[~wide], initial=0.0)))
        if not np.any(wide):
            return fastest
        low, high = halves(low, high, wide)
    raise _undecided(pitch)


def _missed(pitch: PitchCurve, ranges: list[tuple[float, float]], out: float) -> FloatArray:
    """Cam angles [rad] at which the sign of p contradicts the `ranges` of p < 0 by more than their
    ends are off for rounding, that of the face moved `out` [mm] among it.
    """
    start, end = np.array(ranges).reshape(-1, 2).T
    low, high = turn_cells(pitch)
    missed = []
    for _ in range(HALVINGS):
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        at = touch(pitch, middle)
        inside = np.any((middle[:, None] - start) % TURN < (end - start) % TURN, axis=1)
        noise = CUSP * np.max(np.abs(at.distance)) + LOST * math.ulp(out) * at.turn[0]
        wrong = ((at.pace[0] < 0.0) != inside) & (np.abs(at.pace[0]) > noise)
        missed.append(middle[wrong])
        unsure = ~wrong & np.isnan(centres_at(pitch, middle))
        unsure &= np.abs(at.pace[0]) <= half * pitch.speed_bounds(low, high)[1]
        if not np.any(unsure):
            break
        low, high = halves(low, high, unsure)
    return np.concatenate(missed)


class _Face:
    """The demanded contact of a face, at single cam angles."""

    def __init__(self, pitch: PitchCurve) -> None:
        self.pitch = pitch
        self.breaks = np.concatenate([pitch.borders + k * TURN for k in (-1, 0, 1, 2)])

    def at(self, phi: FloatArray) -> tuple[ComplexArray, ComplexArray, FloatArray]:
        """(n,) contacts Z [mm], tangents t and p [mm/rad] at `phi` (n,) [rad]; t = -i sigma n turns
        steadily where Z turns back.
        """
        pitch, sigma = self.pitch, self.pitch.rotation
        normals = flat_follower(pitch.follower).normal(pitch.motion.jet(phi, "right", 1)[0])
        tangents = -1j * sigma * normals * np.exp(-1j * sigma * phi)
        return pitch.point(phi), tangents, touch(pitch, phi).pace[0]

    def turning(self, phi: FloatArray) -> FloatArray:
        """(n,) psi [rad] but for a constant, at `phi` (n,) [rad] of any turn."""
        lift = self.pitch.motion.jet(phi, "right", 1)[0]
        return np.asarray(phi - self.pitch.rotation * self.pitch.follower.swing_sense * lift)

    def way(self, x: float, y: float, ends: ComplexArray) -> complex:
        """Z(y) - Z(x) [mm], `ends` being both."""
        if y - x > SHORT:
            return complex(ends[1] - ends[0])
        inner = self.breaks[(self.breaks > x) & (self.breaks < y)]
        marks = np.concatenate(([x], inner, [y]))
        places, half, weights = gauss(marks[:-1], marks[1:], NODES)
        _, tangents, pace = self.at(places.ravel())
        parts = (half[:, None] * weights).ravel() * pace * tangents
        return complex(np.sum(parts))


def _scanned(face: _Face, arcs: list[Arc]) -> list[tuple[Arc, _Bridge]]:
    """The arcs that count, each with its bridge to the next one."""
    bridges: list[_Bridge | None] = [None] * len(arcs)
    while arcs:
        for k, (arc, bridge) in enumerate(zip(arcs, bridges, strict=True)):
            if bridge is None:
                after = arcs[(k + 1) % len(arcs)]
                shift = TURN if k + 1 == len(arcs) else 0.0
                bridges[k] = _bridge(face, arc, (after[0] + shift, after[1] + shift))
        known = [bridge for bridge in bridges if bridge is not None]
        lefts = [known[-1].y - TURN, *(bridge.y for bridge in known[:-1])]
        hidden = [k for k, bridge in enumerate(known) if lefts[k] >= bridge.x]
        if not hidden:
            if not all(bridge.exact for bridge in known):
                break
            return list(zip(arcs, known, strict=True))
        place = hidden[0]
        del arcs[place], bridges[place]
        if bridges:
            bridges[place - 1] = None
    raise _undecided(face.pitch)


def _bridge(face: _Face, first: Arc, second: Arc) -> _Bridge:
    """The bridge between two arcs, the second one ahead."""
    middle, half = 0.5 * (first[1] + second[0]), 0.5 * (second[0] - first[1])
    # Of a p that is a parabola between the cusps the crossing lies root 3 times as far out.
    x = max(middle - math.sqrt(3.0) * half, 0.5 * (first[0] + first[1]))
    y = min(middle + math.sqrt(3.0) * half, 0.5 * (second[0] + second[1]))
    found = _newton(face, first, second, x, y)
    if found is not None:
        return found
    guess = _sought(face, first, second)
    if guess.exact:
        found = _newton(face, first, second, guess.x, guess.y)
    return found or guess


def _newton(face: _Face, first: Arc, second: Arc, x: float, y: float) -> _Bridge | None:
    """The bridge by Newton's method from a guess; None if it does not converge inside the arcs."""
    settled = False
    for _ in range(STEPS):
        points, (t_x, t_y), (p_x, p_y) = face.at(np.array([x, y]))
        sine = float((np.conj(t_x) * t_y).imag)
        if not (p_x > 0.0 and p_y > 0.0 and sine != 0.0):
            return None
        way = face.way(x, y, points)
        dx = float((np.conj(way) * t_y).imag) / (p_x * sine)
        dy = float((np.conj(way) * t_x).imag) / (p_y * sine)
        share = min(1.0, _room(x, dx, first), _room(y, dy, second))
        x, y = x + share * dx, y + share * dy
        if settled:
            turned = face.turning(np.array([x, y]))
            # Half a turn on, and the same place once more: neither is a sine in common.
            return _Bridge(x, y, exact=True) if turned[1] - turned[0] < math.pi else None
        settled = abs(dx) + abs(dy) <= SETTLED * (y - x) + 8.0 * math.ulp(TURN)
    return None


def _room(place: float, step: float, arc: Arc) -> float:
    """Fraction of `step` that stays inside the `arc`."""
    room = 0.9 * ((arc[1] - place) if step > 0.0 else (place - arc[0]))
    return room / abs(step) if abs(step) > room else 1.0


def _sought(face: _Face, first: Arc, second: Arc) -> _Bridge:
    """The bridge by bisection, or the ends of arcs where it would lie beyond them."""
    places = np.linspace(*second, SAMPLES)
    points, tangents, _ = face.at(places)
    normals = 1j * face.pitch.rotation * tangents
    ahead = face.turning(places)

    def lowest(x: float) -> tuple[float, float]:
        """Smallest h - S [mm] over the second arc for the sine that touches the first one at `x`,
        and where; half a turn ahead at most.
        """
        start = face.at(np.array([x]))[0]
        seen = ahead < float(face.turning(np.array([x]))[0]) + math.pi
        above = np.where(seen, (np.conj(normals) * (points - start)).real, np.inf)
        k = int(np.argmin(above))
        low, high = float(places[max(k - 1, 0)]), float(places[min(k + 1, SAMPLES - 1)])
        for _ in range(ROUNDS):
            near = np.linspace(low, high, SAMPLES)
            there, along, _ = face.at(near)
            falls = (np.conj(along) * (there - start)).real < 0.0  # h - S does
            k = int(np.count_nonzero(falls))
            low, high = float(near[max(k - 1, 0)]), float(near[min(k, SAMPLES - 1)])
        k = min(k, SAMPLES - 1)
        normal = 1j * face.pitch.rotation * along[k]
        return float((np.conj(normal) * (there[k] - start)).real[0]), float(near[k])

    starts = np.linspace(*first, SAMPLES)
    low = float(starts[np.argmax(face.turning(starts) > ahead[0] - math.pi)])
    high = first[1]
    for end, wrong in ((low, -1.0), (high, 1.0)):
        value, y = lowest(end)
        if wrong * value > 0.0:
            return _Bridge(end, y, exact=False)
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if lowest(middle)[0] > 0.0 else (low, middle)
    y = lowest(low)[1]
    room = END * (second[1] - second[0])
    return _Bridge(low, y, exact=second[0] + room < y < second[1] - room)


def _path(flank: WorkingCurve, parts: list[tuple[Arc, _Bridge]]) -> Path:
    """Stretches from bridge to bridge, and the corners between them."""
    rotation = flank.pitch.rotation
    face = _Face(flank.pitch)
    elements: list[tuple[float, list[Element]]] = []
    for k, (_, bridge) in enumerate(parts):
        before = parts[k - 1][1].y - (TURN if k == 0 else 0.0)
        ends = np.array([bridge.x, bridge.y])
        points, tangents, _ = face.at(ends)
        normals = 1j * rotation * tangents
        sweep = float(np.angle(normals[1] * np.conj(normals[0])))
        corner = Pivot(
            complex(np.mean(points)), 0.0, complex(normals[0]), sweep, *(ends % TURN).tolist()
        )
        start = before % TURN
        stretch = Stretch(flank, start, start + (bridge.x - before))
        elements.append((start, [stretch, corner]))
    ordered = sorted(elements, key=lambda each: each[0])
    return Path(tuple(element for _, pair in ordered for element in pair))
