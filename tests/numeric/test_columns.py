"""Tables of numbers with columns that may be missing; lift tables test the format itself."""

from __future__ import annotations

import numpy as np
import pytest

from camgeo.errors import GeometryError
from camgeo.numeric.columns import Asked, Column, Columns, read_columns

ASKED = Asked(
    (Column("x", ("x",), ("mm", "inch"), "mm or inch"), Column("y", ("y",))),
    (Column("nx", ("nx", "i")), Column("ny", ("ny", "j"))),
    fewest=1,
    most=3,
)


def read(text: str) -> Columns:
    return read_columns(text, "points.csv", ASKED)


@pytest.mark.parametrize(
    "text",
    [
        "1.5,2,0,1\n3,4,1,0\n",
        "x;y;nx;ny\n1,5;2;0;1\n3;4;1;0\n",
        "J\tz\ty\tx [mm]\tI\n1\t?\t2\t1.5\t0\n0\t?\t4\t3\t1\n",
    ],
)
def test_columns_are_found_by_name_or_by_place(text: str) -> None:
    found = read(text)
    assert found.values.tolist() == [[1.5, 3.0], [2.0, 4.0], [0.0, 1.0], [1.0, 0.0]]
    assert found.units == (("mm" if "mm" in text else ""), "", "", "")


@pytest.mark.parametrize("text", ["1,2\n", "x,y\n1,2\n", "z,y,x\n9,2,1\n"])
def test_columns_that_may_be_missing(text: str) -> None:
    assert np.array_equal(read(text).values, [[1.0], [2.0]])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "1,2,3\n",
            "line 1.*3 columns; without a heading 2 or 4 are allowed, x and y, or x, y,",
        ),
        ("x,y,nx\n1,2,3\n", "line 1.*0 columns of ny; allowed: one, called ny or j"),
        ("x,y,nx,i,ny\n1,2,3,4,5\n", "line 1.*2 columns of nx"),
        ("x [cm],y\n1,2\n", "line 1: 'x \\[cm\\]': the unit of the x; allowed: mm or inch"),
        ("1,2\n" * 4, "line 4: 4 rows of numbers; allowed: 1 to 3"),
        ("x,y\n", "line 2: 0 rows of numbers"),
        ("1;2\n1,5;2.5\n", "line 2: '2.5': the decimals above have ','; allowed: one kind"),
    ],
)
def test_other_tables_are_refused(text: str, message: str) -> None:
    with pytest.raises(GeometryError, match=message):
        read(text)
