// Writing stretches of frame buffers that will not be read soon.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "hwy/cache_control.h"

namespace nofacet {

// Long stretches are written past the caches: there they would only push out what is still needed, and their lines
// would be read before they are overwritten. flush_streams() makes sure that they have arrived for other threads.
constexpr std::size_t kLongStretch = 512;  // bytes

void stream(double value, std::size_t count, double* out);
void stream(float value, std::size_t count, float* out);
void stream(int32_t value, std::size_t count, int32_t* out);
void stream(const double* from, std::size_t count, double* out);
void stream(const float* from, std::size_t count, float* out);
void flush_streams();

// Fetches the first and last line of a stretch that will soon be written in part, as those that it shares with its
// neighbours are, or read back: they would be waited for.
template <class T>
void prefetch_ends(const T* out, std::size_t count) {
  hwy::Prefetch(out);
  hwy::Prefetch(out + count - 1);
}

template <class T>
void fill_stretch(T* out, std::size_t count, std::type_identity_t<T> value) {
  if (count * sizeof(T) < kLongStretch) {
    std::fill_n(out, count, value);
  } else {
    stream(T(value), count, out);
  }
}

template <class T>
void copy_stretch(const T* from, std::size_t count, T* out) {
  if (count * sizeof(T) < kLongStretch) {
    std::copy_n(from, count, out);
  } else {
    stream(from, count, out);
  }
}

}  // namespace nofacet
