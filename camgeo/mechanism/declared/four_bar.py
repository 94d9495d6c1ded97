"""The four-bar linkage, declared."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from camgeo.declared import schema_beside
from camgeo.mechanism.kind import LinkageKind, Unit, Values

if TYPE_CHECKING:
    from camgeo.mechanism.linkage_protocol import Linkage


def build(values: Values, _: Unit) -> Linkage:
    """The linkage of a table; it turns rockers only."""
    from camgeo.mechanism.four_bar import FourBar

    return FourBar(
        **values.lengths("crank", "coupler", "lever"),
        shaft=values.point("shaft"),
        **values.angles("lever_angle"),
        lever_sense=values.signs("lever_sense").get("lever_sense", 1),
        branch=-values.signs("branch")["branch"],
    )


KIND: Final = LinkageKind(
    name="four-bar",
    told=("the motion is the angle of a lever [degrees]; coupler and crank turn the rocker shaft."),
    members={"rad": "lever"},
    schema=schema_beside(__file__),
    build=build,
    templates=("four-bar",),
)
