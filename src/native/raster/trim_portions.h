// The parts of trim curves that lie in one piece, each monotone in screen y.
#pragma once
#include <optional>
#include <vector>

#include "bezier/net.h"
#include "bezier/parameter_map.h"
#include "raster/scan_planes.h"
#include "raster/screen_jet.h"
#include "trim/curve.h"

namespace nofacet {

struct Piece;

// A point of a trim curve: its parameter t, where it is in the face, in the piece and on the screen, and derivatives by
// t.
struct TrimPoint {
  double t, u, v, a, b, x, y, key;
  double at, bt, xt, yt, kt;
};

// A point of a piece, by the face's parameters; derivatives of the patch's by these, over the piece's width.
struct TrimPlace {
  double u, v, a, b;
  double s_slope, t_slope;
  ScreenJet screen;
};

// A part of a trim arc inside one piece, along which the screen y moves one way only.
struct TrimPortion {
  const TrimArc* arc;
  TrimPoint from, to;
  bool straight;  // all of this is linear between the ends
};

TrimPoint trim_point(const Piece& piece, const TrimArc& arc, double t);

// Finds the portions of one piece. Of what no plane of the frame meets only the y is kept at which it lies: between two
// planes with such an event the order of the crossings may change. Portions begin and end with events, too.
class PortionFinder {
 public:
  // `bounds`: of the piece's net. All must outlive the finder, which appends to the lists.
  PortionFinder(const Piece& piece, const NetBounds& bounds, const ScanPlanes& planes,
                std::vector<TrimPortion>& portions, std::vector<double>& events);

  void add(const TrimArc& arc);
  // Sorts the events and leaves one of those between the same two planes.
  void finish();

 private:
  TrimPoint end(const TrimArc& arc, double t);
  void find(const TrimArc& arc, const TrimPoint& from, const TrimPoint& to, int halvings);
  bool settle(const TrimArc& arc, const TrimPoint& from, const TrimPoint& to, Interval slope);
  void keep(const TrimArc& arc, const TrimPoint& from, const TrimPoint& to);
  Interval rise(Interval du, Interval dv, Interval s_slope, Interval t_slope, Interval ya, Interval yb) const;
  Net restricted(Interval a, Interval b);
  void add_event(double y);

  const Piece& piece_;
  const NetBounds& whole_;
  const ScanPlanes& planes_;
  std::vector<TrimPortion>& portions_;
  std::vector<double>& events_;
  Interval u_, v_;                     // of the piece
  Interval s_slope_, t_slope_;         // of the patch's parameters by u and v, over the piece
  bool affine_;                        // the map to the screen
  std::optional<TrimPlace> last_end_;  // where the next arc of a loop mostly begins
  std::vector<double> scratch_;
  double a_width_ = 1.0, b_width_ = 1.0;  // of the restricted net
};

}  // namespace nofacet
