"""The window of nofacet: the exact picture beside OpenCascade's triangles, under one camera."""
