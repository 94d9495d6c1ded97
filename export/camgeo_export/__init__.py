"""Writers of camgeo: DXF, G-code, STL, 3MF, CSV, pictures, and the machine profiles."""
