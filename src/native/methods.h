// The interface of a rendering method and the one table of them.
#pragma once
#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "camera.h"
#include "frame.h"
#include "scene.h"
#include "section_plane.h"

namespace nofacet {

struct RenderOptions {
  int samples = 4;  // for colour and coverage: scan planes a pixel row, or rays a pixel's side
  int threads = 1;
  bool edges = false;
  bool shadows = false;      // only methods that cast secondary rays
  double reflectance = 0.0;  // in [0, 1); the same
  std::vector<SectionPlane> sections;
  // Not owned, may be null. Once true, the method returns before it begins another band; the frame is then unfinished.
  const std::atomic<bool>* cancel = nullptr;

  bool cancelled() const { return cancel && cancel->load(); }
};

// What a frame cost and met. Seconds are wall-clock, summed over the threads.
struct RenderStats {
  double project_seconds = 0.0, subdivide_seconds = 0.0, span_seconds = 0.0, visibility_seconds = 0.0,
         shade_seconds = 0.0, average_seconds = 0.0, trace_seconds = 0.0, edge_seconds = 0.0;
  int64_t pieces = 0;
  int64_t unresolved = 0;  // pieces left out because they could not be certified; 0 in a sound frame
  std::vector<int32_t> unresolved_faces;
  // Faces cut by section planes that bound no closed body: there are no caps there.
  std::vector<int32_t> uncapped_faces;
  int64_t section_gaps = 0;  // closed outlines of caps that a scan plane met an odd number of times
};

struct Method {
  const char* name;
  bool secondary_rays;  // whether it can cast shadows and mirror
  RenderStats (*render)(const Scene&, const Camera&, const RenderOptions&, const Frame&);
};

RenderStats render_bezier_clip_scanline(const Scene&, const Camera&, const RenderOptions&, const Frame&);
RenderStats render_bezier_clip_ray(const Scene&, const Camera&, const RenderOptions&, const Frame&);

const std::vector<Method>& methods();
// Null if there is none of that name.
const Method* find_method(const std::string& name);

}  // namespace nofacet
