/// A message type without its C++ type: what the data path, the recorder and the tools need of it, as plain function
/// pointers. Each IDL package exports one TypeSupport per struct, got with type_support<T>().
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "framework/dds/cdr.hpp"
#include "framework/dds/hash.hpp"
#include "framework/dds/message.hpp"

namespace kervan {

struct TypeSupport {
  const char* name;       ///< as in IDL: "sensor_msgs::msg::LaserScan"
  const char* wire_name;  ///< as ROS 2 has it: "sensor_msgs::msg::dds_::LaserScan_"

  /// FNV-1a over names, types, keys and units of all members, nested ones included. Two libraries that give the same
  /// name another hash disagree on what the bytes mean.
  std::uint64_t layout_hash;

  const void* descriptor;  ///< idlc's dds_topic_descriptor_t; null for a @nested struct, which cannot be a topic
  bool keyed;
  bool fixed_key;         ///< keyed, and the key always fits 16 bytes: DDS then uses it as its own hash, else its MD5
  std::size_t size;       ///< of the C++ value
  std::size_t alignment;  ///< of the C++ value

  void (*construct)(void* memory);  ///< a fresh value: all zero and empty
  void (*destroy)(void* value);
  void (*reset)(void* value);                ///< as fresh, but strings and vectors keep their capacity
  void (*copy)(void* to, const void* from);  ///< both are values; strings and vectors of `to` keep their capacity
  bool (*equal)(const void* a, const void* b);
  std::size_t (*heap_bytes)(const void* value);  ///< capacity of its strings and vectors

  /// CDR of the body, without the encapsulation header. The size is exact and needs no serialisation.
  std::size_t (*cdr_size)(const void* value);
  void (*write_cdr)(const void* value, cdr::Writer& writer);
  bool (*read_cdr)(void* value, cdr::Reader& reader);  ///< refuses trailing bytes too; reader.refusal() says why

  /// CDR of the key members alone; nothing if the type has no key. Equal keys have equal bytes.
  std::size_t (*cdr_key_size)(const void* value);
  void (*write_key)(const void* value, cdr::Writer& writer);
  bool (*read_key)(void* value, cdr::Reader& reader);      ///< other members stay as they are
  void (*key_bytes)(const void* value, std::string& out);  ///< the key in big endian, which the key hash is made of

  void (*hash)(const void* value, Hash64& hash);         ///< every member
  void (*to_json)(const void* value, std::string& out);  ///< appends; compact; NaN and infinities are null
};

}  // namespace kervan
