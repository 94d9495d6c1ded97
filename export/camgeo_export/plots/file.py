"""A figure as the bytes of a file, the same bytes for the same figure."""

from __future__ import annotations

import io
from collections.abc import Callable
from typing import Any

from matplotlib import rc_context
from matplotlib.figure import Figure

from camgeo_export.plots.style import RC

RESOLUTION = 150
"""Dots per inch of a PNG."""

# No time, no version: the bytes depend on the product only.
METADATA: dict[str, dict[str, Any]] = {
    "svg": {"Date": None, "Creator": "camgeo"},
    "png": {"Software": "camgeo"},
    "pdf": {"CreationDate": None, "Creator": "camgeo", "Producer": None},
}


def figure_file(draw: Callable[[], Figure], suffix: str) -> bytes:
    """The figure that `draw` makes, in the style of all plots, as a file of kind `suffix`.

    Raises
    ------
    ValueError
        If there is no such kind of figure; there are ".svg", ".png" and ".pdf".
    """
    kind = suffix.removeprefix(".")
    if kind not in METADATA:
        raise ValueError(f"no figures of kind {suffix}; there are .svg, .png and .pdf")
    with rc_context({**RC, "svg.hashsalt": "camgeo"}):
        stream = io.BytesIO()
        draw().savefig(stream, format=kind, dpi=RESOLUTION, metadata=METADATA[kind])
    return stream.getvalue()
