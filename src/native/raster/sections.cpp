#include "raster/sections.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nofacet {
namespace {

// A plane is edge-on if its slope against the line of sight, or its distance from the eye over the model's size, is
// smaller.
constexpr double kEdgeOn = 1e-12;

}  // namespace

Sections::Sections(const Scene& scene, const Camera& camera, const ScanPlanes& planes,
                   const std::vector<SectionPlane>& sections, int threads)
    : camera_(camera), body_count_(scene.model.body_count), reports_(threads) {
  for (Report& report : reports_) report.uncapped.assign(scene.model.face_count, 0);
  const double size = model_size(scene), shift = section_shift(scene, sections);
  for (const SectionPlane& section : sections) {
    SectionView& view = views_.emplace_back();
    static_cast<SectionForm&>(view) = SectionForm(camera, section, shift * double(views_.size()));
    const double steepness =
        view.plane[kZ];  // orthographic: against the line of sight; perspective: the eye's distance
    view.key_plane = {-view.plane[kW] / steepness, -view.plane[kX] / steepness, -view.plane[kY] / steepness, 0.0};
    view.upright = steepness > 0;
    view.edge_on = !(std::fabs(steepness) > kEdgeOn * (camera.perspective ? size : 1.0));
    std::copy_n(section.normal, 3, view.side.normal);
    // Decisions are taken on the shifted plane, so that is the one that the side view shows.
    for (int c = 0; c < 3; ++c) view.side.origin[c] = section.origin[c] - view.shift * section.normal[c];
    view.side.picture_width = camera.width;
    view.side.near_right = view.key_plane.by_x < 0;
    view.camera = camera;
    view.camera.width = int(2 * SectionView::kMiddle);
    view.camera.side = &view.side;
    view.patches = std::make_unique<FramePatches>(scene, view.camera, planes, threads);
    const std::vector<PlacedPatch>& patches = view.patches->patches();
    view.bands = sort_into_bands(patches, planes);
    view.whole = std::all_of(patches.begin(), patches.end(), [](const PlacedPatch& patch) { return patch.before_eye; });
  }
  add_caps(scene);
}

// A cap is a piece that reaches a pixel beyond the picture, with the picture's x and y for its parameters.
void Sections::add_caps(const Scene& scene) {
  const double nowhere = std::numeric_limits<double>::quiet_NaN();
  cap_patch_ = {0, 0, ParameterMap(nowhere, nowhere, false), ParameterMap(nowhere, nowhere, false)};
  const Interval x{-1.0, camera_.width + 1.0}, y{-1.0, camera_.height + 1.0};
  cap_nets_.reserve(32 * views_.size());  // of each cap the net and the centred one
  for (std::size_t view = 0; view < views_.size(); ++view) {
    const KeyPlane& plane = views_[view].key_plane;
    double* points = cap_nets_.data() + cap_nets_.size();
    Piece piece{};
    piece.hull = {x, y, Interval::empty(), plane, 0.0, x};
    for (const double px : {x.lo, x.hi}) {
      for (const double py : {y.lo, y.hi}) {
        cap_nets_.insert(cap_nets_.end(), {px, py, 1.0, plane.key(px, py)});
        piece.hull.key.include(plane.key(px, py));
      }
    }
    piece.net = {1, 1, points};
    double* centred = points + 16;
    cap_nets_.resize(cap_nets_.size() + 16);
    piece.centred = centre_net(piece.net, 1.0, centred);
    piece.patch = &cap_patch_;
    piece.s1 = piece.t1 = 1.0;
    piece.rising = piece.planar = true;
    piece.kind = CutKind::regular;
    piece.key_slope = {plane.by_x * x.width(), plane.by_x * x.width()};
    piece.shears = {plane.by_x, plane.by_x};
    for (std::size_t body = 0; body < body_count_; ++body) {
      piece.face = scene.cap_face(int(view), int32_t(body));
      caps_.push_back(piece);
    }
  }
}

Sections::Side Sections::side(const Net& net) const {
  Side side = Side::kept;
  for (const SectionView& view : views_) {
    Interval range = Interval::empty();
    for (const double *p = net.points, *end = p + net.size(); p != end; p += 4)
      range.include(SectionForm::value(view.inner, p));
    if (range.lo > 0) return Side::removed;
    if (range.hi > 0) side = Side::cut;
  }
  return side;
}

bool Sections::removes(const double point[4]) const {
  return std::any_of(views_.begin(), views_.end(),
                     [&](const SectionView& view) { return SectionForm::value(view.inner, point) > 0; });
}

Interval Sections::kept_part(const double p[3], const double q[3]) const {
  Interval part{0.0, 1.0};
  for (const SectionView& view : views_) {
    const double from = SectionForm::value(view.outer, p[0], p[1], p[2]),
                 to = SectionForm::value(view.outer, q[0], q[1], q[2]);
    if (from > 0 && to > 0) return {1.0, 0.0};
    if (from > 0) part.lo = std::max(part.lo, from / (from - to));
    if (to > 0) part.hi = std::min(part.hi, from / (from - to));
  }
  return part;
}

Interval Sections::kept_stretch(std::size_t view, Interval x, double y) const {
  const double* own = views_[view].inner;
  const auto key = [&](double at) { return -(own[kX] * at + own[kY] * y + own[kW]) / own[kZ]; };
  for (std::size_t k = 0; k < views_.size(); ++k) {
    if (k == view) continue;
    const double from = SectionForm::value(views_[k].inner, x.lo, y, key(x.lo)),
                 to = SectionForm::value(views_[k].inner, x.hi, y, key(x.hi));
    if (from > 0 && to > 0) return Interval::empty();
    const double end = x.lo + from / (from - to) * x.width();
    if (from > 0) x.lo = end;
    if (to > 0) x.hi = end;
  }
  return x;
}

void Sections::add_to(RenderStats& stats) const {
  for (const SectionView& view : views_) {
    const FramePatches& patches = *view.patches;
    stats.pieces += patches.piece_count();
    stats.unresolved += patches.unresolved();
    for (const int32_t face : patches.unresolved_faces()) stats.unresolved_faces.push_back(face);
  }
  std::sort(stats.unresolved_faces.begin(), stats.unresolved_faces.end());
  const auto last = std::unique(stats.unresolved_faces.begin(), stats.unresolved_faces.end());
  stats.unresolved_faces.erase(last, stats.unresolved_faces.end());
  for (const Report& report : reports_) stats.section_gaps += report.gaps;
  const std::size_t faces = reports_.empty() ? 0 : reports_[0].uncapped.size();
  for (std::size_t face = 0; face < faces; ++face) {
    if (std::any_of(reports_.begin(), reports_.end(), [&](const Report& report) { return report.uncapped[face]; })) {
      stats.uncapped_faces.push_back(int32_t(face));
    }
  }
}

}  // namespace nofacet
