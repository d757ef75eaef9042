#include "tests/distributed/stations.hpp"

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "framework/kervan.hpp"
#include "framework/test/harness.hpp"
#include "geometry_msgs/msg/TwistStamped.hpp"
#include "kervan_msgs/msg/Goal.hpp"
#include "kervan_msgs/msg/MotionRequest.hpp"
#include "sensor_msgs/msg/LaserScan.hpp"
#include "sensor_msgs/msg/Range.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;
using geometry_msgs::msg::TwistStamped;
using kervan_msgs::msg::Goal;
using kervan_msgs::msg::MotionRequest;
using sensor_msgs::msg::LaserScan;
using sensor_msgs::msg::Range;

struct StationParams {
  std::int64_t id = 0;
  std::int64_t seed = 1;
  template <class Visitor>
  void describe(Visitor& v) {
    v(id, "id", {.min = 0, .max = 1000, .help = "Which station this is."});
    v(seed, "seed", {.min = 0, .max = 1'000'000, .help = "Of everything random."});
  }
};

class Station final : public Component {
  StationParams params_ = parameters<StationParams>();
  Input<LaserScan> in_{this, "in", qos::event, &Station::on_scan, "The ring."};
  Input<Range> common_{this, "common", qos::state.optional(), &Station::on_range, "From everybody, the newest only."};
  Input<MotionRequest> events_{this, "events", qos::state, &Station::on_request, "Keyed, one by one."};
  Input<MotionRequest> requests_{this, "requests", qos::state, "Keyed, looked at."};
  Input<TwistStamped> command_{this, "command", qos::command, "Of the strongest writer, while it lives."};
  Input<Goal> goals_{this, "goals", qos::latched, &Station::on_goal, "Latched."};
  Output<LaserScan> out_{this, "out", qos::event, "The ring."};
  Output<Range> say_{this, "say", qos::state, "To everybody."};
  Output<MotionRequest> request_{this, "request", qos::state, "Keyed; four stations share a key."};
  Output<TwistStamped> drive_{this, "drive", qos::command.strength(static_cast<int>(params_.id % 3)), "A command."};
  Output<Goal> goal_{this, "goal", qos::latched, "Latched."};
  Timer tick_{this, 10ms + 5ms * (params_.id % 3), &Station::on_tick};
  Timer slow_{this, 37ms, &Station::on_slow_tick};
  std::uint64_t state_ = static_cast<std::uint64_t>(params_.seed * 1000 + params_.id) * 77 + 1;

  void mix(std::uint64_t value) { state_ = (state_ ^ value) * 0x9e3779b97f4a7c15ull + 1; }
  void mix(Time time) { mix(static_cast<std::uint64_t>(time.time_since_epoch().count())); }

  void send() {
    auto message = out_.loan();
    message->header.frame_id = std::to_string(state_);
    message->ranges.assign(state_ % 5, static_cast<float>(state_ % 1000));
    out_.publish(std::move(message));
  }
  void say() {
    auto range = say_.loan();
    range->range = static_cast<float>(state_ % 10'000);
    say_.publish(std::move(range));
  }
  void request() {
    auto request = request_.loan();
    request->behaviour = "behaviour" + std::to_string((params_.id + static_cast<std::int64_t>(state_ % 2)) % 4);
    request->priority = static_cast<std::int32_t>(state_ % 1000);
    if (state_ % 7 == 3)
      request_.dispose(*request);
    else
      request_.publish(std::move(request));
  }
  void drive() {
    auto command = drive_.loan();
    command->twist.linear.x = static_cast<double>(state_ % 100);
    drive_.publish(std::move(command));
  }

  void on_activate(Time) override {
    send();
    auto goal = goal_.loan();
    goal->goal_id = std::to_string(state_);
    goal_.publish(std::move(goal));
  }
  void on_scan(const LaserScan& message, Time now) {
    mix(std::stoull(message.header.frame_id) + message.ranges.size());
    mix(now);
    if (state_ % 4 != 0) send();
    if (state_ % 8 == 1) send();
    if (state_ % 16 == 5) say();
    if (state_ % 32 == 9) request();
  }
  void on_range(const Range& message, Time) {
    mix(static_cast<std::uint64_t>(message.range));
    if (state_ % 8 == 2) request();
  }
  void on_request(const Sample<MotionRequest>& sample, Time) {
    mix(static_cast<std::uint64_t>(sample->priority) + sample->behaviour.back() + (sample.disposed() ? 1000 : 0));
    mix(sample.published());
  }
  void on_goal(const Goal& goal, Time) { mix(std::stoull(goal.goal_id)); }
  void on_tick(Time now) {
    mix(now);
    send();
    say();
    if (params_.id % 2 == 1) say();
    request();
    for (const auto& sample : requests_.instances()) mix(static_cast<std::uint64_t>(sample->priority));
    if (const TwistStamped* command = command_.latest()) mix(static_cast<std::uint64_t>(command->twist.linear.x));
  }
  void on_slow_tick(Time) {
    if (state_ % 3 != 0)
      drive();
    else
      drive_.assert_alive();
    if (state_ % 5 == 0) on_activate({});
  }
  // Last words: they belong to the run too.
  void on_deactivate(Time now) override {
    mix(now);
    send();
  }
  void on_shutdown(Time) override { say(); }
};

/// Ends the run at 100 ms.
class Stopper final : public Component {
  Output<Range> out_{this, "out", qos::state, "Something."};
  Timer tick_{this, 20ms, &Stopper::on_tick};
  void on_tick(Time now) {
    out_.publish(Range{});
    if (now.time_since_epoch() >= 100ms) finish("100 ms are enough");
  }
};

/// Answers each message at once with one of its own: for ever.
class Ball final : public Component {
  Input<Range> in_{this, "in", qos::event, &Ball::on_message, "Ball in."};
  Output<Range> out_{this, "out", qos::event, "Ball out."};
  Timer tick_{this, 1s, &Ball::on_tick};
  void on_message(const Range& message, Time) { out_.publish(message); }
  void on_tick(Time) { out_.publish(Range{}); }
};

/// Works for longer than a dead container would be waited for.
class Sleeper final : public Component {
  Output<Range> out_{this, "out", qos::state, "Something."};
  Timer tick_{this, 1s, &Sleeper::on_tick};
  void on_tick(Time now) {
    if (now == Time{}) std::this_thread::sleep_for(5500ms);
    out_.publish(Range{});
  }
};

std::atomic<bool> gate_closed{false};

class Gate final : public Component {
  Output<Range> out_{this, "out", qos::state, "Something."};
  Timer tick_{this, 1s, &Gate::on_tick};
  void on_tick(Time) {
    gate_closed.wait(true);
    out_.publish(Range{});
  }
};

QosProfile profile(const char* name) { return *builtin_profile(name); }

}  // namespace

runtime::ContainerSpec stations(std::uint64_t seed, const Placement& placement, unsigned container,
                                const std::string& tag) {
  runtime::ContainerSpec spec;
  spec.name = "c" + std::to_string(container);
  if (placement.containers > 1)
    for (unsigned i = 0; i < placement.containers; ++i) spec.members.push_back("c" + std::to_string(i));
  spec.clock = runtime::ClockMode::lockstep;
  spec.threads = placement.threads;
  // Several domains of this process meet on the network as if they were of several processes.
  spec.domain = {.id = 40 + container, .network = placement.containers > 1, .tag = tag, .external_id = 40};
  spec.log_to_console = false;
  QosProfile exclusive = profile("command");
  exclusive.ownership = Ownership::exclusive;
  exclusive.deadline = 30ms;
  exclusive.lifespan = 60ms;
  exclusive.liveliness = Liveliness::manual;
  exclusive.lease = 50ms;
  for (unsigned i = 0; i < kStations; ++i) {
    runtime::ComponentSpec& station = spec.components.emplace_back();
    station.name = "station" + std::to_string(i);
    station.type = "test/station";
    station.container = "c" + std::to_string(i % placement.containers);
    station.parameters = {{"id", static_cast<std::int64_t>(i)}, {"seed", static_cast<std::int64_t>(seed)}};
    const auto in = PortDirection::input;
    const auto out = PortDirection::output;
    const std::string before = std::to_string((i + kStations - 1) % kStations);
    const std::string here = std::to_string(i);
    station.ports = {{"in", "/ring" + before, profile("event"), in},
                     {"common", i % 3 == 0 ? "/common" : "/silence", profile("state"), in},
                     {"events", "/requests", profile("state"), in},
                     {"requests", "/requests", profile("state"), in},
                     {"command", "/command", exclusive, in},
                     {"goals", i % 4 == 0 ? "/goals" : "/no_goals", profile("latched"), in},
                     {"out", "/ring" + here, profile("event"), out},
                     {"say", "/common", profile("state"), out},
                     {"request", "/requests", profile("state"), out},
                     {"drive", "/command", exclusive, out},
                     {"goal", "/goals", profile("latched"), out}};
  }
  return spec;
}

ClosedGate::ClosedGate() { gate_closed = true; }

void ClosedGate::open() {
  gate_closed = false;
  gate_closed.notify_all();
}

std::string new_tag() {
  static std::atomic<unsigned> number{0};
  return "kervan-test-" + std::to_string(::getpid()) + "-" + std::to_string(number++);
}

ComponentRegistry station_registry() {
  ComponentRegistry registry({});
  registry.add(define<Station>("test/station"));
  registry.add(define<Stopper>("test/stopper"));
  registry.add(define<Ball>("test/ball"));
  registry.add(define<Sleeper>("test/sleeper"));
  registry.add(define<Gate>("test/gate"));
  return registry;
}

MemberResult run_member(const runtime::ContainerSpec& spec, const runtime::RunControl& control) {
  ComponentRegistry registry = station_registry();
  runtime::Container container(spec, registry);
  MemberResult result;
  result.report = container.run(control);
  result.trace = container.trace_hash();
  for (const auto& instance : container.instances())
    if (instance->state() == ComponentState::failed) result.failures += instance->name() + ": " + instance->reason();
  return result;
}

}  // namespace kervan::test
