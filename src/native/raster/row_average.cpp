#include "raster/row_average.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "raster/shade.h"

namespace nofacet {
namespace {

auto first_after(const std::vector<VisibleSegment>& segments, double x) {
  return std::upper_bound(segments.begin(), segments.end(), x,
                          [](double value, const VisibleSegment& s) { return value < s.x1; });
}

}  // namespace

RowAverage::RowAverage(const Scene& scene, const Camera& camera, const Frame& frame, Visibility& visibility)
    : scene_(scene), camera_(camera), frame_(frame), visibility_(visibility), mixed_(frame.width) {}

void RowAverage::average(int row, const std::vector<VisibleSegment>& front, const std::vector<WeightedLine>& lines) {
  front_ = &front;
  row_rgb_ = frame_.color ? frame_.color + 4 * std::size_t(row) * frame_.width : nullptr;
  before_px_ = -1;
  find_runs(front);
  std::fill(mixed_.begin(), mixed_.end(), 0);
  for (const WeightedLine& weighted : lines) find_mixed(*weighted.line);
  find_veils(lines);
  cursors_.assign(lines.size(), 0);
  const std::size_t start = std::size_t(row) * frame_.width;
  for (const FaceRun& run : runs_) {
    if (frame_.coverage) std::fill_n(frame_.coverage + start + run.first, run.last - run.first, run.face >= 0 ? 1.0f : 0.0f);
  }
  for (const FaceRun& run : runs_) {
    for (int px = run.first; px < run.last; ++px) {
      // Most pixels are not mixed: skip to the next one that is.
      const void* next = std::memchr(mixed_.data() + px, 1, run.last - px);
      if (!next) break;
      px = int(static_cast<const uint8_t*>(next) - mixed_.data());
      centre_face_ = run.face;
      average_pixel(row, px, lines);
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

// Marks the pixels that the line does not show as their centres do.
void RowAverage::find_mixed(const ScanLine& line) {
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
  for (std::size_t k = 0; k < line.segments.size();) {
    const int32_t face = line.segments[k].span->piece->face;
    const double x0 = line.segments[k].x0;
    double x1 = line.segments[k].x1;
    // Neighbours on one face meet but for rounding.
    for (++k; k < line.segments.size() && line.segments[k].span->piece->face == face &&
              line.segments[k].x0 <= x1 + kSliverPixels;
         ++k) {
      x1 = line.segments[k].x1;
    }
    if (x < x0) compare(x, x0, -1);
    compare(x0, x1, face);
    x = x1;
  }
  if (x < frame_.width) compare(x, frame_.width, -1);
  for (const Span* span : line.transparent) {
    mark(int(std::floor(std::max(span->x0, 0.0))), int(std::ceil(std::min(span->x1, double(frame_.width)))));
  }
}

void RowAverage::mark(int first, int last) {
  first = std::max(first, 0), last = std::min(last, frame_.width);
  if (first < last) std::fill(mixed_.begin() + first, mixed_.begin() + last, 1);
}

void RowAverage::find_veils(const std::vector<WeightedLine>& lines) {
  if (veils_.size() < lines.size()) veils_.resize(lines.size());
  for (std::size_t k = 0; k < lines.size(); ++k) {
    veils_[k].clear();
    const ScanLine& line = *lines[k].line;
    for (const Span* span : line.transparent) visibility_.append_visible(*span, line.segments, veils_[k]);
  }
}

void RowAverage::average_pixel(int row, int px, const std::vector<WeightedLine>& lines) {
  const std::size_t at = std::size_t(row) * frame_.width + px;
  px_ = px;
  if (frame_.color) std::copy_n(frame_.color + 4 * at, 3, centre_rgb_);
  rgb_[0] = rgb_[1] = rgb_[2] = alpha_ = coverage_ = 0.0;
  piece_colors_.clear();
  for (std::size_t k = 0; k < lines.size(); ++k) {
    if (veils_[k].empty()) {
      add_opaque(lines[k], cursors_[k], px);
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

void RowAverage::add_opaque(const WeightedLine& weighted, std::size_t& cursor, int px) {
  const std::vector<VisibleSegment>& segments = weighted.line->segments;
  while (cursor < segments.size() && segments[cursor].x1 <= px) ++cursor;
  for (auto it = segments.begin() + cursor; it != segments.end() && it->x0 < px + 1.0; ++it) {
    const double from = std::max(it->x0, double(px)), to = std::min(it->x1, px + 1.0);
    if (!(from < to)) continue;
    const double area = weighted.weight * (to - from);
    coverage_ += area;
    alpha_ += area;
    if (!frame_.color) continue;
    float rgb[3];
    fragment_color(*it->span, 0.5 * (from + to), rgb);
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

// `rgb` if the pixel's centre shows the piece, else null.
const float* RowAverage::neighbour_color(const Piece& piece, int px, const float* rgb) const {
  if (px < 0 || px >= frame_.width) return nullptr;
  const double centre = px + 0.5 + kSampleShiftX;
  const auto segment = first_after(*front_, centre);
  return segment != front_->end() && segment->x0 <= centre && segment->span->piece == &piece ? rgb : nullptr;
}

// What the pixel's centre, or that of a neighbour in the row, shows of the piece; null if none does.
const float* RowAverage::centre_color(const Piece& piece) const {
  if (centre_face_ == piece.face) return centre_rgb_;
  const float* before = before_px_ == px_ - 1 ? before_rgb_ : row_rgb_ + 4 * (px_ - 1);
  if (const float* found = neighbour_color(piece, px_ - 1, before)) return found;
  return neighbour_color(piece, px_ + 1, row_rgb_ + 4 * (px_ + 1));
}

// The shade varies little from one pixel to the next on one piece: an opaque one has the shade of a centre in reach
// that shows it, else of its first fragment in the pixel (a transparent face may show its front and its back in one
// pixel).
void RowAverage::fragment_color(const Span& span, double x, float rgb[3]) {
  const Piece& piece = *span.piece;
  const float* color = scene_.color(piece.face);
  const bool opaque = color[3] >= 1.0f;
  if (opaque) {
    for (const PieceColor& known : piece_colors_) {
      if (known.piece == &piece) return void(std::copy_n(known.rgb, 3, rgb));
    }
  }
  if (const float* found = opaque ? centre_color(piece) : nullptr) {
    std::copy_n(found, 3, rgb);
  } else {
    const double fraction = std::clamp((x - span.x0) / (span.x1 - span.x0), 0.0, 1.0);
    SurfaceSample sample{span.a0 + fraction * (span.a1 - span.a0), span.b0 + fraction * (span.b1 - span.b0), {}};
    solve_sample(span, x, span.y, &sample);
    double n[3];
    surface_normal(scene_, piece, camera_, sample, n);
    shade(camera_, sample, n, color, rgb);
  }
  if (opaque) piece_colors_.push_back({&piece, {rgb[0], rgb[1], rgb[2]}});
}

}  // namespace nofacet
