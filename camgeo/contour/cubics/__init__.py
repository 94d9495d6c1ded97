"""Contours of cubic splines: the fits, and their proof by lines and arcs."""
