"""Effect `friction`: Coulomb, rolling and viscous friction, and the margin against jamming."""
