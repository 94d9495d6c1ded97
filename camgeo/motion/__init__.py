"""Motion: laws, the plan of dwells and moves, the lift as a function of the cam angle."""
