"""What the tolerances of a machine's dimensions do to the motion of its follower.

The cam is made as the scene says, and its flank stays; the machine that it is put into deviates.
`machine` has the contact of that machine, `sensitivity` its exact derivatives, `replay` the motion
itself. Elsewhere in camgeo a tolerance is the accuracy of a contour, here that of a dimension.
"""
