#include "extent.h"

#include <algorithm>
#include <limits>

#include "bezier/bernstein.h"
#include "bezier/parameter_map.h"

namespace nofacet {
namespace {

constexpr int kGrid = 5;  // samples along a curved side of a patch: a quarter circle bulges 2 % of its radius there
constexpr int kCoarseGrid = 2;  // the same in groups of many patches, which are small parts of their faces: the corners
constexpr std::size_t kManyPatches = 10'000;
constexpr int kLoopSamples = 4;                // samples on a curved trim segment, its start included
constexpr std::size_t kManyPairs = 4'000'000;  // (loop corner, patch) pairs of one face, then drawn whole
// A loop's corner is on a patch where it is outside by no more than this part of the patch.
constexpr double kBeside = 1e-6;

struct Corner {
  double u, v, next_u, next_v;  // the edge of the polygon that starts here
};

// The loops of one definition as polygons, sorted into bins by v.
class Polygons {
 public:
  void read(const Model& model, std::size_t definition);
  const std::vector<Corner>& corners() const { return corners_; }
  bool contains(double u, double v) const;

 private:
  std::vector<Corner> corners_;
  std::vector<std::size_t> offsets_, next_;
  std::vector<int32_t> members_;
  double low_ = 0.0, per_v_ = 0.0;
  int bins_ = 0;

  void fill_bins();
  int bin(double v) const { return std::clamp(int((v - low_) * per_v_), 0, bins_ - 1); }
};

void Polygons::read(const Model& model, std::size_t definition) {
  corners_.clear();
  for (int64_t loop = model.definition_loops[definition]; loop < model.definition_loops[definition + 1]; ++loop) {
    const std::size_t begin = corners_.size();
    for (int64_t k = model.loop_offsets[loop]; k < model.loop_offsets[loop + 1]; ++k) {
      const int degree = int(model.segment_offsets[k + 1] - model.segment_offsets[k]) - 1;
      const double* points = model.segment_points + 3 * model.segment_offsets[k];
      const int samples = degree == 1 ? 1 : kLoopSamples;
      for (int s = 0; s < samples; ++s) {
        double basis[kMaxPolynomial + 1], p[3] = {0, 0, 0};
        bernstein_basis(degree, double(s) / samples, basis);
        for (int i = 0; i <= degree; ++i) {
          for (int c = 0; c < 3; ++c) p[c] += basis[i] * points[3 * i + c];
        }
        corners_.push_back({p[0] / p[2], p[1] / p[2], 0, 0});
      }
    }
    for (std::size_t k = begin; k < corners_.size(); ++k) {
      const Corner& next = corners_[k + 1 < corners_.size() ? k + 1 : begin];
      corners_[k].next_u = next.u, corners_[k].next_v = next.v;
    }
  }
  fill_bins();
}

void Polygons::fill_bins() {
  bins_ = int(std::min<std::size_t>(corners_.size(), 1024));
  if (!bins_) return;
  double high = low_ = corners_[0].v;
  for (const Corner& c : corners_) low_ = std::min(low_, c.v), high = std::max(high, c.v);
  per_v_ = high > low_ ? bins_ / (high - low_) : 0.0;
  offsets_.assign(bins_ + 1, 0);
  auto each_bin = [&](auto&& visit) {
    for (std::size_t k = 0; k < corners_.size(); ++k) {
      const int from = bin(corners_[k].v), to = bin(corners_[k].next_v);
      for (int b = std::min(from, to); b <= std::max(from, to); ++b) visit(b, k);
    }
  };
  each_bin([&](int b, std::size_t) { ++offsets_[b + 1]; });
  for (int b = 0; b < bins_; ++b) offsets_[b + 1] += offsets_[b];
  members_.resize(offsets_[bins_]);
  next_.assign(offsets_.begin(), offsets_.end() - 1);
  each_bin([&](int b, std::size_t k) { members_[next_[b]++] = int32_t(k); });
}

// The even-odd rule.
bool Polygons::contains(double u, double v) const {
  if (!bins_) return false;
  bool inside = false;
  const int b = bin(v);
  for (std::size_t k = offsets_[b]; k < offsets_[b + 1]; ++k) {
    const Corner& c = corners_[members_[k]];
    if ((c.v > v) != (c.next_v > v)) inside ^= u < c.u + (v - c.v) * ((c.next_u - c.u) / (c.next_v - c.v));
  }
  return inside;
}

struct PatchRef {
  int32_t group, index;
};

// Patches by definition, in the order of the groups; offsets (definitions + 1,).
std::vector<PatchRef> patches_by_definition(const Model& model, std::vector<std::size_t>* offsets) {
  offsets->assign(model.definition_count + 1, 0);
  for (const PatchGroup& group : model.groups) {
    for (std::size_t k = 0; k < group.count; ++k) ++(*offsets)[group.definition[k] + 1];
  }
  for (std::size_t d = 0; d < model.definition_count; ++d) (*offsets)[d + 1] += (*offsets)[d];
  std::vector<PatchRef> patches(offsets->back());
  std::vector<std::size_t> next(offsets->begin(), offsets->end() - 1);
  for (std::size_t g = 0; g < model.groups.size(); ++g) {
    const PatchGroup& group = model.groups[g];
    for (std::size_t k = 0; k < group.count; ++k) patches[next[group.definition[k]]++] = {int32_t(g), int32_t(k)};
  }
  return patches;
}

// Patch parameters of the grid along one side, and the Bernstein basis at each.
struct Samples {
  int count = 0, degree = 0;
  double s[kGrid], basis[kGrid][kMaxDegree + 1];

  Samples(int patch_degree, bool coarse) : count(patch_degree == 1 || coarse ? kCoarseGrid : kGrid) {
    degree = patch_degree;
    for (int k = 0; k < count; ++k) {
      s[k] = double(k) / (count - 1);
      bernstein_basis(degree, s[k], basis[k]);
    }
  }
};

class Sampler {
 public:
  Sampler(const Model& model, SurfacePoints* result) : model_(model), xyz_(&result->xyz) {
    for (const PatchGroup& group : model.groups) {
      const bool coarse = group.count > kManyPatches;
      samples_.push_back({Samples(group.degree_u, coarse), Samples(group.degree_v, coarse)});
    }
  }

  // Samples patches [first, last) of one definition, all in one group.
  void add(std::size_t definition, const PatchRef* first, const PatchRef* last) {
    const PatchGroup& group = model_.groups[first->group];
    const std::size_t corners = polygons_.corners().size();
    // With very many pairs each patch is a small part of the face, and all of it is taken.
    const bool trimmed = model_.trimmed[definition] && corners * std::size_t(last - first) <= kManyPairs;
    const bool flat = group.degree_u == 1 && group.degree_v == 1;  // reaches no further than its border
    if (!trimmed || !flat) {
      for (const PatchRef* patch = first; patch != last; ++patch) add_grid(group, *patch, trimmed);
    }
    if (trimmed) add_border(group, first, last);
  }

  void read_loops(std::size_t definition) { polygons_.read(model_, definition); }

 private:
  const Model& model_;
  std::vector<double>* xyz_;
  std::vector<std::pair<Samples, Samples>> samples_;
  Polygons polygons_;

  void push(const double* p) { xyz_->insert(xyz_->end(), {p[0] / p[3], p[1] / p[3], p[2] / p[3]}); }

  void add_grid(const PatchGroup& group, PatchRef patch, bool trimmed) {
    const auto& [along_u, along_v] = samples_[patch.group];
    const int rows = group.degree_u + 1, columns = group.degree_v + 1;
    const double* points = group.control_points + 4 * std::size_t(rows * columns) * patch.index;
    const double* domain = group.domain + 4 * std::size_t(patch.index);
    const uint8_t* angular = group.angular + 2 * std::size_t(patch.index);
    const ParameterMap u(domain[0], domain[1], angular[0]), v(domain[2], domain[3], angular[1]);
    for (int a = 0; a < along_u.count; ++a) {
      double curve[4 * (kMaxDegree + 1)] = {0};
      for (int i = 0; i < rows; ++i) {
        const double b = along_u.basis[a][i];
        for (int k = 0; k < 4 * columns; ++k) curve[k] += b * points[4 * columns * i + k];
      }
      for (int s = 0; s < along_v.count; ++s) {
        if (trimmed && !polygons_.contains(u.face_from_patch(along_u.s[a]), v.face_from_patch(along_v.s[s]))) continue;
        double p[4] = {0, 0, 0, 0};
        for (int j = 0; j < columns; ++j) {
          for (int c = 0; c < 4; ++c) p[c] += along_v.basis[s][j] * curve[4 * j + c];
        }
        push(p);
      }
    }
  }

  // The loops' corners, each on the patch that it is in or all but in.
  void add_border(const PatchGroup& group, const PatchRef* first, const PatchRef* last) {
    const PatchRef* near = first;
    for (const Corner& corner : polygons_.corners()) {
      // Neighbouring corners mostly share a patch.
      double least = outside(group, *near, corner);
      for (const PatchRef* patch = first; least > 0.0 && patch != last; ++patch) {
        const double distance = outside(group, *patch, corner);
        if (distance < least) least = distance, near = patch;
      }
      const double* domain = group.domain + 4 * std::size_t(near->index);
      if (least <= kBeside * std::max(domain[1] - domain[0], domain[3] - domain[2])) add_point(group, *near, corner);
    }
  }

  // How far a corner is outside a patch's box, in the face's parameters; 0 or less inside.
  static double outside(const PatchGroup& group, PatchRef patch, const Corner& corner) {
    const double* domain = group.domain + 4 * std::size_t(patch.index);
    return std::max(std::max(domain[0] - corner.u, corner.u - domain[1]),
                    std::max(domain[2] - corner.v, corner.v - domain[3]));
  }

  void add_point(const PatchGroup& group, PatchRef patch, const Corner& corner) {
    const double* domain = group.domain + 4 * std::size_t(patch.index);
    const uint8_t* angular = group.angular + 2 * std::size_t(patch.index);
    const int rows = group.degree_u + 1, columns = group.degree_v + 1;
    const double* points = group.control_points + 4 * std::size_t(rows * columns) * patch.index;
    double in_u[kMaxDegree + 1], in_v[kMaxDegree + 1], p[4] = {0, 0, 0, 0};
    bernstein_basis(group.degree_u, patch_parameter(domain, angular[0], corner.u), in_u);
    bernstein_basis(group.degree_v, patch_parameter(domain + 2, angular[1], corner.v), in_v);
    for (int i = 0; i < rows; ++i) {
      for (int j = 0; j < columns; ++j) {
        for (int c = 0; c < 4; ++c) p[c] += in_u[i] * in_v[j] * points[4 * (columns * i + j) + c];
      }
    }
    push(p);
  }

  static double patch_parameter(const double* ends, bool angular, double u) {
    return ends[0] == ends[1] ? 0.0 : ParameterMap(ends[0], ends[1], angular).patch_from_face(u);
  }
};

}  // namespace

SurfacePoints surface_points(const Model& model) {
  SurfacePoints result;
  std::vector<std::size_t> offsets;
  const std::vector<PatchRef> patches = patches_by_definition(model, &offsets);
  Sampler sampler(model, &result);
  result.first.push_back(0);
  for (std::size_t d = 0; d < model.definition_count; ++d) {
    if (model.trimmed[d]) sampler.read_loops(d);
    const PatchRef* end = patches.data() + offsets[d + 1];
    for (const PatchRef* first = patches.data() + offsets[d]; first != end;) {
      const PatchRef* last = std::find_if(first, end, [&](PatchRef patch) { return patch.group != first->group; });
      sampler.add(d, first, last);
      first = last;
    }
    result.first.push_back(result.xyz.size() / 3);
  }
  return result;
}

std::vector<double> support(const Model& model, const SurfacePoints& points, const double* directions,
                            std::size_t count) {
  std::vector<double> result(count, -std::numeric_limits<double>::infinity());
  for (std::size_t f = 0; f < model.face_count; ++f) {
    const double* m = model.placements + 16 * std::size_t(model.face_placement[f]);
    const std::size_t definition = std::size_t(model.face_definition[f]);
    for (std::size_t k = 0; k < count; ++k) {
      const double* d = directions + 3 * k;
      double own[4];  // the direction seen from the definition, and what its origin adds
      for (int c = 0; c < 4; ++c) own[c] = d[0] * m[c] + d[1] * m[4 + c] + d[2] * m[8 + c];
      double most = -std::numeric_limits<double>::infinity();
      for (std::size_t p = points.first[definition]; p < points.first[definition + 1]; ++p) {
        const double* x = points.xyz.data() + 3 * p;
        most = std::max(most, own[0] * x[0] + own[1] * x[1] + own[2] * x[2]);
      }
      result[k] = std::max(result[k], most + own[3]);
    }
  }
  return result;
}

}  // namespace nofacet
