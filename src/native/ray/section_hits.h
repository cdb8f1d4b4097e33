// What section planes leave of all points in which the rays of a tile meet surfaces, and the caps.
//
// A ray is inside a body at a point if beyond it the body is left more often than it is entered.
#pragma once
#include <array>
#include <vector>

#include "ray/tile_hits.h"
#include "section_plane.h"

namespace nofacet {

// One per thread. Memory: 80 bytes a hit of the tile.
class SectionHits final : public HitSink {
 public:
  SectionHits(const Scene& scene, const Camera& camera, const RayScene& rays,
              const std::vector<SectionPlane>& sections);

  void reset() { hits_.clear(); }
  // Hands what the rays of the grid show to `shown`. To be called when all patches have been traced.
  void resolve(const RayGrid& grid, TileHits& shown);
  // Faces that were cut and bound no closed body, by face.
  const std::vector<uint8_t>& uncapped() const { return uncapped_; }

  bool hidden(double) const override { return false; }
  const double* farthest() const override { return nullptr; }
  void add(const RayPatch& patch, const Region* region, const SolvedRays& solved) override;

 private:
  struct Hit {
    int ray;
    bool upright;  // Su x Sv points away from the eye
    RayHit hit;
  };
  struct Border {
    int32_t body;
    int winds;
    double depth;
  };

  void drop_doubles();
  void resolve_ray(const Hit* first, const Hit* last, double x, double y, const RayGrid& grid, TileHits& shown);
  void add_caps(std::size_t plane, int ray, double x, double y, const RayGrid& grid, TileHits& shown);
  double key(double depth) const { return camera_.perspective ? -1.0 / depth : depth; }
  double depth_on(const double form[4], double x, double y) const;

  const Scene& scene_;
  const Camera& camera_;
  const RayScene& rays_;
  std::vector<SectionForm> forms_;
  std::vector<RayPatch> caps_;                  // by plane and body
  std::vector<std::array<double, 3>> normals_;  // of the planes, eye space, towards the eye
  Scene::PatchRef cap_patch_;
  std::vector<Hit> hits_;
  std::vector<Border> borders_;
  std::vector<uint8_t> uncapped_;
};

}  // namespace nofacet
