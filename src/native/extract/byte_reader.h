// Numbers from packed little-endian bytes.
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>

namespace nofacet {

struct Bytes {
  const unsigned char* data;
  std::size_t size;
};

// A place in bytes that moves on as they are read. Reading beyond their end throws std::out_of_range.
class ByteReader {
 public:
  ByteReader(Bytes bytes, std::size_t at) : bytes_(bytes), at_(at) {}

  std::size_t at() const { return at_; }
  // Where the next number is; skip() over it checks that it is there.
  const unsigned char* here() const { return bytes_.data + at_; }
  uint8_t byte() { return read<uint8_t>(); }
  unsigned short_integer() { return read<uint16_t>(); }
  int64_t integer() { return read<int32_t>(); }
  double real() { return read<double>(); }
  void skip(std::size_t count) { at_ += count; }  // the next read checks the place
  // Skips records whose number the file gives.
  void skip(int64_t count, std::size_t size) {
    if (count < 0 || at_ > bytes_.size || std::size_t(count) > (bytes_.size - at_) / size) {
      throw std::out_of_range("a record is too long");
    }
    at_ += std::size_t(count) * size;
  }

 private:
  Bytes bytes_;
  std::size_t at_;

  template <class T>
  T read() {
    if (at_ > bytes_.size || bytes_.size - at_ < sizeof(T)) throw std::out_of_range("the bytes end too early");
    T value;
    std::memcpy(&value, bytes_.data + at_, sizeof(T));
    at_ += sizeof(T);
    return value;
  }
};

}  // namespace nofacet
