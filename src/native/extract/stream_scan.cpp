#include "extract/stream_scan.h"

#include <stdexcept>
#include <string>

#include "extract/byte_reader.h"

namespace nofacet {
namespace {

enum CurveKind { kLine = 1, kCircle, kEllipse, kParabola, kHyperbola, kBezierCurve, kSpline, kTrimmed, kOffset };
enum SurfaceKind {
  kPlane = 1,
  kCylinder,
  kCone,
  kSphere,
  kTorus,
  kExtrusion,
  kRevolution,
  kBezierSurface,
  kSplineSurface,
  kTrimmedSurface,
  kOffsetSurface
};
enum ShapeKind { kFace = 4, kEdge = 6, kVertex = 7 };  // TopAbs_ShapeEnum
constexpr std::size_t kKnot = 12;                      // bytes: a real and its multiplicity

[[noreturn]] void unknown(const char* what, int kind) {
  throw std::invalid_argument(std::string("unknown kind of ") + what + " " + std::to_string(kind));
}

void skip_curve(ByteReader& reader, int dim, CurveScan* scan);

// The rest of a curve's record behind its kind.
void skip_curve_body(ByteReader& reader, int dim, int kind) {
  const std::size_t frame = 8 * std::size_t(3 * dim + (dim == 3 ? 3 : 0));
  switch (kind) {
    case kLine:
      return reader.skip(16 * dim);
    case kCircle:
    case kParabola:
      return reader.skip(frame + 8);
    case kEllipse:
    case kHyperbola:
      return reader.skip(frame + 16);
    case kBezierCurve: {
      const bool rational = reader.byte();
      const int64_t degree = reader.short_integer();
      return reader.skip(degree + 1, 8 * std::size_t(dim + rational));
    }
    case kSpline: {
      const bool rational = reader.byte();
      reader.skip(3);  // periodic, degree
      const int64_t poles = reader.integer(), knots = reader.integer();
      reader.skip(poles, 8 * std::size_t(dim + rational));
      return reader.skip(knots, kKnot);
    }
    case kOffset:
      reader.skip(dim == 2 ? 8 : 32);
      return skip_curve(reader, dim, nullptr);
    default:
      unknown("curve", kind);
  }
}

void skip_curve(ByteReader& reader, int dim, CurveScan* scan) {
  const std::size_t start = reader.at();
  int kind = reader.byte();
  while (kind == kTrimmed) {
    reader.skip(16);
    kind = reader.byte();
  }
  if (scan) {
    scan->start.push_back(int64_t(start));
    scan->kind.push_back(uint8_t(kind));
    scan->at.push_back(int64_t(reader.at()));
  }
  skip_curve_body(reader, dim, kind);
}

void skip_surface(ByteReader& reader, SurfaceScan* scan);

void skip_surface_body(ByteReader& reader, int kind, SurfaceScan* scan) {
  switch (kind) {
    case kPlane:
      return reader.skip(96);
    case kCylinder:
    case kSphere:
      return reader.skip(104);
    case kCone:
    case kTorus:
      return reader.skip(112);
    case kExtrusion:
    case kRevolution:
      reader.skip(kind == kExtrusion ? 24 : 48);
      return skip_curve(reader, 3, scan ? &scan->profiles : nullptr);
    case kOffsetSurface:
      reader.skip(8);
      return skip_surface(reader, nullptr);
    case kBezierSurface: {
      const bool rational = reader.byte() | reader.byte();
      const int64_t u = reader.short_integer() + 1, v = reader.short_integer() + 1;
      return reader.skip(u * v, 8 * std::size_t(3 + rational));
    }
    case kSplineSurface: {
      const bool rational = reader.byte() | reader.byte();
      reader.skip(6);  // periodic, degrees
      const int64_t u = reader.integer(), v = reader.integer(), knots_u = reader.integer(), knots_v = reader.integer();
      reader.skip(u * v, 8 * std::size_t(3 + rational));
      return reader.skip(knots_u + knots_v, kKnot);
    }
    default:
      unknown("surface", kind);
  }
}

void skip_surface(ByteReader& reader, SurfaceScan* scan) {
  const std::size_t start = reader.at();
  int kind = reader.byte();
  while (kind == kTrimmedSurface) {
    reader.skip(32);
    kind = reader.byte();
  }
  if (scan) {
    scan->start.push_back(int64_t(start));
    scan->kind.push_back(uint8_t(kind));
    scan->at.push_back(int64_t(reader.at()));
    const bool swept = kind == kExtrusion || kind == kRevolution;
    scan->profile.push_back(swept ? int64_t(scan->profiles.start.size()) : 0);
  }
  skip_surface_body(reader, kind, scan);
}

// An edge's tolerance and its representations: its curve in space, its curves on surfaces.
void read_edge(ByteReader& reader, std::size_t shape, ShapeScan& scan) {
  scan.edge_tolerance[shape] = reader.real();
  reader.skip(2);  // same parameter, same range
  scan.edge_degenerated[shape] = reader.byte() != 0;
  while (const int kind = reader.byte()) {
    if (kind == 1) {
      scan.edge_curve[shape] = reader.integer();
      scan.edge_location[shape] = reader.integer();
      scan.edge_first[shape] = reader.real();
      scan.edge_last[shape] = reader.real();
    } else if (kind == 2 || kind == 3) {  // 3: a seam, with a curve for either side
      scan.pcurve_curve.push_back(reader.integer());
      scan.pcurve_second.push_back(kind == 3 ? reader.integer() : 0);
      if (kind == 3) reader.skip(1);  // continuity
      scan.pcurve_surface.push_back(reader.integer());
      scan.pcurve_location.push_back(reader.integer());
      scan.pcurve_first.push_back(reader.real());
      scan.pcurve_last.push_back(reader.real());
    } else if (kind == 4) {
      reader.skip(17);  // continuity of two surfaces
    } else {
      unknown("edge representation", kind);
    }
  }
}

void skip_vertex(ByteReader& reader) {
  reader.skip(32);  // tolerance, point
  while (const int kind = reader.byte()) {
    if (kind > 3) unknown("point representation", kind);
    reader.skip(12 + 4 * std::size_t(kind));
  }
}

void read_face(ByteReader& reader, std::size_t shape, ShapeScan& scan) {
  reader.skip(9);  // natural restriction, tolerance
  scan.face_surface[shape] = reader.integer();
  scan.face_location[shape] = reader.integer();
  if (reader.byte() == 2) scan.face_triangulation[shape] = reader.integer();
}

// The references to sub-shapes, which '*' ends. Shapes are written last first.
void read_children(ByteReader& reader, int64_t count, ShapeScan& scan) {
  for (int orientation; (orientation = reader.byte()) != '*';) {
    if (orientation > 3) unknown("orientation", orientation);
    scan.child_orientation.push_back(uint8_t(orientation));
    scan.child_shape.push_back(count + 1 - reader.integer());
    scan.child_location.push_back(reader.integer());
    if (scan.child_shape.back() < 1 || scan.child_shape.back() > count) throw std::out_of_range("no such shape");
  }
}

}  // namespace

CurveScan scan_curves(Bytes bytes, int dim, std::size_t count, std::size_t* at) {
  CurveScan scan;
  ByteReader reader(bytes, *at);
  for (std::size_t k = 0; k < count; ++k) skip_curve(reader, dim, &scan);
  *at = reader.at();
  return scan;
}

SurfaceScan scan_surfaces(Bytes bytes, std::size_t count, std::size_t* at) {
  SurfaceScan scan;
  ByteReader reader(bytes, *at);
  for (std::size_t k = 0; k < count; ++k) skip_surface(reader, &scan);
  *at = reader.at();
  return scan;
}

ShapeScan scan_shapes(Bytes bytes, std::size_t count, std::size_t* at) {
  if (count > bytes.size) throw std::out_of_range("more shapes than bytes");
  ShapeScan scan;
  for (auto* column :
       {&scan.face_surface, &scan.face_location, &scan.face_triangulation, &scan.edge_curve, &scan.edge_location}) {
    column->assign(count + 1, 0);
  }
  for (auto* column : {&scan.edge_tolerance, &scan.edge_first, &scan.edge_last}) column->assign(count + 1, 0.0);
  scan.edge_degenerated.assign(count + 1, 0);
  ByteReader reader(bytes, *at);
  for (std::size_t shape = 1; shape <= count; ++shape) {
    const uint8_t kind = reader.byte();
    scan.kinds.push_back(kind);
    if (kind == kEdge) {
      read_edge(reader, shape, scan);
    } else if (kind == kVertex) {
      skip_vertex(reader);
    } else if (kind == kFace) {
      read_face(reader, shape, scan);
    }
    reader.skip(7);  // flags: free, modified, checked, orientable, closed, infinite, convex
    read_children(reader, int64_t(count), scan);
    scan.child_offsets.push_back(int64_t(scan.child_shape.size()));
    scan.pcurve_offsets.push_back(int64_t(scan.pcurve_curve.size()));
  }
  *at = reader.at();
  return scan;
}

}  // namespace nofacet
