// Points on the drawn part of a model's faces, close enough together to fit a camera or to measure a box.
#pragma once
#include <cstddef>
#include <vector>

#include "model.h"

namespace nofacet {

// (N, 3), in the coordinates of their definitions; those of definition d are first[d] .. first[d + 1].
struct SurfacePoints {
  std::vector<double> xyz;
  std::vector<std::size_t> first;
};

// Whole patches are sampled on a grid, trimmed faces along their loops and on the grid points inside them. A bulge
// between two samples can stick out by a few per cent of the face's size, never by more.
SurfacePoints surface_points(const Model& model);

// For each of the directions (count, 3) the largest scalar product with a point of the placed faces, in the world;
// -infinity where there is none.
std::vector<double> support(const Model& model, const SurfacePoints& points, const double* directions,
                            std::size_t count);

}  // namespace nofacet
