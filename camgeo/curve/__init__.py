"""Plane curves over the cam angle: pitch curve, working curves, curvature, closure."""
