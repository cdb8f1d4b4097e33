// Filling stretches of frame buffers that will not be read soon.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "hwy/cache_control.h"
#include "hwy/highway.h"

namespace nofacet {

// Long stretches are written past the caches: there they would only push out what is still needed, and lines would be
// read before they are overwritten. hwy::FlushStream() makes sure that they have arrived.
template <class T>
void fill(T* out, std::size_t count, T value) {
  namespace hn = hwy::HWY_NAMESPACE;
  constexpr std::size_t kLong = 1024;  // bytes
  T* const end = out + count;
  if (count * sizeof(T) >= kLong) {
    const hn::ScalableTag<T> d;
    const std::size_t width = hn::Lanes(d), bytes = width * sizeof(T);
    while (reinterpret_cast<std::uintptr_t>(out) % bytes != 0) *out++ = value;
    for (const auto v = hn::Set(d, value); std::size_t(end - out) >= width; out += width) hn::Stream(v, d, out);
  }
  std::fill(out, end, value);
}

}  // namespace nofacet
