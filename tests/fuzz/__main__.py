"""`python -m tests.fuzz`: random scenes, command lines and files, see docs/robustness.md."""

from __future__ import annotations

import argparse
import secrets
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from tests.fuzz.case import CORPUS
from tests.fuzz.cases import KINDS
from tests.fuzz.runner import fuzz


def call(words: Sequence[str] | None = None) -> argparse.Namespace:
    """What the words of a call ask for, those of this process by default."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__)
    parser.add_argument("--minutes", type=float, default=1.0, help="how long; default 1")
    parser.add_argument("--seed", type=int, help="of all that is drawn; default a fresh one")
    parser.add_argument("--kind", choices=tuple(KINDS), help="cases of this kind only")
    parser.add_argument("--case", type=int, help="only the case of this number")
    parser.add_argument("--minimise", type=float, default=60.0, help="seconds for each failure")
    parser.add_argument(
        "--keep", type=Path, default=CORPUS, help="folder for cases that fail; default the corpus"
    )
    return parser.parse_args(words)


def main() -> int:
    """Run; 1 if something failed."""
    given = call()
    seed = secrets.randbelow(10**9) if given.seed is None else given.seed
    if given.case is None:
        words = ["--minutes", f"{given.minutes:g}", "--seed", str(seed)]
        words += ["--kind", given.kind] if given.kind else []
        print(f"the same cases again: python -m tests.fuzz {' '.join(words)}", flush=True)
    report = fuzz(
        seed,
        seconds=60.0 * given.minutes,
        kind=given.kind,
        first=given.case or 0,
        count=None if given.case is None else 1,
        minimise=given.minimise,
        keep=given.keep,
        say=partial(print, flush=True),
    )
    print(report.text)
    return 1 if report.found else 0


if __name__ == "__main__":
    sys.exit(main())
