// What rays meet: patches of placed faces, projected so that every ray is a point of the screen.
//
// A ray is the intersection of the planes x = const and y = const (Nishita, Sederberg, Kakimoto 1990). Projection
// turns both into distances of control points, X - x W and Y - y W, once for all rays of a frame.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "bezier/net.h"
#include "scene.h"

namespace nofacet {

// Of a patch's magnitude: bounds the rounding of control points that come of it by repeated clipping and halving, each
// of which adds a few times 1e-16.
inline constexpr double kRounding = 1e-14;

struct RayPatch {
  Net net;  // of the whole patch, homogeneous screen points
  const Scene::PatchRef* patch;
  const Region* region;  // null: drawn whole
  int32_t face;
  bool perspective;  // depth is W / Z, else Z / W
  Interval x, y;     // screen box; everything where the patch crosses the eye plane
  double nearest;    // depth
  double magnitude;  // of the terms that distances of control points are made of, for margins of rounding

  Component depth_numerator() const { return perspective ? kW : kZ; }
  Component depth_denominator() const { return perspective ? kZ : kW; }
};

// A part of a patch, in its own parameters.
struct PatchBox {
  double s0, s1, t0, t1;
};

// Rays on a regular grid: ray (i, j) meets the screen at (x0 + i step, y0 + j step). Whether a surface is hit is
// decided there, and values are solved at the point (shift_x, shift_y) less (raster/scan_planes.h says why).
struct RayGrid {
  double x0, y0, step;
  int columns, rows;
  double shift_x, shift_y;

  double x(int i) const { return x0 + step * i; }
  double y(int j) const { return y0 + step * j; }
};

// Rays [i0, i1) x [j0, j1) of a grid.
struct RayRect {
  int i0, i1, j0, j1;

  bool empty() const { return i0 >= i1 || j0 >= j1; }
  int count() const { return (i1 - i0) * (j1 - j0); }
  // Keeps the rays that meet the box [x] x [y].
  void clip(const RayGrid& grid, Interval x, Interval y) {
    auto first = [](double value, int lo, int hi) { return int(std::ceil(std::clamp(value, double(lo), double(hi)))); };
    auto end = [](double value, int lo, int hi) { return int(std::floor(std::clamp(value, lo - 1.0, hi - 1.0))) + 1; };
    const double per = 1.0 / grid.step;
    const int a0 = first((x.lo - grid.x0) * per, i0, i1), a1 = end((x.hi - grid.x0) * per, i0, i1);
    const int b0 = first((y.lo - grid.y0) * per, j0, j1), b1 = end((y.hi - grid.y0) * per, j0, j1);
    *this = {a0, a1, b0, b1};
  }
};

}  // namespace nofacet
