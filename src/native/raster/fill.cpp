#include "raster/fill.h"

#include <algorithm>

#include "hwy/cache_control.h"
#include "hwy/highway.h"

namespace nofacet {
namespace {

namespace hn = hwy::HWY_NAMESPACE;  // every processor's baseline: the memory is what takes time

constexpr std::size_t kLong = 1024;  // bytes

template <class T>
void fill_any(T* out, std::size_t count, T value) {
  const hn::ScalableTag<T> d;
  const std::size_t width = hn::Lanes(d), bytes = width * sizeof(T);
  T* const end = out + count;
  if (count * sizeof(T) >= kLong) {
    while (reinterpret_cast<std::uintptr_t>(out) % bytes != 0) *out++ = value;
    for (const auto v = hn::Set(d, value); std::size_t(end - out) >= width; out += width) hn::Stream(v, d, out);
  }
  std::fill(out, end, value);
}

}  // namespace

void fill(double* out, std::size_t count, double value) { fill_any(out, count, value); }
void fill(float* out, std::size_t count, float value) { fill_any(out, count, value); }
void fill(int32_t* out, std::size_t count, int32_t value) { fill_any(out, count, value); }
void flush_fills() { hwy::FlushStream(); }

}  // namespace nofacet
