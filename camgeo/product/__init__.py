"""A finished disc, with the view of it from which each kind of file is written."""
