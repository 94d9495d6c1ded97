"""The search: differential evolution over the whole box, then local searches of the numbers in it.

A design that breaks a limit is worse than any that breaks none, and the less it violates, the
better (after K. Deb, Comput. Methods Appl. Mech. Engrg. 186, 2000, p. 311). Differential evolution
(R. Storn and K. Price, J. Global Optim. 11, 1997, p. 341) is that of scipy, with whole numbers
where there is a list; a generation is computed as a whole, so that several processes may share it.
From its best design COBYQA (T. M. Ragonneau, Model-Based Derivative-Free Optimization Methods and
Software, 2022) goes on with limits as constraints; then steps along each number and in drawn
directions become smaller until they are nothing.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import combinations_with_replacement, islice
from typing import Final

import numpy as np

from camgeo.numeric.arrays import FloatArray
from camgeo.optimise.trials import SpentError, StoppedError, Trial, Trials
from camgeo.wording import counted

WALL: Final = 1e30
"""Energy of designs that break limits: above that of all others."""

POPULATION: Final = 12
"""Designs of a generation for each variable, and at least."""

CONVERGED: Final = 1e-7
"""Spread of a generation's energies, relative to them, at which it has come together."""

FIRST: Final = 0.02
"""First steps of local searches, as a fraction of a range."""

FINEST: Final = 1e-9
"""Last ones."""

SHRINK, GROW = 0.5, 1.5
"""Factors of the step where no direction helps, and where one does."""

DRAWN: Final = 2
"""Sets of directions at right angles to each other that are drawn for each step."""

HALVINGS: Final = 34
"""Of a way between a design within limits and one beyond them: to 10^-10 of it."""

POLISHED: Final = 0.3
"""Share of the designs that is kept for local searches."""

BATCH: Final = 1000
"""Designs that are handed out at once where all are tried."""

LATTICE: Final = {1: 1, 2: 6, 3: 3}
"""Parts into which the weights of so many objectives are divided; else 2."""


@dataclass(frozen=True, slots=True, eq=False)
class Direction:
    """One way to weigh the objectives against each other.

    Attributes
    ----------
    weights : (k,) of the costs, 1 together; of one objective alone 1 and else 0.
    ideal, span : (k,) least costs and range of the costs on the front so far, for several.
    """

    weights: FloatArray
    ideal: FloatArray
    span: FloatArray

    def cost(self, trial: Trial) -> float:
        """Less is better; NaN where an objective has no answer.

        The largest weighted distance from the ideal, and a little of all of them, so that no other
        design with that distance beats the best.
        """
        costs = np.array(trial.costs)
        if np.isnan(costs).any():
            return float("nan")
        if np.count_nonzero(self.weights) == 1:
            return float(costs[self.weights > 0.0][0])
        apart = (costs - self.ideal) / self.span
        return float(np.max(self.weights * apart) + 1e-3 * np.sum(apart))

    def key(self, trial: Trial) -> tuple[float, float]:
        """By which designs are ordered, the best first; the first of equal ones wins."""
        if not trial.feasible:
            return (trial.violation, 0.0)
        return (0.0, self.cost(trial))

    def energy(self, trial: Trial) -> float:
        """The order as one number."""
        return self.cost(trial) if trial.feasible else WALL * (1.0 + trial.violation)

    def best(self, trials: Iterable[Trial]) -> Trial:
        """The best of some."""
        return min(trials, key=self.key)


def directions(count: int) -> list[FloatArray]:
    """Weights of `count` objectives: each alone, then evenly spaced."""
    parts = LATTICE.get(count, 2)
    found = [np.eye(count)[number] for number in range(count)]
    for chosen in combinations_with_replacement(range(count), parts):
        weights = np.bincount(chosen, minlength=count) / parts
        if np.max(weights) < 1.0:
            found.append(weights)
    return found


def direction(weights: FloatArray, trials: Trials) -> Direction:
    """The direction with these weights, the range of the costs taken from the trials so far."""
    costs = np.array([each.costs for each in trials.made if each.feasible])
    if not len(costs):
        return Direction(weights, np.zeros_like(weights), np.ones_like(weights))
    # The range is that between the best designs of each objective alone.
    ends = costs[np.argmin(costs, axis=0)]
    span = np.max(ends, axis=0) - np.min(ends, axis=0)
    return Direction(weights, np.min(costs, axis=0), np.where(span > 0.0, span, 1.0))


def evolve(trials: Trials, towards: Direction, seed: int, most: int) -> bool:
    """Differential evolution with at most so many new designs; whether it came together."""
    from scipy.optimize import differential_evolution

    space = trials.space
    sides = np.flatnonzero(space.upper > 0.0)
    size = max(POPULATION, POPULATION * len(sides))
    start = _population(trials, towards, sides, seed, size)
    last = len(trials) + most

    def energies(_: object, generation: Iterable[FloatArray]) -> list[float]:
        members = np.array(list(generation))
        places = np.zeros((len(members), len(space.upper)))
        places[:, sides] = members
        return [towards.energy(each) for each in trials.all_at(places)]

    def ended(*_: object, **__: object) -> bool:
        return len(trials) + size > last

    if ended():
        return False
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that it did not converge, which is told
        result = differential_evolution(
            float,  # a generation is computed as a whole
            [(0.0, space.upper[side]) for side in sides],
            integrality=~space.continuous[sides],
            init=start,
            rng=np.random.default_rng(seed),
            maxiter=10 * most // size + 10,
            tol=CONVERGED,
            polish=False,
            updating="deferred",
            workers=energies,
            callback=ended,
        )
    return bool(result.success)


def _population(
    trials: Trials, towards: Direction, sides: np.ndarray, seed: int, size: int
) -> FloatArray:
    """The first generation: a Latin square, in which the best designs so far take places."""
    from scipy.stats import qmc

    space = trials.space
    shares = qmc.LatinHypercube(len(sides), rng=np.random.default_rng(seed)).random(size)
    found: FloatArray = shares * space.upper[sides]
    whole = ~space.continuous[sides]
    # Each number of a list is as likely as the others.
    counts = space.upper[sides][whole] + 1.0
    found[:, whole] = np.minimum(np.floor(shares[:, whole] * counts), counts - 1.0)
    known = sorted((each for each in trials.made if each.place is not None), key=towards.key)
    for row, trial in enumerate(known[: size // 3]):
        assert trial.place is not None
        found[row] = trial.place[sides]
    return found


def polish(trials: Trials, towards: Direction, seed: int) -> None:
    """Local searches from the best design so far, in its continuous variables."""
    free = np.flatnonzero(trials.space.continuous)
    start = towards.best(each for each in trials.made if each.place is not None)
    if not len(free) or not np.isfinite(towards.cost(start)):
        return
    if np.count_nonzero(towards.weights) == 1:  # else the cost has edges
        _follow(trials, towards, start, free)
    start = towards.best(each for each in trials.made if each.place is not None)
    _step(trials, towards, start, free, seed)


def _follow(trials: Trials, towards: Direction, start: Trial, free: np.ndarray) -> None:
    """COBYQA, then bisection to the border of what is allowed if it ended beyond."""
    from scipy.optimize import Bounds, NonlinearConstraint, minimize

    base = start.place
    assert base is not None
    names = tuple(start.margins)
    first = towards.cost(start)
    scale = abs(first) or 1.0

    def at(numbers: FloatArray) -> Trial:
        place = base.copy()
        place[free] = np.clip(numbers, 0.0, 1.0)
        return trials.at(place)

    def cost(numbers: FloatArray) -> float:
        found = towards.cost(at(numbers))
        return found / scale if np.isfinite(found) else 1e6

    def margins(numbers: FloatArray) -> FloatArray:
        found = at(numbers)
        missing = -1.0 if found.violation >= 1.0 else 1.0
        each = [min(found.margins.get(name, missing), 1.0) for name in names]
        return np.array([*each, -min(found.violation, 1e6)])

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        result = minimize(
            cost,
            base[free],
            method="COBYQA",
            bounds=Bounds(np.zeros(len(free)), np.ones(len(free))),
            constraints=NonlinearConstraint(margins, 0.0, np.inf),
            options={
                "initial_tr_radius": FIRST,
                "final_tr_radius": FINEST,
                "maxfev": 60 * (len(free) + 1),
            },
        )
    beyond = at(result.x)
    within = towards.best((start, *trials.made))
    if beyond.feasible or not within.feasible or within.place is None:
        return
    low, high = within.place, np.array(beyond.place)
    if not np.array_equal(low[~trials.space.continuous], high[~trials.space.continuous]):
        return
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        found = trials.at(middle)
        if found.feasible and towards.key(found) <= towards.key(within):
            low, within = middle, found
        else:
            high = middle


def _step(trials: Trials, towards: Direction, best: Trial, free: np.ndarray, seed: int) -> None:
    """Steps along each number, in drawn directions, and on from the last success.

    Where limits meet at an angle only few directions are within both and better.
    """
    drawn = np.random.default_rng(seed)
    step, last = FIRST, np.zeros(len(free))
    while step > FINEST:
        turned = np.eye(len(free))
        if len(free) > 1:
            turned = np.vstack((turned, *(_rotation(drawn, len(free)) for _ in range(DRAWN))))
        ways = np.vstack((last, turned, -turned)) if last.any() else np.vstack((turned, -turned))
        for way in ways:
            assert best.place is not None
            place = best.place.copy()
            place[free] = np.clip(place[free] + step * way, 0.0, 1.0)
            found = trials.at(place)
            if found.place is not None and towards.key(found) < towards.key(best):
                best, last = found, way
                step *= GROW
                break
        else:
            step *= SHRINK
            last = np.zeros(len(free))


def _rotation(drawn: np.random.Generator, count: int) -> FloatArray:
    """(count, count) unit vectors at right angles to each other, drawn evenly."""
    found: FloatArray = np.linalg.qr(drawn.standard_normal((count, count)))[0].T
    return found


def search(trials: Trials, seed: int) -> str:
    """Try designs; why it ended."""
    space, task = trials.space, trials.task
    try:
        start = space.place_of(task.family.scene)
        if start is not None:
            trials.at(start)
        if space.count is not None and space.count <= trials.most:
            places = space.everything()
            while batch := list(islice(places, BATCH)):
                trials.all_at(batch)
            return "all designs were tried"
        ways = directions(len(task.goals))
        whole = True
        for number, weights in enumerate(ways):
            left = (trials.most - len(trials)) // (len(ways) - number)
            towards = direction(weights, trials)
            trials.share = len(trials) + left
            try:
                together = evolve(trials, towards, seed + number, int((1.0 - POLISHED) * left))
                polish(trials, towards, seed + number)
            except SpentError:
                together = False
            whole &= together
    except StoppedError as stop:
        return str(stop)
    return "converged" if whole else f"{counted(trials.most, 'design')} were allowed"
