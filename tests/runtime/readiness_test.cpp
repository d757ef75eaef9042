/// The barrier before a run of several containers, and how its end spreads.
#include <gmock/gmock.h>

#include <mutex>
#include <optional>

#include "builtin_interfaces/msg/Time.hpp"
#include "framework/kervan.hpp"
#include "framework/test/harness.hpp"
#include "tests/runtime/containers.hpp"

namespace {

using namespace std::chrono_literals;
using builtin_interfaces::msg::Time;
using kervan::PortDirection;
using kervan::runtime::RunEnd;
using kervan::runtime::RunPhase;
using kervan::test::binding;
using kervan::test::Composition;
using kervan::test::eventually;
using kervan::test::Running;
using ::testing::HasSubstr;

constexpr int kLast = 20;

/// Publishes 1, 2, 3, … from the moment it is active.
class Counter final : public kervan::Component {
  kervan::Output<Time> out_{this, "out", kervan::qos::event, "Numbers."};
  kervan::Timer tick_{this, 1ms, &Counter::on_tick};
  int next_ = 0;
  void on_activate(kervan::Time) override { on_tick({}); }
  void on_tick(kervan::Time) {
    auto message = out_.loan();
    message->sec = ++next_;
    out_.publish(std::move(message));
  }
};

/// Ends the run when it has heard the last number.
class Listener final : public kervan::Component {
  kervan::Input<Time> in_{this, "in", kervan::qos::event, &Listener::on_message, "Numbers."};
  void on_message(const Time& message, kervan::Time) {
    if (first == 0) first = message.sec;
    if (message.sec == kLast) finish("heard the last one");
  }

 public:
  static inline int first = 0;
};

/// Neither ends the run nor says anything.
class Idle final : public kervan::Component {
  kervan::Input<Time> in_{this, "in", kervan::qos::event, "Numbers."};
};

const auto counter = kervan::test::define<Counter>("test/counter");
const auto listener = kervan::test::define<Listener>("test/listener");
const auto idle = kervan::test::define<Idle>("test/idle");

const kervan::QosProfile event = *kervan::builtin_profile("event");
const kervan::runtime::PortBinding out = binding<Time>("out", PortDirection::output, "/numbers", event);
const kervan::runtime::PortBinding in = binding<Time>("in", PortDirection::input, "/numbers", event);

TEST(Readiness, NothingIsPublishedBeforeEveryContainerIsMatchedAndOneEndsForAll) {
  Composition composition({"left", "right"});
  composition.add("left", "counter", counter, {out});
  composition.add("right", "listener", listener, {in});
  Listener::first = 0;

  Running left(composition.spec("left"), composition.registry());
  // Alone it gets nowhere, however long: its ports have nobody to be matched with.
  EXPECT_FALSE(left.has_reached(RunPhase::matched));
  Running right(composition.spec("right"), composition.registry());

  EXPECT_EQ(right.report().end, RunEnd::finished);
  EXPECT_EQ(right.report().reason, "heard the last one");
  EXPECT_EQ(left.report().end, RunEnd::finished);
  EXPECT_EQ(left.report().reason, "heard the last one");
  EXPECT_EQ(Listener::first, 1) << "the very first sample was published to nobody";
  for (const Running* running : {&left, &right}) {
    EXPECT_TRUE(running->has_reached(RunPhase::matched));
    EXPECT_TRUE(running->has_reached(RunPhase::active));
    EXPECT_EQ(running->log(), "");
  }
}

TEST(Readiness, WhileItWaitsItSaysWhatIsMissing) {
  Composition composition({"left", "middle", "right"});
  composition.add("left", "counter", counter, {out});
  composition.add("middle", "idle", idle, {in});
  composition.add("right", "listener", listener, {in});
  Listener::first = 0;

  Running left(composition.spec("left"), composition.registry());
  Running middle(composition.spec("middle"), composition.registry());
  EXPECT_TRUE(eventually([&] { return middle.has_reached(RunPhase::matched); }));
  EXPECT_TRUE(eventually([&] { return !left.log().empty() && !middle.log().empty(); }));
  EXPECT_THAT(left.log(), HasSubstr(" warning [kervan/left] waiting for 5 s: counter.out with listener.in of container "
                                    "'right'; container 'right' is not there\n"));
  EXPECT_THAT(middle.log(),
              HasSubstr(" warning [kervan/middle] waiting for 5 s: container 'left' is not matched with all"
                        " others; container 'right' is not there\n"));
  EXPECT_FALSE(left.has_reached(RunPhase::matched));
  EXPECT_FALSE(middle.has_reached(RunPhase::active));

  Running right(composition.spec("right"), composition.registry());
  for (Running* running : {&left, &middle, &right}) EXPECT_EQ(running->report().end, RunEnd::finished);
  EXPECT_EQ(Listener::first, 1) << "somebody began long before the last one was told that all are matched";
}

TEST(Readiness, AContainerOfAnotherCompositionIsNamedAndNotWaitedFor) {
  Composition composition({"left", "right"});
  composition.add("left", "counter", counter, {out});
  composition.add("right", "listener", listener, {in});
  kervan::runtime::ContainerSpec other = composition.spec("right");
  other.components.front().name = "another";

  Running left(composition.spec("left"), composition.registry());
  Running right(other, composition.registry());
  EXPECT_TRUE(eventually([&] { return !left.log().empty() && !right.log().empty(); }));
  const std::string who = " (pid " + std::to_string(getpid()) + " on ";
  EXPECT_THAT(left.log(), HasSubstr("waiting for 5 s: container 'right'" + who));
  EXPECT_THAT(left.log(), HasSubstr(") runs another composition: start it from the same file\n"));
  EXPECT_THAT(right.log(), HasSubstr("waiting for 5 s: container 'left'" + who));
  EXPECT_FALSE(left.has_reached(RunPhase::active));
  EXPECT_FALSE(right.has_reached(RunPhase::active));
  right.stop();
  EXPECT_EQ(right.report().end, RunEnd::interrupted);
}

TEST(Readiness, AContainerThatIsRestartedJoinsTheOthersWithoutThemWaiting) {
  Composition composition({"left", "right"});
  composition.add("left", "counter", counter, {out});
  composition.add("right", "idle", idle, {in});

  Running left(composition.spec("left"), composition.registry());
  for (int i = 0; i < 3; ++i) {
    Running right(composition.spec("right"), composition.registry());
    EXPECT_TRUE(eventually([&] { return right.has_reached(RunPhase::active); }));
    right.stop();
    EXPECT_EQ(right.report().end, RunEnd::interrupted);
    EXPECT_EQ(right.log(), "");
  }
  EXPECT_FALSE(left.has_ended());
}

TEST(Readiness, ARestartedContainerDoesNotWaitForOneThatIsGoneForGood) {
  Composition composition({"left", "middle", "right"});
  composition.add("left", "counter", counter, {out});
  composition.add("middle", "idle1", idle, {in});
  composition.add("right", "idle2", idle, {in});

  Running left(composition.spec("left"), composition.registry());
  auto right = std::make_optional<Running>(composition.spec("right"), composition.registry());
  {
    Running middle(composition.spec("middle"), composition.registry());
    EXPECT_TRUE(eventually([&] { return left.has_reached(RunPhase::active) && right->has_reached(RunPhase::active); }));
  }
  right.reset();
  right.emplace(composition.spec("right"), composition.registry());
  EXPECT_TRUE(eventually([&] { return right->has_reached(RunPhase::active); }));
  EXPECT_THAT(right->log(),
              HasSubstr("the others are running, so this container becomes active too, although: container "
                        "'middle' is not there\n"));
}

TEST(Readiness, AnInterruptEndsTheWaiting) {
  Composition composition({"left", "right"});
  composition.add("left", "counter", counter, {out});
  composition.add("right", "listener", listener, {in});
  Running left(composition.spec("left"), composition.registry());
  left.stop();
  EXPECT_EQ(left.report().end, RunEnd::interrupted);
  EXPECT_FALSE(left.has_reached(RunPhase::active));
}

}  // namespace
