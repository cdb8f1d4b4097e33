// One tile of the picture: rays to pixels.
#pragma once
#include <optional>
#include <vector>

#include "frame.h"
#include "methods.h"
#include "ray/clipper.h"
#include "ray/ray_scene.h"
#include "ray/ray_shader.h"
#include "ray/section_hits.h"
#include "ray/tile_hits.h"

namespace nofacet {

// Pixels [x0, x1) x [y0, y1).
struct PixelRect {
  int x0, x1, y0, y1;
};

// Draws tiles of one frame. One per thread; memory: that of TileHits for the rays of a tile's part,
// kTileSide a side, or one pixel's.
class TilePainter {
 public:
  static constexpr int kTile = 16;  // pixels a side, at one sample

  TilePainter(const Scene& scene, const Camera& camera, const RayScene& rays, const RenderOptions& options,
              const PartTree* tree, const Frame& frame)
      : scene_(scene),
        camera_(camera),
        samples_(options.samples),
        frame_(frame),
        hits_(rays, camera),
        shader_(scene, camera, options, tree, rays.tie) {
    if (!options.sections.empty()) sections_.emplace(scene, camera, rays, options.sections);
  }

  // `patches`: those that may be seen in the tile, in a fixed order.
  void paint(const PixelRect& tile, const std::vector<const RayPatch*>& patches);

  const Clipper& clipper() const { return clipper_; }
  const RayShader& shader() const { return shader_; }
  // Null without section planes.
  const SectionHits* sections() const { return sections_ ? &*sections_ : nullptr; }

 private:
  static constexpr int kTileSide = 64;  // rays a side, at more samples

  void paint_samples(const PixelRect& tile, const std::vector<const RayPatch*>& patches);
  RayGrid trace(const PixelRect& pixels, int samples, bool normals, const std::vector<const RayPatch*>& patches);
  void write_values(const PixelRect& tile);
  void write_background(std::size_t pixel);
  void write_hit(std::size_t pixel, const RayHit& hit, const double eye_direction[3]);
  void write_color(const PixelRect& tile, const RayGrid& grid, int samples);
  void add_color(const RayHit& hit, double x, double y, double transmitted, double rgba[4]);
  void eye_direction(double x, double y, double direction[3]) const;

  const Scene& scene_;
  const Camera& camera_;
  int samples_;
  const Frame& frame_;
  TileHits hits_;
  std::optional<SectionHits> sections_;
  RayShader shader_;
  Clipper clipper_;
};

}  // namespace nofacet
