// The floor under a frame's time: what evaluating the frame's own visible samples costs when their places are known.
#pragma once
#include <cstddef>
#include <cstdint>

#include "scene.h"

namespace nofacet {

struct FloorResult {
  double seconds = 0.0;   // of the fastest repeat
  int64_t samples = 0;    // pixels that show a face
  double checksum = 0.0;  // sum of position . normal: nothing else leaves the loop
};

// Evaluates position, both derivatives and unit normal at every pixel with a face, from the (u, v) shown there:
// rational Bezier patches in Bernstein form, double, in SIMD lanes, on one thread, nothing written. Placing the control
// points and sorting the samples by patch is done before and not timed. `face` and `uv`: a frame's buffers of `pixels`
// entries.
FloorResult measure_floor(const Scene& scene, const int32_t* face, const double* uv, std::size_t pixels, int repeats);

}  // namespace nofacet
