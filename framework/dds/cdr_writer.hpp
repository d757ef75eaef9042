/// XCDR version 1 ("plain CDR", what ROS 2 speaks) of generated messages: exact size, writer, and the key alone.
///
/// A *sink* takes the parts of a message one after the other: number(x), numbers(pointer, count), text(string). Sizer,
/// Writer and Hash64 are sinks, so that `put` is the only place that knows how a message is taken apart.
/// Positions count from the first byte after the encapsulation header, as alignment does.
#pragma once

#include <array>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "framework/dds/message.hpp"

namespace kervan::cdr {

using Endian = std::endian;

namespace detail {

template <class T>
inline constexpr bool is_vector = false;
template <class T>
inline constexpr bool is_vector<std::vector<T>> = true;

template <class T>
inline constexpr bool is_array = false;
template <class T, std::size_t N>
inline constexpr bool is_array<std::array<T, N>> = true;

template <class T>
concept Number = std::is_arithmetic_v<T>;

/// Numbers whose every bit pattern is a value: many of them can be copied at once.
template <class T>
concept BulkNumber = Number<T> && !std::is_same_v<T, bool>;

template <Number T>
T byte_swapped(T value) {
  if constexpr (sizeof(T) == 1) {
    return value;
  } else if constexpr (sizeof(T) == 2) {
    return std::bit_cast<T>(__builtin_bswap16(std::bit_cast<std::uint16_t>(value)));
  } else if constexpr (sizeof(T) == 4) {
    return std::bit_cast<T>(__builtin_bswap32(std::bit_cast<std::uint32_t>(value)));
  } else {
    return std::bit_cast<T>(__builtin_bswap64(std::bit_cast<std::uint64_t>(value)));
  }
}

/// CDR has 32-bit lengths. A longer message could not be sent; making one is a bug of whoever filled it.
constexpr std::uint32_t wire_length(std::size_t length) {
  assert(length <= std::numeric_limits<std::uint32_t>::max());
  return static_cast<std::uint32_t>(length);
}

}  // namespace detail

/// Gives every part of `value` to `sink`, in the order of the wire.
template <class Sink, class T>
constexpr void put(Sink& sink, const T& value) {
  if constexpr (detail::Number<T>) {
    sink.number(value);
  } else if constexpr (std::is_enum_v<T>) {
    sink.number(static_cast<std::int32_t>(value));
  } else if constexpr (std::is_same_v<T, std::string>) {
    sink.text(value);
  } else if constexpr (detail::is_vector<T> || detail::is_array<T>) {
    if constexpr (detail::is_vector<T>) sink.number(detail::wire_length(value.size()));
    if constexpr (detail::BulkNumber<typename T::value_type>) {
      sink.numbers(value.data(), value.size());
    } else {
      for (const auto& element : value) put(sink, element);
    }
  } else {
    fields([&sink](const Field&, const auto& member) { put(sink, member); }, value);
  }
}

/// Gives the key members to `sink`. A key that is a struct counts as a whole, unless some of its own members are keys.
template <class Sink, class T>
constexpr void put_key(Sink& sink, const T& value) {
  fields(
      [&sink](const Field& field, const auto& member) {
        using Member = std::remove_cvref_t<decltype(member)>;
        if (is_keyed<T> && !field.key) return;
        if constexpr (Message<Member>) {
          put_key(sink, member);
        } else {
          put(sink, member);
        }
      },
      value);
}

/// The sink that counts the bytes a Writer would write. `aligned` is false for a lower bound wherever the message
/// begins.
template <bool aligned = true>
class BasicSizer {
 public:
  constexpr std::size_t size() const { return size_; }

  template <detail::Number T>
  constexpr void number(T) {
    align(sizeof(T));
    size_ += sizeof(T);
  }

  template <detail::Number T>
  constexpr void numbers(const T*, std::size_t count) {
    if (count == 0) return;
    align(sizeof(T));
    size_ += count * sizeof(T);
  }

  constexpr void text(std::string_view value) {
    number(std::uint32_t{});
    size_ += value.size() + 1;
  }

 private:
  constexpr void align(std::size_t alignment) {
    if constexpr (aligned) size_ = (size_ + alignment - 1) & ~(alignment - 1);
  }

  std::size_t size_ = 0;
};
using Sizer = BasicSizer<true>;

/// A run of numbers that a Writer did not copy, except for its first and last `edge` bytes: it lies in the message as the
/// wire wants it. Any part of the written form that is no longer than an edge is thus in one piece in one of the two.
struct LongRun {
  static constexpr std::size_t edge = std::size_t{64} << 10;  ///< no datagram is longer
  static constexpr std::size_t shortest = 4 * edge;           ///< below, a copy is as good

  std::size_t offset = 0;            ///< in the written form
  const std::byte* bytes = nullptr;  ///< in the message; nullptr: everything was copied
  std::size_t size = 0;

  bool contains(std::size_t from, std::size_t count) const {
    return bytes && from >= offset && from + count <= offset + size;
  }
};

/// The sink that writes into memory of the size a Sizer found.
template <Endian order>
class BasicWriter {
 public:
  BasicWriter(void* memory, std::size_t size)
      : begin_(static_cast<std::byte*>(memory)), at_(begin_), end_(begin_ + size) {}

  /// Notes the first long run of numbers in `run`, which must outlive the writer, instead of copying it.
  void leave_out(LongRun& run) { long_run_ = &run; }

  std::size_t size() const { return static_cast<std::size_t>(at_ - begin_); }

  template <detail::Number T>
  void number(T value) {
    align(sizeof(T));
    if constexpr (order != Endian::native) value = detail::byte_swapped(value);
    copy(&value, sizeof(T));
  }

  template <detail::Number T>
  void numbers(const T* values, std::size_t count) {
    if (count == 0) return;
    if constexpr (order == Endian::native || sizeof(T) == 1) {
      align(sizeof(T));
      if (long_run_ && !long_run_->bytes && count * sizeof(T) >= LongRun::shortest)
        leave_out(reinterpret_cast<const std::byte*>(values), count * sizeof(T));
      else
        copy(values, count * sizeof(T));
    } else {
      for (std::size_t i = 0; i < count; ++i) number(values[i]);
    }
  }

  void text(std::string_view value) {
    number(detail::wire_length(value.size() + 1));
    copy(value.data(), value.size());
    number('\0');
  }

 private:
  /// Padding is zero: equal messages have equal bytes, and nothing of this process' memory leaves it.
  void align(std::size_t alignment) {
    while ((size() & (alignment - 1)) != 0) number('\0');
  }

  void copy(const void* from, std::size_t size) {
    assert(size <= static_cast<std::size_t>(end_ - at_));
    if (size != 0) std::memcpy(at_, from, size);
    at_ += size;
  }

  void leave_out(const std::byte* from, std::size_t size) {
    assert(size <= static_cast<std::size_t>(end_ - at_));
    *long_run_ = {this->size(), from, size};
    std::memcpy(at_, from, LongRun::edge);
    std::memcpy(at_ + size - LongRun::edge, from + size - LongRun::edge, LongRun::edge);
    at_ += size;
  }

  std::byte* begin_;
  std::byte* at_;
  std::byte* end_;
  LongRun* long_run_ = nullptr;
};
using Writer = BasicWriter<Endian::little>;        ///< for the wire and for comparing keys
using BigEndianWriter = BasicWriter<Endian::big>;  ///< for the key hash, which DDS wants in this order

inline constexpr std::size_t encapsulation_size = 4;

/// How many zero bytes follow a body of this size, so that the whole is a multiple of four.
constexpr std::size_t padding_after(std::size_t body_size) { return (4 - body_size % 4) % 4; }

/// The header that says "CDR, little endian, and this much padding at the end".
constexpr std::array<std::byte, encapsulation_size> encapsulation(std::size_t body_size) {
  return {std::byte{0}, std::byte{1}, std::byte{0}, static_cast<std::byte>(padding_after(body_size))};
}

}  // namespace kervan::cdr
