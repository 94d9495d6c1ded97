"""Keyways of hubs by DIN 6885-1, parallel keys of the deep form: from the diameter of the bore.

Rows on which sources do not agree are left out: that of shafts above 440 mm, where the depth in the
hub is 19.4 or 19.5 mm. `tests/part/test_keyways.py` names the sources.
"""

from __future__ import annotations

from bisect import bisect_left
from typing import Final, NamedTuple

from camgeo.errors import GeometryError

DIN_6885_1: Final = "DIN 6885-1"

STANDARDS: Final = (DIN_6885_1,)


class Row(NamedTuple):
    """A row of the table.

    Attributes
    ----------
    largest : diameter of shaft and bore up to which it holds, that included [mm].
    width : b of key and keyway [mm].
    depth : t2 of the keyway in the hub [mm].
    """

    largest: float
    width: float
    depth: float


SMALLEST: Final = 6.0
"""Diameter above which the table begins [mm]."""

ROWS: Final = (
    Row(8.0, 2.0, 1.0),
    Row(10.0, 3.0, 1.4),
    Row(12.0, 4.0, 1.8),
    Row(17.0, 5.0, 2.3),
    Row(22.0, 6.0, 2.8),
    Row(30.0, 8.0, 3.3),
    Row(38.0, 10.0, 3.3),
    Row(44.0, 12.0, 3.3),
    Row(50.0, 14.0, 3.8),
    Row(58.0, 16.0, 4.3),
    Row(65.0, 18.0, 4.4),
    Row(75.0, 20.0, 4.9),
    Row(85.0, 22.0, 5.4),
    Row(95.0, 25.0, 5.4),
    Row(110.0, 28.0, 6.4),
    Row(130.0, 32.0, 7.4),
    Row(150.0, 36.0, 8.4),
    Row(170.0, 40.0, 9.4),
    Row(200.0, 45.0, 10.4),
    Row(230.0, 50.0, 11.4),
    Row(260.0, 56.0, 12.4),
    Row(290.0, 63.0, 12.4),
    Row(330.0, 70.0, 14.4),
    Row(380.0, 80.0, 15.4),
    Row(440.0, 90.0, 17.4),
)

RANGE: Final = f"is for bores above {SMALLEST:g} mm, up to {ROWS[-1].largest:g} mm"


def din_6885_1(bore: float) -> Row:
    """The keyway for a bore of that diameter [mm].

    Raises
    ------
    GeometryError
        With key "part.keyway.standard", outside the table.
    """
    if not SMALLEST < bore <= ROWS[-1].largest:
        raise GeometryError(RANGE, key="part.keyway.standard", value=f"{bore:g} mm")
    return ROWS[bisect_left([row.largest for row in ROWS], bore)]
