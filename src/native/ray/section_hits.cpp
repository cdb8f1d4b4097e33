#include "ray/section_hits.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "raster/screen_jet.h"

namespace nofacet {
namespace {

// Roots on the border of two parts of a patch are found twice, this close in the patch's parameters.
constexpr double kSameRoot = 1e-7;

}  // namespace

SectionHits::SectionHits(const Scene& scene, const Camera& camera, const RayScene& rays,
                         const std::vector<SectionPlane>& sections)
    : scene_(scene), camera_(camera), rays_(rays), uncapped_(scene.model.face_count) {
  const double nowhere = std::numeric_limits<double>::quiet_NaN(), shift = section_shift(scene, sections);
  cap_patch_ = {0, 0, ParameterMap(nowhere, nowhere, false), ParameterMap(nowhere, nowhere, false)};
  for (const SectionPlane& section : sections) {
    const int32_t plane = int32_t(forms_.size());
    const SectionForm& form = forms_.emplace_back(camera, section, shift * (plane + 1));
    const double facing = form.plane[kZ] > 0 ? -1.0 : 1.0;
    normals_.push_back({facing * Camera::dot(section.normal, camera.right),
                        facing * Camera::dot(section.normal, camera.up),
                        facing * Camera::dot(section.normal, camera.forward)});
    for (std::size_t body = 0; body < scene.model.body_count; ++body) {
      caps_.push_back(
          {{}, &cap_patch_, nullptr, scene.cap_face(plane, int32_t(body)), camera.perspective, {}, {}, 0, 0});
    }
  }
}

void SectionHits::add(const RayPatch& patch, const Region* region, const SolvedRays& solved) {
  const Scene::PatchRef& ref = *patch.patch;
  for (int k = 0; k < solved.count; ++k) {
    if (region && !region->contains(ref.u.face_from_patch(solved.s_in[k]), ref.v.face_from_patch(solved.t_in[k]))) {
      continue;
    }
    const double jacobian = ScreenJet(evaluate(patch.net, solved.s_in[k], solved.t_in[k])).jacobian();
    hits_.push_back({int(solved.ray[k]),
                     jacobian > 0,
                     {&patch,
                      solved.depth[k],
                      solved.s[k],
                      solved.t[k],
                      {solved.normal[0][k], solved.normal[1][k], solved.normal[2][k]}}});
  }
}

void SectionHits::resolve(const RayGrid& grid, TileHits& shown) {
  std::stable_sort(hits_.begin(), hits_.end(), [](const Hit& p, const Hit& q) {
    return std::tie(p.ray, p.hit.patch->face, p.hit.patch, p.hit.depth) <
           std::tie(q.ray, q.hit.patch->face, q.hit.patch, q.hit.depth);
  });
  drop_doubles();
  for (std::size_t first = 0, last = 0; first < hits_.size(); first = last) {
    const int ray = hits_[first].ray;
    while (last < hits_.size() && hits_[last].ray == ray) ++last;
    resolve_ray(hits_.data() + first, hits_.data() + last, grid.x(ray % grid.columns), grid.y(ray / grid.columns), grid,
                shown);
  }
}

void SectionHits::drop_doubles() {
  const auto same = [&](const Hit& p, const Hit& q) {
    return p.ray == q.ray && p.hit.patch == q.hit.patch && p.upright == q.upright &&
           std::fabs(p.hit.s - q.hit.s) < kSameRoot && std::fabs(p.hit.t - q.hit.t) < kSameRoot;
  };
  hits_.erase(std::unique(hits_.begin(), hits_.end(), same), hits_.end());
}

void SectionHits::resolve_ray(const Hit* first, const Hit* last, double x, double y, const RayGrid& grid,
                              TileHits& shown) {
  borders_.clear();
  for (const Hit* hit = first; hit != last; ++hit) {
    const int32_t face = hit->hit.patch->face;
    const int64_t from = scene_.face_body_offsets[face], to = scene_.face_body_offsets[face + 1];
    for (int64_t k = from; k < to; ++k) {
      const bool leaves = hit->upright == (scene_.face_bodies[k].outward > 0);
      borders_.push_back({scene_.face_bodies[k].body, leaves ? 1 : -1, hit->hit.depth});
    }
    const auto removes = [&](const SectionForm& form) {
      return SectionForm::value(form.inner, x, y, key(hit->hit.depth)) > 0;
    };
    if (std::none_of(forms_.begin(), forms_.end(), removes)) {
      shown.show(hit->ray, hit->hit);
    } else if (from == to) {
      uncapped_[face] = 1;
    }
  }
  std::sort(borders_.begin(), borders_.end(),
            [](const Border& p, const Border& q) { return std::tie(p.body, p.depth) < std::tie(q.body, q.depth); });
  for (std::size_t plane = 0; plane < forms_.size(); ++plane) add_caps(plane, first->ray, x, y, grid, shown);
}

// Shows the caps that the ray meets in a plane.
void SectionHits::add_caps(std::size_t plane, int ray, double x, double y, const RayGrid& grid, TileHits& shown) {
  const double depth = depth_on(forms_[plane].inner, x, y);
  if (!std::isfinite(depth) || (camera_.perspective && depth <= 0)) return;
  for (std::size_t k = 0; k < forms_.size(); ++k) {
    if (k != plane && SectionForm::value(forms_[k].inner, x, y, key(depth)) > 0) return;
  }
  for (std::size_t first = 0, last = 0; first < borders_.size(); first = last) {
    const int32_t body = borders_[first].body;
    int winding = 0;
    for (; last < borders_.size() && borders_[last].body == body; ++last) {
      if (borders_[last].depth > depth) winding += borders_[last].winds;
    }
    if (winding == 0) continue;
    const RayPatch& cap = caps_[plane * scene_.model.body_count + body];
    const double at = depth_on(forms_[plane].plane, x - grid.shift_x, y - grid.shift_y);
    shown.show(ray, {&cap, at, 0.0, 0.0, {normals_[plane][0], normals_[plane][1], normals_[plane][2]}});
  }
}

double SectionHits::depth_on(const double form[4], double x, double y) const {
  return camera_.depth(-(form[kX] * x + form[kY] * y + form[kW]) / form[kZ]);
}

}  // namespace nofacet
