// Non-owning views of the model's arrays (src/nofacet/model.py documents shapes and meanings).
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace nofacet {

// All patches of one bidegree.
struct PatchGroup {
  int degree_u = 0, degree_v = 0;
  std::size_t count = 0;
  const double* control_points = nullptr;  // (count, degree_u + 1, degree_v + 1, 4): wx, wy, wz, w
  const int32_t* definition = nullptr;     // (count,)
  const double* domain = nullptr;          // (count, 4): u0, u1, v0, v1
  const uint8_t* angular = nullptr;        // (count, 2)
};

struct Model {
  std::vector<PatchGroup> groups;

  std::size_t definition_count = 0;
  const uint8_t* trimmed = nullptr;           // (definitions,)
  const int64_t* definition_loops = nullptr;  // (definitions + 1,)
  const int64_t* loop_offsets = nullptr;      // (loops + 1,)
  const int64_t* segment_offsets = nullptr;   // (segments + 1,)
  const double* segment_points = nullptr;     // (points, 3): wu, wv, w
  const int32_t* segment_edge = nullptr;      // (segments,)

  std::size_t face_count = 0;
  const int32_t* face_definition = nullptr;  // (faces,)
  const int32_t* face_placement = nullptr;   // (faces,)
  const double* placements = nullptr;        // (placements, 4, 4)
  const int8_t* face_outward = nullptr;      // (faces,)
  const float* face_color = nullptr;         // (faces, 4): linear RGBA

  std::size_t body_count = 0;
  const int64_t* body_offsets = nullptr;      // (bodies + 1,)
  const int32_t* body_face = nullptr;         // (uses,)
  const int8_t* body_face_outward = nullptr;  // (uses,)
  const uint8_t* body_closed = nullptr;       // (bodies,)
};

}  // namespace nofacet
