"""Proof of a contour: its distance from the exact path, enclosed for every point."""
