"""What `camgeo tolerance` finds, in words, as a table and as a picture."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from camgeo.answers.sweep.rendering import aligned
from camgeo.answers.tolerance import Machines, Room, Share, Spread, ToleranceAnalysis
from camgeo.numeric.extremes import Extreme
from camgeo.product.value_table import Table
from camgeo.tolerancing.distribution import SIGMAS
from camgeo.tolerancing.sampled import QUANTILES
from camgeo.wording import at_cam_angles, cam_angle, counted, small

if TYPE_CHECKING:
    from camgeo.figure.model import Figure

NOTE: Final = (
    "share of the variance, over the turn and where it is largest;\n"
    "not linear: by how much the exact motion with 3 sigma of the source is off the linear one"
)

SQUEEZED: Final = (
    "negative: both sides squeeze the follower; the position above is that of one that rests on the"
    " main side"
)

COST: Final = "by the scene, and below what 1 %, 50 % and 99 % of machines stay"


def text(answer: ToleranceAnalysis) -> str:
    """The largest error, and a line for each source."""
    sources = counted(len(answer.sources), "source")
    lines = [
        f"{answer.scene.name}: position of the {answer.of} on the {answer.flank} flank, {sources}",
        f"largest error, mean and 3 sigma: {_at(answer.worst, answer.unit)}{_verdict(answer)}",
    ]
    if answer.set_at is not None:
        lines.append(f"the machine is set {at_cam_angles(answer.set_at)}")
    lines += ["", *_sources(answer.sources), ""]
    lines.append(f"errors in {answer.unit}, cam angles in degrees; {NOTE}")
    room = answer.play
    if room is not None:
        least, most = (_at(each, room.unit) for each in (room.least, room.most))
        lines += ["", f"play between both sides, mean and 3 sigma: {least}, {most}"]
        lines += [SQUEEZED, "", *_sources(room.sources), ""]
    if answer.machines is not None:
        lines += ["", *_machines(answer.machines, answer.unit, room), ""]
    lines += [f"{each.name}: {each.sense}" for each in answer.sources]
    return "\n".join(lines)


def _sources(sources: tuple[Share, ...]) -> list[str]:
    rows = [["source", "limits", "sensitivity", "at", "mean", "3 sigma", "share", "worst",
             "not linear"]]  # fmt: skip
    return list(aligned([*rows, *map(_row, sources)]))


def _machines(found: Machines, unit: str, room: Room | None) -> list[str]:
    lines = [
        f"{counted(found.count, 'random machine')} (Sobol, seed {found.seed}), replayed exactly:",
        f"  1 % or 99 % of the errors are beyond {_at(found.quantile, unit)}",
        f"  3 sigma {_at(found.three_sigma, unit)}",
        f"  99 % of machines err nowhere by more than {small(found.largest, unit)}",
    ]
    if found.kept is not None:
        lines.append(f"  {found.kept:.2%} keep the limit all round, +- {found.kept_error:.1%}")
    lines += ["", f"what deviations cost: {COST}"]
    lines += _cost("largest acceleration", f"{unit}/rad^2", found.acceleration)
    lines += _cost("largest contact force", "N", found.largest_force)
    lines += _cost("smallest contact force", "N", found.smallest_force)
    if room is not None:
        lines += _cost("least play", room.unit, found.least_play)
        lines += _cost("largest play", room.unit, found.most_play)
        lines.append(f"  {found.squeezed:.2%} of machines squeeze the follower somewhere")
    return lines


def _cost(name: str, unit: str, found: Spread | None) -> list[str]:
    if found is None:
        return []
    machines = ", ".join(f"{each:.5g}" for each in found.machines)
    return [f"  {name} {found.nominal:.5g} {unit}: {machines}"]


def _verdict(answer: ToleranceAnalysis) -> str:
    if answer.limit is None:
        return ""
    kept = "kept" if answer.within else "BROKEN"
    return f"; limit {small(answer.limit, answer.unit)}: {kept}"


def _at(extreme: Extreme, unit: str) -> str:
    return f"{small(extreme.value, unit, signed=True)} {at_cam_angles(extreme.place)}"


def _row(each: Share) -> list[str]:
    low, high = each.limits
    return [
        each.name,
        f"{low:+.4g} to {high:+.4g} {each.unit}",
        small(each.sensitivity.value, each.sensitivity_unit, signed=True),
        cam_angle(each.sensitivity.place),
        f"{each.mean.value:+.3g}",
        f"{each.spread.value:.3g}",
        f"{100.0 * each.share:.1f} %",
        f"{100.0 * each.share_at_worst:.1f} %",
        f"{each.remainder.value:.1g}",
    ]


def table(answer: ToleranceAnalysis) -> Table:
    """A row for each degree of the cam angle: mean, band, and what each source does."""
    linear, factor, unit = answer.linear, answer.factor, answer.unit
    low, high = linear.band
    columns = {
        "phi [deg]": np.degrees(linear.angles),
        f"mean [{unit}]": linear.mean * factor,
        f"mean - 3 sigma [{unit}]": low * factor,
        f"mean + 3 sigma [{unit}]": high * factor,
    }
    if answer.between is not None:
        unit_of_play, per = answer.play_unit
        edges = zip(("-", "+"), answer.between.band, strict=True)
        columns |= {f"play {sign} 3 sigma [{unit_of_play}]": each * per for sign, each in edges}
    for source, variance in zip(linear.stated.sources, linear.variances, strict=True):
        columns[f"3 sigma of {source.name} [{unit}]"] = SIGMAS * np.sqrt(variance) * factor
    if answer.sampled is not None:
        for share, values in zip(QUANTILES, answer.sampled.quantiles, strict=True):
            columns[f"{share:.0%} quantile [{unit}]"] = values * factor
    return Table(tuple(columns), np.column_stack(list(columns.values())))


def figure(answer: ToleranceAnalysis) -> Figure:
    """The band of errors, and the variance by source, over the cam angle."""
    from camgeo.figure.tolerance import of_analysis

    return of_analysis(
        answer.linear, answer.sampled, answer.scene.name, unit=answer.unit, factor=answer.factor
    )
