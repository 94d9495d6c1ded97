"""`python -m tests.fuzz`: random scenes, command lines and files, see docs/robustness.md."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Final

from tests.fuzz.case import OPEN
from tests.fuzz.runner import KINDS, TRIES, fuzz
from tests.seeds import add_seed

COUNT: Final = 60


def call(words: Sequence[str] | None = None) -> argparse.Namespace:
    """What the words of a call ask for, those of this process by default."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__)
    parser.add_argument("--count", type=int, default=COUNT, help=f"of cases; default {COUNT}")
    add_seed(parser)
    parser.add_argument("--kind", choices=tuple(KINDS), help="cases of this kind only")
    parser.add_argument("--case", type=int, help="only the case of this number")
    parser.add_argument(
        "--minimise", type=int, default=TRIES, help="runs that make a failure smaller"
    )
    parser.add_argument(
        "--keep", type=Path, default=OPEN, help="folder for cases that fail; default the corpus's"
    )
    return parser.parse_args(words)


def main(words: Sequence[str] | None = None) -> int:
    """Run; 1 if something failed."""
    given = call(words)
    if given.case is None:
        again = ["--count", str(given.count), "--seed", str(given.seed)]
        again += ["--kind", given.kind] if given.kind else []
        print(f"the same cases again: python -m tests.fuzz {' '.join(again)}", flush=True)
    report = fuzz(
        given.seed,
        count=given.count if given.case is None else 1,
        kind=given.kind,
        first=given.case or 0,
        minimise=given.minimise,
        keep=given.keep,
        say=partial(print, flush=True),
    )
    print(report.text)
    return 1 if report.found else 0


if __name__ == "__main__":
    sys.exit(main())
