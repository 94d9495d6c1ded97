"""Results in double precision compared with mpmath, as table, JSON and picture.

python -m tests.stability [--only NAME ...] [--quick] [--json] [-o PICTURE]
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from typing import Final

from camgeo.app.cli.command import (
    Argument,
    CallError,
    Progress,
    output_files,
    picture_options,
    present_name,
    show,
    write_files,
)
from camgeo.app.cli.main import AS_JSON, add_arguments
from camgeo.errors import meant
from camgeo.units import counted

ARGUMENTS: Final = (
    Argument(
        "--only",
        metavar="NAME",
        nargs="+",
        default=[],
        help="groups (laws, tables, cams, linkages, slotted-levers, extremes, outlines),"
        " quantities, or beginnings of case names",
    ),
    Argument("--quick", action="store_true", help="only two places of each case"),
    AS_JSON,
    *picture_options(),
)


def run(arguments: argparse.Namespace) -> int:
    """Run the suite; 0 if all ratios are within the limit, else 1."""
    from tests.stability import suite
    from tests.stability.report import stability  # with all that it measures

    cases = suite.all_cases()
    only = known_names(arguments.only, suite.names(cases))
    found = stability(cases, only, quick=arguments.quick, progress=arguments.progress)
    points = counted(len(suite.worst_of_cases(found.readings)), "point")
    write_files(output_files(found, arguments, points), arguments)
    return show(found, arguments)


def known_names(asked: Sequence[str], known: tuple[str, ...]) -> frozenset[str]:
    """The names requested; an unknown name stands for all names that begin with it."""
    found: set[str] = set()
    for name in map(present_name, asked):
        these = [name] if name in known else [each for each in known if each.startswith(name)]
        if not these:
            message = f"argument --only: there is no {name!r}"
            hint = meant(name, known, '"')
            raise CallError(f"{message}; {hint}" if hint else message)
        found.update(these)
    return frozenset(found)


def main(words: Sequence[str] | None = None) -> int:
    """Run the suite as `words` say, by default those of this process."""
    parser = argparse.ArgumentParser(
        prog="python -m tests.stability",
        description="Measure the rounding errors of every quantity against mpmath, also on the"
        " hard cases.",
    )
    add_arguments(parser, ARGUMENTS)
    parser.set_defaults(progress=Progress())
    arguments = parser.parse_args(words)
    arguments.progress.begin()
    try:
        return run(arguments)
    except CallError as error:
        parser.error(str(error))
    finally:
        arguments.progress.end()


if __name__ == "__main__":
    sys.exit(main())
