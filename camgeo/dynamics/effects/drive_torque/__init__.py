"""Effect `drive-torque`: the torque that the camshaft needs."""
