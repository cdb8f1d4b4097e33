#include "raster/key_plane.h"

#include <cmath>

namespace nofacet {

KeyPlane fit_key_plane(const Net& net, Interval key) {
  struct Corner {
    double x, y, key;

    explicit Corner(const double* p) : x(p[kX] / p[kW]), y(p[kY] / p[kW]), key(p[kZ] / p[kW]) {}
  };
  const Corner p(net.at(0, 0)), q(net.at(net.n, 0)), r(net.at(0, net.m)), s(net.at(net.n, net.m));
  const double xa = q.x - p.x + s.x - r.x, ya = q.y - p.y + s.y - r.y, ka = q.key - p.key + s.key - r.key;
  const double xb = r.x - p.x + s.x - q.x, yb = r.y - p.y + s.y - q.y, kb = r.key - p.key + s.key - q.key;
  const double determinant = xa * yb - xb * ya;
  KeyPlane plane = {key.mid(), 0.0, 0.0, 0.5 * key.width()};
  const double by_x = (ka * yb - kb * ya) / determinant, by_y = (kb * xa - ka * xb) / determinant;
  if (!std::isfinite(by_x) || !std::isfinite(by_y)) return plane;
  Interval rest = Interval::empty();
  for (const double *point = net.points, *end = point + net.size(); point != end; point += 4) {
    rest.include((point[kZ] - by_x * point[kX] - by_y * point[kY]) / point[kW]);
  }
  if (0.5 * rest.width() < plane.error) plane = {rest.mid(), by_x, by_y, 0.5 * rest.width()};
  return plane;
}

}  // namespace nofacet
