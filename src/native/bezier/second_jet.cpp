#include "bezier/second_jet.h"

namespace nofacet {
namespace {

constexpr int kAnyDegree = -1;

// Bernstein basis with first and second derivatives, all from the basis of degree n - 2. A degree known when compiling
// keeps them in registers.
template <int N>
struct SecondBasis {
  static constexpr int kSize = (N == kAnyDegree ? kMaxDegree : N) + 1;
  double value[kSize], slope[kSize], bend[kSize];

  SecondBasis(int degree, double t) {
    const int n = N == kAnyDegree ? degree : N;
    const double s = 1.0 - t;
    if (n == 1) {
      value[0] = s, value[1] = t;
      slope[0] = -1.0, slope[1] = 1.0;
      bend[0] = bend[1] = 0.0;
      return;
    }
    bernstein_basis(n - 2, t, value);
    double before = 0.0, before_that = 0.0;  // entries i - 1 and i - 2 of degree n - 2
    double lower = 0.0;                      // entry i - 1 of degree n - 1
    for (int i = 0; i <= n; ++i) {
      const double here = i <= n - 2 ? value[i] : 0.0;
      const double raised = s * here + t * before;
      bend[i] = n * (n - 1) * (before_that - 2.0 * before + here);
      slope[i] = n * (lower - raised);
      value[i] = s * raised + t * lower;
      before_that = before, before = here, lower = raised;
    }
  }
};

template <int N, int M>
SecondJet evaluate_degrees(const Net& net, double a, double b) {
  const int n = N == kAnyDegree ? net.n : N, m = M == kAnyDegree ? net.m : M;
  const SecondBasis<N> in_a(n, a);
  const SecondBasis<M> in_b(m, b);
  SecondJet jet{};
  const double* p = net.points;
  for (int i = 0; i <= n; ++i) {
    double row[4] = {0, 0, 0, 0}, slope[4] = {0, 0, 0, 0}, bend[4] = {0, 0, 0, 0};
    for (int j = 0; j <= m; ++j, p += 4) {
      for (int c = 0; c < 4; ++c) {
        row[c] += in_b.value[j] * p[c];
        slope[c] += in_b.slope[j] * p[c];
        bend[c] += in_b.bend[j] * p[c];
      }
    }
    for (int c = 0; c < 4; ++c) {
      jet.p[c] += in_a.value[i] * row[c];
      jet.pa[c] += in_a.slope[i] * row[c];
      jet.pb[c] += in_a.value[i] * slope[c];
      jet.paa[c] += in_a.bend[i] * row[c];
      jet.pab[c] += in_a.slope[i] * slope[c];
      jet.pbb[c] += in_a.value[i] * bend[c];
    }
  }
  return jet;
}

}  // namespace

SecondJet evaluate_second(const Net& net, double a, double b) {
  switch (net.n * 64 + net.m) {
    case 1 * 64 + 1:
      return evaluate_degrees<1, 1>(net, a, b);
    case 1 * 64 + 2:
      return evaluate_degrees<1, 2>(net, a, b);
    case 2 * 64 + 1:
      return evaluate_degrees<2, 1>(net, a, b);
    case 2 * 64 + 2:
      return evaluate_degrees<2, 2>(net, a, b);
    case 3 * 64 + 3:
      return evaluate_degrees<3, 3>(net, a, b);
    default:
      return evaluate_degrees<kAnyDegree, kAnyDegree>(net, a, b);
  }
}

}  // namespace nofacet
