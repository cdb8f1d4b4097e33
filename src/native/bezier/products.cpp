// Compiled once for every instruction set that Highway knows of; the best one is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bezier/products.cpp"
#include "bezier/products.h"

#include <algorithm>

#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace nofacet {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// Row by row: each is a sum of rows of g, shifted and weighted by the coefficients of f.
void AddScaledProduct(double sign, const double* f, int f_n, int f_m, const double* g, int g_n, int g_m, double* out) {
  constexpr int kStride = kScaledStride, kPadded = 3 * kStride;
  const hn::CappedTag<double, 8> d;
  double padded[kStride * kPadded];  // the rows of g with zeros on both sides
  for (int k = 0; k <= g_n; ++k) {
    double* row = padded + k * kPadded;
    std::fill(row, row + kPadded, 0.0);
    std::copy(g + k * kStride, g + k * kStride + g_m + 1, row + kStride);
  }
  for (int r = 0; r <= f_n + g_n; ++r) {
    for (int column = 0; column <= f_m + g_m; column += int(hn::Lanes(d))) {
      auto sum = hn::LoadU(d, out + r * kStride + column);
      for (int i = std::max(0, r - g_n); i <= std::min(f_n, r); ++i) {
        const double* row = padded + (r - i) * kPadded + kStride + column;
        for (int j = 0; j <= f_m; ++j) {
          sum = hn::MulAdd(hn::Set(d, sign * f[i * kStride + j]), hn::LoadU(d, row - j), sum);
        }
      }
      hn::StoreU(sum, d, out + r * kStride + column);
    }
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace nofacet
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nofacet {

HWY_EXPORT(AddScaledProduct);

void add_scaled_product(double sign, const double* f, int f_n, int f_m, const double* g, int g_n, int g_m,
                        double* out) {
  HWY_DYNAMIC_DISPATCH(AddScaledProduct)(sign, f, f_n, f_m, g, g_n, g_m, out);
}

}  // namespace nofacet
#endif
