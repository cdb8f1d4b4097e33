// Section planes as one frame sees them: what they remove, and their side views.
//
// A section plane's distance is linear in homogeneous screen coordinates, so control points tell on which side of it a
// patch lies. Where a scan plane, the section plane and a surface meet is found in a side view of the section plane
// (Camera::side): there the section plane is a vertical line, scan planes are horizontals, and the key is the picture's
// x. Patches are subdivided until certified, cut by scan planes and trimmed as in any view, so every crossing is found,
// once, between two points of opposite distances.
#pragma once
#include <deque>
#include <memory>
#include <vector>

#include "methods.h"
#include "raster/frame_patches.h"

namespace nofacet {

// One section plane.
struct SectionView : SectionForm {
  KeyPlane key_plane;  // of the plane itself
  bool edge_on;        // has no area on the screen
  // Whether a surface whose Su x Sv points out of a body is entered, along the growing x, where its Jacobian in the
  // side view is positive; else where it is negative.
  bool upright;
  SidePlane side;
  Camera camera;                            // the side view
  std::unique_ptr<FramePatches> patches;    // that the plane may cut
  std::vector<std::vector<int32_t>> bands;  // of them
  bool whole;  // none of these patches reaches behind the eye: bodies are closed along every horizontal

  // Where the plane lies in the side view: at this x, of a picture twice as wide.
  static constexpr double kMiddle = 1.0;
};

class Sections {
 public:
  enum class Side : unsigned char { kept, cut, removed };

  Sections(const Scene& scene, const Camera& camera, const ScanPlanes& planes,
           const std::vector<SectionPlane>& sections, int threads);
  Sections(const Sections&) = delete;

  const Camera& camera() const { return camera_; }
  std::deque<SectionView>& views() { return views_; }
  // On which side of the planes a net lies, by its control points.
  Side side(const Net& net) const;
  // Whether some plane removes the homogeneous screen point.
  bool removes(const double point[4]) const;
  // The part of the straight line from p to q, as shares of its length, that no plane removes but for rounding; empty
  // (lo >= hi) if there is none. p, q: x, y and key.
  Interval kept_part(const double p[3], const double q[3]) const;
  // What of the stretch x of the scan plane y, on the plane of views()[view], the other planes keep; empty (lo >= hi)
  // if nothing is.
  Interval kept_stretch(std::size_t view, Interval x, double y) const;
  // A body's cap in views()[view].
  const Piece& cap(std::size_t view, int32_t body) const { return caps_[view * body_count_ + body]; }

  // What threads report: a face that is cut and has no cap, an outline with a gap.
  void report_uncapped(int thread, int32_t face) { reports_[thread].uncapped[face] = 1; }
  void report_gap(int thread) { ++reports_[thread].gaps; }
  void add_to(RenderStats& stats) const;

 private:
  struct Report {
    std::vector<uint8_t> uncapped;  // by face
    int64_t gaps = 0;
  };

  void add_caps(const Scene& scene);

  const Camera& camera_;
  std::size_t body_count_;
  std::deque<SectionView> views_;
  std::vector<Piece> caps_;
  std::vector<double> cap_nets_;
  Scene::PatchRef cap_patch_;
  std::vector<Report> reports_;
};

}  // namespace nofacet
