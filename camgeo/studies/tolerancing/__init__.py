"""What the tolerances of a machine's dimensions do to the motion of its follower.

The cam is made as the scene says, and its flank stays; the machine that it is put into deviates.
`stated` has what a scene states, `sensitivity` the contact of that machine and its exact
derivatives, `linear` the motion itself and its error. Elsewhere in camgeo a tolerance is the
accuracy of a contour, here that of a dimension.
"""
