"""Effect `gravity`: the weights of the masses."""
