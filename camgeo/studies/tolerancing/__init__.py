"""What the tolerances of a machine's dimensions do to the motion of its follower.

The cam is made as the scene says, and its flank stays as it is; the machine around it deviates.
`stated` has the tolerances of a scene, the contact of the machine and its exact sensitivities,
`linear` the resulting error of the position. Elsewhere in camgeo a tolerance is the accuracy of a
contour; here it is that of a dimension.
"""
