#include "raster/key_lines.h"

#include <cmath>

namespace nofacet {
namespace {

constexpr double kSteepest = 1e6;  // slopes beyond it, by x, bound nothing and cost digits

}  // namespace

Interval key_slopes(const Span& span) {
  const Piece& piece = *span.piece;
  if (piece.kind != CutKind::fold) return piece.shears;
  if (!(piece.shears.lo <= piece.shears.hi)) return {-INFINITY, INFINITY};
  // Each branch is steeper than the shears, one way or the other.
  const bool falls = span.key1 - span.key0 <= piece.shears.lo * (span.x1 - span.x0);
  return falls ? Interval{-INFINITY, piece.shears.lo} : Interval{piece.shears.hi, INFINITY};
}

Interval sag(const Piece& piece, double a0, double a1, double c) {
  const Interval bend = piece.key_bend - piece.x_bend * c;
  const double reach = 0.125 * (a1 - a0) * (a1 - a0);
  return {-reach * std::max(bend.hi, 0.0), -reach * std::min(bend.lo, 0.0)};
}

KeyLines::KeyLines(const Span& span) {
  const KeyPlane& plane = span.piece->hull.plane;
  const double chord = (span.key1 - span.key0) / (span.x1 - span.x0);
  // The chord, to which key - chord x comes back at both ends, or the piece's plane, whichever is closer.
  const Interval error = sag(*span.piece, span.a0, span.a1, chord);
  if (span.piece->kind != CutKind::uncertain && error.width() <= 2.0 * plane.error) {
    add_near(chord, span.x0, span.key0 + error.lo);
    add_far(chord, span.x0, span.key0 + error.hi);
  } else {
    const double at = plane.key(0.0, span.y);
    add_near(plane.by_x, 0.0, at - plane.error);
    add_far(plane.by_x, 0.0, at + plane.error);
  }
  // From the ends on, by the slopes that there are.
  const Interval slopes = key_slopes(span);
  if (slopes.lo > -kSteepest) add_near(slopes.lo, span.x0, span.key0), add_far(slopes.lo, span.x1, span.key1);
  if (slopes.hi < kSteepest) add_near(slopes.hi, span.x1, span.key1), add_far(slopes.hi, span.x0, span.key0);
}

}  // namespace nofacet
