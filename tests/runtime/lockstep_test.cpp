/// Lockstep: the order of things depends on the composition, never on threads.
#include <gtest/gtest.h>

#include <stdexcept>

#include "builtin_interfaces/msg/Time.hpp"
#include "framework/dds/statistics.hpp"
#include "framework/kervan.hpp"
#include "framework/runtime/container.hpp"
#include "framework/test/harness.hpp"
#include "kervan_msgs/msg/MotionRequest.hpp"
#include "nav_msgs/msg/OccupancyGrid.hpp"
#include "sensor_msgs/msg/LaserScan.hpp"

namespace {

using namespace std::chrono_literals;
using builtin_interfaces::msg::Time;
using kervan_msgs::msg::MotionRequest;
using sensor_msgs::msg::LaserScan;

struct NodeParams {
  std::int64_t id = 0;
  template <class Visitor>
  void describe(Visitor& v) {
    v(id, "id", {.min = 0, .max = 1000, .help = "Which node of the ring this is."});
  }
};

/// Mixes what it hears into its state and passes it on for a while: any change of order changes everything after it.
class Node final : public kervan::Component {
  const NodeParams& params_ = parameters<NodeParams>();
  kervan::Input<LaserScan> in_{this, "in", kervan::qos::event, &Node::on_message, "The ring."};
  kervan::Input<MotionRequest> all_{this, "all", kervan::qos::state.optional(), &Node::on_request, "From everybody."};
  kervan::Output<LaserScan> out_{this, "out", kervan::qos::event, "The ring."};
  kervan::Output<MotionRequest> request_{this, "request", kervan::qos::state, "To everybody."};
  kervan::Timer tick_{this, 10ms + 5ms * (params_.id % 3), &Node::on_tick};
  std::uint64_t state_ = static_cast<std::uint64_t>(params_.id) * 77 + 1;

  void mix(std::uint64_t value) { state_ = (state_ ^ value) * 0x9e3779b97f4a7c15ull + 1; }
  void send() {
    auto message = out_.loan();
    message->header.frame_id = std::to_string(state_);
    message->ranges.assign(state_ % 5, static_cast<float>(state_ % 1000));
    out_.publish(std::move(message));
  }
  void on_message(const LaserScan& message, kervan::Time) {
    mix(std::stoull(message.header.frame_id) + message.ranges.size());
    if (state_ % 4 != 0) send();
    if (state_ % 8 == 1) send();
  }
  void on_request(const MotionRequest& message, kervan::Time) { mix(static_cast<std::uint64_t>(message.priority)); }
  void on_tick(kervan::Time now) {
    mix(static_cast<std::uint64_t>(now.time_since_epoch().count()));
    send();
    auto request = request_.loan();
    request->behaviour = "node" + std::to_string(params_.id % 4);
    request->priority = static_cast<std::int32_t>(state_ % 1000);
    request_.publish(std::move(request));
  }
};

const kervan::ComponentClass node = kervan::test::define<Node>("test/node");

kervan::runtime::ContainerSpec ring(unsigned size, unsigned threads) {
  kervan::runtime::ContainerSpec spec;
  spec.clock = kervan::runtime::ClockMode::lockstep;
  spec.threads = threads;
  spec.domain = {.id = 201, .network = false};
  spec.log_to_console = false;
  for (unsigned i = 0; i < size; ++i) {
    const kervan::QosProfile event = *kervan::builtin_profile("event");
    const kervan::QosProfile state = *kervan::builtin_profile("state");
    spec.components.push_back({.name = "node" + std::to_string(i),
                               .type = "test/node",
                               .parameters = {{"id", static_cast<std::int64_t>(i)}},
                               .ports = {{"in", "/ring" + std::to_string((i + size - 1) % size), event},
                                         {"out", "/ring" + std::to_string(i), event},
                                         {"all", "/requests", state},
                                         {"request", "/requests", state}}});
  }
  return spec;
}

std::uint64_t trace_of_ring(unsigned threads) {
  kervan::ComponentRegistry registry({});
  registry.add(node);
  kervan::runtime::Container container(ring(8, threads), registry);
  const auto report = container.run({.limit = 2s});
  EXPECT_EQ(report.end, kervan::runtime::RunEnd::time_limit);
  EXPECT_GT(report.cycles, 500u);
  for (const auto& instance : container.instances())
    EXPECT_EQ(instance->state(), kervan::ComponentState::stopped) << instance->reason();
  return container.trace_hash();
}

TEST(Lockstep, GivesTheSameTraceEveryTimeAndWithAnyNumberOfThreads) {
  const std::uint64_t expected = trace_of_ring(1);
  EXPECT_EQ(trace_of_ring(1), expected);
  for (const unsigned threads : {2u, 4u, 4u, 4u}) EXPECT_EQ(trace_of_ring(threads), expected) << threads << " threads";
}

TEST(Lockstep, CopiesAndSerialisesNothing) {
  const auto before = kervan::dds::data_path_statistics();
  trace_of_ring(1);
  const auto after = kervan::dds::data_path_statistics();
  EXPECT_EQ(after.serialised, before.serialised);
  EXPECT_EQ(after.deserialised, before.deserialised);
}

/// Answers each message at once with one of its own: for ever.
class PingPong final : public kervan::Component {
  kervan::Input<Time> in_{this, "in", kervan::qos::event, &PingPong::on_message, "Ball in."};
  kervan::Output<Time> out_{this, "out", kervan::qos::event, "Ball out."};
  kervan::Timer tick_{this, 1s, &PingPong::on_tick};
  void on_message(const Time& message, kervan::Time) { out_.publish(message); }
  void on_tick(kervan::Time) { out_.publish(Time{}); }
};

TEST(Lockstep, NamesTheComponentsOfALoopThatNeverEnds) {
  kervan::ComponentRegistry registry({});
  const kervan::ComponentClass type = kervan::test::define<PingPong>("test/ping_pong");
  registry.add(type);
  kervan::runtime::ContainerSpec spec;
  spec.clock = kervan::runtime::ClockMode::lockstep;
  spec.domain = {.id = 202, .network = false};
  spec.log_to_console = false;
  const kervan::QosProfile event = *kervan::builtin_profile("event");
  spec.components.push_back({.name = "ping", .type = type.type, .ports = {{"in", "/b", event}, {"out", "/a", event}}});
  spec.components.push_back({.name = "pong", .type = type.type, .ports = {{"in", "/a", event}, {"out", "/b", event}}});
  kervan::runtime::Container container(spec, registry);
  const auto report = container.run({});
  EXPECT_EQ(report.end, kervan::runtime::RunEnd::livelock);
  EXPECT_EQ(report.reason, "components publish to each other for ever at one time: ping, pong");
}

/// Publishes a map now and then.
class Mapper final : public kervan::Component {
  kervan::Output<nav_msgs::msg::OccupancyGrid> map_{this, "map", kervan::qos::latched, "A large map."};
  kervan::Timer tick_{this, 100ms, &Mapper::on_tick};
  void on_tick(kervan::Time) {
    auto map = map_.loan_uncleared();
    map->data.resize(1 << 20);
    last_published = &*map;
    map_.publish(std::move(map));
  }

 public:
  static inline const void* last_published = nullptr;
};

class MapReader final : public kervan::Component {
  kervan::Input<nav_msgs::msg::OccupancyGrid> map_{this, "map", kervan::qos::latched, &MapReader::on_map,
                                                   "A large map."};
  void on_map(const nav_msgs::msg::OccupancyGrid& map, kervan::Time) {
    EXPECT_EQ(&map, Mapper::last_published);
    ++seen;
    if (seen == 20) finish("enough maps");
  }

 public:
  static inline int seen = 0;
};

TEST(Lockstep, AReaderGetsTheVeryObjectThatWasPublishedAndBlocksAreReused) {
  kervan::ComponentRegistry registry({});
  const auto mapper = kervan::test::define<Mapper>("test/mapper");
  const auto reader = kervan::test::define<MapReader>("test/map_reader");
  registry.add(mapper);
  registry.add(reader);
  kervan::runtime::ContainerSpec spec;
  spec.clock = kervan::runtime::ClockMode::lockstep;
  spec.domain = {.id = 203, .network = false};
  spec.log_to_console = false;
  spec.components.push_back({
      .name = "mapper",
      .type = mapper.type,
  });
  spec.components.push_back({
      .name = "reader",
      .type = reader.type,
  });
  const auto before = kervan::dds::data_path_statistics();
  kervan::runtime::Container container(spec, registry);
  const auto report = container.run({});
  const auto after = kervan::dds::data_path_statistics();
  EXPECT_EQ(report.end, kervan::runtime::RunEnd::finished);
  EXPECT_EQ(report.reason, "enough maps");
  EXPECT_EQ(MapReader::seen, 20);
  EXPECT_EQ(after.serialised, before.serialised);
  EXPECT_LE(after.blocks_allocated - before.blocks_allocated, 12u);  // a few maps, statuses and log lines
}

}  // namespace
