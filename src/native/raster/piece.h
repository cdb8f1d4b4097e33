// Pieces: parts of projected patches small enough to be certified, so that every scan plane cuts them in curves that
// can be followed without losing or inventing a root.
//
// In a piece the scan plane's cut d(a, b) = Y - y W = 0 is a graph b(a): d grows (or falls) with b all over the piece.
// Along the cut the screen x moves one way only, or turns at most once (the turn is the silhouette), or hardly moves
// (raster/certificate.h). This is proved, up to rounding, over the whole piece; what cannot be proved is subdivided
// (METHODS section 3; Nishita, Kaneda, Nakamae 1991, with certificates instead of a flatness test).
#pragma once
#include <cstdint>
#include <vector>

#include "arena.h"
#include "bezier/centred_net.h"
#include "bezier/interval.h"
#include "bezier/jacobian.h"
#include "bezier/net.h"
#include "block_pool.h"
#include "camera.h"
#include "raster/certificate.h"
#include "raster/hull_bounds.h"
#include "raster/level_point.h"
#include "raster/part.h"
#include "raster/scan_planes.h"
#include "raster/trim_portions.h"
#include "scene.h"

namespace nofacet {

// No scan plane meets a border a = 0 or a = 1 twice; the other two may turn in y, if the piece is not trimmed.
struct Piece {
  Net net;             // a = the patch's s and b = its t, or the other way round if transposed
  CentredNet centred;  // the same net; none if nothing is proved of the piece
  const Scene::PatchRef* patch;
  const Region* region;  // null: not trimmed here
  const TrimPortion* portions;
  const double* events;  // y at which trim portions begin, end or were left out, ascending (trim_portions.h)
  int32_t portion_count, event_count;
  const double* turns;    // the a at which the border b = 0 turns in y, ascending, then those of b = 1
  int32_t turn_count[2];  // of either
  int32_t face;
  double s0, s1, t0, t1;  // the piece in the patch's own parameters
  bool transposed;
  bool rising;    // Y - y W grows with b
  bool rational;  // the weights differ; else they are 1
  bool planar;    // the key plane is exact: its error is below kNegligiblePixels
  CutKind kind;   // uncertain: as small as kNegligiblePixels, drawn as a point
  HullBounds hull;
  Interval key_slope;         // d key / da along a cut
  Interval x_bend, key_bend;  // d^2 x / da^2 and d^2 key / da^2 along a cut
  Interval shears;            // key_is_monotone
  double bend;                // a parameter step h is straight on the screen (x, y and depth) to within bend h^2 pixels
  // No tangent along a or b is shorter on the screen, in pixels; 0 if normals may be unsound somewhere.
  double least_tangent;
  double longest_a, longest_b;  // no tangent along a, or b, is longer
  double reach;                 // an error on the screen grows by less than this factor in depth ...
  double depth_rise;            // ... and at any one point by 1 plus this over the Jacobian there

  // Whether key - c x moves one way along every cut: if c is no slope of key by x there.
  bool key_is_monotone(double c) const { return (shears.lo <= c && c <= shears.hi) == (kind == CutKind::fold); }
  // Whether points of the centred net are as good as those of the net itself.
  bool has_accurate_centred_net() const { return centred.error < kCentredError; }
  // The face's (u, v) at (a, b), and back.
  void face_from_local(double a, double b, double* u, double* v) const {
    if (transposed) std::swap(a, b);
    *u = patch->u.face_from_patch(s0 + a * (s1 - s0));
    *v = patch->v.face_from_patch(t0 + b * (t1 - t0));
  }
  void local_from_face(double u, double v, double* a, double* b) const {
    *a = (patch->u.patch_from_face(u) - s0) / (s1 - s0);
    *b = (patch->v.patch_from_face(v) - t0) / (t1 - t0);
    if (transposed) std::swap(*a, *b);
  }
};

// The patch as the camera sees it; `points` holds the net. Weights that are all the same become 1.
Net projected_net(const Scene& scene, const Camera& camera, int32_t face, const Scene::PatchRef& patch,
                  std::vector<double>& points);

// Finds what parts of patches consist of. One per thread; what it finds lives as long as it does.
class PieceBuilder {
 public:
  PieceBuilder(const Scene& scene, const Camera& camera, const ScanPlanes& planes)
      : scene_(scene), camera_(camera), planes_(planes) {}

  // Finds the pieces or the smaller parts of a part of the placed patch, and gives back the memory that it needed.
  void open(int32_t face, const Scene::PatchRef& patch, Part& part);

 private:
  struct Box {
    double s0, s1, t0, t1;

    explicit Box(const PartNet& part) : s0(part.s0), s1(part.s1), t0(part.t0), t1(part.t1) {}
  };
  // A part that may be seen.
  struct Found {
    HullBounds hull;
    PartNet net;
  };

  PartNet project();
  void carry_forms(PartNet& whole);
  bool find_arcs(PartNet& part);
  void subdivide(const PartNet& part, const HullBounds& hull);
  bool bound(PartNet& part, HullBounds* hull) const;
  void add(PartNet part);
  // The parts on both sides of a = t or b = t.
  std::pair<PartNet, PartNet> cut(const PartNet& part, bool along_a, double t);
  Halve calming(const PartNet& part, const Certificate& certificate, const NetBounds& bounds) const;
  void halve(const PartNet& part, bool along_a);
  void peel(const PartNet& part, const ParameterBox& core);
  // `net` is the part's, or part of it: that over `box`.
  void describe(const Net& net, const NetBounds& bounds, const HullBounds& hull, const Certificate& certificate,
                const PartNet& part, const Box& box, Piece* piece) const;
  bool is_planar(const Net& net, Interval key) const;
  void emit_certified(const PartNet& part, const NetBounds& bounds, const HullBounds& hull,
                      const Certificate& certificate);
  void emit_cut_at_turns(const PartNet& part, const Certificate& certificate);
  void emit(Piece& piece, const Net& net, const Box& box, bool trimmed);
  void add_portions(Piece& piece);
  void store(Part& part);
  void give_back(const PartNet& part);

  const Scene& scene_;
  const Camera& camera_;
  const ScanPlanes& planes_;
  Arena<Piece> pieces_;
  Arena<Part> parts_;
  Arena<double> nets_;
  Arena<TrimPortion> portion_arena_;
  Arena<double> event_arena_, turn_arena_;
  Arena<const TrimArc*> arc_arena_;
  Arena<CarriedForms> scale_arena_;
  BlockPool blocks_;
  std::vector<TrimPortion> portions_;
  std::vector<double> events_;
  std::vector<double> projected_, turns_, part_;
  std::vector<double> forms_;  // of the patch: J, its turn and that of key and y
  // The part being worked on.
  const Scene::PatchRef* patch_ = nullptr;
  const Region* region_ = nullptr;
  int32_t face_ = 0;
  std::vector<const TrimArc*> arcs_;  // that run through it
  std::vector<Piece> found_pieces_;
  std::vector<Found> found_parts_;
  int32_t unresolved_ = 0;
};

}  // namespace nofacet
