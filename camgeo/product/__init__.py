"""A disc as it is made, with the view of it that each kind of file is written from."""
