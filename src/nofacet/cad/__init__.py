"""From CAD files to plain arrays: the only part of the package that imports OpenCascade (OCP)."""
