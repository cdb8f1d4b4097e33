#include "raster/row_average.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "raster/shade.h"
#include "raster/stream.h"

namespace nofacet {
RowAverage::RowAverage(const Scene& scene, const Camera& camera, const Frame& frame, Visibility& visibility)
    : scene_(scene), camera_(camera), frame_(frame), visibility_(visibility), mixed_(frame.width) {}

void RowAverage::average(int row, const std::vector<VisibleSegment>& front, const std::vector<WeightedLine>& lines) {
  row_rgb_ = frame_.color ? frame_.color + 4 * std::size_t(row) * frame_.width : nullptr;
  before_px_ = -1;
  find_runs(front);
  std::fill(mixed_.begin(), mixed_.end(), 0);
  if (stretches_.size() < lines.size()) stretches_.resize(lines.size());
  for (std::size_t k = 0; k < lines.size(); ++k) {
    find_stretches(*lines[k].line, stretches_[k]);
    find_mixed(*lines[k].line, stretches_[k]);
  }
  find_veils(lines);
  cursors_.assign(lines.size(), 0);
  const std::size_t start = std::size_t(row) * frame_.width;
  for (const FaceRun& run : runs_) {
    if (frame_.coverage)
      fill_stretch(frame_.coverage + start + run.first, run.last - run.first, run.face >= 0 ? 1.0f : 0.0f);
  }
  for (std::size_t k = 0; k < runs_.size(); ++k) {
    const FaceRun& run = runs_[k];
    for (int px = run.first; px < run.last; ++px) {
      // Most pixels are not mixed: skip to the next one that is.
      const void* next = std::memchr(mixed_.data() + px, 1, run.last - px);
      if (!next) break;
      px = int(static_cast<const uint8_t*>(next) - mixed_.data());
      average_pixel(row, px, k, lines);
    }
  }
}

void RowAverage::find_runs(const std::vector<VisibleSegment>& front) {
  runs_.clear();
  const auto add = [&](int first, int last, int32_t face) {
    if (first >= last) return;
    if (!runs_.empty() && runs_.back().face == face) {
      runs_.back().last = last;
    } else {
      runs_.push_back({first, last, face});
    }
  };
  int next = 0;
  for (const VisibleSegment& segment : front) {
    const int first = first_pixel(segment.x0, frame_.width), last = first_pixel(segment.x1, frame_.width);
    if (first >= last) continue;
    add(next, first, -1);
    add(first, last, segment.span->piece->face);
    next = last;
  }
  add(next, frame_.width, -1);
}

void RowAverage::find_stretches(const ScanLine& line, std::vector<Stretch>& out) const {
  out.clear();
  for (std::size_t k = 0; k < line.segments.size(); ++k) {
    const VisibleSegment& segment = line.segments[k];
    const int32_t face = segment.span->piece->face;
    if (!out.empty() && out.back().face == face && segment.x0 <= out.back().x1 + kSliverPixels) {
      out.back().x1 = segment.x1;
    } else {
      out.push_back({segment.x0, segment.x1, face, k});
    }
  }
}

// Marks the pixels that the line does not show as their centres do.
void RowAverage::find_mixed(const ScanLine& line, const std::vector<Stretch>& stretches) {
  std::size_t run = 0;
  // What the line shows between x0 and x1.
  const auto compare = [&](double x0, double x1, int32_t face) {
    const int first = int(std::floor(x0)), last = int(std::ceil(x1));  // first inner pixel, end of the inner ones
    const int inner_first = int(std::ceil(x0)), inner_last = int(std::floor(x1));
    if (inner_first > first) mark(first, first + 1);
    if (last > inner_last) mark(last - 1, last);
    while (run < runs_.size() && runs_[run].last <= inner_first) ++run;
    for (std::size_t k = run; k < runs_.size() && runs_[k].first < inner_last; ++k) {
      if (runs_[k].face != face) mark(std::max(runs_[k].first, inner_first), std::min(runs_[k].last, inner_last));
    }
  };
  double x = 0.0;
  for (const Stretch& stretch : stretches) {
    if (x < stretch.x0) compare(x, stretch.x0, -1);
    compare(stretch.x0, stretch.x1, stretch.face);
    x = stretch.x1;
  }
  if (x < frame_.width) compare(x, frame_.width, -1);
  for (const Span* span : line.transparent) {
    mark(int(std::floor(std::max(span->x0, 0.0))), int(std::ceil(std::min(span->x1, double(frame_.width)))));
  }
}

void RowAverage::mark(int first, int last) {
  first = std::max(first, 0), last = std::min(last, frame_.width);
  if (first >= last) return;
  std::fill(mixed_.begin() + first, mixed_.begin() + last, 1);
  if (row_rgb_) prefetch_ends(row_rgb_ + 4 * first, 4 * (last - first));
}

void RowAverage::find_veils(const std::vector<WeightedLine>& lines) {
  if (veils_.size() < lines.size()) veils_.resize(lines.size());
  for (std::size_t k = 0; k < lines.size(); ++k) {
    veils_[k].clear();
    const ScanLine& line = *lines[k].line;
    for (const Span* span : line.transparent) visibility_.append_visible(*span, line, veils_[k]);
  }
}

void RowAverage::average_pixel(int row, int px, std::size_t run, const std::vector<WeightedLine>& lines) {
  const std::size_t at = std::size_t(row) * frame_.width + px;
  px_ = px, run_ = run;
  centre_face_ = runs_[run].face;
  if (frame_.color) std::copy_n(frame_.color + 4 * at, 3, centre_rgb_);
  rgb_[0] = rgb_[1] = rgb_[2] = alpha_ = coverage_ = 0.0;
  face_colors_.clear();
  for (std::size_t k = 0; k < lines.size(); ++k) {
    if (veils_[k].empty()) {
      add_opaque(lines[k], stretches_[k], cursors_[k], px);
    } else {
      add_layers(*lines[k].line, veils_[k], px, lines[k].weight);
    }
  }
  if (frame_.coverage) frame_.coverage[at] = float(std::min(1.0, coverage_));
  if (!frame_.color) return;
  for (int c = 0; c < 3; ++c) frame_.color[4 * at + c] = float(rgb_[c]);
  frame_.color[4 * at + 3] = float(std::min(1.0, alpha_));
  before_px_ = px;
  std::copy_n(centre_rgb_, 3, before_rgb_);
}

void RowAverage::add_opaque(const WeightedLine& weighted, const std::vector<Stretch>& stretches, std::size_t& cursor,
                            int px) {
  while (cursor < stretches.size() && stretches[cursor].x1 <= px) ++cursor;
  for (auto it = stretches.begin() + cursor; it != stretches.end() && it->x0 < px + 1.0; ++it) {
    const double from = std::max(it->x0, double(px)), to = std::min(it->x1, px + 1.0);
    if (!(from < to)) continue;
    const double area = weighted.weight * (to - from);
    coverage_ += area;
    alpha_ += area;
    if (!frame_.color) continue;
    float rgb[3];
    stretch_color(*weighted.line, *it, 0.5 * (from + to), rgb);
    for (int c = 0; c < 3; ++c) rgb_[c] += area * rgb[c];
  }
}

// Between neighbouring ends of segments and veils the same surfaces lie over each other all along.
void RowAverage::add_layers(const ScanLine& line, const std::vector<VisibleSegment>& veils, int px, double weight) {
  stack_.clear();
  borders_.clear();
  for (const std::vector<VisibleSegment>* list : {&line.segments, &veils}) {
    for (const VisibleSegment& segment : *list) {
      const double from = std::max(segment.x0, double(px)), to = std::min(segment.x1, px + 1.0);
      if (!(from < to)) continue;
      stack_.push_back({from, to, segment.span});
      borders_.insert(borders_.end(), {from, to});
    }
  }
  std::sort(borders_.begin(), borders_.end());
  for (std::size_t k = 1; k < borders_.size(); ++k) {
    if (borders_[k - 1] < borders_[k]) add_stack(borders_[k - 1], borders_[k], weight);
  }
}

void RowAverage::add_stack(double from, double to, double weight) {
  const double middle = 0.5 * (from + to), area = weight * (to - from);
  layers_.clear();
  for (const VisibleSegment& segment : stack_) {
    double a;
    if (segment.x0 <= from && segment.x1 >= to) layers_.push_back({key_at(*segment.span, middle, &a), segment.span});
  }
  if (layers_.empty()) return;
  std::stable_sort(layers_.begin(), layers_.end(), [](const Layer& p, const Layer& q) { return p.key < q.key; });
  coverage_ += area;
  double light = area;  // what still passes through the layers so far
  for (const Layer& layer : layers_) {
    const double opacity = scene_.color(layer.span->piece->face)[3];
    float rgb[3] = {0, 0, 0};
    if (frame_.color) fragment_color(*layer.span, middle, rgb);
    for (int c = 0; c < 3; ++c) rgb_[c] += light * opacity * rgb[c];
    light *= 1.0 - opacity;
  }
  alpha_ += area - light;
}

// The shade varies little from one pixel to the next on one surface: an opaque face has, all over the pixel, that of a
// centre in reach to which it runs on without a border, else that of the middle x of its first part in the pixel.
void RowAverage::stretch_color(const ScanLine& line, const Stretch& stretch, double x, float rgb[3]) {
  const float* found = known_color(stretch.face);
  if (!found) found = neighbour_color(stretch);
  if (found) {
    std::copy_n(found, 3, rgb);
    return;
  }
  std::size_t k = stretch.first;
  while (line.segments[k].x1 < x) ++k;
  fragment_color(*line.segments[k].span, x, rgb);
}

// What is known of the face in this pixel; null if nothing is.
const float* RowAverage::known_color(int32_t face) const {
  if (centre_face_ == face) return centre_rgb_;
  for (const FaceColor& known : face_colors_) {
    if (known.face == face) return known.rgb;
  }
  return nullptr;
}

// What a neighbour's centre in the row shows of the stretch; null if neither shows it.
const float* RowAverage::neighbour_color(const Stretch& stretch) const {
  const auto shows = [&](int px) {
    if (px < 0 || px >= frame_.width) return false;
    const std::size_t run = px < runs_[run_].first ? run_ - 1 : px >= runs_[run_].last ? run_ + 1 : run_;
    const double centre = px + 0.5 + kSampleShiftX;
    return runs_[run].face == stretch.face && stretch.x0 <= centre && centre <= stretch.x1;
  };
  if (shows(px_ - 1)) return before_px_ == px_ - 1 ? before_rgb_ : row_rgb_ + 4 * (px_ - 1);
  return shows(px_ + 1) ? row_rgb_ + 4 * (px_ + 1) : nullptr;
}

// The shade of the span at x; of an opaque face what is known of it in the pixel.
void RowAverage::fragment_color(const Span& span, double x, float rgb[3]) {
  const Piece& piece = *span.piece;
  const float* color = scene_.color(piece.face);
  const bool opaque = color[3] >= 1.0f;
  if (const float* found = opaque ? known_color(piece.face) : nullptr) return void(std::copy_n(found, 3, rgb));
  const double fraction = std::clamp((x - span.x0) / (span.x1 - span.x0), 0.0, 1.0);
  SurfaceSample sample{span.a0 + fraction * (span.a1 - span.a0), span.b0 + fraction * (span.b1 - span.b0), {}};
  solve_sample(span, x, span.y, &sample);
  double n[3];
  surface_normal(scene_, piece, camera_, sample, n);
  shade(camera_, sample, n, color, rgb);
  if (opaque) face_colors_.push_back({piece.face, {rgb[0], rgb[1], rgb[2]}});
}

}  // namespace nofacet
