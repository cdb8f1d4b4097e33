// Proofs of how scan planes cut a whole piece: by the Bernstein forms of its Jacobian where those are carried along,
// else by interval bounds.
#pragma once
#include "bezier/jacobian.h"
#include "bezier/net.h"

namespace nofacet {

// A surface seen edge-on to within this (pixels of x along any one cut) is a sliver: its cuts are drawn from end to end
// without asking which way x moves in between, which moves no point of it by more than this. Likewise a trim curve that
// is level to within this. Real files are full of walls that are edge-on up to the digits the file was written with.
inline constexpr double kSliverPixels = 1e-6;

// A length on the screen, in pixels, below which nothing is told apart: what remains uncertified at this size is
// drawn as a point or, if it has no area, not at all. It bounds the error of doing so.
inline constexpr double kNegligiblePixels = 1e-9;

// A derivative counts as one-signed only if it stays this far from zero, relative to the terms it is made of.
inline constexpr double kRoundingMargin = 1e-12;

// What is proved of the cut y = const of a piece, for every y: it is a graph over one parameter (y depends on the other
// one strictly), and along it the screen x
enum class CutKind : unsigned char {
  regular,    // moves one way only
  fold,       // turns at most once: the turn is the silhouette
  sliver,     // moves by less than kSliverPixels
  uncertain,  // nothing is proved
};

// Which parameter to halve where nothing is proved, or a fold's shears are empty.
enum class Halve : unsigned char { either, a, b };

struct Certificate {
  CutKind kind = CutKind::uncertain;
  bool transposed = false;  // the cut is a graph a(b) instead of b(a)
  Halve halve = Halve::either;
  bool graph = false;  // at least this is proved: that the cut is a graph
  // Of a fold whose forms are carried along: for these c, key - c x moves one way along every cut. May be empty.
  Interval shears = Interval::empty();
};

// By interval bounds alone.
Certificate certify_cut(const Net& net, const NetBounds& bounds);

// What is known of a patch whose forms are carried along: the size of the terms that they are made of, by which
// rounding errors are measured, the least weight, and whether the weights differ: the forms' degrees depend on it.
struct CarriedForms {
  bool rational = false;
  double jacobian_terms = 0.0, turn_terms = 0.0, weight = 1.0;
};
// With the Jacobian's own Bernstein form, and unless they are null the form of its turn along the cuts and that of key
// and y in place of x and y: much tighter, and of the bounds it needs only those of y and its first derivatives.
Certificate certify_cut(const QuotientBounds& y, const Grid& jacobian, const Grid& turn, const Grid& key_jacobian,
                        const CarriedForms& scales);

}  // namespace nofacet
