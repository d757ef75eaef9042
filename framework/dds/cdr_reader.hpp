/// Reads XCDR version 1 from bytes nobody vouches for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

#include "framework/dds/cdr_writer.hpp"
#include "framework/dds/message.hpp"

namespace kervan::cdr {

/// Why bytes were not accepted as a message.
enum class Refusal {
  none,
  encapsulation,  ///< the header is missing, or says neither CDR_LE nor CDR_BE
  truncated,      ///< the bytes end before the message does
  trailing,       ///< more bytes follow the message than padding explains: another layout
  length,         ///< a sequence claims more elements than the remaining bytes can hold
  boolean,        ///< neither 0 nor 1
  enumerator,     ///< a value the enum does not have
  text,           ///< a string without its terminating NUL, or with one inside
};

[[gnu::visibility("default")]] std::string_view to_string(Refusal refusal);

/// The fewest bytes any value of the type takes.
template <class T>
inline constexpr std::size_t least_size = [] {
  BasicSizer<false> sizer;
  put(sizer, T{});
  return sizer.size();
}();

/// Takes a message from bytes nobody vouches for. After the first refusal every further step fails.
/// No length makes it allocate more than a small multiple of the bytes that are really there.
class [[gnu::visibility("default")]] Reader {
 public:
  /// `body` are the bytes after the encapsulation header; they must outlive the reader.
  Reader(const void* body, std::size_t size, Endian order = Endian::little)
      : begin_(static_cast<const std::byte*>(body)), at_(begin_), end_(begin_ + size), swap_(order != Endian::native) {}

  Refusal refusal() const { return refusal_; }
  std::size_t remaining() const { return static_cast<std::size_t>(end_ - at_); }

  bool refuse(Refusal why) {
    if (refusal_ == Refusal::none) refusal_ = why;
    at_ = end_;
    return false;
  }

  template <detail::Number T>
  bool number(T& value) {
    if (!align(sizeof(T)) || remaining() < sizeof(T)) return refuse(Refusal::truncated);
    if constexpr (std::is_same_v<T, bool>) {
      const auto raw = std::to_integer<unsigned>(*at_);
      if (raw > 1) return refuse(Refusal::boolean);
      value = raw == 1;
    } else {
      std::memcpy(&value, at_, sizeof(T));
      if (swap_) value = detail::byte_swapped(value);
    }
    at_ += sizeof(T);
    return true;
  }

  template <detail::BulkNumber T>
  bool numbers(T* values, std::size_t count) {
    if (count == 0) return true;
    if (!align(sizeof(T)) || remaining() / sizeof(T) < count) return refuse(Refusal::truncated);
    std::memcpy(values, at_, count * sizeof(T));
    at_ += count * sizeof(T);
    if (swap_) {
      for (std::size_t i = 0; i < count; ++i) values[i] = detail::byte_swapped(values[i]);
    }
    return true;
  }

  /// The length of a sequence whose elements take at least `least` bytes each.
  bool length(std::uint32_t & count, std::size_t least) {
    if (!number(count)) return false;
    return count <= remaining() / least || refuse(Refusal::length);
  }

  bool text(std::string& value);

  /// Refuses bytes left over, beyond the padding to a multiple of four.
  bool finish() { return refusal_ == Refusal::none && (remaining() < 4 || refuse(Refusal::trailing)); }

 private:
  bool align(std::size_t alignment) {
    const std::size_t misaligned = static_cast<std::size_t>(at_ - begin_) & (alignment - 1);
    if (misaligned == 0) return true;
    if (remaining() < alignment - misaligned) return false;
    at_ += alignment - misaligned;
    return true;
  }

  const std::byte* begin_;
  const std::byte* at_;
  const std::byte* end_;
  bool swap_;
  Refusal refusal_ = Refusal::none;
};

/// Reads one value; strings and vectors keep their capacity. False after a refusal: then `value` holds something valid
/// of its type, but nothing that was sent.
template <class T>
bool get(Reader& reader, T& value) {
  if constexpr (detail::Number<T>) {
    return reader.number(value);
  } else if constexpr (std::is_enum_v<T>) {
    std::int32_t raw = 0;
    if (!reader.number(raw)) return false;
    if (!is_valid(static_cast<T>(raw))) return reader.refuse(Refusal::enumerator);
    value = static_cast<T>(raw);
    return true;
  } else if constexpr (std::is_same_v<T, std::string>) {
    return reader.text(value);
  } else if constexpr (detail::is_vector<T> || detail::is_array<T>) {
    using Element = typename T::value_type;
    if constexpr (detail::is_vector<T>) {
      std::uint32_t count = 0;
      if (!reader.length(count, least_size<Element>)) return false;
      value.resize(count);
    }
    if constexpr (detail::BulkNumber<Element>) {
      return reader.numbers(value.data(), value.size());
    } else {
      for (auto& element : value) {
        if (!get(reader, element)) return false;
      }
      return true;
    }
  } else {
    bool ok = true;
    fields([&](const Field&, auto& member) { ok = ok && get(reader, member); }, value);
    return ok;
  }
}

/// Reads what put_key wrote; the other members stay as they are.
template <class T>
bool get_key(Reader& reader, T& value) {
  bool ok = true;
  fields(
      [&](const Field& field, auto& member) {
        using Member = std::remove_cvref_t<decltype(member)>;
        if (is_keyed<T> && !field.key) return;
        if constexpr (Message<Member>) {
          ok = ok && get_key(reader, member);
        } else {
          ok = ok && get(reader, member);
        }
      },
      value);
  return ok;
}

/// A reader of the body of `payload`, a whole serialised payload with header and padding. Bytes without a proper header
/// give a reader that has already refused.
[[gnu::visibility("default")]] Reader open(const void* payload, std::size_t size);

}  // namespace kervan::cdr
