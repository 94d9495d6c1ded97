"""Effect `spring`: a linear spring that closes the contact."""
