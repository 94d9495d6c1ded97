"""Sizing a mechanism: Flocke's construction, the exact region of the cam axis, its best place.

It is part of the checks, because the rule r_R <= ratio r_K needs the curvature of the pitch curve,
which the stage of the mechanisms does not know.
"""
