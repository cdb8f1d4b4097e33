// The scan planes y = const of a frame: one through the pixel centres of each row, and `samples` for coverage.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

namespace nofacet {

// CAD models are full of edges that run exactly through pixel centres or sample lines under a standard view, where
// rounding decides on which side of an edge a sample falls, and may decide differently for two faces that share the
// edge: a crack. Every sample therefore lies this far (in pixels) off its nominal place, in general position
// (simulation of simplicity: Edelsbrunner, Muecke 1990). Values are still solved at the exact pixel centre.
inline constexpr double kSampleShiftX = 1.0726e-8, kSampleShiftY = 1.3093e-8;

class ScanPlanes {
 public:
  // `centre`: whether the planes through pixel centres are wanted; `samples`: planes a row for colour and coverage.
  ScanPlanes(int rows, int samples, bool centre) : rows_(rows) {
    for (int k = 0; k < samples; ++k) offsets_.push_back((k + 0.5) / samples);
    const bool odd = samples % 2 == 1;
    if (centre && !odd) offsets_.insert(offsets_.begin() + samples / 2, 0.5);
    centre_ = centre ? samples / 2 : -1;
    centre_counts_ = odd;
  }
  int per_row() const { return int(offsets_.size()); }
  int rows() const { return rows_; }
  // Index within a row of the plane through the pixel centres, or -1.
  int centre() const { return centre_; }
  // Whether plane k of a row is one of those averaged for coverage.
  bool counts(int k) const { return k != centre_ || centre_counts_; }
  double y(int row, int k) const { return row + offsets_[k] + kSampleShiftY; }
  // Whether some plane lies in [lo, hi).
  bool any_in(double lo, double hi) const {
    if (hi <= 0.0 || lo >= rows_) return false;
    int row = std::max(0, int(std::floor(lo)) - 1);
    for (; row < rows_ && row <= hi; ++row) {
      for (std::size_t k = 0; k < offsets_.size(); ++k) {
        const double plane = y(row, int(k));
        if (plane >= lo) return plane < hi;
      }
    }
    return false;
  }

 private:
  int rows_, centre_;
  bool centre_counts_;
  std::vector<double> offsets_;
};

}  // namespace nofacet
