"""Numerical tools that know nothing of cams: arrays, checked values, roots, extremes, integrals.

Results hold between the samples, too: extremes and roots are enclosed in cells before they are
refined.
"""
