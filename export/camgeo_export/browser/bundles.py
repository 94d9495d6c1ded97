"""The scripts that run in a browser, made by node from the sources beside them, and kept.

Nothing here needs node: `npm run build` in this folder makes the bundles anew, see CONTRIBUTING.md.
"""

from __future__ import annotations

from importlib.resources import files


def bundle(name: str) -> str:
    """The text of a bundle, "report.js" say; it holds nothing that ends a script element."""
    return files("camgeo_export.browser").joinpath("bundle", name).read_text("utf-8")
