#include "raster/band.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "raster/stream.h"

namespace nofacet {
namespace {

// Length of the longest stretch of x that one of two planes covers and the other does not.
double longest_difference(const std::vector<Interval>& p, const std::vector<Interval>& q) {
  double longest = 0.0, x = 0.0;
  bool in_p = false, in_q = false;
  std::size_t k = 0, l = 0;  // next border of p and q: even index enters, odd leaves
  const auto border = [](const std::vector<Interval>& list, std::size_t index) {
    return index % 2 == 0 ? list[index / 2].lo : list[index / 2].hi;
  };
  while (k < 2 * p.size() || l < 2 * q.size()) {
    const bool from_p = l >= 2 * q.size() || (k < 2 * p.size() && border(p, k) <= border(q, l));
    const double next = from_p ? border(p, k) : border(q, l);
    if (in_p != in_q) longest = std::max(longest, next - x);
    x = next;
    if (from_p) {
      in_p = !in_p, ++k;
    } else {
      in_q = !in_q, ++l;
    }
  }
  return longest;
}

}  // namespace

BandPainter::BandPainter(const Scene& scene, const Camera& camera, const ScanPlanes& planes, FramePatches& patches,
                         Sections* sections, int thread, const Frame& frame)
    : scene_(scene),
      camera_(camera),
      planes_(planes),
      patches_(patches),
      thread_(thread),
      frame_(frame),
      visibility_(camera, patches.depth_tie()),
      average_(scene, camera, frame, visibility_) {
  if (sections) cuts_.emplace(scene, *sections, thread);
}

void BandPainter::paint(int first_row, int end_row, const std::vector<int32_t>& patches) {
  first_row_ = first_row, end_row_ = end_row;
  band_patches_ = &patches;
  watch_.restart();
  lay_planes();
  const double opening = patches_.opening_seconds(thread_);
  cut_patches();
  watch_.lap(times_.visibility);
  times_.subdivide += patches_.opening_seconds(thread_) - opening;
  times_.visibility -= patches_.opening_seconds(thread_) - opening;
  if (planes_.centre()) solve_values();
  watch_.lap(times_.shade);
  for (int row = first_row; row < end_row && (frame_.color || frame_.coverage); ++row) {
    weigh_planes(row);
    average_.average(row, (planes_.centre() ? front(row) : *row_lines_[1]).segments, weighted_);
  }
  flush_streams();
  watch_.lap(times_.average);
}

// The band's planes from top to bottom: of each row the sample planes with the centre plane among them, and, where
// level edges are located, the neighbouring rows' nearest.
void BandPainter::lay_planes() {
  plane_y_.clear();
  const int samples = planes_.samples();
  if (planes_.locates_level_edges()) plane_y_.push_back(planes_.sample_y(int64_t(first_row_) * samples - 1));
  for (int row = first_row_; row < end_row_; ++row) {
    for (int k = 0; k <= samples; ++k) {
      if (planes_.centre() && !planes_.centre_is_sample() && k == samples / 2)
        plane_y_.push_back(planes_.centre_y(row));
      if (k < samples) plane_y_.push_back(planes_.sample_y(int64_t(row) * samples + k));
    }
  }
  if (planes_.locates_level_edges()) plane_y_.push_back(planes_.sample_y(int64_t(end_row_) * samples));
  if (lines_.size() < plane_y_.size()) lines_.resize(plane_y_.size());
  for (std::size_t k = 0; k < plane_y_.size(); ++k) lines_[k].clear(plane_y_[k]);
}

int BandPainter::centre_plane(int row) const {
  return (planes_.locates_level_edges() ? 1 : 0) + (row - first_row_) * planes_.per_row() + planes_.samples() / 2;
}

// k from -1 (the last one of the row above) to `samples` (the first one of the row below).
int BandPainter::sample_plane(int row, int k) const {
  const int samples = planes_.samples();
  if (k < 0) return sample_plane(row - 1, samples - 1);
  if (k >= samples) return sample_plane(row + 1, 0);
  const int after_centre =
      planes_.per_row() > samples && k >= samples / 2 && row >= first_row_ && row < end_row_ ? 1 : 0;
  if (row < first_row_) return 0;
  return (planes_.locates_level_edges() ? 1 : 0) + (row - first_row_) * planes_.per_row() + k + after_centre;
}

void BandPainter::cut_patches() {
  spans_.reuse();
  order_ = 0;
  if (cuts_) insert_caps(plane_y_.data(), int(plane_y_.size()), lines_.data());
  const auto needs = [&](const HullBounds& hull) { return !hidden(hull); };
  for (std::span<const int32_t> rest = *band_patches_; !rest.empty(); rest = rest.subspan(1)) {
    const bool sectioned = patches_.patches()[rest[0]].cut;
    patches_.visit(rest, thread_, needs, [&](const Piece& piece) { cut_piece(piece, sectioned); });
  }
}

void BandPainter::cut_piece(const Piece& piece, bool sectioned) {
  auto [first, last] = planes_in(piece.hull.y);
  while (first < last && hidden(piece.hull, lines_[first])) ++first;
  while (first < last && hidden(piece.hull, lines_[last - 1])) --last;
  if (first == last) return;
  watch_.lap(times_.visibility);
  made_.clear();
  maker_.append(piece, plane_y_.data() + first, last - first, first, camera_.width, made_);
  if (sectioned) cuts_->remove(piece, made_);
  watch_.lap(times_.spans);
  insert_spans(piece, lines_.data());
}

// Cuts the planes y[0] .. y[count - 1] by the section planes and hands the caps to their lines.
void BandPainter::insert_caps(const double* y, int count, ScanLine* lines) {
  cuts_->cut(first_row_ / planes_.band_rows(), y, count);
  for (const CapSpans& cap : cuts_->caps()) {
    made_.assign(cap.first, cap.last);
    insert_spans(*cap.first->piece, lines);
  }
}

// The planes [first, second) of the band that lie in y.
std::pair<int, int> BandPainter::planes_in(Interval y) const {
  if (y.hi < plane_y_.front() || y.lo > plane_y_.back()) return {0, 0};  // most parts of a patch lie in other bands
  const auto first = std::lower_bound(plane_y_.begin(), plane_y_.end(), y.lo);
  const auto last = std::upper_bound(first, plane_y_.end(), y.hi);
  return {int(first - plane_y_.begin()), int(last - plane_y_.begin())};
}

// Whether the plane shows something nearer wherever it may meet what lies within these bounds.
bool BandPainter::hidden(const HullBounds& hull, const ScanLine& line) const {
  const Interval x = intersect(hull.x_at(line.y), {0.0, double(camera_.width)});
  const KeyLine near{hull.plane.key(0.0, line.y) - hull.plane.error, hull.plane.by_x};
  return line.hides(x, hull.key.lo, near, visibility_.tie(hull.key.lo));
}

// Whether all of the band's planes do.
bool BandPainter::hidden(const HullBounds& hull) const {
  const auto [first, last] = planes_in(hull.y);
  return std::all_of(lines_.begin() + first, lines_.begin() + last,
                     [&](const ScanLine& line) { return hidden(hull, line); });
}

// Hands the spans just made to their lines.
void BandPainter::insert_spans(const Piece& piece, ScanLine* lines) {
  if (made_.empty()) return;
  const bool opaque = scene_.color(piece.face)[3] >= 1.0f;
  for (const Span& span : made_) {
    ScanLine& line = lines[span.plane];
    Span* kept = spans_.take(1);
    *kept = span;
    kept->order = order_;  // after the copy: it would wait for what has just been written
    if (!opaque) {
      line.transparent.push_back(kept);
    } else if (!visibility_.insert(*kept, line)) {
      spans_.give_back(1);
    }
  }
  ++order_;
}

// What is visible at the row's centre plane, transparent or not.
const ScanLine& BandPainter::front(int row) {
  const ScanLine& line = lines_[centre_plane(row)];
  if (line.transparent.empty()) return line;
  front_ = line;
  for (const Span* span : line.transparent) visibility_.insert(*span, front_);
  return front_;
}

// Pixels are solved piece by piece, so that what a piece needs is at hand.
void BandPainter::solve_values() {
  jobs_.clear();
  for (int row = first_row_; row < end_row_; ++row) collect_jobs(row);
  job_starts_.assign(order_ + 1, 0);
  for (const PixelJob& job : jobs_) ++job_starts_[job.span->order + 1];
  for (int32_t k = 0; k < order_; ++k) job_starts_[k + 1] += job_starts_[k];
  sorted_.resize(jobs_.size());
  for (const PixelJob& job : jobs_) sorted_[job_starts_[job.span->order]++] = job;
  hard_.clear();
  for (std::size_t first = 0, last = 0; first < sorted_.size(); first = last) {
    const Piece* piece = sorted_[first].span->piece;
    while (last < sorted_.size() && sorted_[last].span->piece == piece) ++last;
    solve_pixels(scene_, camera_, frame_, *piece, sorted_.data() + first, last - first, hard_);
  }
  for (const HardPixel& pixel : hard_) solve_hard_pixel(scene_, camera_, frame_, pixel);
}

void BandPainter::collect_jobs(int row) {
  int next = 0;
  for (const VisibleSegment& segment : front(row).segments) {
    const int first = first_pixel(segment.x0, frame_.width), last = first_pixel(segment.x1, frame_.width);
    if (first >= last) continue;
    fill_background(row, next, first);
    if (frame_.face) prefetch_ends(frame_.face + std::size_t(row) * frame_.width + first, last - first);
    jobs_.push_back({segment.span, row, first, last});
    next = last;
  }
  fill_background(row, next, frame_.width);
}

void BandPainter::fill_background(int row, int first, int last) const {
  if (first >= last) return;
  const std::size_t at = std::size_t(row) * frame_.width + first, count = last - first;
  if (frame_.depth) fill_stretch(frame_.depth + at, count, INFINITY);
  if (frame_.face) fill_stretch(frame_.face + at, count, -1);
  if (frame_.color) fill_stretch(frame_.color + 4 * at, 4 * count, 0.0f);
  if (frame_.uv) fill_stretch(frame_.uv + 2 * at, 2 * count, 0.0);
  if (frame_.normal) fill_stretch(frame_.normal + 3 * at, 3 * count, 0.0f);
}

// The lines that the row is averaged over, each for the strip of the row that is nearest to it.
void BandPainter::weigh_planes(int row) {
  const int samples = planes_.samples();
  row_lines_.clear();
  level_count_ = 0;
  ScanLine bounds[2];  // the neighbouring rows' lines, where only their y matters
  if (planes_.locates_level_edges()) {
    std::vector<Interval>*above = &covered_[0], *below = &covered_[1];
    row_lines_.push_back(&lines_[sample_plane(row, -1)]);
    row_lines_.back()->covered(camera_.width, *above);
    for (int k = 0; k <= samples; ++k) {
      const ScanLine& next = lines_[sample_plane(row, k)];
      next.covered(camera_.width, *below);
      locate_level_edges(*row_lines_.back(), *above, next, *below);
      row_lines_.push_back(&next);
      std::swap(above, below);
    }
  } else {
    bounds[0].y = planes_.sample_y(int64_t(row) * samples - 1);
    bounds[1].y = planes_.sample_y(int64_t(row + 1) * samples);
    row_lines_.push_back(&bounds[0]);
    for (int k = 0; k < samples; ++k) row_lines_.push_back(&lines_[sample_plane(row, k)]);
    row_lines_.push_back(&bounds[1]);
  }
  weighted_.clear();
  for (std::size_t k = 1; k + 1 < row_lines_.size(); ++k) {
    const double y = row_lines_[k]->y - kSampleShiftY;
    const double above = 0.5 * (y + row_lines_[k - 1]->y - kSampleShiftY);
    const double below = 0.5 * (y + row_lines_[k + 1]->y - kSampleShiftY);
    const double weight = std::min(below, row + 1.0) - std::max(above, double(row));
    if (weight > 0.0) weighted_.push_back({row_lines_[k], weight});
  }
}

// A level edge hides or shows a stretch of x at once, and no number of equal strips places it well: halve the gap
// between the planes until it lies in a strip of 1 / kLevelSteps. With each line goes what it covers.
void BandPainter::locate_level_edges(const ScanLine& above, const std::vector<Interval>& covered_above,
                                     const ScanLine& below, const std::vector<Interval>& covered_below) {
  constexpr double kLevelRun = 2.0;  // pixels; shorter stretches are no worse placed than slanted outlines
  if (longest_difference(covered_above, covered_below) < kLevelRun) return;
  const double y = ScanPlanes::level_y(ScanPlanes::level_step(0.5 * (above.y + below.y)));
  if (!(y > above.y && y < below.y)) return;
  const ScanLine& middle = cut_level(y);
  std::vector<Interval> covered;
  middle.covered(camera_.width, covered);
  locate_level_edges(above, covered_above, middle, covered);
  row_lines_.push_back(&middle);
  locate_level_edges(middle, covered, below, covered_below);
}

const ScanLine& BandPainter::cut_level(double y) {
  if (level_count_ == level_lines_.size()) level_lines_.emplace_back();
  ScanLine& line = level_lines_[level_count_++];
  line.clear(y);
  if (cuts_) insert_caps(&y, 1, &line);
  const auto needs = [&](const HullBounds& hull) { return hull.y.lo <= y && y <= hull.y.hi && !hidden(hull, line); };
  for (std::span<const int32_t> rest = *band_patches_; !rest.empty(); rest = rest.subspan(1)) {
    patches_.visit(rest, thread_, needs, [&](const Piece& piece) {
      if (!needs(piece.hull)) return;
      made_.clear();
      maker_.append(piece, &y, 1, 0, camera_.width, made_);
      if (patches_.patches()[rest[0]].cut) cuts_->remove(piece, made_);
      insert_spans(piece, &line);
    });
  }
  return line;
}

}  // namespace nofacet
