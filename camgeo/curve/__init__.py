"""Plane curves as functions of the cam angle: pitch curve, working curves, curvature, closure."""
