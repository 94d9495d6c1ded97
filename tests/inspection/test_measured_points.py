"""Measured points from files."""

from __future__ import annotations

import numpy as np
import pytest

from camgeo.app.answers.inspect import MOST, read_points
from camgeo.errors import GeometryError
from tests.findings import known

ROWS = [(float(k), 0.5 * k * k) for k in range(12)]

NORMAL = "".join(f"{x},{y},1,0\n" for x, y in ROWS)

PLAIN = "".join(f"{x},{y}\n" for x, y in ROWS)


def test_units_are_those_of_the_heading_or_as_asked() -> None:
    expected = np.array([complex(*row) for row in ROWS])
    assert np.array_equal(read_points(PLAIN, "p.csv").points, expected)
    assert np.array_equal(read_points(PLAIN, "p.csv", "inch").points, 25.4 * expected)
    for unit in ("inch", "in"):
        found = read_points(f"x [{unit}],y [{unit}]\n{PLAIN}", "p.csv", "mm")
        assert np.array_equal(found.points, 25.4 * expected)
        assert found.normals is None
    assert np.array_equal(read_points(f"x [mm],y\n{PLAIN}", "p.csv", "inch").points, expected)
    normals = read_points(f"x [mm],y [mm],nx [inch],ny [inch]\n{NORMAL}", "p.csv", "inch")
    assert np.array_equal(normals.points, expected)  # the unit of a direction means nothing


def test_normals_become_unit_vectors() -> None:
    rows = "".join(f"{x};{y};0;{-2.0 - x}\n".replace(".", ",") for x, y in ROWS)
    assert np.array_equal(known(read_points(f"X;Y;I;J\n{rows}", "p.csv").normals), np.full(12, -1j))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (PLAIN[:30], "p.csv, line .*rows? of numbers; allowed: 12 to 50,000"),
        ("1,1\n" * (MOST + 1), "50,001 rows"),
        (f"x [mm],y [inch]\n{PLAIN}", "line 2: x and y have different units"),
        (f"x [m],y\n{PLAIN}", "unit of the x is unknown; allowed: mm or inch"),
        (PLAIN + "1e10,0\n", "line 13: '10000000000.0': too large"),
        ("1,2,3\n" * 12, "3 columns; without a heading 2 or 4 are allowed, x and y, or x, y, nx"),
        ("1,2\n" * 40, "line 40: fewer than 12 different points"),
        (f"{NORMAL}1,2,0,0\n", "line 13: a normal of no length"),
        ("x,y,nx\n" + "1,2,1\n" * 12, "0 columns of ny"),
        ("a,b\n1,2\n", "0 columns of x; allowed: one, called x"),
    ],
)
def test_other_files_are_refused(text: str, message: str) -> None:
    with pytest.raises(GeometryError, match=message):
        read_points(text, "p.csv")
