#include "extract/spline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <stdexcept>

#include "bezier/bernstein.h"
#include "extract/blossom.h"

namespace nofacet {

KnotVector::KnotVector(int degree, bool periodic, const std::vector<double>& knots,
                       const std::vector<int>& multiplicities, double low, double high)
    : degree_(degree) {
  if (degree < 1 || degree > kMaxDegree) throw std::invalid_argument("a spline's degree is out of range");
  if (periodic) {
    unroll(knots, multiplicities, low, high);
    return;
  }
  for (std::size_t k = 0; k < knots.size(); ++k) flat_.insert(flat_.end(), std::size_t(multiplicities[k]), knots[k]);
  pole_count_ = size() - degree - 1;
  if (pole_count_ <= degree) throw std::invalid_argument("a spline has too few knots");
}

void KnotVector::unroll(const std::vector<double>& knots, const std::vector<int>& multiplicities, double low,
                        double high) {
  std::vector<double> once;
  for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
    once.insert(once.end(), std::size_t(multiplicities[k]), knots[k]);
  }
  const auto count = int64_t(once.size());
  const double period = knots.back() - knots.front();
  const double first = std::floor((low - knots.front()) / period), last = std::ceil((high - knots.front()) / period);
  if (!count || !(period > 0) || !(last - first < 1e6) || !(std::abs(first) < 1e9)) {
    throw std::invalid_argument("a periodic spline is wanted over too many periods");
  }
  // flat knot p is the last copy of the first knot; one period and the degree are added at both ends
  first_pole_ = (int64_t(first) - 1) * count;
  pole_count_ = count;
  const int64_t end = (int64_t(last) + 1) * count + 2 * degree_ + 2;
  for (int64_t index = first_pole_; index < end; ++index) {
    const int64_t shifted = index - degree_ + multiplicities[0] - 1;
    const int64_t knot = pole(shifted);
    flat_.push_back(once[std::size_t(knot)] + period * double((shifted - knot) / count));
  }
}

namespace {

// The span for an interval that lies outside the domain, or between two knots a sliver apart.
KnotSpan span_outside(const KnotVector& vector, double low, double high) {
  std::vector<int64_t> filled;
  for (int64_t j = vector.degree(); j < vector.size() - vector.degree() - 1; ++j) {
    if (vector.knot(j + 1) > vector.knot(j)) filled.push_back(j);
  }
  if (filled.empty()) throw std::out_of_range("a spline without a span");
  const int64_t flat = low >= vector.knot(filled.back()) ? filled.back() : filled.front();
  const double middle = 0.5 * (vector.knot(flat) + vector.knot(flat + 1));
  return {flat, std::min(low, middle), std::max(high, middle)};  // blossoming needs one end inside the span
}

}  // namespace

std::vector<KnotSpan> spans(const KnotVector& vector, double low, double high) {
  const double sliver = kSliver * (high - low);
  std::vector<KnotSpan> result;
  for (int64_t j = vector.degree(); j < vector.size() - vector.degree() - 1; ++j) {
    const double left = vector.knot(j), right = vector.knot(j + 1);
    if (right > left && right - left > sliver && right > low + sliver && left < high - sliver)
      result.push_back({j, left, 0.0});
  }
  if (result.empty()) return {span_outside(vector, low, high)};
  result.front().start = low;
  for (std::size_t k = 0; k + 1 < result.size(); ++k) result[k].stop = result[k + 1].start;
  result.back().stop = high;
  return result;
}

namespace {

// Spans of one degree side by side, as blossom() wants them.
class Columns {
 public:
  Columns(int degree, std::size_t components, std::size_t count)
      : degree_(degree),
        components_(components),
        count_(count),
        points_(components * stride()),
        knots_(2 * std::size_t(degree) * count),
        start_(count),
        stop_(count) {}

  double& point(std::size_t component, int i, std::size_t column) {
    return points_[(component * std::size_t(degree_ + 1) + std::size_t(i)) * count_ + column];
  }
  // From one component of a point to the next.
  std::size_t stride() const { return std::size_t(degree_ + 1) * count_; }
  void set(std::size_t column, const KnotVector& vector, const KnotSpan& span) {
    for (int k = 0; k < 2 * degree_; ++k) {
      knots_[std::size_t(k) * count_ + column] = vector.knot(span.flat + 1 - degree_ + k);
    }
    start_[column] = span.start;
    stop_[column] = span.stop;
  }
  void blossom() {
    nofacet::blossom(points_.data(), components_, degree_, count_, knots_.data(), start_.data(), stop_.data());
  }

 private:
  int degree_;
  std::size_t components_, count_;
  std::vector<double> points_, knots_, start_, stop_;
};

constexpr std::size_t kTogether = 64;  // spans blossomed together: few enough to stay in the cache

// Blossoms spans of one degree: put(job, columns, column) fills a column for each job, take(job, columns, column) gets
// the Bezier points out again.
template <class Jobs, class Put, class Take>
void blossom_all(const Jobs& jobs, int degree, std::size_t components, Put&& put, Take&& take) {
  for (std::size_t first = 0; first < jobs.size(); first += kTogether) {
    const std::size_t count = std::min(kTogether, jobs.size() - first);
    Columns columns(degree, components, count);
    for (std::size_t k = 0; k < count; ++k) put(jobs[first + k], columns, k);
    columns.blossom();
    for (std::size_t k = 0; k < count; ++k) take(jobs[first + k], columns, k);
  }
}

// Stored poles: `dim` coordinates, with a weight behind them if rational.
class Poles {
 public:
  // Takes `count` poles from the reader.
  Poles(ByteReader& reader, int64_t count, int dim, bool rational)
      : dim_(dim), rational_(rational), data_(reader.here()) {
    reader.skip(count, 8 * components());
  }

  int dim() const { return dim_; }
  bool rational() const { return rational_; }
  std::size_t components() const { return std::size_t(dim_ + rational_); }
  // Homogeneous coordinates of pole `number`, one every `stride`.
  void get(int64_t number, double* out, std::size_t stride) const {
    double pole[4];
    std::memcpy(pole, data_ + std::size_t(number) * 8 * components(), 8 * components());
    for (int c = 0; c < dim_; ++c) out[std::size_t(c) * stride] = rational_ ? pole[c] * pole[dim_] : pole[c];
    if (rational_) out[std::size_t(dim_) * stride] = pole[dim_];
  }

 private:
  int dim_;
  bool rational_;
  const unsigned char* data_;
};

KnotVector read_knots(ByteReader& reader, int degree, bool periodic, int64_t count, double low, double high) {
  std::vector<double> knots;
  std::vector<int> multiplicities;
  for (int64_t k = 0; k < count; ++k) {
    knots.push_back(reader.real());
    multiplicities.push_back(int(reader.integer()));
  }
  return KnotVector(degree, periodic, knots, multiplicities, low, high);
}

struct StoredCurve {
  std::size_t owner;
  KnotVector vector;
  Poles poles;
  std::vector<KnotSpan> spans;
};

StoredCurve read_curve(Bytes bytes, int dim, std::size_t owner, int64_t at, double low, double high) {
  ByteReader reader(bytes, std::size_t(at));
  const bool rational = reader.byte(), periodic = reader.byte();
  const int degree = int(reader.short_integer());
  const int64_t poles = reader.integer(), knots = reader.integer();
  const Poles stored(reader, poles, dim, rational);
  KnotVector vector = read_knots(reader, degree, periodic, knots, low, high);
  std::vector<KnotSpan> wanted = spans(vector, low, high);
  return {owner, std::move(vector), stored, std::move(wanted)};
}

// All pieces of curves of one degree, rational or not.
CurvePieces pieces_of(const std::vector<StoredCurve>& curves) {
  struct Job {
    const StoredCurve* curve;
    const KnotSpan* span;
  };
  const int degree = curves[0].vector.degree(), dim = curves[0].poles.dim();
  const std::size_t components = curves[0].poles.components();
  CurvePieces result{degree, {}, {}, {}, {}};
  std::vector<Job> jobs;
  for (const StoredCurve& curve : curves) {
    for (const KnotSpan& span : curve.spans) {
      jobs.push_back({&curve, &span});
      result.owner.push_back(int64_t(curve.owner));
      result.start.push_back(span.start);
      result.stop.push_back(span.stop);
    }
  }
  result.points.assign(jobs.size() * std::size_t(degree + 1) * std::size_t(dim + 1), 1.0);
  double* out = result.points.data();
  auto put = [&](const Job& job, Columns& columns, std::size_t column) {
    const KnotVector& vector = job.curve->vector;
    columns.set(column, vector, *job.span);
    for (int i = 0; i <= degree; ++i) {
      const int64_t pole = vector.pole(vector.first_pole(job.span->flat) + i);
      job.curve->poles.get(pole, &columns.point(0, i, column), columns.stride());
    }
  };
  auto take = [&](const Job&, Columns& columns, std::size_t column) {
    for (int i = 0; i <= degree; ++i, out += dim + 1) {
      for (std::size_t c = 0; c < components; ++c) out[c] = columns.point(c, i, column);
    }
  };
  blossom_all(jobs, degree, components, put, take);
  return result;
}

struct StoredSurface {
  std::size_t owner;
  KnotVector u, v;
  Poles poles;
  int64_t columns;  // of the net of poles, v running faster
  std::vector<KnotSpan> in_u, in_v;

  int64_t first_row() const { return u.first_pole(in_u.front().flat); }
  std::size_t rows() const { return std::size_t(in_u.back().flat - in_u.front().flat + u.degree() + 1); }
};

StoredSurface read_surface(Bytes bytes, bool bezier, std::size_t owner, int64_t at, const double* box) {
  ByteReader reader(bytes, std::size_t(at));
  const bool rational = reader.byte() | reader.byte();
  if (bezier) {
    const int degree_u = int(reader.short_integer()), degree_v = int(reader.short_integer());
    KnotVector u(degree_u, false, {0.0, 1.0}, {degree_u + 1, degree_u + 1}, box[0], box[1]);
    KnotVector v(degree_v, false, {0.0, 1.0}, {degree_v + 1, degree_v + 1}, box[2], box[3]);
    std::vector<KnotSpan> in_u = spans(u, box[0], box[1]), in_v = spans(v, box[2], box[3]);
    const Poles poles(reader, int64_t(degree_u + 1) * (degree_v + 1), 3, rational);
    return {owner, std::move(u), std::move(v), poles, degree_v + 1, std::move(in_u), std::move(in_v)};
  }
  const bool periodic_u = reader.byte(), periodic_v = reader.byte();
  const int degree_u = int(reader.short_integer()), degree_v = int(reader.short_integer());
  const int64_t rows = reader.integer(), columns = reader.integer();
  const int64_t knots_u = reader.integer(), knots_v = reader.integer();
  const Poles poles(reader, rows * columns, 3, rational);
  KnotVector u = read_knots(reader, degree_u, periodic_u, knots_u, box[0], box[1]);
  KnotVector v = read_knots(reader, degree_v, periodic_v, knots_v, box[2], box[3]);
  std::vector<KnotSpan> in_u = spans(u, box[0], box[1]), in_v = spans(v, box[2], box[3]);
  return {owner, std::move(u), std::move(v), poles, columns, std::move(in_u), std::move(in_v)};
}

// Every needed row of poles blossomed in v, surface by surface, span by span, row by row: for each `components` values
// of its points, one point behind the other.
std::vector<double> strips_of(const std::vector<StoredSurface>& surfaces) {
  struct Job {
    const StoredSurface* surface;
    const KnotSpan* span;
    int64_t row;
  };
  const int degree = surfaces[0].v.degree();
  const std::size_t components = surfaces[0].poles.components();
  std::vector<Job> jobs;
  for (const StoredSurface& surface : surfaces) {
    for (const KnotSpan& span : surface.in_v) {
      for (std::size_t row = 0; row < surface.rows(); ++row) {
        jobs.push_back({&surface, &span, surface.u.pole(surface.first_row() + int64_t(row))});
      }
    }
  }
  std::vector<double> strips(jobs.size() * components * std::size_t(degree + 1));
  double* out = strips.data();
  auto put = [&](const Job& job, Columns& columns, std::size_t column) {
    const KnotVector& v = job.surface->v;
    columns.set(column, v, *job.span);
    for (int j = 0; j <= degree; ++j) {
      const int64_t pole = job.row * job.surface->columns + v.pole(v.first_pole(job.span->flat) + j);
      job.surface->poles.get(pole, &columns.point(0, j, column), columns.stride());
    }
  };
  auto take = [&](const Job&, Columns& columns, std::size_t column) {
    for (int j = 0; j <= degree; ++j) {
      for (std::size_t c = 0; c < components; ++c) *out++ = columns.point(c, j, column);
    }
  };
  blossom_all(jobs, degree, components, put, take);
  return strips;
}

// All patches of surfaces of one bidegree, rational or not: blossomed in v first, then in u.
SurfacePatches patches_of(const std::vector<StoredSurface>& surfaces) {
  struct Job {
    const StoredSurface* surface;
    const KnotSpan* span;
    const double* strip;  // of the first of degree_u + 1 rows
  };
  const int du = surfaces[0].u.degree(), dv = surfaces[0].v.degree();
  const std::size_t components = surfaces[0].poles.components(), across = components * std::size_t(dv + 1);
  const std::vector<double> strips = strips_of(surfaces);
  SurfacePatches result{du, dv, {}, {}, {}};
  std::vector<Job> jobs;
  const double* own = strips.data();
  for (const StoredSurface& surface : surfaces) {
    for (const KnotSpan& u : surface.in_u) {
      const auto row = std::size_t(u.flat - surface.in_u.front().flat);
      for (std::size_t v = 0; v < surface.in_v.size(); ++v) {
        jobs.push_back({&surface, &u, own + (v * surface.rows() + row) * across});
        result.owner.push_back(int64_t(surface.owner));
        result.domain.insert(result.domain.end(), {u.start, u.stop, surface.in_v[v].start, surface.in_v[v].stop});
      }
    }
    own += surface.in_v.size() * surface.rows() * across;
  }
  result.points.assign(jobs.size() * std::size_t(du + 1) * std::size_t(dv + 1) * 4, 1.0);
  double* out = result.points.data();
  auto put = [&](const Job& job, Columns& columns, std::size_t column) {
    columns.set(column, job.surface->u, *job.span);
    const double* value = job.strip;
    for (int i = 0; i <= du; ++i) {
      for (std::size_t c = 0; c < across; ++c) columns.point(c, i, column) = *value++;
    }
  };
  auto take = [&](const Job&, Columns& columns, std::size_t column) {
    for (int i = 0; i <= du; ++i) {
      for (int j = 0; j <= dv; ++j, out += 4) {
        for (std::size_t c = 0; c < components; ++c) out[c] = columns.point(std::size_t(j) * components + c, i, column);
      }
    }
  };
  blossom_all(jobs, du, across, put, take);
  return result;
}

}  // namespace

std::vector<CurvePieces> spline_pieces(Bytes bytes, int dim, std::size_t count, const int64_t* at, const double* first,
                                       const double* last) {
  std::map<std::pair<int, bool>, std::vector<StoredCurve>> kinds;  // by degree, rational
  for (std::size_t k = 0; k < count; ++k) {
    StoredCurve curve = read_curve(bytes, dim, k, at[k], first[k], last[k]);
    kinds[{curve.vector.degree(), curve.poles.rational()}].push_back(std::move(curve));
  }
  std::vector<CurvePieces> result;
  for (const auto& [kind, curves] : kinds) result.push_back(pieces_of(curves));
  return result;
}

std::vector<SurfacePatches> spline_patches(Bytes bytes, bool bezier, std::size_t count, const int64_t* at,
                                           const double* boxes) {
  std::map<std::array<int, 3>, std::vector<StoredSurface>> kinds;  // by rational, degrees
  for (std::size_t k = 0; k < count; ++k) {
    StoredSurface surface = read_surface(bytes, bezier, k, at[k], boxes + 4 * k);
    kinds[{surface.poles.rational(), surface.u.degree(), surface.v.degree()}].push_back(std::move(surface));
  }
  std::vector<SurfacePatches> result;
  for (const auto& [kind, surfaces] : kinds) result.push_back(patches_of(surfaces));
  return result;
}

CurvePieces curve_pieces(const KnotVector& vector, const double* poles, std::size_t components, double low,
                         double high) {
  const std::vector<KnotSpan> wanted = spans(vector, low, high);
  CurvePieces result{vector.degree(), {}, {}, {}, {}};
  auto put = [&](const KnotSpan& span, Columns& columns, std::size_t column) {
    columns.set(column, vector, span);
    for (int i = 0; i <= vector.degree(); ++i) {
      const auto pole = std::size_t(vector.pole(vector.first_pole(span.flat) + i));
      for (std::size_t c = 0; c < components; ++c) columns.point(c, i, column) = poles[pole * components + c];
    }
  };
  auto take = [&](const KnotSpan& span, Columns& columns, std::size_t column) {
    result.owner.push_back(0);
    result.start.push_back(span.start);
    result.stop.push_back(span.stop);
    for (int i = 0; i <= vector.degree(); ++i) {
      for (std::size_t c = 0; c < components; ++c) result.points.push_back(columns.point(c, i, column));
    }
  };
  blossom_all(wanted, vector.degree(), components, put, take);
  return result;
}

}  // namespace nofacet
