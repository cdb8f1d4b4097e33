"""`nofacet bench`: speed and error of exact pictures and of triangles, measured in one run on the machine at hand."""
