"""Effect `load`: the process force over the cam angle."""
