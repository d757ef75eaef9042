/// Makes the TypeSupport of a generated type. Only generated .cpp files include this: every inclusion compiles the
/// serialisers of a type anew.
#pragma once

#include <memory>
#include <new>
#include <string>
#include <type_traits>

#include "framework/dds/cdr.hpp"
#include "framework/dds/json.hpp"
#include "framework/dds/type_support.hpp"

namespace kervan {

/// What the generator knows and the C++ type does not say.
struct TypeSupportFacts {
  const char* name;
  const char* wire_name;
  std::uint64_t layout_hash;
  const void* descriptor;
};

namespace detail {

template <class T>
std::size_t heap_bytes(const T& value) {
  if constexpr (std::is_same_v<T, std::string>) {
    const bool in_place = value.capacity() <= std::string().capacity();
    return in_place ? 0 : value.capacity() + 1;
  } else if constexpr (cdr::detail::is_vector<T> || cdr::detail::is_array<T>) {
    using Element = typename T::value_type;
    std::size_t bytes = 0;
    if constexpr (cdr::detail::is_vector<T>) bytes = value.capacity() * sizeof(Element);
    if constexpr (!std::is_arithmetic_v<Element> && !std::is_enum_v<Element>) {
      for (const auto& element : value) bytes += heap_bytes(element);
    }
    return bytes;
  } else if constexpr (Message<const T>) {
    std::size_t bytes = 0;
    fields([&bytes](const Field&, const auto& member) { bytes += heap_bytes(member); }, value);
    return bytes;
  } else {
    return 0;
  }
}

template <class T>
void reset(T& value) {
  if constexpr (std::is_same_v<T, std::string> || cdr::detail::is_vector<T>) {
    value.clear();
  } else if constexpr (Message<T>) {
    fields([](const Field&, auto& member) { reset(member); }, value);
  } else if constexpr (cdr::detail::is_array<T>) {
    for (auto& element : value) reset(element);
  } else {
    value = T{};
  }
}

/// Whether a key member can have more than one size: a string, or a struct with one.
template <class T>
constexpr bool has_string_key() {
  bool found = false;
  T value{};
  fields(
      [&found](const Field& field, const auto& member) {
        using Member = std::remove_cvref_t<decltype(member)>;
        if (is_keyed<T> && !field.key) return;
        if constexpr (std::is_same_v<Member, std::string>) {
          found = true;
        } else if constexpr (Message<Member>) {
          found = found || has_string_key<Member>();
        }
      },
      value);
  return found;
}

template <class T>
constexpr bool has_fixed_key() {
  if constexpr (is_keyed<T>) {
    cdr::Sizer sizer;
    cdr::put_key(sizer, T{});
    return !has_string_key<T>() && sizer.size() <= 16;
  } else {
    return false;
  }
}

}  // namespace detail

template <class T>
constexpr TypeSupport make_type_support(const TypeSupportFacts& facts) {
  TypeSupport support{};
  support.name = facts.name;
  support.wire_name = facts.wire_name;
  support.layout_hash = facts.layout_hash;
  support.descriptor = facts.descriptor;
  support.keyed = is_keyed<T>;
  support.fixed_key = detail::has_fixed_key<T>();
  support.size = sizeof(T);
  support.alignment = alignof(T);

  support.construct = [](void* memory) { ::new (memory) T{}; };
  support.destroy = [](void* value) { std::destroy_at(static_cast<T*>(value)); };
  support.reset = [](void* value) { detail::reset(*static_cast<T*>(value)); };
  support.copy = [](void* to, const void* from) { *static_cast<T*>(to) = *static_cast<const T*>(from); };
  support.equal = [](const void* a, const void* b) { return *static_cast<const T*>(a) == *static_cast<const T*>(b); };
  support.heap_bytes = [](const void* value) { return detail::heap_bytes(*static_cast<const T*>(value)); };

  support.cdr_size = [](const void* value) {
    cdr::Sizer sizer;
    cdr::put(sizer, *static_cast<const T*>(value));
    return sizer.size();
  };
  support.write_cdr = [](const void* value, cdr::Writer& writer) { cdr::put(writer, *static_cast<const T*>(value)); };
  support.read_cdr = [](void* value, cdr::Reader& reader) {
    return cdr::get(reader, *static_cast<T*>(value)) && reader.finish();
  };

  support.cdr_key_size = [](const void* value) {
    cdr::Sizer sizer;
    if constexpr (is_keyed<T>) cdr::put_key(sizer, *static_cast<const T*>(value));
    return sizer.size();
  };
  support.write_key = [](const void* value, cdr::Writer& writer) {
    if constexpr (is_keyed<T>) cdr::put_key(writer, *static_cast<const T*>(value));
  };
  support.read_key = [](void* value, cdr::Reader& reader) {
    if constexpr (is_keyed<T>) {
      return cdr::get_key(reader, *static_cast<T*>(value)) && reader.finish();
    } else {
      return reader.finish();
    }
  };
  support.key_bytes = [](const void* value, std::string& out) {
    out.clear();
    if constexpr (is_keyed<T>) {
      const T& message = *static_cast<const T*>(value);
      cdr::Sizer sizer;
      cdr::put_key(sizer, message);
      out.resize(sizer.size());
      cdr::BigEndianWriter writer(out.data(), out.size());
      cdr::put_key(writer, message);
    }
  };

  support.hash = [](const void* value, Hash64& hash) { cdr::put(hash, *static_cast<const T*>(value)); };
  support.to_json = [](const void* value, std::string& out) { json::add_value(out, *static_cast<const T*>(value)); };
  return support;
}

}  // namespace kervan
