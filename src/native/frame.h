// Non-owning views of the frame's buffers; a null pointer is a buffer that was not asked for. Row 0 is at the top.
#pragma once
#include <cstdint>

namespace nofacet {

struct Frame {
  int width = 0, height = 0;
  float* color = nullptr;     // (height, width, 4): linear RGBA, alpha premultiplied
  float* coverage = nullptr;  // (height, width)
  double* depth = nullptr;    // (height, width), +inf on background
  int32_t* face = nullptr;    // (height, width), -1 on background
  double* uv = nullptr;       // (height, width, 2)
  float* normal = nullptr;    // (height, width, 3), world, towards the eye

  bool needs_values() const { return depth || face || uv || normal; }
};

}  // namespace nofacet
