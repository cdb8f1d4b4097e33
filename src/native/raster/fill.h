// Filling stretches of frame buffers that will not be read soon.
#pragma once
#include <cstddef>
#include <cstdint>

namespace nofacet {

// Long stretches are written past the caches: there they would only push out what is still needed, and their lines
// would be read before they are overwritten. flush_fills() makes sure that they have arrived for other threads.
void fill(double* out, std::size_t count, double value);
void fill(float* out, std::size_t count, float value);
void fill(int32_t* out, std::size_t count, int32_t value);
void flush_fills();

}  // namespace nofacet
