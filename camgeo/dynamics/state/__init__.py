"""The state of motion: what follower and output do over the cam angle and in time."""
