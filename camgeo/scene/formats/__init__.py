"""The declarations of file formats: names, options, needs. Their writers are in other packages."""
