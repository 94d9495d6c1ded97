"""What the file formats declare: names, options, needs. What writes them is in other packages."""
