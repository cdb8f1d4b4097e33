// Lines that bound the depth key along a span.
#pragma once
#include "raster/span.h"

namespace nofacet {

struct KeyLine {
  double at, slope;

  double key(double x) const { return at + slope * x; }
};

// All along the span the key is no less than each of `near` and no more than each of `far`.
struct KeyLines {
  static constexpr int kMost = 3;

  KeyLine near[kMost], far[kMost];
  int near_count = 0, far_count = 0;

  explicit KeyLines(const Span& span);

 private:
  void add_near(double slope, double x, double key) { near[near_count++] = {key - slope * x, slope}; }
  void add_far(double slope, double x, double key) { far[far_count++] = {key - slope * x, slope}; }
};

// Bounds of d key / dx along a span; infinite where there are none.
Interval key_slopes(const Span& span);
// How far key - c x may be from running evenly with the parameter between two points of a span, at a0 and a1.
Interval sag(const Piece& piece, double a0, double a1, double c);

}  // namespace nofacet
