"""Contours of G1 arcs: the fast fit of biarcs, and the one of fewest arcs."""
