/// Our CDR against the serialiser that comes with Cyclone, for random values of every IDL type.
#include <dds/dds.h>
#include <dds/ddsi/ddsi_cdrstream.h>
#include <dds/ddsi/q_protocol.h>
#include <gtest/gtest.h>

#include <ostream>
#include <string>
#include <vector>

#include "tests/conformance/random_message.hpp"

namespace kervan::test {

void PrintTo(const MessageType& type, std::ostream* out) { *out << type.support->name; }

namespace {

constexpr std::uint32_t xcdr1 = CDR_ENC_VERSION_1;
constexpr int rounds = 300;

using Bytes = std::vector<unsigned char>;

/// Cyclone's view of a type: the descriptor idlc made, and a sample in idlc's C layout.
class CycloneSample {
 public:
  explicit CycloneSample(const TypeSupport& support)
      : descriptor_(static_cast<const dds_topic_descriptor_t*>(support.descriptor)),
        sample_(dds_alloc(descriptor_->m_size)) {
    // What Cyclone itself makes of a descriptor when a topic is created; the function that does it is not exported.
    for (std::uint32_t i = 0; i < descriptor_->m_nkeys; ++i) {
      keys_.push_back({.ops_offs = descriptor_->m_keys[i].m_offset, .idx = descriptor_->m_keys[i].m_idx});
    }
    type_.encoding_format = CDR_ENC_FORMAT_PLAIN;
    type_.write_encoding_version = xcdr1;
    type_.type.size = descriptor_->m_size;
    type_.type.align = descriptor_->m_align;
    type_.type.flagset = descriptor_->m_flagset;
    type_.type.keys = {.nkeys = descriptor_->m_nkeys, .keys = keys_.data()};
    type_.type.ops = {.nops = dds_stream_countops(descriptor_->m_ops, descriptor_->m_nkeys, descriptor_->m_keys),
                      .ops = const_cast<std::uint32_t*>(descriptor_->m_ops)};
    type_.opt_size_xcdr1 = dds_stream_check_optimize(&type_.type, xcdr1);
  }
  ~CycloneSample() {
    dds_stream_free_sample(sample_, type_.type.ops.ops);
    dds_free(sample_);
  }
  CycloneSample(const CycloneSample&) = delete;
  CycloneSample& operator=(const CycloneSample&) = delete;

  bool read(Bytes bytes) {
    std::uint32_t actual = 0;
    const auto size = static_cast<std::uint32_t>(bytes.size());
    if (!dds_stream_normalize(bytes.data(), size, false, xcdr1, &type_, false, &actual) || actual != size) return false;
    dds_istream_t in;
    dds_istream_init(&in, size, bytes.data(), xcdr1);
    dds_stream_read_sample(&in, sample_, &type_);
    return in.m_index == size;
  }

  Bytes write() const {
    return collect([this](dds_ostream_t* out) { dds_stream_write_sample(out, sample_, &type_); });
  }
  Bytes write_big_endian() const {
    return collect([this](dds_ostream_t* out) {
      dds_stream_write_sampleBE(reinterpret_cast<dds_ostreamBE_t*>(out), sample_, &type_);
    });
  }
  Bytes write_key() const {
    return collect([this](dds_ostream_t* out) { dds_stream_write_key(out, static_cast<char*>(sample_), &type_); });
  }
  Bytes write_key_big_endian() const {
    return collect([this](dds_ostream_t* out) {
      dds_stream_write_keyBE(reinterpret_cast<dds_ostreamBE_t*>(out), static_cast<char*>(sample_), &type_);
    });
  }

  bool keyed() const { return descriptor_->m_nkeys != 0; }
  bool fixed_key() const { return (descriptor_->m_flagset & DDS_TOPIC_FIXED_KEY) != 0; }

 private:
  template <class Write>
  static Bytes collect(const Write& write) {
    dds_ostream_t out;
    dds_ostream_init(&out, 0, xcdr1);
    write(&out);
    Bytes bytes(out.m_buffer, out.m_buffer + out.m_index);
    dds_ostream_fini(&out);
    return bytes;
  }

  const dds_topic_descriptor_t* descriptor_;
  void* sample_;
  std::vector<ddsi_sertype_default_desc_key_t> keys_;
  ddsi_sertype_default type_{};
};

class EveryType : public testing::TestWithParam<MessageType> {
 protected:
  const TypeSupport& support_ = *GetParam().support;
  Random random_{support_.layout_hash};
  AnyMessage value_{support_};
  AnyMessage again_{support_};

  void randomise() { GetParam().randomise(random_, value_.get()); }
};

TEST_P(EveryType, HasTheBytesOfCyclonesSerialiserBothWays) {
  CycloneSample cyclone(support_);
  for (int round = 0; round < rounds; ++round) {
    randomise();
    const Bytes ours = cdr_of(support_, value_.get());
    ASSERT_EQ(ours.size(), support_.cdr_size(value_.get()));
    ASSERT_TRUE(cyclone.read(ours)) << "Cyclone refuses our bytes";
    const Bytes theirs = cyclone.write();
    ASSERT_EQ(ours, theirs);

    cdr::Reader reader(theirs.data(), theirs.size());
    ASSERT_TRUE(support_.read_cdr(again_.get(), reader)) << to_string(reader.refusal());
    ASSERT_TRUE(support_.equal(value_.get(), again_.get()));

    const Bytes big_endian = cyclone.write_big_endian();
    cdr::Reader big_endian_reader(big_endian.data(), big_endian.size(), cdr::Endian::big);
    ASSERT_TRUE(support_.read_cdr(again_.get(), big_endian_reader)) << to_string(big_endian_reader.refusal());
    ASSERT_TRUE(support_.equal(value_.get(), again_.get()));
  }
}

TEST_P(EveryType, HasTheKeyOfCyclonesSerialiser) {
  CycloneSample cyclone(support_);
  ASSERT_EQ(support_.keyed, cyclone.keyed());
  ASSERT_EQ(support_.fixed_key, support_.keyed && cyclone.fixed_key());
  for (int round = 0; round < rounds && support_.keyed; ++round) {
    randomise();
    ASSERT_TRUE(cyclone.read(cdr_of(support_, value_.get())));

    Bytes key(support_.cdr_key_size(value_.get()), 0xa5);
    cdr::Writer writer(key.data(), key.size());
    support_.write_key(value_.get(), writer);
    ASSERT_EQ(writer.size(), key.size());
    ASSERT_EQ(key, cyclone.write_key());

    std::string hash_key;
    support_.key_bytes(value_.get(), hash_key);
    ASSERT_EQ(Bytes(hash_key.begin(), hash_key.end()), cyclone.write_key_big_endian());

    support_.reset(again_.get());
    cdr::Reader reader(key.data(), key.size());
    ASSERT_TRUE(support_.read_key(again_.get(), reader)) << to_string(reader.refusal());
    std::string key_again;
    support_.key_bytes(again_.get(), key_again);
    ASSERT_EQ(key_again, hash_key);
  }
}

TEST_P(EveryType, HashesEqualValuesAlikeAndOthersNot) {
  const auto hash_of = [this](const void* value) {
    Hash64 hash;
    support_.hash(value, hash);
    return hash.value();
  };
  for (int round = 0; round < rounds; ++round) {
    randomise();
    support_.copy(again_.get(), value_.get());
    ASSERT_EQ(hash_of(value_.get()), hash_of(again_.get()));
    GetParam().randomise(random_, again_.get());
    ASSERT_EQ(support_.equal(value_.get(), again_.get()), hash_of(value_.get()) == hash_of(again_.get()));
  }
}

TEST_P(EveryType, IsFreshAfterAReset) {
  randomise();
  support_.reset(value_.get());
  EXPECT_TRUE(support_.equal(value_.get(), again_.get()));
}

std::string test_name(const testing::TestParamInfo<MessageType>& info) {
  std::string name;
  for (const char* c = info.param.support->name; *c; ++c) {
    if (*c != ':') {
      name += *c;
    } else if (c[1] == ':') {
      name += '_';
    }
  }
  return name;
}

INSTANTIATE_TEST_SUITE_P(Cdr, EveryType, testing::ValuesIn(all_message_types()), test_name);

}  // namespace
}  // namespace kervan::test
