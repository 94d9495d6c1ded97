"""Writers of camgeo: DXF, G-code, STL, 3MF, STEP, CSV, pictures, and the machine profiles."""
