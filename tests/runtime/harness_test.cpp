/// The harness, seen by somebody who tests a component with it.
#include "framework/test/harness.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "framework/kervan.hpp"
#include "geometry_msgs/msg/TwistStamped.hpp"
#include "kervan_msgs/msg/MotionRequest.hpp"
#include "nav_msgs/msg/Odometry.hpp"

namespace {

using namespace std::chrono_literals;
using geometry_msgs::msg::TwistStamped;
using nav_msgs::msg::Odometry;

struct Params {
  double gain = 2.0;
  template <class Visitor>
  void describe(Visitor& v) {
    v(gain, "gain", {.unit = "1/s", .min = 0.0, .max = 10.0, .help = "Speed per metre of error."});
  }
};

/// Drives back to x = 0; throws beyond 100 m.
class Homing final : public kervan::Component {
  const Params& params_ = parameters<Params>();
  kervan::Input<Odometry> odom_{this, "odom", kervan::qos::sensor.max_age(300ms), "Where the robot is."};
  kervan::Input<TwistStamped> echo_{this, "echo", kervan::qos::event.optional(), &Homing::on_echo, "Repeated at once."};
  kervan::Output<TwistStamped> cmd_vel_{this, "cmd_vel", kervan::qos::command, "Speed wanted."};
  kervan::Output<TwistStamped> repeated_{this, "repeated", kervan::qos::event, "What came in on echo."};
  kervan::Timer tick_{this, 100ms, &Homing::on_tick};

  void on_echo(const TwistStamped& message, kervan::Time) { repeated_.publish(message); }

  void on_tick(kervan::Time) {
    const Odometry* odom = odom_.latest();
    auto command = cmd_vel_.loan();
    if (!odom) {
      report_degraded(odom_.missing());
    } else {
      report_active();
      if (odom->pose.pose.position.x > 100.0) throw std::runtime_error("lost");
      command->twist.linear.x = -params_.gain * odom->pose.pose.position.x;
    }
    cmd_vel_.publish(std::move(command));
  }

  void on_deactivate(kervan::Time) override { cmd_vel_.publish(TwistStamped{}); }
};

const kervan::ComponentClass homing = kervan::test::define<Homing>("test/homing");

Odometry at(double x) {
  Odometry odometry;
  odometry.pose.pose.position.x = x;
  return odometry;
}

TEST(Harness, GivesAComponentItsInputsAndReadsItsOutputs) {
  kervan::test::Harness harness(homing, {{"gain", 3.0}});
  harness.feed("odom", at(2.0));
  harness.advance(100ms);
  ASSERT_NE(harness.latest<TwistStamped>("cmd_vel"), nullptr);
  EXPECT_DOUBLE_EQ(harness.latest<TwistStamped>("cmd_vel")->twist.linear.x, -6.0);
  EXPECT_EQ(harness.state(), kervan::ComponentState::active);
}

TEST(Harness, ShowsWhyAComponentIsDegraded) {
  kervan::test::Harness harness(homing);
  harness.advance(0ms);
  EXPECT_EQ(harness.state(), kervan::ComponentState::degraded);
  EXPECT_EQ(harness.reason(), "odom: nothing received yet");
  harness.feed("odom", at(1.0));
  harness.advance(100ms);
  EXPECT_EQ(harness.state(), kervan::ComponentState::active);
  harness.advance(400ms);
  EXPECT_EQ(harness.reason(), "odom: no sample for more than 0.30 s");
}

TEST(Harness, CountsEveryPeriodOfATimer) {
  kervan::test::Harness harness(homing);
  harness.advance(1s);
  EXPECT_EQ(harness.take<TwistStamped>("cmd_vel").size(), 11u);  // at 0.0 s, 0.1 s, … 1.0 s
  EXPECT_EQ(harness.take<TwistStamped>("cmd_vel").size(), 0u);
}

TEST(Harness, HandsEverySampleOfAnEventInputToItsHandlerInOrder) {
  kervan::test::Harness harness(homing);
  for (int i = 0; i < 5; ++i) {
    TwistStamped message;
    message.twist.angular.z = i;
    harness.feed("echo", message);
  }
  harness.advance(0ms);
  const auto repeated = harness.take<TwistStamped>("repeated");
  ASSERT_EQ(repeated.size(), 5u);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(repeated[static_cast<std::size_t>(i)]->twist.angular.z, i);
}

TEST(Harness, AHandlerThatThrowsFailsTheComponentAndSaysWhere) {
  kervan::test::Harness harness(homing);
  harness.feed("odom", at(200.0));
  harness.advance(100ms);
  EXPECT_EQ(harness.state(), kervan::ComponentState::failed);
  EXPECT_EQ(harness.reason(), "lost (in a timer)");
  harness.take<TwistStamped>("cmd_vel");
  harness.advance(1s);
  EXPECT_EQ(harness.take<TwistStamped>("cmd_vel").size(), 0u);
}

TEST(Harness, EndLetsTheComponentSayItsLastWords) {
  kervan::test::Harness harness(homing);
  harness.feed("odom", at(2.0));
  harness.advance(100ms);
  harness.end();
  EXPECT_EQ(harness.latest<TwistStamped>("cmd_vel")->twist.linear.x, 0.0);
  EXPECT_EQ(harness.state(), kervan::ComponentState::stopped);
}

TEST(Harness, RefusesAWrongPortAWrongTypeAndAWrongParameter) {
  kervan::test::Harness harness(homing);
  EXPECT_THROW(harness.feed("odometry", at(0.0)), std::invalid_argument);
  EXPECT_THROW(harness.feed("odom", TwistStamped{}), std::invalid_argument);
  EXPECT_THROW(harness.latest<Odometry>("cmd_vel"), std::invalid_argument);
  EXPECT_THROW(kervan::test::Harness(homing, {{"gian", 1.0}}), kervan::ParameterError);
  EXPECT_THROW(kervan::test::Harness(homing, {{"gain", 11.0}}), kervan::ParameterError);
  EXPECT_THROW(kervan::test::Harness("no/such_type"), std::invalid_argument);
}

TEST(Manifest, ComesFromTheDeclarationsWithoutRunningAnything) {
  const kervan::Manifest manifest = kervan::describe(homing, {});
  ASSERT_EQ(manifest.ports.size(), 4u);
  EXPECT_EQ(manifest.ports[0].name, "odom");
  EXPECT_EQ(manifest.ports[0].type, "nav_msgs::msg::Odometry");
  EXPECT_EQ(manifest.ports[0].qos.max_age(), 300ms);
  EXPECT_EQ(manifest.ports[2].direction, kervan::PortDirection::output);
  ASSERT_NE(manifest.parameter("gain"), nullptr);
  EXPECT_EQ(manifest.parameter("gain")->unit, "1/s");
  EXPECT_EQ(manifest.parameter("gain")->default_value, kervan::Value(2.0));
  ASSERT_EQ(manifest.timers.size(), 1u);
  EXPECT_EQ(manifest.timers[0].period, 100ms);
}

}  // namespace
