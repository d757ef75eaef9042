/// What the generator makes of types it takes, and the reader, hash and JSON by hand-made examples.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "framework/dds/cdr.hpp"
#include "framework/dds/hash.hpp"
#include "framework/dds/type_support.hpp"
#include "geometry_msgs/msg/TwistStamped.hpp"
#include "kervan_msgs/msg/ComponentStatus.hpp"
#include "kervan_msgs/msg/GoalStatus.hpp"
#include "kervan_msgs/msg/MapTile.hpp"
#include "kervan_test_msgs/msg/Containers.hpp"
#include "kervan_test_msgs/msg/FixedKey.hpp"
#include "kervan_test_msgs/msg/Keyed.hpp"
#include "kervan_test_msgs/msg/Primitives.hpp"
#include "sensor_msgs/msg/LaserScan.hpp"
#include "sensor_msgs/msg/Range.hpp"

namespace kervan {
namespace {

using kervan_msgs::msg::ComponentState;
using kervan_test_msgs::msg::Containers;
using kervan_test_msgs::msg::Hue;

using Bytes = std::vector<unsigned char>;

template <class T>
cdr::Refusal read(const Bytes& body, T& value, cdr::Endian order = cdr::Endian::little) {
  cdr::Reader reader(body.data(), body.size(), order);
  type_support<T>().read_cdr(&value, reader);
  return reader.refusal();
}

template <class T>
Bytes written(const T& value) {
  Bytes bytes(type_support<T>().cdr_size(&value));
  cdr::Writer writer(bytes.data(), bytes.size());
  type_support<T>().write_cdr(&value, writer);
  return bytes;
}

template <class T>
std::string json_of(const T& value) {
  std::string out;
  type_support<T>().to_json(&value, out);
  return out;
}

TEST(GeneratedType, HasTheMembersOfItsIdl) {
  static_assert(std::is_same_v<decltype(Containers::by_typedef), std::array<std::array<double, 3>, 2>>);
  static_assert(std::is_same_v<decltype(Containers::by_hand), std::array<std::array<double, 3>, 2>>);
  static_assert(std::is_same_v<decltype(Containers::several), std::array<std::int32_t, 2>>);
  static_assert(std::is_same_v<decltype(Containers::one), std::int32_t>);
  static_assert(std::is_same_v<decltype(Containers::nested), std::vector<std::vector<std::uint8_t>>>);
  static_assert(std::is_same_v<decltype(Containers::rows), std::vector<std::array<double, 3>>>);
  static_assert(std::is_same_v<std::underlying_type_t<Hue>, std::int32_t>);
  static_assert(std::is_aggregate_v<Containers>);
  EXPECT_EQ(kervan_test_msgs::msg::Primitives{}.a_double, 0.0);
}

TEST(GeneratedType, HasTheConstantsOfItsIdl) {
  namespace constants = kervan_test_msgs::msg::Primitives_Constants;
  static_assert(sensor_msgs::msg::Range_Constants::INFRARED == 1);
  static_assert(constants::YES && constants::LETTER == 'k' && constants::LEAST_INT8 == -128 &&
                constants::SHORT == -300);
  static_assert(constants::LEAST_LONG == std::numeric_limits<std::int32_t>::min());
  static_assert(constants::GREATEST_ULONG == std::numeric_limits<std::uint32_t>::max());
  static_assert(constants::LEAST_LONG_LONG == std::numeric_limits<std::int64_t>::min() + 1);
  static_assert(constants::GREATEST_ULONG_LONG == std::numeric_limits<std::uint64_t>::max());
  static_assert(constants::TENTH == 0.1F && constants::THREE == 3.0 && constants::PI == 3.14159265358979323846);
  static_assert(constants::QUOTED == "a \"quoted\" word");
}

TEST(GeneratedEnum, KnowsItsNamesAndValues) {
  static_assert(to_string(ComponentState::COMPONENT_DEGRADED) == "COMPONENT_DEGRADED");
  static_assert(is_valid(Hue::HUE_VIOLET) && static_cast<int>(Hue::HUE_VIOLET) == 70000);
  static_assert(!is_valid(static_cast<Hue>(1)) && to_string(static_cast<Hue>(1)).empty());
}

TEST(GeneratedType, NamesItsFieldsWithUnitsAndKeys) {
  std::string seen;
  kervan_msgs::msg::MapTile tile;
  fields([&seen](const Field& field,
                 const auto&) { seen += std::string(field.key ? "*" : "") + field.name + '[' + field.unit + "] "; },
         tile);
  EXPECT_EQ(seen, "*tile_x[] *tile_y[] header[] session[] revision[] resolution[m] width[] height[] data[] ");
}

TEST(TypeSupportOf, HasTheNamesOfRos2) {
  const TypeSupport& support = type_support<sensor_msgs::msg::LaserScan>();
  EXPECT_STREQ(support.name, "sensor_msgs::msg::LaserScan");
  EXPECT_STREQ(support.wire_name, "sensor_msgs::msg::dds_::LaserScan_");
  EXPECT_FALSE(support.keyed);
  EXPECT_EQ(support.size, sizeof(sensor_msgs::msg::LaserScan));
}

TEST(TypeSupportOf, HashesNamesTypesKeysAndUnits) {
  const auto fnv = [](std::string_view text) {
    std::uint64_t hash = 0xcbf29ce484222325U;
    for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
    return hash;
  };
  EXPECT_EQ(type_support<builtin_interfaces::msg::Time>().layout_hash, fnv("{sec:i32;nanosec:u32;}"));
  EXPECT_EQ(type_support<geometry_msgs::msg::Twist>().layout_hash,
            fnv("{linear:{x:f64[SI];y:f64[SI];z:f64[SI];}[m/s];angular:{x:f64[SI];y:f64[SI];z:f64[SI];}[rad/s];}"));
  EXPECT_EQ(type_support<kervan_test_msgs::msg::FixedKey>().layout_hash, fnv("{*small:u8;text:string;*large:i64;}"));
}

TEST(TypeSupportOf, KnowsWhichKeysAreTheirOwnHash) {
  EXPECT_TRUE(type_support<kervan_test_msgs::msg::FixedKey>().fixed_key);
  EXPECT_TRUE(type_support<kervan_msgs::msg::MapTile>().fixed_key);
  EXPECT_FALSE(type_support<kervan_msgs::msg::ComponentStatus>().fixed_key);
  EXPECT_FALSE(type_support<sensor_msgs::msg::LaserScan>().fixed_key);
}

TEST(TypeSupportOf, KeepsCapacityOverAReset) {
  const TypeSupport& support = type_support<sensor_msgs::msg::LaserScan>();
  sensor_msgs::msg::LaserScan scan;
  scan.ranges.resize(1000, 1.0F);
  scan.angle_min = -1.0F;
  support.reset(&scan);
  EXPECT_EQ(scan, sensor_msgs::msg::LaserScan{});
  EXPECT_GE(scan.ranges.capacity(), 1000U);
  EXPECT_GE(support.heap_bytes(&scan), 4000U);
}

TEST(Cdr, IsWhatRos2PutsOnTheWire) {
  sensor_msgs::msg::Range range;
  range.header.stamp = {.sec = 1, .nanosec = 2};
  range.header.frame_id = "s";
  range.radiation_type = 1;
  range.field_of_view = 0.5F;
  range.range = 1.0F;
  const Bytes body{1, 0, 0,    0,    2, 0, 0, 0, 2, 0, 0, 0, 's', 0,  // header: sec, nanosec, length, characters
                   1, 0,                                              // radiation_type, padding
                   0, 0, 0,    0x3f,                                  // field_of_view
                   0, 0, 0,    0,    0, 0, 0, 0,                      // min_range, max_range
                   0, 0, 0x80, 0x3f,                                  // range
                   0, 0, 0,    0};                                    // variance
  EXPECT_EQ(written(range), body);
  sensor_msgs::msg::Range again;
  EXPECT_EQ(read(body, again), cdr::Refusal::none);
  EXPECT_EQ(again, range);
}

TEST(Cdr, HasAnEncapsulationThatSaysOrderAndPadding) {
  const auto header = cdr::encapsulation(5);
  EXPECT_EQ(header, (std::array{std::byte{0}, std::byte{1}, std::byte{0}, std::byte{3}}));
  const Bytes payload{0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 2};
  cdr::Reader reader = cdr::open(payload.data(), payload.size());
  builtin_interfaces::msg::Time time;
  EXPECT_TRUE(type_support<builtin_interfaces::msg::Time>().read_cdr(&time, reader));
  EXPECT_EQ(time, (builtin_interfaces::msg::Time{.sec = 1, .nanosec = 2}));
}

TEST(Cdr, RefusesHeadersOfOtherEncodings) {
  for (const Bytes& payload : {Bytes{}, Bytes{0, 1, 0}, Bytes{0, 2, 0, 0}, Bytes{1, 1, 0, 0}, Bytes{0, 1, 0, 1}}) {
    EXPECT_EQ(cdr::open(payload.data(), payload.size()).refusal(), cdr::Refusal::encapsulation);
  }
}

TEST(Cdr, RefusesAStringThatIsNotOne) {
  std_msgs::msg::Header header;
  const auto refusal = [&header](Bytes text) {
    text.insert(text.begin(), 8, 0);
    return read(text, header);
  };
  EXPECT_EQ(refusal({2, 0, 0, 0, 'a', 0}), cdr::Refusal::none);
  EXPECT_EQ(refusal({0, 0, 0, 0}), cdr::Refusal::text);
  EXPECT_EQ(refusal({2, 0, 0, 0, 'a', 'b'}), cdr::Refusal::text);
  EXPECT_EQ(refusal({3, 0, 0, 0, 'a', 0, 0}), cdr::Refusal::text);
  EXPECT_EQ(refusal({3, 0, 0, 0, 'a', 0}), cdr::Refusal::truncated);
  EXPECT_EQ(refusal({0xff, 0xff, 0xff, 0xff, 'a', 0}), cdr::Refusal::truncated);
}

TEST(Cdr, RefusesBooleansAndEnumeratorsThatDoNotExist) {
  kervan_msgs::msg::GoalStatus status;
  Bytes bytes = written(status);
  EXPECT_EQ(read(bytes, status), cdr::Refusal::none);
  bytes.at(24) = 9;  // stamp takes 8 bytes, frame_id 4 + 1, goal_id from 16 on 4 + 1, state begins at 24
  EXPECT_EQ(read(bytes, status), cdr::Refusal::enumerator);

  kervan_test_msgs::msg::Primitives primitives;
  Bytes other = written(primitives);
  other.at(16) = 2;  // an octet, padding to 8, a double
  EXPECT_EQ(read(other, primitives), cdr::Refusal::boolean);
}

TEST(Cdr, RefusesMoreBytesThanAMessageHasButNotItsPadding) {
  builtin_interfaces::msg::Time time;
  EXPECT_EQ(read(Bytes(8), time), cdr::Refusal::none);
  EXPECT_EQ(read(Bytes(11), time), cdr::Refusal::none);
  EXPECT_EQ(read(Bytes(12), time), cdr::Refusal::trailing);
  EXPECT_EQ(read(Bytes(7), time), cdr::Refusal::truncated);
}

TEST(Cdr, AllocatesNothingForALengthItCannotHold) {
  kervan_msgs::msg::MapTile tile;
  Bytes bytes = written(tile);
  for (std::size_t i = bytes.size() - 4; i < bytes.size(); ++i) bytes[i] = 0xff;
  EXPECT_EQ(read(bytes, tile), cdr::Refusal::length);
  EXPECT_EQ(tile.data.capacity(), 0U);
}

TEST(Hash, MixesEveryByteAndEveryLength) {
  const auto of = [](const sensor_msgs::msg::LaserScan& scan) {
    Hash64 hash;
    type_support<sensor_msgs::msg::LaserScan>().hash(&scan, hash);
    return hash.value();
  };
  sensor_msgs::msg::LaserScan scan;
  scan.ranges.assign(100, 1.0F);
  const std::uint64_t before = of(scan);
  scan.ranges[57] = 1.0000001F;
  const std::uint64_t after = of(scan);
  const int flipped = __builtin_popcountll(before ^ after);
  EXPECT_GT(flipped, 10);
  EXPECT_LT(flipped, 54);
  scan.ranges[57] = 1.0F;
  EXPECT_EQ(of(scan), before);
  scan.ranges.pop_back();
  scan.intensities.push_back(1.0F);
  EXPECT_NE(of(scan), before);
}

TEST(Hash, IsTheSameOnEveryHostAndInEveryBuild) {
  Hash64 hash(7);
  hash.text("kervan");
  hash.number(-1.5);
  hash.number(std::int32_t{-2});
  EXPECT_EQ(hash.value(), 0x9a1a0015fa880804U);
}

TEST(Json, IsCompactAndReadable) {
  geometry_msgs::msg::TwistStamped twist;
  twist.header.frame_id = "r1/\"base\"\n";
  twist.twist.linear = {.x = 0.1, .y = std::numeric_limits<double>::quiet_NaN(), .z = -1e300};
  EXPECT_EQ(json_of(twist),
            "{\"header\":{\"stamp\":{\"sec\":0,\"nanosec\":0},\"frame_id\":\"r1/\\\"base\\\"\\n\"},"
            "\"twist\":{\"linear\":{\"x\":0.1,\"y\":null,\"z\":-1e+300},\"angular\":{\"x\":0,\"y\":0,\"z\":0}}}");
}

TEST(Json, NamesEnumeratorsAndReplacesWhatIsNoText) {
  kervan_msgs::msg::ComponentStatus status;
  status.component = "a\xff\xc3\xa4\xe2\x82";
  status.state = ComponentState::COMPONENT_FAILED;
  status.ports.resize(1);
  const std::string json = json_of(status);
  EXPECT_NE(json.find("\"component\":\"a\xef\xbf\xbd\xc3\xa4\xef\xbf\xbd\xef\xbf\xbd\""), std::string::npos) << json;
  EXPECT_NE(json.find("\"state\":\"COMPONENT_FAILED\""), std::string::npos) << json;
  EXPECT_NE(json.find("\"ports\":[{\"name\":\"\",\"topic\":\"\",\"output\":false,"), std::string::npos) << json;
}

}  // namespace
}  // namespace kervan
