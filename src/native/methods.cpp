#include "methods.h"

namespace nofacet {

const std::vector<Method>& methods() {
  static const std::vector<Method> table = {
      {"bezier_clip_scanline", false, render_bezier_clip_scanline},
      {"bezier_clip_ray", true, render_bezier_clip_ray},
  };
  return table;
}

const Method* find_method(const std::string& name) {
  for (const Method& method : methods()) {
    if (name == method.name) return &method;
  }
  return nullptr;
}

}  // namespace nofacet
