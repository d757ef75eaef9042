/// What generated message types give: a `fields()` visitor found by argument-dependent lookup, and a TypeSupport.
///
///   fields([](const kervan::Field& field, auto& member) { … }, message);   // every member, in IDL order
#pragma once

#include <cstdint>

namespace kervan {

/// What the IDL says of one member beyond its C++ type.
struct Field {
  const char* name;
  const char* unit = "";  ///< as in @unit: "m", "rad/s"; empty for members that have none
  bool key = false;
};

struct TypeSupport;

/// Specialised by the generated code of each topic type and exported by its package's shared library.
template <class T>
const TypeSupport& type_support();

/// Whether any member of the message has @key. Specialised by the generated code.
template <class T>
inline constexpr bool is_keyed = false;

/// TypeSupport::layout_hash as it was when the including code was compiled. Specialised by the generated code.
template <class T>
inline constexpr std::uint64_t compiled_layout = 0;

namespace detail {
struct AnyVisitor {
  template <class Member>
  constexpr void operator()(const Field&, Member&) const {}
};
}  // namespace detail

/// A generated struct.
template <class T>
concept Message = requires(T& message) {
  fields(detail::AnyVisitor{}, message);
};

/// A list of message types; the generated <package>/all_types.hpp has one with every struct of the package.
template <class... T>
struct TypeList {};

}  // namespace kervan
