// Compiled once for every instruction set that Highway knows of; the best one is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raster/stream.cpp"
#include "raster/stream.h"

#include "hwy/cache_control.h"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace nofacet {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// The elements [first, last) of a stretch that fill whole lines of the caches. Only they may go past them: a line
// written in part has to be read after all, and waited for.
struct WholeLines {
  static constexpr std::size_t kBytes = 64;

  std::size_t first, last;

  template <class T>
  WholeLines(const T* out, std::size_t count) {
    constexpr std::size_t kInLine = kBytes / sizeof(T);
    first = (0 - reinterpret_cast<std::uintptr_t>(out)) % kBytes / sizeof(T);
    last = first + (count - first) / kInLine * kInLine;
  }
};

template <class T>
HWY_INLINE void fill(T value, std::size_t count, T* out) {
  const hn::CappedTag<T, WholeLines::kBytes / sizeof(T)> d;
  const WholeLines lines(out, count);
  std::fill(out, out + lines.first, value);
  const auto v = hn::Set(d, value);
  for (std::size_t k = lines.first; k < lines.last; k += hn::Lanes(d)) hn::Stream(v, d, out + k);
  std::fill(out + lines.last, out + count, value);
}

template <class T>
HWY_INLINE void copy(const T* from, std::size_t count, T* out) {
  const hn::CappedTag<T, WholeLines::kBytes / sizeof(T)> d;
  const WholeLines lines(out, count);
  std::copy(from, from + lines.first, out);
  for (std::size_t k = lines.first; k < lines.last; k += hn::Lanes(d)) hn::Stream(hn::LoadU(d, from + k), d, out + k);
  std::copy(from + lines.last, from + count, out + lines.last);
}

void FillDoubles(double value, std::size_t count, double* out) { fill(value, count, out); }
void FillFloats(float value, std::size_t count, float* out) { fill(value, count, out); }
void FillIntegers(int32_t value, std::size_t count, int32_t* out) { fill(value, count, out); }
void CopyDoubles(const double* from, std::size_t count, double* out) { copy(from, count, out); }
void CopyFloats(const float* from, std::size_t count, float* out) { copy(from, count, out); }

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace nofacet
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nofacet {

HWY_EXPORT(FillDoubles);
HWY_EXPORT(FillFloats);
HWY_EXPORT(FillIntegers);
HWY_EXPORT(CopyDoubles);
HWY_EXPORT(CopyFloats);

void stream(double value, std::size_t count, double* out) { HWY_DYNAMIC_DISPATCH(FillDoubles)(value, count, out); }
void stream(float value, std::size_t count, float* out) { HWY_DYNAMIC_DISPATCH(FillFloats)(value, count, out); }
void stream(int32_t value, std::size_t count, int32_t* out) { HWY_DYNAMIC_DISPATCH(FillIntegers)(value, count, out); }
void stream(const double* from, std::size_t count, double* out) { HWY_DYNAMIC_DISPATCH(CopyDoubles)(from, count, out); }
void stream(const float* from, std::size_t count, float* out) { HWY_DYNAMIC_DISPATCH(CopyFloats)(from, count, out); }
void flush_streams() { hwy::FlushStream(); }

}  // namespace nofacet
#endif
