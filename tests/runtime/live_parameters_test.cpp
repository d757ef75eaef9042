/// Parameters that change while a component runs: checked like those of a composition, all of them or none.
#include <gtest/gtest.h>

#include <optional>

#include "builtin_interfaces/msg/Time.hpp"
#include "framework/kervan.hpp"
#include "framework/runtime/container.hpp"
#include "framework/runtime/operations.hpp"
#include "framework/test/harness.hpp"

namespace {

using namespace std::chrono_literals;
using builtin_interfaces::msg::Time;
using kervan::Duration;
using kervan::ValueMap;

enum class Gear { low, high };

struct LiveParams {
  double speed = 0.5;
  double limit = 1.0;
  Duration pause = 100ms;
  Gear gear = Gear::low;
  std::string frame = "map";

  template <class Visitor>
  void describe(Visitor& v) {
    v(speed, "speed", {.unit = "m/s", .min = 0.0, .max = 2.0, .help = "Speed.", .live = true});
    v(limit, "limit", {.unit = "m/s", .min = 0.0, .max = 2.0, .help = "Never faster than this.", .live = true});
    v(pause, "pause", {.min = 0.01, .max = 1.0, .help = "Between two.", .live = true});
    v(gear, "gear", {.choices = {"low", "high"}, .help = "Gear.", .live = true});
    v(frame, "frame", {.help = "Frame."});
  }
};

/// Publishes its speed in mm/s every 10 ms. Refuses a speed above the limit, which no range can say.
class Live final : public kervan::Component {
  const LiveParams& params_ = parameters<LiveParams>();
  kervan::Output<Time> out_{this, "out", kervan::qos::state, "The speed."};
  kervan::Timer tick_{this, 10ms, &Live::on_tick};
  double copied_ = params_.speed;

  void on_parameters_changed() override {
    copied_ = params_.speed;
    if (params_.speed == 1.5) throw std::runtime_error("no component likes 1.5");
    if (params_.speed > params_.limit) throw kervan::ParameterError("speed", "it is above the limit");
  }
  void on_tick(kervan::Time) {
    Time message;
    message.sec = static_cast<std::int32_t>(params_.speed * 1000);
    message.nanosec = static_cast<std::uint32_t>(copied_ * 1000);
    out_.publish(message);
  }
};

/// Declares a live parameter and does nothing else about it.
struct PlainParams {
  double gain = 1.0;
  template <class Visitor>
  void describe(Visitor& v) {
    v(gain, "gain", {.min = 0.0, .max = 9.0, .help = "Gain.", .live = true});
  }
};

class Plain final : public kervan::Component {
  const PlainParams& params_ = parameters<PlainParams>();
  kervan::Output<Time> out_{this, "out", kervan::qos::state, "The gain."};
  kervan::Timer tick_{this, 10ms, &Plain::on_tick};
  void on_tick(kervan::Time) {
    Time message;
    message.sec = static_cast<std::int32_t>(params_.gain);
    out_.publish(message);
  }
};

class Fixed final : public kervan::Component {};

const auto live = kervan::test::define<Live>("test/live");

/// What a change is refused with; empty if it is not.
std::string refusal(kervan::test::Harness& harness, const ValueMap& changes) {
  try {
    harness.change_parameters(changes);
    return {};
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
}

std::pair<int, int> speeds(kervan::test::Harness& harness) {
  harness.advance(10ms);
  const Time* message = harness.latest<Time>("out");
  return {message->sec, static_cast<int>(message->nanosec)};
}

TEST(LiveParameters, TakeEffectAtTheNextHandlerAndAreWhatTheReferenceShows) {
  kervan::test::Harness harness(kervan::test::define<Plain>("test/plain"));
  harness.advance(10ms);
  EXPECT_EQ(harness.latest<Time>("out")->sec, 1);
  EXPECT_EQ(refusal(harness, {{"gain", 7.0}}), "");
  EXPECT_EQ(harness.latest<Time>("out")->sec, 1);
  harness.advance(10ms);
  EXPECT_EQ(harness.latest<Time>("out")->sec, 7);
}

TEST(LiveParameters, AreToldToTheComponentOnceTheyAreThere) {
  kervan::test::Harness harness(live);
  EXPECT_EQ(speeds(harness), (std::pair{500, 500}));
  EXPECT_EQ(refusal(harness, {{"speed", 0.25}, {"gear", "high"}, {"pause", 0.5}}), "");
  EXPECT_EQ(speeds(harness), (std::pair{250, 250}));
}

TEST(LiveParameters, AreRefusedWithWhatIsAllowed) {
  kervan::test::Harness harness(live);
  EXPECT_EQ(refusal(harness, {{"sped", 1.0}}),
            "sped: there is no such parameter; did you mean 'speed'? allowed: speed, limit, pause, gear, frame");
  EXPECT_EQ(refusal(harness, {{"speed", 7.0}}), "speed: 7 m/s is out of range; allowed: 0 .. 2 m/s");
  EXPECT_EQ(refusal(harness, {{"speed", "fast"}}), "speed: expected number, found fast");
  EXPECT_EQ(refusal(harness, {{"gear", "hgih"}}), "gear: hgih is not one of low, high; did you mean 'high'?");
  EXPECT_EQ(refusal(harness, {{"pause", 2.0}}), "pause: 2 s is out of range; allowed: 0.01 .. 1 s");
  EXPECT_EQ(refusal(harness, {{"frame", "odom"}}),
            "frame: cannot be changed while the component runs; live are: speed, limit, pause, gear");
  EXPECT_EQ(speeds(harness), (std::pair{500, 500}));
}

TEST(LiveParameters, OfAComponentWithoutAnyAreRefused) {
  kervan::test::Harness harness(kervan::test::define<Fixed>("test/fixed"));
  EXPECT_EQ(refusal(harness, {{"speed", 1.0}}), "speed: there is no such parameter; this component has none");
}

TEST(LiveParameters, ChangeAllTogetherOrNotAtAll) {
  kervan::test::Harness harness(live);
  EXPECT_EQ(refusal(harness, {{"speed", 0.25}, {"limit", 9.0}}), "limit: 9 m/s is out of range; allowed: 0 .. 2 m/s");
  EXPECT_EQ(speeds(harness), (std::pair{500, 500}));
  // The component itself refuses, after it has taken the value over: it is told to go back.
  EXPECT_EQ(refusal(harness, {{"speed", 1.25}, {"gear", "high"}}), "speed: it is above the limit");
  EXPECT_EQ(speeds(harness), (std::pair{500, 500}));
  EXPECT_EQ(refusal(harness, {{"speed", 1.25}, {"limit", 1.25}}), "");
  EXPECT_EQ(speeds(harness), (std::pair{1250, 1250}));
}

TEST(LiveParameters, AComponentThatThrowsAnythingElseHasFailed) {
  kervan::test::Harness harness(live);
  EXPECT_EQ(refusal(harness, {{"speed", 1.5}, {"limit", 2.0}}),
            "it failed: no component likes 1.5 (in on_parameters_changed)");
  EXPECT_EQ(harness.state(), kervan::ComponentState::failed);
  EXPECT_EQ(refusal(harness, {{"speed", 0.5}}),
            "'subject' has failed: no component likes 1.5 (in on_parameters_changed)");
}

TEST(LiveParameters, StandInTheManifest) {
  const kervan::Manifest manifest = kervan::describe(live, {});
  EXPECT_TRUE(manifest.parameter("speed")->live);
  EXPECT_FALSE(manifest.parameter("frame")->live);
}

/// Asks for its parameters twice.
class Greedy final : public kervan::Component {
  const LiveParams& first_ = parameters<LiveParams>();
  const LiveParams& second_ = parameters<LiveParams>();

 public:
  double sum() const { return first_.speed + second_.speed; }
};

TEST(LiveParameters, BelongToOneStruct) {
  try {
    kervan::test::Harness harness(kervan::test::define<Greedy>("test/greedy"));
    ADD_FAILURE() << "two structs were given out";
  } catch (const std::logic_error& error) {
    EXPECT_STREQ(error.what(), "a component has one struct of parameters");
  }
}

}  // namespace
