"""A camshaft that does not turn at constant speed: its equation of motion over the cam angle."""
