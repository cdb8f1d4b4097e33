// Compiled once for every instruction set that Highway knows of; the best one is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raster/fill.cpp"
#include "raster/fill.h"

#include <algorithm>

#include "hwy/cache_control.h"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace nofacet {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

template <class T>
HWY_INLINE void fill_streaming(T* out, std::size_t count, T value) {
  const hn::ScalableTag<T> d;
  const auto v = hn::Set(d, value);
  const std::size_t width = hn::Lanes(d), bytes = width * sizeof(T);
  T* const end = out + count;
  while (out != end && reinterpret_cast<uintptr_t>(out) % bytes != 0) *out++ = value;
  for (; std::size_t(end - out) >= width; out += width) hn::Stream(v, d, out);
  std::fill(out, end, value);
}

void FillDouble(double* out, std::size_t count, double value) { fill_streaming(out, count, value); }
void FillFloat(float* out, std::size_t count, float value) { fill_streaming(out, count, value); }
void FillInt(int32_t* out, std::size_t count, int32_t value) { fill_streaming(out, count, value); }

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace nofacet
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nofacet {

HWY_EXPORT(FillDouble);
HWY_EXPORT(FillFloat);
HWY_EXPORT(FillInt);

void fill(double* out, std::size_t count, double value) { HWY_DYNAMIC_DISPATCH(FillDouble)(out, count, value); }
void fill(float* out, std::size_t count, float value) { HWY_DYNAMIC_DISPATCH(FillFloat)(out, count, value); }
void fill(int32_t* out, std::size_t count, int32_t value) { HWY_DYNAMIC_DISPATCH(FillInt)(out, count, value); }

}  // namespace nofacet
#endif
