"""Tables of a machine profile that a controller may lack: compensation and smoothing."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Annotated

from camgeo.numeric.checked import check_fields, one_of
from camgeo.toolpath.machine_fields import (
    Plain,
    Share,
    Size,
    Text,
    Texts,
    blocks_of,
    blocks_with,
)
from camgeo.toolpath.tool import CONTROL, WEAR


@dataclass(frozen=True, slots=True)
class Compensation:
    """`[compensation]`: words of the controller's own radius compensation.

    Attributes
    ----------
    left, right : switch it on, in the block of a straight move; with {tool} and {nominal}.
    off : switches it off, likewise.
    modes : those of camgeo that it allows: "wear" and "control".
    nominal : with {radius}: takes the cutter's nominal radius off what the tool table holds, so
        that in mode "wear" the table keeps the radius as it is measured; it stands where {nominal}
        is, in `left` and `right` or in `tool_change.change`. Empty: there the offset of the tool
        holds the wear alone.
    table : whether the offsets of tools are a "radius" or a "diameter".
    """

    left: Text
    right: Text
    off: Text
    modes: Texts
    nominal: Text = ""
    table: Annotated[str, partial(one_of, choices=("radius", "diameter"))] = "radius"

    def __post_init__(self) -> None:
        check_fields(self, "compensation.")
        for name in ("left", "right"):
            blocks_of(f"compensation.{name}", (getattr(self, name),), ("tool", "nominal"))
        blocks_of("compensation.off", (self.off,), ())
        blocks_of("compensation.nominal", (self.nominal,), ("radius",))
        for mode in self.modes:
            one_of("compensation.modes", mode, (WEAR, CONTROL))


@dataclass(frozen=True, slots=True)
class Smoothing:
    """`[smoothing]`: smoothing of the path, whose error counts against the tolerance.

    Attributes
    ----------
    on : blocks with {p}, the largest deviation, in the program's unit.
    off : blocks of the exact path.
    end : blocks before the end of the program.
    share : the deviation as a share of the tolerance; 0 for the exact path always.
    smallest : deviation [mm] below which the exact path is programmed instead.
    largest : deviation [mm] above which no more is asked for.
    """

    on: Annotated[tuple[str, ...], blocks_with("p")]
    off: Plain
    share: Share
    smallest: Size
    end: Plain = ()
    largest: Size = 1.0

    def __post_init__(self) -> None:
        check_fields(self, "smoothing.")
