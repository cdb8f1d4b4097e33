// The scan planes y = const of a frame: one through the pixel centres of each row, and `samples` for coverage.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "bezier/interval.h"

namespace nofacet {

// CAD models are full of edges that run exactly through pixel centres or sample lines under a standard view, where
// rounding decides on which side of an edge a sample falls, and may decide differently for two faces that share the
// edge: a crack. Every sample therefore lies this far (in pixels) off its nominal place, in general position
// (simulation of simplicity: Edelsbrunner, Muecke 1990). Values are still solved at the exact pixel centre.
inline constexpr double kSampleShiftX = 1.0726e-8, kSampleShiftY = 1.3093e-8;

// The first of the pixels 0 .. width whose centre lies at or right of x.
inline int first_pixel(double x, int width) {
  return int(std::ceil(std::clamp(x - 0.5 - kSampleShiftX, 0.0, double(width))));
}

class ScanPlanes {
 public:
  // Level edges are located to one part in this many of a pixel, where they are located at all.
  static constexpr int kLevelSteps = 1024;
  // From this many samples on, level edges are located between the sample planes.
  static constexpr int kLevelSamples = 8;

  // `samples`: planes a row for coverage, 0 for none; `centre`: whether planes through the pixel centres are wanted.
  ScanPlanes(int rows, int samples, bool centre) : rows_(rows), samples_(samples), centre_(centre) {}

  int rows() const { return rows_; }
  int samples() const { return samples_; }
  bool centre() const { return centre_; }
  // Rows handed to a thread at a time: a band, whose planes show no more than a processor's cache holds.
  int band_rows() const { return locates_level_edges() ? 8 : 16; }
  int bands() const { return (rows_ + band_rows() - 1) / band_rows(); }
  // The band that y lies in, or the nearest.
  int band_of(double y) const {
    return std::clamp(int(std::clamp(y, -1.0, rows_ + 1.0)) / band_rows(), 0, bands() - 1);
  }
  bool locates_level_edges() const { return samples_ >= kLevelSamples; }
  // Whether the centre plane is one of the sample planes.
  bool centre_is_sample() const { return samples_ % 2 == 1; }

  // Planes a row, the centre plane among them.
  int per_row() const { return samples_ + (centre_ && !centre_is_sample() ? 1 : 0); }

  double centre_y(int row) const { return row + 0.5 + kSampleShiftY; }
  // Of the sample plane `index` of the frame: row * samples + k.
  double sample_y(int64_t index) const { return (double(index) + 0.5) / samples_ + kSampleShiftY; }
  // Of the planes between the sample planes that serve to locate level edges. The strips that they stand for begin and
  // end at multiples of 1 / kLevelSteps.
  static double level_y(int64_t step) { return (double(step) + 0.5) / kLevelSteps + kSampleShiftY; }
  // The level plane nearest to y.
  static int64_t level_step(double y) { return int64_t(std::floor((y - kSampleShiftY) * kLevelSteps)); }

  // Whether some plane lies in [lo, hi).
  bool any_in(double lo, double hi) const {
    if (!(hi > 0.0 && lo < rows_)) return false;
    const double first = std::max(lo, -1.0) - kSampleShiftY, last = hi - kSampleShiftY;
    const auto between = [&](double per_row, double offset) {
      return (std::ceil(first * per_row - offset) + offset) / per_row < last;
    };
    return (centre_ && between(1.0, 0.5)) || (samples_ > 0 && between(samples_, 0.5)) ||
           (locates_level_edges() && between(kLevelSteps, 0.5));
  }

  // The largest open interval around y that no plane lies in; an end of it may be infinite.
  Interval gap(double y) const {
    Interval gap{-INFINITY, INFINITY};
    const auto narrow = [&](double per_row) {
      const double last = std::floor((y - kSampleShiftY) * per_row - 0.5), end = rows_ * per_row;
      if (last >= 0.0) gap.lo = std::max(gap.lo, (std::min(last, end - 1.0) + 0.5) / per_row + kSampleShiftY);
      if (last < end - 1.0) gap.hi = std::min(gap.hi, (std::max(last, -1.0) + 1.5) / per_row + kSampleShiftY);
    };
    if (centre_) narrow(1.0);
    if (samples_ > 0) narrow(samples_);
    if (locates_level_edges()) narrow(kLevelSteps);
    return gap;
  }

 private:
  int rows_, samples_;
  bool centre_;
};

}  // namespace nofacet
