"""Answer of `camgeo tolerance`: the error of the position, and the share of each dimension."""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np

from camgeo.app.answers.answer import (
    BROKEN,
    FINE,
    SCENE,
    Answer,
    Key,
    aligned,
    display_unit,
    scaled,
    small_extreme,
)
from camgeo.app.cli.command import (
    CSV,
    IMAGES,
    JSON,
    SCENE_FILE,
    Argument,
    opened,
    output_options,
    show,
)
from camgeo.design.design import Design
from camgeo.design.value_table import Table
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.extremes import Extreme
from camgeo.pictures.model import Figure
from camgeo.scene.scene import Scene
from camgeo.studies.tolerancing.linear import (
    COUNT,
    QUANTILES,
    Contribution,
    Linear,
    Play,
    Sampled,
    contact_forces,
)
from camgeo.studies.tolerancing.stated import SIGMAS, StatedTolerances
from camgeo.units import at_cam_angles, cam_angle, counted, small


@dataclass(frozen=True, slots=True)
class Share:
    """The contribution of one source; errors in the unit of the position.

    Attributes
    ----------
    name, sense : of the source, and what a positive deviation of it is.
    limits, unit, distribution : of the deviation of the source.
    sensitivity : of the largest magnitude, error per deviation; see `Contribution`.
    sensitivity_unit : as "deg/mm".
    spread, mean, remainder : see `Contribution`.
    share, share_at_worst : of the variance, over the turn and where it is largest.
    """

    name: str
    sense: str
    limits: tuple[float, float]
    unit: str
    distribution: str
    sensitivity: Extreme
    sensitivity_unit: str
    spread: Extreme
    mean: Extreme
    remainder: Extreme
    share: float
    share_at_worst: float


@dataclass(frozen=True, slots=True)
class Room:
    """Play of the follower between the two sides that hold it; negative where they squeeze it.

    Attributes
    ----------
    unit : of the motion of the follower itself, which a linkage may transmit.
    least, most : over the turn, of mean minus and plus three standard deviations.
    sources : contributions to the play, like those to the position.
    """

    unit: str
    least: Extreme
    most: Extreme
    sources: tuple[Share, ...]


@dataclass(frozen=True, slots=True)
class Spread:
    """A quantity of the nominal machine, and its 1 %, 50 % and 99 % quantiles over the machines."""

    nominal: float
    machines: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Machines:
    """Statistics of random machines; errors in the unit of the position.

    Attributes
    ----------
    count, seed : number of machines, and seed of the random numbers.
    quantile : the value of largest magnitude among the `QUANTILES` of the error.
    three_sigma : three times the largest standard deviation over the cam angle.
    largest : of the errors of all machines at all cam angles, the quantile of 99 % of machines.
    kept, conforming_error : share of machines that keep the limit all round, and its standard
        error; None if there is no limit.
    acceleration : largest magnitude [unit/rad^2].
    largest_force, smallest_force : of the contact [N]; None if they are not known.
    least_play, most_play : over the turn, of the follower; None on a single flank.
    squeezed : share of machines that squeeze it somewhere; None on a single flank.
    """

    count: int
    seed: int
    quantile: Extreme
    three_sigma: Extreme
    largest: float
    kept: float | None
    conforming_error: float | None
    acceleration: Spread
    largest_force: Spread | None
    smallest_force: Spread | None
    least_play: Spread | None
    most_play: Spread | None
    squeezed: float | None


@dataclass(frozen=True, eq=False)
class ToleranceAnalysis(Answer):
    """Effect of the tolerances of a scene on the position.

    Attributes
    ----------
    scene : states the tolerances.
    linear : the analysis by sensitivities.
    contributions : of the sources to the error.
    sampled : random machines; None if there are none.
    linear_play : the analysis of the play between two sides; None on a single flank.
    """

    scene: Scene
    linear: Linear
    contributions: tuple[Contribution, ...]
    sampled: Sampled | None
    linear_play: Play | None = None

    @property
    def member(self) -> str:
        """Whose position it is: the follower's, or that of the far end of the linkage."""
        return str(self.linear.stated.machine.cam.drive.demanded_member)

    @property
    def unit(self) -> str:
        """Unit of the position: that of the scene, or "deg"."""
        return display_unit(self.scene.unit, is_angle=self._turns)[0]

    @property
    def _turns(self) -> bool:
        return self.linear.stated.machine.cam.drive.unit == "rad"

    @property
    def factor(self) -> float:
        """Factor from mm or rad to `unit`."""
        return display_unit(self.scene.unit, is_angle=self._turns)[1]

    @property
    def limit(self) -> float | None:
        """Limit of the error, plus or minus, in `unit`; None if none is stated."""
        limit = self.linear.stated.limit
        return None if limit is None else limit * self.factor

    @property
    def worst(self) -> Extreme:
        """The error of largest magnitude, from mean and three standard deviations."""
        return scaled(self.linear.worst, self.factor)

    @property
    def sources(self) -> tuple[Share, ...]:
        """Contributions of the sources, in the order of the scene."""
        return tuple(self._share(source, self.factor, self.unit) for source in self.contributions)

    @property
    def play(self) -> Room | None:
        """Play between the two sides that hold the follower; None on a single flank."""
        if self.linear_play is None:
            return None
        unit, factor = self.play_unit
        least, most = (
            scaled(extreme, factor) for extreme in (self.linear_play.least, self.linear_play.most)
        )
        shares = (self._share(source, factor, unit) for source in self.linear_play.contributions)
        return Room(unit, least, most, tuple(shares))

    @property
    def play_unit(self) -> tuple[str, float]:
        """Unit of the follower's own motion, and the factor from mm or rad to it."""
        turns = self.linear.stated.machine.cam.lift_unit == "rad"
        return display_unit(self.scene.unit, is_angle=turns)

    def _share(self, contribution: Contribution, factor: float, quantity_unit: str) -> Share:
        """The contribution of a source to a quantity with the unit `quantity_unit`, which 1 mm or
        rad is `factor` of.
        """
        source = contribution.source
        unit, scale = display_unit(self.scene.unit, is_angle=source.is_angle)
        (low, high), per = source.limits, contribution.sensitivity
        return Share(
            name=source.name,
            sense=source.sense,
            limits=(low * scale, high * scale),
            unit=unit,
            distribution=source.shape,
            sensitivity=replace(per, value=per.value * factor / scale),
            sensitivity_unit=f"{quantity_unit}/{unit}",
            spread=scaled(contribution.spread, factor),
            mean=scaled(contribution.mean, factor),
            remainder=scaled(contribution.remainder, factor),
            share=contribution.share,
            share_at_worst=contribution.share_at_worst,
        )

    @property
    def machines(self) -> Machines | None:
        """Statistics of the random machines; None if there are none."""
        sample, factor = self.sampled, self.factor
        if sample is None:
            return None
        forces = _ends(None if sample.contact is None else sample.contact.nominal, sample.forces)
        at_rest = None if self.linear_play is None else self.linear_play.nominal_values
        plays = _ends(at_rest, sample.plays, self.play_unit[1])
        return Machines(
            count=sample.count,
            seed=sample.seed,
            quantile=scaled(sample.worst, factor),
            three_sigma=scaled(scaled(sample.sigma, factor), SIGMAS),
            largest=float(np.quantile(sample.largest, QUANTILES[-1])) * factor,
            kept=sample.share_in_limit,
            conforming_error=sample.share_error,
            acceleration=_spread(sample.acceleration * factor, sample.accelerations * factor),
            largest_force=forces[1],
            smallest_force=forces[0],
            least_play=plays[0],
            most_play=plays[1],
            # Column 0 is the least play of each machine over the turn.
            squeezed=None if sample.plays is None else float(np.mean(sample.plays[:, 0] < 0.0)),
        )

    @property
    def keeps_limit(self) -> bool | None:
        """Whether mean and three standard deviations keep the limit; None if there is none."""
        return None if self.limit is None else abs(self.worst.value) <= self.limit

    @property
    def exit_code(self) -> int:
        """1 if mean and three standard deviations break the limit, else 0."""
        return BROKEN if self.keeps_limit is False else FINE


def _spread(nominal: float, values: FloatArray) -> Spread:
    return Spread(nominal, tuple(map(float, np.quantile(values, QUANTILES))))


def _ends(
    nominal: FloatArray | None, values: FloatArray | None, factor: float = 1.0
) -> tuple[Spread | None, Spread | None]:
    """The smallest and the largest of a quantity over the turn, times a factor: (n,) of the nominal
    machine, and (k, 2) of the others; None each if one of these is not known.
    """
    if nominal is None or values is None:
        return None, None
    least, most = float(np.min(nominal)) * factor, float(np.max(nominal)) * factor
    return _spread(least, values[:, 0] * factor), _spread(most, values[:, 1] * factor)


def tolerance(design: Design, *, count: int = COUNT, seed: int = 0) -> ToleranceAnalysis:
    """Effect of the tolerances that the scene of a design states on the position.

    Parameters
    ----------
    count : number of random machines; 0 for the linear analysis alone.
    seed : of the random numbers; the same seed gives the same machines.

    Raises
    ------
    SceneError
        If it states none, or tolerances of what the machine does not have.
    GeometryError
        If its kind of machine, or its flank, cannot be analysed; if there are too few or too many
        machines, or one has no contact near the nominal one.
    """
    linear = Linear(StatedTolerances.from_design(design))
    contributions = linear.contributions
    sample = None
    play = None if linear.stated.second is None else Play(linear.stated)
    if count:
        contact = None
        if play is None:
            contact = contact_forces(design, linear.stated.machine.flank, linear.angles)
        sample = Sampled.draw(linear, count, seed, contact, play)
    return ToleranceAnalysis(design.scene, linear, contributions, sample, play)


# -- document -------------------------------------------------------------------------------------
# The keys of its JSON document.


EXTREME: Final = Key(
    "A value of the largest magnitude and its place.",
    {
        "value": "The value, in the unit of the position, or as the key says.",
        "cam_angle_deg": Key("Cam angle of the value.", of="place"),
    },
)

SOURCE: Final = Key(
    "A dimension, a clearance or an error of form.",
    {
        "name": "Key of the dimension, or what the scene states.",
        "sense": "What a positive deviation is.",
        "limits": "Lower and upper limit of the deviation, in `unit`.",
        "unit": Key("Unit of the deviation.", type=Literal["mm", "inch", "deg"]),
        "distribution": Key(
            "Distribution between the limits.",
            type=Literal["normal", "uniform", "triangular", "random phase"],
        ),
        "sensitivity": Key(
            "Error of the position per deviation, exact; of a source without direction its"
            " amplitude.",
            EXTREME,
        ),
        "sensitivity_unit": 'As "deg/mm".',
        "mean": Key("Error that all machines share, the largest over the turn.", EXTREME),
        "three_sigma": Key(
            "Three standard deviations of the error, the largest over the turn.",
            EXTREME,
            of="spread",
        ),
        "share": (
            "Share of the variance of the error, averaged over the whole degrees of the cam angle;"
            " 0 to 1."
        ),
        "share_at_worst": "Share of the variance where that is largest.",
        "remainder": Key(
            "Largest difference, at whole degrees of the cam angle, between the exact and the"
            " linear motion if the source deviates by three standard deviations.",
            EXTREME,
        ),
    },
)

SPREAD: Final = Key(
    "A quantity of the nominal machine and of random ones.",
    {
        "nominal": "Value for the machine of the scene.",
        "machines": "The 1 %, 50 % and 99 % quantiles over the machines.",
    },
)

DOCUMENT: Final = Key(
    "Effect of the tolerances of a machine's dimensions on the position that its cam produces.",
    {
        "scene": SCENE,
        "of": Key(
            "Whose position it is: that of the follower, or of the far end of the linkage.",
            of="member",
            type=Literal["follower", "slider", "lever", "crank"],
        ),
        "flank": Key("The flank that carries the follower.", of="linear.stated.machine.flank"),
        "unit": Key("Unit of the position and its errors.", type=Literal["mm", "inch", "deg"]),
        "limit": "Largest error that is allowed, plus or minus; null if the scene states none.",
        "set_at_deg": Key(
            "Cam angle at which the error is set to 0; null if it is not.",
            of="linear.stated.zero_angle",
        ),
        "within": Key(
            "Whether mean and three standard deviations keep the limit; null if there is none.",
            of="keeps_limit",
        ),
        "worst": Key(
            "The largest error over the turn by the linear analysis, of mean and three standard"
            " deviations.",
            EXTREME,
        ),
        "sources": Key("The sources of deviations, in the order of the scene.", SOURCE),
        "play": Key(
            "How far the follower can move between the two sides that hold it, a conjugate pair"
            " or a yoke, by the linear analysis; negative where they squeeze it. Left out on a"
            " single flank.",
            {
                "unit": Key(
                    "Unit of the follower's own motion.", type=Literal["mm", "inch", "deg"]
                ),
                "least": Key(
                    "The least over the turn, of mean less three standard deviations.", EXTREME
                ),
                "most": Key(
                    "The largest over the turn, of mean and three standard deviations.", EXTREME
                ),
                "sources": Key(
                    "Contribution of each source to the play, like that to the position.", SOURCE
                ),
            },
            optional=True,
        ),
        "machines": Key(
            "Random machines, each replayed exactly; left out if none were asked for.",
            {
                "count": "Number of machines.",
                "seed": "Seed of the random numbers.",
                "quantile": Key(
                    "The value of larger magnitude among the 1 % and 99 % quantiles of the error.",
                    EXTREME,
                ),
                "three_sigma": Key("Three times the largest standard deviation.", EXTREME),
                "largest": (
                    "Magnitude that the errors of 99 % of machines do not exceed at any cam angle."
                ),
                "kept": Key(
                    "Share of machines that keep the limit at all cam angles, 0 to 1; null if"
                    " there is no limit.",
                ),
                "kept_error": Key("Standard error of that share.", of="conforming_error"),
                "acceleration": Key(
                    "Largest magnitude of the second derivative of the position, in its unit per"
                    " rad^2.",
                    SPREAD,
                ),
                "largest_force": Key(
                    "The largest contact force over the turn; left out unless the scene names"
                    " contact-force and inertia, and a speed.",
                    SPREAD,
                    optional=True,
                ),
                "smallest_force": Key(
                    "The smallest contact force over the turn; left out unless the scene names"
                    " contact-force and inertia, and a speed.",
                    SPREAD,
                    optional=True,
                ),
                "least_play": Key(
                    "The least play over the turn; left out on a single flank.",
                    SPREAD,
                    optional=True,
                ),
                "most_play": Key(
                    "The largest play over the turn; left out on a single flank.",
                    SPREAD,
                    optional=True,
                ),
                "squeezed": Key(
                    "Share of machines that squeeze the follower somewhere, 0 to 1; left out on a"
                    " single flank.",
                    optional=True,
                ),
            },
            optional=True,
        ),
    },
    type=ToleranceAnalysis,
)


# -- rendering ------------------------------------------------------------------------------------
# The answer of `camgeo tolerance` in words, as a table and as a picture.


NOTE: Final = (
    "share of the variance, over the turn and where it is largest;\n"
    "not linear: how far the exact motion at 3 sigma of the source departs from the linear one"
)

SQUEEZED: Final = (
    "negative: both sides squeeze the follower; the position above is that of one that rests on the"
    " main side"
)

COST: Final = "the nominal value, and the values that 1 %, 50 % and 99 % of machines stay below"


def text(answer: ToleranceAnalysis) -> str:
    """The largest error, and a line for each source; then the play, and the random machines."""
    sources, stated = counted(len(answer.sources), "source"), answer.linear.stated
    worst, flank = small_extreme(answer.worst, answer.unit), stated.machine.flank
    lines = [
        f"{answer.scene.name}: position of the {answer.member} on the {flank} flank, {sources}",
        f"largest error, mean and 3 sigma: {worst}{_verdict(answer)}",
    ]
    if stated.zero_angle is not None:
        lines.append(f"the machine is set {at_cam_angles(stated.zero_angle)}")
    lines += ["", *_sources(answer.sources), ""]
    lines.append(f"errors in {answer.unit}, cam angles in degrees; {NOTE}")
    room = answer.play
    if room is not None:
        least, most = (small_extreme(extreme, room.unit) for extreme in (room.least, room.most))
        lines += ["", f"play between both sides, mean and 3 sigma: {least}, {most}"]
        lines += [SQUEEZED, "", *_sources(room.sources), ""]
    if answer.machines is not None:
        lines += ["", *_machines(answer.machines, answer.unit, room), ""]
    lines += [f"{source.name}: {source.sense}" for source in answer.sources]
    return "\n".join(lines)


def _sources(sources: tuple[Share, ...]) -> list[str]:
    rows = [["source", "limits", "sensitivity", "at", "mean", "3 sigma", "share", "worst",
             "not linear"]]  # fmt: skip
    return list(aligned([*rows, *map(_row, sources)]))


def _machines(machines: Machines, unit: str, room: Room | None) -> list[str]:
    lines = [
        (
            f"{counted(machines.count, 'random machine')} (Sobol, seed {machines.seed}), replayed"
            " exactly:"
        ),
        f"  1 % or 99 % of the errors are beyond {small_extreme(machines.quantile, unit)}",
        f"  3 sigma {small_extreme(machines.three_sigma, unit)}",
        f"  for 99 % of machines the error nowhere exceeds {small(machines.largest, unit)}",
    ]
    if machines.kept is not None:
        lines.append(
            f"  {machines.kept:.2%} keep the limit at all cam angles, +-"
            f" {machines.conforming_error:.1%}"
        )
    lines += ["", f"effect of the deviations: {COST}"]
    lines += _cost("largest acceleration", f"{unit}/rad^2", machines.acceleration)
    lines += _cost("largest contact force", "N", machines.largest_force)
    lines += _cost("smallest contact force", "N", machines.smallest_force)
    if room is not None:
        lines += _cost("least play", room.unit, machines.least_play)
        lines += _cost("largest play", room.unit, machines.most_play)
        lines.append(f"  {machines.squeezed:.2%} of machines squeeze the follower somewhere")
    return lines


def _cost(name: str, unit: str, spread: Spread | None) -> list[str]:
    if spread is None:
        return []
    machines = ", ".join(f"{quantile:.5g}" for quantile in spread.machines)
    return [f"  {name} {spread.nominal:.5g} {unit}: {machines}"]


def _verdict(answer: ToleranceAnalysis) -> str:
    if answer.limit is None:
        return ""
    verdict = "kept" if answer.keeps_limit else "BROKEN"
    return f"; limit {small(answer.limit, answer.unit)}: {verdict}"


def _row(share: Share) -> list[str]:
    low, high = share.limits
    return [
        share.name,
        f"{low:+.4g} to {high:+.4g} {share.unit}",
        small(share.sensitivity.value, share.sensitivity_unit, signed=True),
        cam_angle(share.sensitivity.place),
        f"{share.mean.value:+.3g}",
        f"{share.spread.value:.3g}",
        f"{100.0 * share.share:.1f} %",
        f"{100.0 * share.share_at_worst:.1f} %",
        f"{share.remainder.value:.1g}",
    ]


def table(answer: ToleranceAnalysis) -> Table:
    """A row for each degree of the cam angle: mean, band, and the contribution of each source."""
    linear, factor, unit = answer.linear, answer.factor, answer.unit
    low, high = linear.band
    columns = {
        "phi [deg]": np.degrees(linear.angles),
        f"mean [{unit}]": linear.mean * factor,
        f"mean - 3 sigma [{unit}]": low * factor,
        f"mean + 3 sigma [{unit}]": high * factor,
    }
    if answer.linear_play is not None:
        unit_of_play, per = answer.play_unit
        edges = zip(("-", "+"), answer.linear_play.band, strict=True)
        columns |= {f"play {sign} 3 sigma [{unit_of_play}]": edge * per for sign, edge in edges}
    for source, variance in zip(linear.stated.sources, linear.variances, strict=True):
        columns[f"3 sigma of {source.name} [{unit}]"] = SIGMAS * np.sqrt(variance) * factor
    if answer.sampled is not None:
        for share, values in zip(QUANTILES, answer.sampled.quantiles, strict=True):
            columns[f"{share:.0%} quantile [{unit}]"] = values * factor
    return Table(tuple(columns), np.column_stack(list(columns.values())))


def figure(answer: ToleranceAnalysis) -> Figure:
    """The band of errors, and the variance by source, over the cam angle."""
    from camgeo.pictures.deviations import tolerance_figure

    return tolerance_figure(
        answer.linear, answer.sampled, answer.scene.name, unit=answer.unit, factor=answer.factor
    )


# -- command line ----------------------------------------------------------------------------------


EXAMPLE: Final = (
    "camgeo tolerance fixtures/tolerance/lever.toml -o tolerance.png\n"
    "  camgeo tolerance my-cam.toml --count 4096 --seed 1 -o errors.csv"
)


ARGUMENTS: Final = (
    SCENE_FILE,
    Argument(
        "--count",
        type=int,
        help="number of random machines to replay; default 1024, 0 for the linear analysis alone",
    ),
    Argument("--seed", type=int, default=0, help="seed of the random numbers; default 0"),
    *output_options(
        f"file to write: a table ({CSV}), a picture ({', '.join(IMAGES)}), or the answer ({JSON})",
        (CSV, JSON, *IMAGES),
    ),
)


def run(arguments: argparse.Namespace) -> int:
    """Analyse, print the answer, and write it."""
    count = COUNT if arguments.count is None else arguments.count
    answer = tolerance(opened(arguments), count=count, seed=arguments.seed)
    return show(answer, arguments, contents="errors over the cam angle")
