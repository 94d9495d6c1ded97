"""Effect `power-balance`: where the power of the camshaft goes."""
