"""The part: boundaries in the plane, thickness, bore and keyway, rim and groove."""
