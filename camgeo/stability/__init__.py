"""Stability shown: what camgeo computes in doubles, held against the same with eighty digits."""
