"""Random machines against the linear analysis and against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.scene.scene import load_scene
from camgeo.studies.tolerancing.linear import ANGLES, Sampled, machine_deviations, replay_machines
from camgeo.studies.tolerancing.stated import SHAPES, Deviations, Distribution, Shape, Source
from tests.tolerancing.machines import FIXTURES, LEVER, lifter, linear_of


def drawn(sources: tuple[Source, ...], count: int) -> list[FloatArray]:
    shares = np.random.default_rng(1).random((20, count))
    return [each.numbers(shares[: each.draws]) for each in sources]


@pytest.mark.parametrize("name", ["setzhub", "tappet", "flat_rocker"])
def test_what_is_not_linear_falls_with_the_square(name: str) -> None:
    """The same machines with a tenth of the deviations: a hundredth of the rest."""
    scene = load_scene(FIXTURES / "scenes" / f"{name}.toml")
    keys = ("mounting.x", "mounting.angle", "shaft.y", "follower.base_radius")
    table = {
        "dimension": [{"key": key, "plus_minus": 0.2} for key in keys],
        "form": [{"plus_minus": 0.01, "waves": 3}],
    }
    linear = linear_of(scene.with_values({"tolerance": table}))
    sources = linear.stated.sources
    numbers = drawn(sources, 8)

    def left(scale: float) -> float:
        some = [scale * each for each in numbers]
        found = replay_machines(linear.nominal, machine_deviations(sources, some)).position[0]
        expected = sum(
            rows.T @ sensitivities
            for rows, sensitivities in zip(some, linear.sensitivities, strict=True)
        )
        return float(np.max(np.abs(found - linear.nominal.positions[0] - expected)))

    assert left(0.1) <= 0.013 * left(1.0)


def test_small_tolerances_have_the_linear_mean_and_spread() -> None:
    """At all cam angles within two standard errors of as many independent machines."""
    linear, count = linear_of(load_scene(LEVER)), 256
    found = Sampled.draw(linear, count, seed=3)
    apart = np.mean(found.errors, axis=0) - linear.mean
    assert np.max(np.abs(apart) / linear.sigma) <= 2.0 / math.sqrt(count)
    ratio = np.std(found.errors, axis=0) / linear.sigma
    assert np.max(np.abs(ratio - 1.0)) <= 2.0 / math.sqrt(2.0 * count)


@pytest.mark.parametrize("shape", SHAPES)
def test_the_yield_of_one_dimension(shape: Shape) -> None:
    """The face is off by minus the deviation of its radius: the share within a limit is known."""
    limit, plus_minus = 0.02, 0.03
    dimension = {"key": "follower.base_radius", "plus_minus": plus_minus, "distribution": shape}
    found = Sampled.draw(lifter(dimension, limit=limit), 1024)
    share = limit / plus_minus
    known = {
        "normal": math.erf(3.0 * share / math.sqrt(2.0)),
        "uniform": share,
        "triangular": 1.0 - (1.0 - share) ** 2,
    }
    assert found.share_in_limit == pytest.approx(known[shape], abs=2.0 / 1024)
    assert found.share_error == pytest.approx(
        math.sqrt(known[shape] * (1.0 - known[shape]) / 1024), rel=0.15
    )
    assert np.max(found.accelerations) <= 1e-9
    quantiles = {"normal": 2.3263479 / 3.0, "uniform": 0.98, "triangular": 1.0 - math.sqrt(0.02)}
    assert abs(found.worst.value) == pytest.approx(quantiles[shape] * plus_minus, rel=0.02)


@pytest.mark.parametrize("shape", SHAPES)
def test_moments_of_distributions(shape: Shape) -> None:
    """By the quantiles themselves, at the middles of 2^16 equal shares."""
    distribution = Distribution(-0.01, 0.03, shape)
    shares = (np.arange(2**16) + 0.5) / 2**16
    values = distribution.quantile(shares)
    assert np.all(np.diff(values) > 0.0)
    assert np.mean(values) == pytest.approx(distribution.mean, abs=1e-12)
    assert np.std(values) == pytest.approx(distribution.sigma, rel=3e-4)
    if shape != "normal":
        ends = distribution.quantile(np.array([0.0, 1.0]))
        assert ends == pytest.approx([distribution.low, distribution.high])


def test_clearances_and_waves_have_the_moments_that_are_stated() -> None:
    """Of random numbers, and uncorrelated, within five standard errors."""
    count = 40_000
    table = {
        "clearance": [
            {"at": "cam", "hole": "H7", "shaft": "f7"},
            {"at": "cam", "hole": "H8", "shaft": "f7", "shifted": "by-load"},
            {"at": "roller", "size": 8, "hole": "F7", "shaft": "h6", "distribution": "uniform"},
        ],
        "form": [{"plus_minus": 0.01, "waves": 7}],
    }
    linear = linear_of(load_scene(LEVER).with_values({"tolerance": table}))
    for source, rows in zip(
        linear.stated.sources, drawn(linear.stated.sources, count), strict=True
    ):
        assert rows.shape == (len(source.units), count)
        moments = source.moments
        sigma = math.sqrt(moments.variance)
        for row in rows:
            assert np.mean(row) == pytest.approx(moments.mean, abs=5.0 * sigma / math.sqrt(count))
            assert np.std(row) == pytest.approx(sigma, rel=5.0 / math.sqrt(count))
        if len(rows) == 2:
            assert moments.mean == 0.0
            together = float(np.mean(rows[0] * rows[1])) / float(np.std(rows[0]) * np.std(rows[1]))
            assert abs(together) <= 5.0 / math.sqrt(count)


def test_load_lowers_the_follower_by_half_of_a_clearance() -> None:
    """H7/f7 of 20 mm leaves 41 micrometres on average, which a flat face loses all round."""
    fit = {"at": "cam", "size": 20, "hole": "H7", "shaft": "f7", "shifted": "by-load"}
    linear = lifter({"key": "mounting.x", "plus_minus": 0.001}, clearance=[fit])
    np.testing.assert_allclose(linear.mean, -0.5 * 0.041, rtol=1e-12)


def test_many_machines_are_computed_as_few() -> None:
    """Blocks do not show."""
    linear = lifter({"key": "mounting.x", "plus_minus": 0.05})
    sizes: ComplexArray = np.linspace(-0.05, 0.05, 100).astype(complex)
    (freedom,) = (unit.freedom for unit in linear.stated.sources[0].units)
    every = replay_machines(linear.nominal, Deviations(100, {freedom: sizes})).position
    one = replay_machines(linear.nominal, Deviations(1, {freedom: sizes[77:78]})).position
    assert every.shape == (3, 100, ANGLES)
    np.testing.assert_allclose(every[:, 77], one[:, 0], rtol=0, atol=1e-13)
