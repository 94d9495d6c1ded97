"""Cases whose places are roots: extremes of curvature and transmission angle, cusps."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np

from camgeo.check.disc import transmission_angle_extremes
from camgeo.geometry.outline.outline import undercut_ranges
from camgeo.geometry.pieces import Extremes, curvature_extremes
from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.numeric.arrays import FloatArray
from tests.stability import cams
from tests.stability.cams import CamSpec
from tests.stability.exact_cam import CamJet
from tests.stability.measure import Case
from tests.stability.series import Number, Roots

GROUP: Final = "extremes"

CURVATURE: Final = ("extreme curvature", "place of extreme curvature")

TRANSMISSION: Final = ("extreme transmission angle", "place of extreme transmission")


CUSP: Final = ("place of a cusp",)

CAMS: Final = (
    "offset guide",
    "rocker",
    "tiny stroke, offset",
    "HC12 huge base circle",
    "HC20b inflections",
    "HC23 runs back",
    "tiny swing",
    "scale 1e-06 mm",
    "Setzhub",
)
"""Cams whose extremes are measured."""

EXCESS: Final = (1e-3, 1e-4, 1e-5, 1e-6)
"""Excess of the roller radius over the smallest radius of curvature, as a fraction of that."""

GUESS: Final = 7
"""Decimals of a cam angle [rad] from which an exact root is sought: the pairs of cusps with an
excess of 1e-6 are 5e-4 apart, and Newton's steps double the digits from there."""

TERMS: Final = 5
"""Z to Z'''', for kappa''."""

ENOUGH: Final = 12
"""A step that vanishes to this many decimals is the last one: its error is about its square, 1e-24,
and half an ulp of the inputs moves a place by 1e-17 or more."""

RIGHT: Final = 1e-6
"""A transmission angle this near to 0 or 90 degrees [rad] is not a smooth extreme: the acute angle
has a kink there, and the place is a root of one component of Z'."""


def cases() -> tuple[Case, ...]:
    """All cases of this module."""
    specs = {spec.name: spec for spec in (*cams.specs(), *cams.linked_specs())}
    found: list[Case] = []
    for name in CAMS:
        curve = specs[name].curve
        found += _extremes(specs[name], CURVATURE, curvature_extremes(curve), _bend)
        found += _extremes(specs[name], TRANSMISSION, _smooth_transmission(curve), _tilt)
    return (*found, *(_cusps(specs["HC20b inflections"], excess) for excess in EXCESS))


def _extremes(
    spec: CamSpec,
    quantities: tuple[str, ...],
    engine: Extremes,
    slopes: Callable[[CamJet], tuple[Number, Number, Number]],
) -> Iterator[Case]:
    """Extremes inside the moves, excluding those at their ends."""

    def found(guesses: FloatArray) -> tuple[FloatArray, ...]:
        nearest = [int(np.argmin(np.abs(engine.phi - guess))) for guess in guesses]
        return engine.values[nearest], engine.phi[nearest]

    roots = Roots(GUESS)

    def exact(guess: Number, *parameters: Number) -> tuple[Number, ...]:
        def bend(phi: Number) -> Sequence[Number]:
            return slopes(spec.stage.jet(phi, parameters, TERMS))[1:]

        place = roots.root(bend, guess, ENOUGH)
        return slopes(spec.stage.jet(place, parameters, TERMS))[0], place

    for back, word in ((False, "rise"), (True, "return")):
        start, end = spec.joints(back=back)
        edge = 1e-5 * (end - start)
        inside = engine.phi[(engine.phi > start + edge) & (engine.phi < end - edge)]
        breaks = spec.curve.breaks
        places = [phi for phi in inside if np.min(np.abs(breaks - phi)) > edge]
        if places:
            yield Case(
                GROUP, f"{spec.name}, {word}", quantities,
                tuple(round(float(phi), GUESS) for phi in places),
                spec.parameters(back=back), found, exact,
            )  # fmt: skip


def _smooth_transmission(curve: PitchCurve) -> Extremes:
    engine = transmission_angle_extremes(curve)
    smooth = (engine.values > RIGHT) & (engine.values < 0.5 * math.pi - RIGHT)
    return Extremes(engine.phi[smooth], engine.values[smooth])


def _cusps(spec: CamSpec, excess: float) -> Case:
    """Both ends of the undercut in the rise, with a roller too large by `excess`."""
    smallest = 1.0 / curvature_extremes(spec.curve).largest()[0]
    roller: dict[str, Any] = {"roller_radius": smallest * (1.0 + excess)}
    large = replace(spec, follower=replace(spec.follower, **roller))
    ends = _undercut_ends(large.curve)

    def found(guesses: FloatArray) -> tuple[FloatArray, ...]:
        return (np.array([min(ends, key=lambda end: abs(end - guess)) for guess in guesses]),)

    roots = Roots(GUESS)

    def exact(guess: Number, *parameters: Number) -> tuple[Number, ...]:
        def margin(phi: Number) -> tuple[Number, Number]:
            jet = large.stage.jet(phi, parameters, TERMS)
            bend = jet.bend
            return 1 - jet.roller * bend.terms[0], -jet.roller * bend.terms[1]

        return (roots.root(margin, guess, ENOUGH),)

    return Case(
        GROUP, f"roller {excess:.0e} too large", CUSP,
        tuple(round(end, GUESS) for end in ends), large.parameters(back=False), found, exact,
    )  # fmt: skip


def _undercut_ends(curve: PitchCurve) -> tuple[float, ...]:
    flank = WorkingCurve(curve, -curve.follower.roller_radius)
    return tuple(end for pair in undercut_ranges(flank, curvature_extremes(curve)) for end in pair)


def _bend(jet: CamJet) -> tuple[Number, Number, Number]:
    """kappa, kappa', kappa''."""
    bend = jet.bend
    return bend.terms[0], bend.terms[1], bend.derivative(2)


def _tilt(jet: CamJet) -> tuple[Number, Number, Number]:
    """The transmission angle, and two derivatives of the angle whose acute angle it is."""
    tilt = jet.tilt
    return jet.transmission_angle, tilt.terms[1], tilt.derivative(2)
