#include "framework/dds/cdr.hpp"

namespace kervan::cdr {

std::string_view to_string(Refusal refusal) {
  switch (refusal) {
    case Refusal::none: return "none";
    case Refusal::encapsulation: return "the header is neither CDR_LE nor CDR_BE";
    case Refusal::truncated: return "the bytes end before the message does";
    case Refusal::trailing: return "more bytes than the message has";
    case Refusal::length: return "a sequence is longer than the bytes that follow";
    case Refusal::boolean: return "a boolean is neither 0 nor 1";
    case Refusal::enumerator: return "an enum has a value that is none of its enumerators";
    case Refusal::text: return "a string is not terminated, or has a NUL inside";
  }
  return "unknown";
}

bool Reader::text(std::string& value) {
  std::uint32_t size = 0;  // with the terminating NUL
  if (!number(size)) return false;
  if (size == 0) return refuse(Refusal::text);
  if (size > remaining()) return refuse(Refusal::truncated);
  const auto* characters = reinterpret_cast<const char*>(at_);
  if (std::memchr(characters, '\0', size) != characters + size - 1) return refuse(Refusal::text);
  value.assign(characters, size - 1);
  at_ += size;
  return true;
}

Reader open(const void* payload, std::size_t size) {
  const auto refused = [] {
    Reader reader(nullptr, 0);
    reader.refuse(Refusal::encapsulation);
    return reader;
  };
  const auto* bytes = static_cast<const unsigned char*>(payload);
  if (size < encapsulation_size || bytes[0] != 0 || bytes[1] > 1) return refused();
  const std::size_t padding = bytes[3] & 3U;
  if (padding > size - encapsulation_size) return refused();
  return Reader(bytes + encapsulation_size, size - encapsulation_size - padding,
                bytes[1] == 1 ? Endian::little : Endian::big);
}

}  // namespace kervan::cdr
