// The B-rep's edges as fine anti-aliased lines over the finished picture.
#pragma once
#include <vector>

#include "camera.h"
#include "frame.h"
#include "scene.h"

namespace nofacet {

class Sections;

// Draws every edge of every face that the frame's depth does not hide into frame.color (coverage is left alone, alpha
// grows where a line reaches over the outline). Needs frame.color and frame.depth. The lines follow each face's trim
// curves on its surface, flattened to 0.05 px; they decorate the picture and carry no value.
// `sections`: which cut the edges off; null: none.
void draw_edge_lines(const Scene& scene, const Camera& camera, int threads, const Frame& frame,
                     const Sections* sections = nullptr);

}  // namespace nofacet
