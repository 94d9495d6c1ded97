"""Effect `camshaft-windup`: torsion of the camshaft between its drive and the cam."""
