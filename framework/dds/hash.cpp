#include "framework/dds/hash.hpp"

#include <cstring>

namespace kervan {

static_assert(std::endian::native == std::endian::little, "hashes of bulk data would differ from those of other hosts");

void Hash64::bytes(const void* data, std::size_t size) {
  const auto* at = static_cast<const unsigned char*>(data);
  // Two words a multiplication, which is what the time goes into.
  for (; size >= 16; at += 16, size -= 16) {
    std::uint64_t words[2];
    std::memcpy(words, at, 16);
    state_ = fold(state_ ^ words[0], words[1] ^ 0xa0761d6478bd642fU) + 0xe7037ed1a0b428dbU;
  }
  if (size >= 8) {
    std::uint64_t value;
    std::memcpy(&value, at, 8);
    word(value);
    at += 8;
    size -= 8;
  }
  if (size != 0) {
    std::uint64_t value = 0;
    std::memcpy(&value, at, size);
    word(value);
  }
}

}  // namespace kervan
