/// Random values of any message type, and every message type there is, for tests that hold for all of them.
#pragma once

#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <type_traits>
#include <vector>

#include "framework/dds/cdr.hpp"
#include "framework/dds/message.hpp"
#include "framework/dds/type_support.hpp"

namespace kervan::test {

using Random = std::mt19937_64;

inline std::size_t random_length(Random& random) { return random() % 4 == 0 ? 0 : random() % 7; }

/// Any value the type allows, short strings and sequences often empty; no NaN, so that values can be compared.
template <class T>
void randomise(Random& random, T& value) {
  if constexpr (std::is_same_v<T, bool>) {
    value = random() % 2 == 1;
  } else if constexpr (std::is_floating_point_v<T>) {
    do {
      const std::uint64_t bits = random();
      std::memcpy(&value, &bits, sizeof value);
    } while (value != value);
  } else if constexpr (std::is_integral_v<T>) {
    value = static_cast<T>(random());
  } else if constexpr (std::is_enum_v<T>) {
    // The enums' values are few and far between: draw until one is hit.
    do {
      value = static_cast<T>(random() % 2 == 0 ? random() % 8 : 70000);
    } while (!is_valid(value));
  } else if constexpr (std::is_same_v<T, std::string>) {
    value.resize(random_length(random));
    for (char& c : value) c = static_cast<char>(random() % 255 + 1);
  } else if constexpr (cdr::detail::is_vector<T> || cdr::detail::is_array<T>) {
    if constexpr (cdr::detail::is_vector<T>) value.resize(random_length(random));
    for (auto& element : value) randomise(random, element);
  } else {
    fields([&random](const Field&, auto& member) { randomise(random, member); }, value);
  }
}

struct MessageType {
  const TypeSupport* support;
  void (*randomise)(Random& random, void* value);
};

/// A value of a type known only by its TypeSupport.
class AnyMessage {
 public:
  explicit AnyMessage(const TypeSupport& support)
      : support_(&support), memory_(::operator new(support.size, std::align_val_t(support.alignment))) {
    support.construct(memory_);
  }
  ~AnyMessage() {
    support_->destroy(memory_);
    ::operator delete(memory_, std::align_val_t(support_->alignment));
  }
  AnyMessage(const AnyMessage&) = delete;
  AnyMessage& operator=(const AnyMessage&) = delete;

  void* get() { return memory_; }
  const void* get() const { return memory_; }

 private:
  const TypeSupport* support_;
  void* memory_;
};

inline std::vector<unsigned char> cdr_of(const TypeSupport& support, const void* value) {
  std::vector<unsigned char> bytes(support.cdr_size(value), 0xa5);  // so that padding left unwritten shows
  cdr::Writer writer(bytes.data(), bytes.size());
  support.write_cdr(value, writer);
  bytes.resize(writer.size());
  return bytes;
}

template <class... T>
void add_message_types(std::vector<MessageType>& types, TypeList<T...>) {
  (types.push_back(
       {&type_support<T>(), [](Random& random, void* value) { randomise(random, *static_cast<T*>(value)); }}),
   ...);
}

/// Every type of every package, in the order of the file lists. Generated, so that no type can be forgotten.
const std::vector<MessageType>& all_message_types();

}  // namespace kervan::test
