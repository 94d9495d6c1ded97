"""A replay over the cam angle: lift and lost stroke, velocity, acceleration and its ripple."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from camgeo.numeric.arrays import FloatArray
from camgeo.outline.replay_result import Replay
from camgeo_export.plots.file import figure_file
from camgeo_export.plots.style import AUXILIARY, LIMIT, LINE, frame, over_cam_angle

SIZE: Final = (7.0, 7.8)

BOTTOM: Final = 0.8
"""Margin [inch] with room for the legend."""

ACTUAL: Any = {"color": LINE, "linewidth": 1.1}
DEMANDED: Any = {"color": AUXILIARY, "linewidth": 1.4, "linestyle": (0, (5, 3))}
LOST: Any = {"color": LIMIT, "alpha": 0.35, "linewidth": 0.0}
SHOCK: Any = {"marker": "^", "markersize": 3.5, "color": LIMIT, "linestyle": "none"}

MOST: Final = 3.0
"""The acceleration is drawn up to so many times its demanded peak: beyond that a corner's spike
would flatten all else."""

SHARE: Final = 0.05
"""Lost stroke below this share of the lift's range is too thin to be seen as an area."""


def render(
    replay: Replay,
    *,
    title: str,
    unit: str,
    scale: float,
    joints: tuple[float, ...],
    suffix: str,
) -> bytes:
    """The replay as a file of kind `suffix`: ".svg", ".png" or ".pdf".

    Parameters
    ----------
    unit, scale : in which the lift is drawn, and how many of it are in 1 mm or rad.
    joints : cam angles [rad] to be marked.

    Raises
    ------
    ValueError
        If there is no such kind of figure.
    """
    return figure_file(lambda: _figure(title, replay, unit, scale, joints), suffix)


def _figure(
    title: str, replay: Replay, unit: str, scale: float, joints: tuple[float, ...]
) -> Figure:
    unit = "°" if unit == "deg" else unit
    figure = Figure(figsize=SIZE)
    FigureCanvasAgg(figure)
    panels = figure.subplots(3, 1, gridspec_kw={**frame(figure, BOTTOM), "hspace": 0.12})
    for order, axes in enumerate(panels):
        _draw(axes, replay, order, scale, unit)
        over_cam_angle(axes, joints, label=order == 2)
        mark = ("ψ" if unit == "°" else "s") + ("", "′", "″")[order]
        per = ("", "/rad", "/rad²")[order]
        axes.set_ylabel(f"{mark} [{unit}{per}]")
    panels[0].set_title(title, fontsize=10.0)
    _legend(figure, panels)
    return figure


def _draw(axes: Axes, replay: Replay, order: int, scale: float, unit: str) -> None:
    phi = np.degrees(replay.phi)
    shown = replay.smooth if order == 2 else np.ones(len(phi), dtype=bool)
    demanded, actual = replay.demanded[order] * scale, replay.actual[order] * scale
    axes.axhline(0.0, color="black", linewidth=0.5)
    axes.plot(phi[shown], actual[shown], label="actual", **ACTUAL)
    axes.plot(phi, demanded, label="demanded", **DEMANDED)
    if order == 0:
        _shade_lost(axes, replay, phi, demanded, actual)
        loss = replay.largest_loss.value * scale
        _tell(axes, f"lost stroke up to {loss:.3g} {unit}")
    elif order == 1:
        if len(replay.shocks):
            places = np.degrees(replay.shocks.phi)
            foot = np.full(len(places), 0.03)
            across = axes.get_xaxis_transform()  # along the foot of the panel
            axes.plot(places, foot, label="shock", transform=across, **SHOCK)
            count = len(places)
            _tell(axes, "1 shock" if count == 1 else f"{count} shocks")
    else:
        _limit(axes, replay, actual[shown], scale)


def _legend(figure: Figure, panels: Any) -> None:
    """One for all panels, below them."""
    found: dict[str, Any] = {}
    for axes in panels:
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
            found.setdefault(label, handle)
    figure.legend(found.values(), found.keys(), loc="lower center", ncols=len(found))


def _shade_lost(
    axes: Axes, replay: Replay, phi: FloatArray, demanded: FloatArray, actual: FloatArray
) -> None:
    span = float(np.ptp(demanded))
    lost = replay.lost > 0.0
    if span > 0.0 and float(np.max(np.abs(actual - demanded))) > SHARE * span:
        axes.fill_between(phi, demanded, actual, where=lost, label="lost stroke", **LOST)


def _limit(axes: Axes, replay: Replay, actual: FloatArray, scale: float) -> None:
    """Keep spikes from flattening the curve, and tell the ripple."""
    peak = replay.demanded_acceleration * scale
    if replay.ripple is not None:
        share = 100.0 * replay.ripple
        text = f"{share:.0f}" if share >= 100.0 else f"{share:.3g}"
        _tell(axes, f"ripple {text} % of the demanded peak")
    if peak > 0.0 and float(np.max(np.abs(actual))) > MOST * peak:
        axes.set_ylim(-MOST * peak, MOST * peak)


def _tell(axes: Axes, text: str) -> None:
    axes.text(
        0.99, 0.94, text, fontsize=8.0, transform=axes.transAxes, ha="right", va="top",
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.0},
    )  # fmt: skip
