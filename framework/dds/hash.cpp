#include "framework/dds/hash.hpp"

#include <cstring>

namespace kervan {

static_assert(std::endian::native == std::endian::little, "hashes of bulk data would differ from those of other hosts");

void Hash64::bytes(const void* data, std::size_t size) {
  const auto* at = static_cast<const unsigned char*>(data);
  for (; size >= 8; at += 8, size -= 8) {
    std::uint64_t value;
    std::memcpy(&value, at, 8);
    word(value);
  }
  if (size != 0) {
    std::uint64_t value = 0;
    std::memcpy(&value, at, size);
    word(value);
  }
}

}  // namespace kervan
