#include "raster/row.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "raster/shade.h"

namespace nofacet {

RowPainter::RowPainter(const Scene& scene, const Camera& camera, const ScanPlanes& planes, double tie,
                       const Frame& frame)
    : scene_(scene), camera_(camera), planes_(planes), tie_(tie), frame_(frame) {
  const std::size_t width = frame.width;
  depth_.resize(width);
  sample_.resize(width);
  piece_.resize(width);
  centre_rgb_.resize(3 * width);
  rgb_.resize(3 * width);
  alpha_.resize(width);
  coverage_.resize(width);
  sample_cuts_.resize(planes.samples() + 2);
  sample_index_.assign(planes.samples() + 2, -2);
}

void RowPainter::paint(int row, const std::vector<const Piece*>& pieces) {
  std::fill(piece_.begin(), piece_.end(), nullptr);
  if (planes_.centre()) {
    if (planes_.centre_is_sample()) {
      solve_values(sample_cut(int64_t(row) * planes_.samples() + planes_.samples() / 2, pieces), row);
    } else {
      centre_cut_.intersect(pieces, planes_.centre_y(row), scene_, camera_, tie_);
      solve_values(centre_cut_, row);
    }
    write_values(row);
  }
  if (!frame_.color && !frame_.coverage) return;
  std::fill(rgb_.begin(), rgb_.end(), 0.0);
  std::fill(alpha_.begin(), alpha_.end(), 0.0);
  std::fill(coverage_.begin(), coverage_.end(), 0.0);
  collect_cuts(row, pieces);
  for (std::size_t k = 1; k + 1 < cuts_.size(); ++k) {
    // Each plane stands for the strip of the row that is nearest to it.
    const double y = cuts_[k]->y - kSampleShiftY;
    const double above = 0.5 * (y + cuts_[k - 1]->y - kSampleShiftY);
    const double below = 0.5 * (y + cuts_[k + 1]->y - kSampleShiftY);
    const double weight = std::min(below, row + 1.0) - std::max(above, double(row));
    if (!(weight > 0.0)) continue;
    if (cuts_[k]->transparent.empty()) {
      for (const VisibleSegment& segment : cuts_[k]->segments) accumulate(segment, weight);
    } else {
      accumulate_layers(*cuts_[k], weight);
    }
  }
  write_color(row);
}

// The cut by one of the frame's sample planes, or an empty one outside the frame.
const PlaneCut& RowPainter::sample_cut(int64_t index, const std::vector<const Piece*>& pieces) {
  const std::size_t slot = std::size_t(index + 1) % sample_cuts_.size();
  PlaneCut& cut = sample_cuts_[slot];
  if (sample_index_[slot] != index) {
    cut.intersect(pieces, planes_.sample_y(index), scene_, camera_, tie_);
    sample_index_[slot] = index;
  }
  return cut;
}

// The row's sample planes, the last of the row above and the first of the row below, and planes added between where
// coverage jumps from one to the next.
void RowPainter::collect_cuts(int row, const std::vector<const Piece*>& pieces) {
  cuts_.clear();
  level_count_ = 0;
  const int64_t first = int64_t(row) * planes_.samples() - 1, last = first + planes_.samples() + 1;
  if (!planes_.locates_level_edges()) {
    // The neighbours only bound the outer strips.
    edge_cuts_[0].y = planes_.sample_y(first), edge_cuts_[1].y = planes_.sample_y(last);
    cuts_.push_back(&edge_cuts_[0]);
    for (int64_t k = first + 1; k < last; ++k) cuts_.push_back(&sample_cut(k, pieces));
    cuts_.push_back(&edge_cuts_[1]);
    return;
  }
  cuts_.push_back(&sample_cut(first, pieces));
  for (int64_t k = first + 1; k <= last; ++k) {
    const PlaneCut& next = sample_cut(k, pieces);
    locate_level_edges(*cuts_.back(), next, pieces);
    cuts_.push_back(&next);
  }
}

// A level edge hides or shows a stretch of x at once, and no number of equal strips places it well: halve the gap
// between the planes until it lies in a strip of 1 / kLevelSteps.
void RowPainter::locate_level_edges(const PlaneCut& above, const PlaneCut& below,
                                    const std::vector<const Piece*>& pieces) {
  constexpr double kLevelRun = 2.0;  // pixels; shorter stretches are no worse placed than slanted outlines
  if (longest_difference(above, below) < kLevelRun) return;
  const double y = ScanPlanes::level_y(ScanPlanes::level_step(0.5 * (above.y + below.y)));
  if (!(y > above.y && y < below.y)) return;
  if (level_count_ == level_cuts_.size()) level_cuts_.emplace_back();
  PlaneCut& middle = level_cuts_[level_count_++];
  middle.intersect(pieces, y, scene_, camera_, tie_);
  locate_level_edges(above, middle, pieces);
  cuts_.push_back(&middle);
  locate_level_edges(middle, below, pieces);
}

void RowPainter::solve_values(const PlaneCut& cut, int row) {
  std::fill(depth_.begin(), depth_.end(), INFINITY);
  for (const auto* spans : {&cut.opaque, &cut.transparent}) {
    for (const Span& span : *spans) solve_span(span, row);
  }
}

void RowPainter::solve_span(const Span& span, int row) {
  const int begin = std::max(0, int(std::ceil(std::max(span.x0, -1.0) - 0.5 - kSampleShiftX)));
  const int end = std::min(frame_.width, int(std::ceil(std::min(span.x1, frame_.width + 1.0) - 0.5 - kSampleShiftX)));
  // Runs of pixels that nothing solved so far hides for certain.
  for (int px = begin; px < end;) {
    if (span.nearest > depth_[px] + tie_) {
      ++px;
      continue;
    }
    int last = px + 1;
    while (last < end && !(span.nearest > depth_[last] + tie_)) ++last;
    solve_pixels(span, row, px, last);
    px = last;
  }
}

namespace {

// Guess at the pixel `pixels` to the right of a solved one, along the tangent of the cut.
void follow_cut(SurfaceSample* sample, double pixels) {
  const ScreenJet screen(sample->jet);
  const double scale = pixels / screen.jacobian();
  sample->a += scale * screen.yb;
  sample->b -= scale * screen.ya;
}

constexpr int kShortRun = 6;  // pixels; solved one after the other
constexpr double kStepTolerance = 1e-7;

}  // namespace

// Solves the pixels [first, last): one in PixelRun::kCapacity by itself, those between from cubic guesses, together.
void RowPainter::solve_pixels(const Span& span, int row, int first, int last) {
  const double fraction = std::clamp((first + 0.5 - span.x0) / (span.x1 - span.x0), 0.0, 1.0);
  SurfaceSample knot{span.a0 + fraction * (span.a1 - span.a0), span.b0 + fraction * (span.b1 - span.b0), {}};
  solve_sample(span, first + 0.5, row + 0.5, &knot);
  keep(span, first, knot);
  const bool one_by_one = span.piece->kind > CutKind::fold || last - first < kShortRun;
  for (int px = first; px + 1 < last;) {
    const int next = one_by_one ? px + 1 : std::min(px + PixelRun::kCapacity, last - 1);
    const SurfaceSample from = knot;
    follow_cut(&knot, next - px);
    solve_sample(span, next + 0.5, row + 0.5, &knot);
    keep(span, next, knot);
    if (next > px + 1) solve_chunk(span, row, px + 1, next, from, knot);
    px = next;
  }
}

// Solves the pixels [first, last) between two solved neighbours.
void RowPainter::solve_chunk(const Span& span, int row, int first, int last, const SurfaceSample& from,
                             const SurfaceSample& to) {
  const ScreenJet s0(from.jet), s1(to.jet);
  const double width = last - first + 1;
  const double j0 = width / s0.jacobian(), j1 = width / s1.jacobian();
  run_.count = last - first;
  for (int k = 0; k < run_.count; ++k) {
    const double t = (k + 1) / width, s = 1.0 - t;
    const double h0 = s * s * (1 + 2 * t), h1 = t * t * (3 - 2 * t), d0 = s * s * t, d1 = -t * t * s;
    run_.x[k] = first + k + 0.5;
    run_.a[k] = h0 * from.a + h1 * to.a + d0 * j0 * s0.yb + d1 * j1 * s1.yb;
    run_.b[k] = h0 * from.b + h1 * to.b - d0 * j0 * s0.ya - d1 * j1 * s1.ya;
  }
  const ParameterBox box{std::min(span.a0, span.a1), std::max(span.a0, span.a1), 0.0, 1.0};
  solve_run(span.piece->net, row + 0.5, box, kStepTolerance, 4, run_);
  for (int k = 0; k < run_.count; ++k) {
    SurfaceSample sample{run_.a[k], run_.b[k], {}};
    const bool inside = sample.a >= box.a_lo && sample.a <= box.a_hi && sample.b >= 0.0 && sample.b <= 1.0;
    if (run_.step[k] < kStepTolerance && inside) {
      for (int c = 0; c < 4; ++c) {
        sample.jet.p[c] = run_.p[c][k];
        sample.jet.pa[c] = run_.pa[c][k];
        sample.jet.pb[c] = run_.pb[c][k];
      }
    } else {
      const double t = (k + 1) / width;
      sample.a = from.a + t * (to.a - from.a), sample.b = from.b + t * (to.b - from.b);
      solve_sample(span, run_.x[k], row + 0.5, &sample);
    }
    keep(span, first + k, sample);
  }
}

// Stores the sample if it is the nearest at its pixel so far.
void RowPainter::keep(const Span& span, int px, const SurfaceSample& sample) {
  const double depth = camera_.depth(sample.jet.p);
  if (piece_[px]) {
    const bool tie = std::fabs(depth - depth_[px]) <= tie_;
    if (!(tie ? span.piece->face < piece_[px]->face : depth < depth_[px])) return;
  }
  depth_[px] = depth;
  sample_[px] = sample;
  piece_[px] = span.piece;
}

void RowPainter::write_values(int row) {
  const std::size_t start = std::size_t(row) * frame_.width;
  for (int px = 0; px < frame_.width; ++px) {
    const std::size_t k = start + px;
    const Piece* piece = piece_[px];
    if (frame_.depth) frame_.depth[k] = piece ? depth_[px] : INFINITY;
    if (frame_.face) frame_.face[k] = piece ? piece->face : -1;
    if (!piece) {
      if (frame_.uv) frame_.uv[2 * k] = frame_.uv[2 * k + 1] = 0.0;
      if (frame_.normal) std::fill_n(frame_.normal + 3 * k, 3, 0.0f);
      continue;
    }
    if (frame_.uv) piece->face_from_local(sample_[px].a, sample_[px].b, frame_.uv + 2 * k, frame_.uv + 2 * k + 1);
    if (!frame_.normal && !frame_.color) continue;
    double n[3];
    surface_normal(scene_, *piece, camera_, sample_[px], n);
    if (frame_.normal) {
      for (int c = 0; c < 3; ++c) {
        frame_.normal[3 * k + c] = float(n[0] * camera_.right[c] + n[1] * camera_.up[c] + n[2] * camera_.forward[c]);
      }
    }
    shade(camera_, sample_[px], n, scene_.model.face_color + 4 * std::size_t(piece->face), centre_rgb_.data() + 3 * px);
  }
}

// The shade varies little inside a pixel: where the pixel's centre shows the same opaque face its shade serves, else
// the fragment's own is evaluated (a transparent face may show its front and its back in one pixel).
void RowPainter::fragment_color(const Span& span, double x, int px, float rgb[3]) {
  const float* color = scene_.model.face_color + 4 * std::size_t(span.piece->face);
  if (piece_[px] && piece_[px]->face == span.piece->face && color[3] >= 1.0f) {
    std::copy_n(centre_rgb_.data() + 3 * px, 3, rgb);
    return;
  }
  const double fraction = std::clamp((x - span.x0) / (span.x1 - span.x0), 0.0, 1.0);
  SurfaceSample sample{span.a0 + fraction * (span.a1 - span.a0), span.b0 + fraction * (span.b1 - span.b0), {}};
  solve_sample(span, x, span.y, &sample);
  double n[3];
  surface_normal(scene_, *span.piece, camera_, sample, n);
  shade(camera_, sample, n, color, rgb);
}

namespace {

// Calls add(px, from, to) for each pixel that [x0, x1] runs through.
template <class Add>
void for_each_pixel(double x0, double x1, int width, Add&& add) {
  const int last = std::min(width - 1, int(std::ceil(x1)) - 1);
  for (int px = std::max(0, int(std::floor(x0))); px <= last; ++px) {
    const double from = std::max(x0, double(px)), to = std::min(x1, px + 1.0);
    if (from < to) add(px, from, to);
  }
}

}  // namespace

void RowPainter::accumulate(const VisibleSegment& segment, double weight) {
  for_each_pixel(segment.x0, segment.x1, frame_.width, [&](int px, double from, double to) {
    const double area = weight * (to - from);
    coverage_[px] += area;
    alpha_[px] += area;
    if (!frame_.color) return;
    float rgb[3];
    fragment_color(*segment.span, 0.5 * (from + to), px, rgb);
    for (int c = 0; c < 3; ++c) rgb_[3 * px + c] += area * rgb[c];
  });
}

// Between neighbouring ends of segments and veils the same surfaces lie over each other all along.
void RowPainter::accumulate_layers(const PlaneCut& cut, double weight) {
  veils_.clear();
  for (const Span& span : cut.transparent) visible_parts(span, cut.segments, camera_, tie_, veils_);
  borders_.clear();
  for (const std::vector<VisibleSegment>* list : {&cut.segments, &std::as_const(veils_)}) {
    for (const VisibleSegment& segment : *list) borders_.insert(borders_.end(), {segment.x0, segment.x1});
  }
  std::sort(borders_.begin(), borders_.end());
  for (std::size_t k = 1; k < borders_.size(); ++k) {
    if (borders_[k - 1] < borders_[k]) add_layers(cut, borders_[k - 1], borders_[k], weight);
  }
}

void RowPainter::add_layers(const PlaneCut& cut, double x0, double x1, double weight) {
  const double middle = 0.5 * (x0 + x1);
  layers_.clear();
  for (const std::vector<VisibleSegment>* list : {&cut.segments, &std::as_const(veils_)}) {
    for (const VisibleSegment& segment : *list) {
      double a;
      if (segment.x0 <= x0 && segment.x1 >= x1)
        layers_.push_back({depth_at(*segment.span, middle, camera_, &a), segment.span});
    }
  }
  std::stable_sort(layers_.begin(), layers_.end(), [](const Layer& p, const Layer& q) { return p.depth < q.depth; });
  if (layers_.empty()) return;
  for_each_pixel(x0, x1, frame_.width, [&](int px, double from, double to) {
    const double area = weight * (to - from);
    coverage_[px] += area;
    double light = area;  // what still passes through the layers so far
    for (const Layer& layer : layers_) {
      const double opacity = scene_.model.face_color[4 * std::size_t(layer.span->piece->face) + 3];
      float rgb[3] = {0, 0, 0};
      if (frame_.color) fragment_color(*layer.span, 0.5 * (from + to), px, rgb);
      for (int c = 0; c < 3; ++c) rgb_[3 * px + c] += light * opacity * rgb[c];
      light *= 1.0 - opacity;
    }
    alpha_[px] += area - light;
  });
}

void RowPainter::write_color(int row) {
  const std::size_t start = std::size_t(row) * frame_.width;
  for (int px = 0; px < frame_.width; ++px) {
    const std::size_t k = start + px;
    const float coverage = float(std::min(1.0, coverage_[px]));
    if (frame_.coverage) frame_.coverage[k] = coverage;
    if (!frame_.color) continue;
    for (int c = 0; c < 3; ++c) frame_.color[4 * k + c] = float(rgb_[3 * px + c]);
    frame_.color[4 * k + 3] = float(std::min(1.0, alpha_[px]));
  }
}

}  // namespace nofacet
