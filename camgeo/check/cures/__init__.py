"""The smallest cure of undercut, one for each knob of the design, the cheapest first."""
