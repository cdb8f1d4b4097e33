#include "extract/trim_loops.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "extract/corners.h"

namespace nofacet {
namespace {

struct Point2 {
  double u, v;
};

// An entry's control points in the direction and at the place of its loop.
class Entry {
 public:
  Entry(const RunView& runs, std::size_t k)
      : points_(runs.table.points + 3 * runs.table.first_point[runs.segment[k]]),
        degree_(int(runs.table.degree[runs.segment[k]])),
        backwards_(runs.backwards[k]),
        shift_{runs.shift[2 * k], runs.shift[2 * k + 1]} {}

  int degree() const { return degree_; }
  LoopPoint operator[](int i) const {
    const double* p = points_ + 3 * (backwards_ ? degree_ - i : i);
    return {p[0] + shift_.u * p[2], p[1] + shift_.v * p[2], p[2]};
  }
  LoopPoint front() const { return (*this)[0]; }
  LoopPoint back() const { return (*this)[degree_]; }

 private:
  const double* points_;
  int degree_;
  bool backwards_;
  Point2 shift_;
};

// The joint behind an entry.
struct Joint {
  bool open, small;  // whether the ends differ; whether by no more than rounding
  double width;      // of a wider gap, in parts of the face's box

  bool is_gap() const { return open && !small; }
  bool may_be_corner() const { return is_gap() && width >= kNarrowestCorner && width <= kWidestCorner; }
};

Joint joint(const RunView& runs, std::size_t loop, std::size_t k, const double* box) {
  const auto first = std::size_t(runs.loop_offsets[loop]), last = std::size_t(runs.loop_offsets[loop + 1]);
  const LoopPoint end = Entry(runs, k).back(), start = Entry(runs, k + 1 < last ? k + 1 : first).front();
  const double du = std::abs(start.u - end.u), dv = std::abs(start.v - end.v);
  if (!(du > 0 || dv > 0)) return {false, false, 0.0};
  const double width = box[1] - box[0], height = box[3] - box[2];
  if (du <= kSnap * width && dv <= kSnap * height && last - first > 1) return {true, true, 0.0};
  return {true, false, std::hypot(du / width, dv / height)};
}

// All joints; boxes: (faces, 4).
std::vector<Joint> joints_of(const RunView& runs, const double* boxes) {
  std::vector<Joint> joints;
  joints.reserve(runs.entries());
  for (std::size_t loop = 0; loop < runs.loops; ++loop) {
    for (auto k = std::size_t(runs.loop_offsets[loop]); k < std::size_t(runs.loop_offsets[loop + 1]); ++k) {
      joints.push_back(joint(runs, loop, k, boxes + 4 * runs.face[loop]));
    }
  }
  return joints;
}

struct Box {
  double u0 = std::numeric_limits<double>::infinity(), u1 = -u0, v0 = u0, v1 = -u0;

  void include(double u, double v) {
    // A coordinate that is not a number makes the box so, and is found there.
    u0 = std::isnan(u) || u < u0 ? u : u0;
    u1 = std::isnan(u) || u > u1 ? u : u1;
    v0 = std::isnan(v) || v < v0 ? v : v0;
    v1 = std::isnan(v) || v > v1 ? v : v1;
  }
  bool contains(double u, double v) const { return u >= u0 && u <= u1 && v >= v0 && v <= v1; }
  void store(double* out) const { out[0] = u0, out[1] = u1, out[2] = v0, out[3] = v1; }
};

// Control points of a Bezier curve's sixteen equal parts from its own, (16 (degree + 1), degree + 1).
std::vector<double> subdivision(int degree) {
  const int n = degree + 1;
  std::vector<double> halves(2 * n * n, 0.0);
  for (int i = 0; i < n; ++i) {
    double binomial = std::ldexp(1.0, -i);
    for (int j = 0; j <= i; ++j) {
      halves[i * n + j] = halves[(2 * n - 1 - i) * n + degree - j] = binomial;
      binomial = binomial * (i - j) / (j + 1);
    }
  }
  std::vector<double> result(n * n, 0.0);
  for (int i = 0; i < n; ++i) result[i * n + i] = 1.0;
  for (int parts = 1; parts < 16; parts *= 2) {
    std::vector<double> finer(2 * result.size(), 0.0);
    for (int part = 0; part < parts; ++part) {
      for (int i = 0; i < 2 * n; ++i) {
        for (int k = 0; k < n; ++k) {
          for (int j = 0; j < n; ++j) {
            finer[(2 * part * n + i) * n + j] += halves[i * n + k] * result[(part * n + k) * n + j];
          }
        }
      }
    }
    result = std::move(finer);
  }
  return result;
}

// Boxes of loops: first of the segments' ends, then of what bulges beyond those.
class Boxes {
 public:
  // segments: ranges of control points, anything with degree() and [].
  template <class Segments>
  Box of(const Segments& segments) {
    Box ends;
    for (const auto& segment : segments) {
      const LoopPoint from = segment[0], to = segment[segment.degree()];
      ends.include(from.u, from.v);
      ends.include(to.u, to.v);
    }
    Box box = ends;
    for (const auto& segment : segments) {
      if (segment.degree() > 1 && bulges(segment, ends)) include_parts(segment, box);
    }
    return box;
  }

 private:
  std::map<int, std::vector<double>> subdivisions_;

  template <class Segment>
  static bool bulges(const Segment& segment, const Box& box) {
    for (int i = 1; i < segment.degree(); ++i) {
      const LoopPoint p = segment[i];
      if (!box.contains(p.u / p.w, p.v / p.w)) return true;
    }
    return false;
  }

  template <class Segment>
  void include_parts(const Segment& segment, Box& box) {
    const int n = segment.degree() + 1;
    std::vector<double>& matrix = subdivisions_[segment.degree()];
    if (matrix.empty()) matrix = subdivision(segment.degree());
    for (int row = 0; row < 16 * n; ++row) {
      double u = 0.0, v = 0.0, w = 0.0;
      for (int i = 0; i < n; ++i) {
        const LoopPoint p = segment[i];
        const double part = matrix[row * n + i];
        u += part * p.u, v += part * p.v, w += part * p.w;
      }
      box.include(u / w, v / w);
    }
  }
};

// A segment that owns its points, as Boxes wants it.
struct Owned {
  const TrimSegment* segment;
  int degree() const { return int(segment->points.size()) - 1; }
  LoopPoint operator[](int i) const { return segment->points[i]; }
};

// The loops of each face in turn: visit(face, first loop, last loop).
template <class Visit>
void each_face(std::size_t loops, const int64_t* face, Visit&& visit) {
  for (std::size_t first = 0, last; first < loops; first = last) {
    for (last = first + 1; last < loops && face[last] == face[first];) ++last;
    visit(std::size_t(face[first]), first, last);
  }
}

class LoopWriter {
 public:
  explicit LoopWriter(LoopTable* table) : table_(table) {}

  void point(const LoopPoint& p) { table_->points.insert(table_->points.end(), {p.u, p.v, p.w}); }
  void end_segment(int64_t edge) {
    table_->segment_offsets.push_back(int64_t(table_->points.size() / 3));
    table_->edge.push_back(int32_t(edge));
  }
  void end_loop(std::size_t face) {
    table_->face.push_back(int64_t(face));
    table_->loop_offsets.push_back(int64_t(table_->edge.size()));
  }

 private:
  LoopTable* table_;
};

// A loop without corners: small gaps are moved away, wide ones get a link.
void write_linked(const RunView& runs, std::size_t loop, const std::vector<Joint>& joints, LoopTable* table) {
  LoopWriter writer(table);
  const auto first = std::size_t(runs.loop_offsets[loop]), last = std::size_t(runs.loop_offsets[loop + 1]);
  const std::size_t begin = table->points.size();
  for (std::size_t k = first; k < last; ++k) {
    const Entry entry(runs, k);
    const bool moved = k > first && joints[k - 1].small;
    writer.point(moved ? Entry(runs, k - 1).back() : entry.front());
    for (int i = 1; i <= entry.degree(); ++i) writer.point(entry[i]);
    writer.end_segment(runs.edge[k]);
    const Joint& behind = joints[k];
    if (behind.is_gap()) {
      writer.point(entry.back());
      writer.point(Entry(runs, k + 1 < last ? k + 1 : first).front());
      writer.end_segment(-1);
    } else if (k + 1 == last && behind.open) {
      std::copy_n(table->points.begin() + std::ptrdiff_t(begin), 3, table->points.end() - 3);
    }
  }
  writer.end_loop(std::size_t(runs.face[loop]));
}

TrimLoop loop_of(const RunView& runs, std::size_t loop, const bool* at_pole) {
  TrimLoop result;
  for (auto k = std::size_t(runs.loop_offsets[loop]); k < std::size_t(runs.loop_offsets[loop + 1]); ++k) {
    const Entry entry(runs, k);
    TrimSegment segment{{}, runs.edge[k], at_pole[k]};
    for (int i = 0; i <= entry.degree(); ++i) segment.points.push_back(entry[i]);
    result.push_back(std::move(segment));
  }
  return result;
}

// The loops first .. last of one face with corners; its box is brought up to date.
void write_welded(const RunView& runs, std::size_t first, std::size_t last, const bool* at_pole, Boxes& boxes,
                  double* box, LoopTable* table) {
  LoopWriter writer(table);
  std::vector<TrimLoop> loops;
  std::vector<Owned> segments;
  for (std::size_t loop = first; loop < last; ++loop) {
    loops.push_back(weld(loop_of(runs, loop, at_pole), box[1] - box[0], box[3] - box[2]));
  }
  for (const TrimLoop& loop : loops) {
    for (const TrimSegment& segment : loop) {
      segments.push_back({&segment});
      for (const LoopPoint& p : segment.points) writer.point(p);
      writer.end_segment(segment.edge);
    }
    writer.end_loop(std::size_t(runs.face[first]));
  }
  boxes.of(segments).store(box);
}

// A loop is a rectangle when its segments lie on the box's sides within this part of the box.
constexpr double kRectangle = 1e-9;

bool is_rectangle(const LoopView& loops, std::size_t loop, const double* box) {
  const double width = box[1] - box[0], height = box[3] - box[2];
  double twice_area = 0.0;
  for (int64_t k = loops.loop_offsets[loop]; k < loops.loop_offsets[loop + 1]; ++k) {
    unsigned sides = 15;  // those that all of the segment's points are on: u0, v0, u1, v1
    auto place = [&](int64_t point) {
      const double* p = loops.points + 3 * point;
      return Point2{(p[0] - box[0] * p[2]) / width, (p[1] - box[2] * p[2]) / height};
    };
    const int64_t begin = loops.segment_offsets[k], end = loops.segment_offsets[k + 1];
    for (int64_t point = begin; point < end && sides; ++point) {
      const double w = loops.points[3 * point + 2];
      const auto [u, v] = place(point);
      unsigned near = 0;
      if (std::abs(u) <= kRectangle) near |= 1;
      if (std::abs(v) <= kRectangle) near |= 2;
      if (std::abs(u - w) <= kRectangle) near |= 4;
      if (std::abs(v - w) <= kRectangle) near |= 8;
      sides &= near;
    }
    if (!sides) return false;
    const auto from = place(begin), to = place(end - 1);
    twice_area += from.u * to.v - to.u * from.v;
  }
  return std::abs(std::abs(0.5 * twice_area) - 1) <= 1e-6;
}

}  // namespace

std::vector<double> bounding_boxes(const RunView& runs, std::size_t faces) {
  std::vector<double> result(4 * faces, std::numeric_limits<double>::quiet_NaN());
  Boxes boxes;
  std::vector<Entry> entries;
  each_face(runs.loops, runs.face, [&](std::size_t face, std::size_t first, std::size_t last) {
    entries.clear();
    for (int64_t k = runs.loop_offsets[first]; k < runs.loop_offsets[last]; ++k) entries.emplace_back(runs, k);
    boxes.of(entries).store(result.data() + 4 * face);
  });
  return result;
}

std::vector<int64_t> corner_gaps(const RunView& runs, const double* boxes) {
  std::vector<int64_t> result;
  const std::vector<Joint> joints = joints_of(runs, boxes);
  for (std::size_t k = 0; k < joints.size(); ++k) {
    if (joints[k].may_be_corner()) result.push_back(int64_t(k));
  }
  return result;
}

LoopTable close_loops(const RunView& runs, const bool* kept, const bool* at_pole, double* boxes) {
  LoopTable table;
  table.points.reserve(9 * runs.entries());
  Boxes measure;
  const std::vector<Joint> joints = joints_of(runs, boxes);
  each_face(runs.loops, runs.face, [&](std::size_t face, std::size_t first, std::size_t last) {
    if (!kept[face]) return;
    const auto begin = joints.begin() + runs.loop_offsets[first], end = joints.begin() + runs.loop_offsets[last];
    if (std::any_of(begin, end, [](const Joint& joint) { return joint.may_be_corner(); })) {
      return write_welded(runs, first, last, at_pole, measure, boxes + 4 * face, &table);
    }
    for (std::size_t loop = first; loop < last; ++loop) write_linked(runs, loop, joints, &table);
  });
  return table;
}

std::vector<uint8_t> rectangles(const LoopView& loops, const double* boxes, std::size_t faces) {
  std::vector<uint8_t> result(faces, 0);
  each_face(loops.loops, loops.face, [&](std::size_t face, std::size_t first, std::size_t last) {
    result[face] = last - first == 1 && is_rectangle(loops, first, boxes + 4 * face);
  });
  return result;
}

}  // namespace nofacet
