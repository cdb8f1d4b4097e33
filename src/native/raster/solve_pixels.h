// The surface at many pixel centres: Newton's method with a pixel in each SIMD lane, shaded and written at once.
#pragma once
#include <vector>

#include "frame.h"
#include "raster/span.h"

namespace nofacet {

// The pixels [first, last) of a row, whose centres lie on the span.
struct PixelJob {
  const Span* span;
  int32_t row, first, last;
};

// A pixel to be solved by itself, and what is still to be written of it: no buffer may depend on which others are
// wanted.
struct HardPixel {
  const Span* span;
  int32_t row, px;
  bool values, normal, uv;  // depth and colour; normal; uv
};

// Solves jobs that all lie on `piece` and writes the frame's buffers there; `color` gets the shade with alpha 1.
// A pixel is accepted when the second-order remainder of its last Newton step is below kPixelTolerance, in x, y and
// depth, and it lies on its span's part of the piece, where the certificate allows one solution only. The rest is
// appended to `hard` and left unwritten or wrong.
void solve_pixels(const Scene& scene, const Camera& camera, const Frame& frame, const Piece& piece,
                  const PixelJob* jobs, std::size_t count, std::vector<HardPixel>& hard);

// Solves one pixel, whatever it takes, and writes it.
void solve_hard_pixel(const Scene& scene, const Camera& camera, const Frame& frame, const HardPixel& pixel);

inline constexpr double kPixelTolerance = 1e-11;
// Largest change of direction, in radians, of the tangents that a normal is made of, as stored and for shading.
inline constexpr double kNormalTolerance = 3e-8, kShadeTolerance = 1e-4;

}  // namespace nofacet
