/// A fast 64-bit hash that mixes well, for the traces of deterministic runs. It is no defence against an adversary.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>

namespace kervan {

/// Each word is mixed in by a multiplication to 128 bits whose halves are folded together: every bit of the word and of
/// the state reaches every bit of the next state. It is a sink (cdr.hpp), so cdr::put hashes a whole message: strings
/// and sequences with their lengths, floating-point numbers by their bits (0.0 and -0.0 differ).
class [[gnu::visibility("default")]] Hash64 {
 public:
  constexpr explicit Hash64(std::uint64_t seed = 0) : state_(seed ^ 0x9e3779b97f4a7c15U) {}

  constexpr std::uint64_t value() const { return fold(state_ ^ (state_ >> 32), 0xd6e8feb86659fd93U); }

  constexpr void word(std::uint64_t value) { state_ = fold(state_ ^ value, 0xa0761d6478bd642fU) + 0xe7037ed1a0b428dbU; }

  template <class T>
  requires std::is_arithmetic_v<T>
  constexpr void number(T value) {
    if constexpr (std::is_floating_point_v<T>) {
      using Bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
      word(std::bit_cast<Bits>(value));
    } else {
      word(static_cast<std::uint64_t>(value));
    }
  }

  template <class T>
  requires std::is_arithmetic_v<T>
  void numbers(const T* values, std::size_t count) { bytes(values, count * sizeof(T)); }

  void text(std::string_view value) {
    word(value.size());
    bytes(value.data(), value.size());
  }

  /// Sixteen bytes at a time. The length is not part of the hash: add it where the bytes' end is not otherwise known.
  void bytes(const void* data, std::size_t size);

 private:
  static constexpr std::uint64_t fold(std::uint64_t a, std::uint64_t b) {
    __extension__ using Wide = unsigned __int128;
    const Wide product = static_cast<Wide>(a) * b;
    return static_cast<std::uint64_t>(product) ^ static_cast<std::uint64_t>(product >> 64);
  }

  std::uint64_t state_;
};

}  // namespace kervan
