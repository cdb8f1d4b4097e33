// Hidden surface removal on one scan plane: which span is nearest, over which stretch of x.
#pragma once
#include <vector>

#include "raster/span.h"

namespace nofacet {

// A stretch [x0, x1] of the scan plane on which `span` is the nearest surface.
struct VisibleSegment {
  double x0, x1;
  const Span* span;
};

// What one scan plane meets.
struct ScanLine {
  double y = 0.0;
  std::vector<VisibleSegment> segments;  // nearest opaque spans: disjoint, ascending in x
  std::vector<const Span*> transparent;  // in the order of insertion
  mutable std::size_t hint = 0;          // where a segment was looked for last: the next is often near

  void clear(double plane_y) {
    y = plane_y;
    hint = 0;
    segments.clear();
    transparent.clear();
  }
  // Whether nothing beyond the key `nearest` can be seen of the plane between x0 and x1.
  bool hides(double x0, double x1, double nearest) const;
  // The stretches of x covered by anything, disjoint and ascending, into `out`.
  void covered(double width, std::vector<Interval>& out) const;
};

// Sorts stretches of x and joins those that overlap or meet.
void merge_stretches(std::vector<Interval>& stretches);

// `depth_tie`: depths closer than this are one and the same surface, for coincident faces computed from different
// patches differ by rounding only; the face with the lower index is then shown.
//
// Where two surfaces pass through each other the crossing is solved to 1e-6 px; a second crossing of the same two spans
// within half a pixel along x may be missed, and so may one within 1e-5 px of where they touch. Spans are inserted in a
// fixed order, which decides only on overlaps below kNegligiblePixels. One per thread.
class Visibility {
 public:
  Visibility(const Camera& camera, double depth_tie) : camera_(camera), depth_tie_(depth_tie) {}

  // The difference of keys that stands for the depth tie, near a key.
  double tie(double key) const { return camera_.perspective ? depth_tie_ * key * key : depth_tie_; }
  // Whether bounds of the keys tell that `span` is behind the segments all along. Such a span need not be kept.
  bool hidden(const Span& span, const std::vector<VisibleSegment>& segments) const;
  // Makes `span` compete with the segments.
  void insert(const Span& span, std::vector<VisibleSegment>& segments);
  // Appends the stretches of `span` that none of `segments` hides: how a transparent face lies before opaque ones.
  void append_visible(const Span& span, const std::vector<VisibleSegment>& segments, std::vector<VisibleSegment>& out);

 private:
  struct Range {
    std::ptrdiff_t first, last;
  };
  // How much farther one span's key is than another's at x.
  struct KeyDifference {
    double x, d;
  };

  Range merge(const Span& span, const std::vector<VisibleSegment>& segments);
  void push(double x0, double x1, const Span* span);
  const Span* decide(Interval fresh_key, Interval old_key, double tie, const Span& fresh, const Span& old) const;
  bool show(const Span* winner, const Span& fresh, double x0, double x1);
  bool compare(const Span& fresh, const Span& old, double x0, double x1);
  bool compare_points(const Span& fresh, const Span& old, double x0, double x1);
  bool cross(const Span& fresh, const Span& old, KeyDifference left, KeyDifference right, double tie);
  KeyDifference leave_touch(const Span& fresh, const Span& old, double end, KeyDifference* far, double tie) const;
  double solve_crossing(const Span& fresh, const Span& old, KeyDifference left, KeyDifference right) const;

  const Camera& camera_;
  double depth_tie_;
  std::vector<VisibleSegment> merged_;
  bool shown_ = false;
};

}  // namespace nofacet
