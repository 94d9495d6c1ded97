"""Effect `kinematics`: velocity, acceleration and jerk in time."""
