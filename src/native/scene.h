// A model prepared for drawing: what does not change from frame to frame.
#pragma once
#include <memory>
#include <vector>

#include "bezier/parameter_map.h"
#include "model.h"
#include "trim/region.h"

namespace nofacet {

struct Scene {
  struct PatchRef {
    int32_t group, index;
    ParameterMap u, v;
  };

  Model model;
  std::vector<std::unique_ptr<Region>> regions;  // per definition; null where the patches are drawn whole
  // Patches of definition d: patches[patch_offsets[d]] .. patches[patch_offsets[d + 1] - 1].
  std::vector<std::size_t> patch_offsets;
  std::vector<PatchRef> patches;

  // The closed bodies that a face bounds: face_bodies[face_body_offsets[face]] .. ; outward: +1 where Su x Sv points
  // out.
  struct BodyUse {
    int32_t body;
    int8_t outward;
  };
  std::vector<int64_t> face_body_offsets;
  std::vector<BodyUse> face_bodies;

  explicit Scene(Model m);

  // Caps of section planes are faces of their own, numbered behind the model's, so that none has another's shade.
  int32_t cap_face(int plane, int32_t body) const {
    return int32_t(model.face_count + std::size_t(plane) * model.body_count + body);
  }
  bool is_cap(int32_t face) const { return std::size_t(face) >= model.face_count; }
  // Linear RGBA of a face or a cap: a cap has the colour of most faces of its body.
  const float* color(int32_t face) const {
    if (!is_cap(face)) return model.face_color + 4 * std::size_t(face);
    return body_colors.data() + 4 * ((std::size_t(face) - model.face_count) % model.body_count);
  }
  // What the frame's face buffer says: the face, or -2 - plane for a cap.
  int32_t face_number(int32_t face) const {
    return is_cap(face) ? -2 - int32_t((std::size_t(face) - model.face_count) / model.body_count) : face;
  }

  std::vector<float> body_colors;  // (bodies, 4)

 private:
  void prepare_patches();
  void prepare_bodies();
};

}  // namespace nofacet
