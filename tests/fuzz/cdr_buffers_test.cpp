/// Random, truncated and mutated buffers into the reader of every type: it must neither crash, nor allocate for bytes
/// that are not there, nor accept what it cannot give back.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "framework/dds/cdr.hpp"
#include "tests/conformance/random_message.hpp"

namespace kervan::test {
namespace {

using Bytes = std::vector<unsigned char>;

constexpr int buffers = 100'000;

Bytes payload_of(const MessageType& type, Random& random) {
  AnyMessage message(*type.support);
  type.randomise(random, message.get());
  const Bytes body = cdr_of(*type.support, message.get());
  const auto header = cdr::encapsulation(body.size());
  Bytes payload(header.size() + body.size() + cdr::padding_after(body.size()));
  std::memcpy(payload.data(), header.data(), header.size());
  std::memcpy(payload.data() + header.size(), body.data(), body.size());
  return payload;
}

/// Bytes that are nearly, or not at all, a message of the type.
Bytes hostile_payload(const MessageType& type, Random& random) {
  Bytes bytes;
  const auto kind = random() % 5;
  if (kind == 0) {
    bytes.resize(random() % 200);
    for (unsigned char& b : bytes) b = static_cast<unsigned char>(random() % 3 == 0 ? random() : 0);
    if (bytes.size() > 1 && random() % 8 != 0) {
      bytes[0] = 0;
      bytes[1] = static_cast<unsigned char>(random() % 2);
    }
    return bytes;
  }
  bytes = payload_of(type, random);
  if (kind == 1) {
    bytes.resize(random() % (bytes.size() + 1));
  } else if (kind == 2) {
    bytes[1] = 0;  // says big endian, is little
  } else {
    for (auto n = random() % 4 + 1; n > 0; --n) {
      const std::size_t at = random() % bytes.size();
      if (kind == 3) {
        bytes[at] = static_cast<unsigned char>(random());
      } else {
        // Where a length is, this asks for as much as can be asked for, or for one too many.
        static constexpr std::array<unsigned char, 4> extremes{0xff, 0x7f, 0x80, 0x01};
        const unsigned char extreme = extremes[random() % extremes.size()];
        for (std::size_t i = at; i < bytes.size() && i < at + 4; ++i) bytes[i] = extreme;
      }
    }
  }
  return bytes;
}

TEST(CdrReader, SurvivesHostileBuffersAndSaysWhyItRefuses) {
  const std::vector<MessageType>& types = all_message_types();
  Random random(20240501);
  int accepted = 0;
  std::array<int, static_cast<std::size_t>(cdr::Refusal::text) + 1> refused{};

  for (int i = 0; i < buffers; ++i) {
    const MessageType& type = types[static_cast<std::size_t>(i) % types.size()];
    const TypeSupport& support = *type.support;
    // On the heap and of the exact size, so that the address sanitizer sees a read of one byte too many.
    const Bytes payload = hostile_payload(type, random);
    AnyMessage message(support);
    cdr::Reader reader = cdr::open(payload.data(), payload.size());
    const bool ok = support.read_cdr(message.get(), reader);
    ASSERT_EQ(ok, reader.refusal() == cdr::Refusal::none);
    ASSERT_LE(support.heap_bytes(message.get()), 8 * payload.size() + 64) << support.name;
    if (ok) {
      ++accepted;
      const Bytes body = cdr_of(support, message.get());
      AnyMessage again(support);
      cdr::Reader second(body.data(), body.size());
      ASSERT_TRUE(support.read_cdr(again.get(), second)) << support.name;
      ASSERT_EQ(cdr_of(support, again.get()), body) << support.name;
    } else {
      ++refused[static_cast<std::size_t>(reader.refusal())];
    }

    if (support.keyed) {
      cdr::Reader key_reader = cdr::open(payload.data(), payload.size());
      support.read_key(message.get(), key_reader);
    }
  }

  int total = accepted;
  for (std::size_t reason = 1; reason < refused.size(); ++reason) {
    total += refused[reason];
    RecordProperty(std::string("refusal_") + std::to_string(reason), refused[reason]);
    EXPECT_GT(refused[reason], 0) << "never refused for: " << to_string(static_cast<cdr::Refusal>(reason));
  }
  EXPECT_EQ(total, buffers);
  EXPECT_GT(accepted, buffers / 100) << "too few buffers come near to a message";
}

TEST(CdrReader, RefusesEveryTruncation) {
  Random random(1);
  for (const MessageType& type : all_message_types()) {
    const Bytes payload = payload_of(type, random);
    const std::size_t body_end = payload.size() - (payload[3] & 3U);
    for (std::size_t size = 0; size < body_end; ++size) {
      Bytes cut(payload.begin(), payload.begin() + static_cast<std::ptrdiff_t>(size));
      if (size > 3) cut[3] = 0;  // a header that still claims padding would explain part of the loss
      AnyMessage message(*type.support);
      cdr::Reader reader = cdr::open(cut.data(), cut.size());
      ASSERT_FALSE(type.support->read_cdr(message.get(), reader)) << type.support->name << " cut to " << size;
    }
  }
}

}  // namespace
}  // namespace kervan::test
