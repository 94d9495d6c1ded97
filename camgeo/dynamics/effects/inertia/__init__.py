"""Effect `inertia`: the masses that are moved, and their inertia forces."""
