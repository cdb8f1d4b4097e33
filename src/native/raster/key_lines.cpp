#include "raster/key_lines.h"

#include <cmath>

namespace nofacet {
namespace {

constexpr double kSteepest = 1e6;  // slopes beyond it, by x, bound nothing and cost digits

}  // namespace

Interval sag(const Span& span, double c) {
  const Interval bend = span.piece->key_bend - span.piece->x_bend * c;
  const double reach = 0.125 * (span.a1 - span.a0) * (span.a1 - span.a0);
  return {-reach * std::max(bend.hi, 0.0), -reach * std::min(bend.lo, 0.0)};
}

KeyLines::KeyLines(const Span& span) {
  const Piece& piece = *span.piece;
  const KeyPlane& plane = piece.hull.plane;
  const double chord = (span.key1 - span.key0) / (span.x1 - span.x0);
  // The chord, to which key - chord x comes back at both ends, or the piece's plane, whichever is closer.
  const Interval error = sag(span, chord);
  if (error.width() <= 2.0 * plane.error) {
    add_near(chord, span.x0, span.key0 + error.lo);
    add_far(chord, span.x0, span.key0 + error.hi);
  } else {
    const double at = plane.key(0.0, span.y);
    add_near(plane.by_x, 0.0, at - plane.error);
    add_far(plane.by_x, 0.0, at + plane.error);
  }
  // From the ends on, by the slopes that there are.
  const Interval slopes = piece.shears;
  if (piece.kind == CutKind::fold) {
    if (!(slopes.lo <= slopes.hi)) return;
    if (chord <= slopes.lo) {  // the branch that is steeper downwards
      if (slopes.lo < -kSteepest) return;
      add_near(slopes.lo, span.x1, span.key1);
      add_far(slopes.lo, span.x0, span.key0);
    } else if (slopes.hi < kSteepest) {
      add_near(slopes.hi, span.x0, span.key0);
      add_far(slopes.hi, span.x1, span.key1);
    }
  } else if (slopes.lo > -kSteepest && slopes.hi < kSteepest) {
    add_near(slopes.lo, span.x0, span.key0), add_near(slopes.hi, span.x1, span.key1);
    add_far(slopes.hi, span.x0, span.key0), add_far(slopes.lo, span.x1, span.key1);
  }
}

}  // namespace nofacet
