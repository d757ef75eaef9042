/// Which cells are blocked, one bit each, to be looked at fifty-six at a time.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

namespace kervan::planning {

static_assert(std::endian::native == std::endian::little, "the bits of a line follow each other in memory");

/// Lines of cells; a cell before the beginning or behind the end of a line is blocked.
class BlockedBits {
 public:
  static constexpr int window = 57;  ///< cells that bits_from() tells

  /// All cells are blocked.
  void resize(int lines, int length) {
    pitch_ = static_cast<std::size_t>(length / 64 + 4) * 8;
    bytes_.assign(pitch_ * static_cast<std::size_t>(lines), std::uint8_t{0xff});
  }

  void set(int line, int at, bool blocked) {
    const std::size_t bit = static_cast<std::size_t>(at + margin);
    std::uint8_t& byte = bytes_[static_cast<std::size_t>(line) * pitch_ + bit / 8];
    const auto one = static_cast<std::uint8_t>(1u << (bit % 8));
    byte = static_cast<std::uint8_t>(blocked ? byte | one : byte & ~one);
  }

  /// Cell `at` of a line in bit 0, the one behind it in bit 1; good are the lowest 57. `at` may be 60 cells before the
  /// line's beginning and at its end.
  std::uint64_t bits_from(int line, int at) const {
    const auto bit = static_cast<std::size_t>(at + margin);
    std::uint64_t bits;
    std::memcpy(&bits, bytes_.data() + static_cast<std::size_t>(line) * pitch_ + bit / 8, 8);
    return bits >> (bit % 8);
  }

 private:
  static constexpr int margin = 64;

  std::size_t pitch_ = 0;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace kervan::planning
