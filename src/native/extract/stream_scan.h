// One pass over OpenCascade's binary serialisation of a shape (BinTools, format version 4): where the records of curves
// and surfaces start, and the topology as columns.
//
// The format is little-endian and packed. All functions throw std::out_of_range where the bytes end too early and
// std::invalid_argument where they hold a record of an unknown kind. Records count from 1; entry 0 of each column
// stands for none.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "extract/byte_reader.h"

namespace nofacet {

// Curves: where each record starts; the kind of the curve itself, if it is trimmed; the byte after that kind.
struct CurveScan {
  std::vector<int64_t> start{0};
  std::vector<uint8_t> kind{0};
  std::vector<int64_t> at{0};
};

// The same of surfaces. profiles: the curves of swept surfaces; profile: each surface's, 0 for none.
struct SurfaceScan {
  std::vector<int64_t> start{0};
  std::vector<uint8_t> kind{0};
  std::vector<int64_t> at{0};
  CurveScan profiles;
  std::vector<int64_t> profile{0};
};

// The shapes (src/nofacet/cad/stream.py says what the columns mean). Run k of `..._offsets` is offsets[k] ..
// offsets[k + 1].
struct ShapeScan {
  std::vector<uint8_t> kinds{0};

  std::vector<int64_t> child_offsets{0, 0};
  std::vector<uint8_t> child_orientation;
  std::vector<int64_t> child_shape, child_location;

  std::vector<int64_t> face_surface, face_location, face_triangulation;

  std::vector<double> edge_tolerance;
  std::vector<uint8_t> edge_degenerated;
  std::vector<int64_t> edge_curve, edge_location;
  std::vector<double> edge_first, edge_last;

  std::vector<int64_t> pcurve_offsets{0, 0};
  std::vector<int64_t> pcurve_curve, pcurve_second, pcurve_surface, pcurve_location;
  std::vector<double> pcurve_first, pcurve_last;
};

// Each reads `count` records from byte *at on and leaves *at behind them. dim: of the space that the curves are in.
CurveScan scan_curves(Bytes bytes, int dim, std::size_t count, std::size_t* at);
SurfaceScan scan_surfaces(Bytes bytes, std::size_t count, std::size_t* at);
ShapeScan scan_shapes(Bytes bytes, std::size_t count, std::size_t* at);

}  // namespace nofacet
