// Spans: what a scan plane shows of one piece, inside its trim loops.
#pragma once
#include <span>
#include <vector>

#include "raster/cut.h"
#include "raster/screen_jet.h"
#include "raster/trim_crossings.h"

namespace nofacet {

// A stretch of the cut along which x moves one way only, inside the trim loops: on it every x in [x0, x1] has exactly
// one point of the surface.
struct Span {
  const Piece* piece;
  double y;                  // of the scan plane
  double x0, x1;             // pixels, x0 < x1
  double a0, b0, a1, b1;     // the piece's parameters at x0 and x1
  double key0, key1;         // at x0 and x1
  double nearest, farthest;  // bounds of the key along the span
  int32_t plane;             // index of the scan plane in its band
  bool fold0, fold1;         // x turns at x0, at x1
  uint16_t curve;            // of the curves in which the plane cuts the piece
  int32_t order = 0;         // of the piece in its band

  // Bounds of the key between two points of the span.
  Interval key_between(double a_from, double key_from, double a_to, double key_to) const;
};

// A point of a surface at a given place on the screen.
struct SurfaceSample {
  double a, b;
  Jet jet;
};

// Makes the spans of pieces on many planes. One per thread.
class SpanMaker {
 public:
  // Appends the spans of `piece` on the planes y[0] .. y[count - 1] that overlap 0 <= x <= width; `first_plane` is
  // the index of the first one.
  void append(const Piece& piece, const double* y, int count, int first_plane, int width, std::vector<Span>& out);

 private:
  void append_point(const Piece& piece, const double* y, int count, int first_plane, int width,
                    std::vector<Span>& out) const;
  bool same_layout(const Piece& piece, std::span<const TrimCrossing> crossings, double y);
  bool inside(const Piece& piece, double y, const CutPoint& from, const CutPoint& to, std::size_t stretch);

  PieceCutter cutter_;
  TrimCrosser crosser_;
  // Which stretches of a plane, between one crossing and the next, are inside. It stays the same from plane to plane
  // while they meet the same portions in the same order and no portion begins or ends between them.
  std::vector<signed char> inside_;  // 1, 0, or -1: not known
  std::vector<int> layout_;          // portions crossed, in order
  int next_event_ = 0;               // of the piece
};

// The span's surface point at pixel position (x, y'), where y' is within a few nanopixels of the span's plane and x of
// its range. Newton from (sample->a, sample->b); where that strays, bisection on the cut, which cannot fail.
void solve_sample(const Span& span, double x, double y, SurfaceSample* sample);

// Key of the span at x, and the parameter a there.
double key_at(const Span& span, double x, double* a);

// The same at several x at once, ascending. The last Newton step of each leaves a remainder below kPixelTolerance, or
// is below kSpanKeyStep.
struct SpanKeys {
  static constexpr int kMost = 8;

  double a[kMost], key[kMost];
};
void keys_at(const Span& span, const double* x, int count, SpanKeys* out);
// A last Newton step no larger leaves an error of its square and is enough, whatever the piece.
inline constexpr double kSpanKeyStep = 1e-7;

}  // namespace nofacet
