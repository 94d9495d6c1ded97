"""Effect `balance`: mass, centre of mass and unbalance of the disc."""
