#include <gtest/gtest.h>

#include <limits>

#include "framework/test/harness.hpp"
#include "tests/component/plane_fixtures.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;
using geometry_msgs::msg::TwistStamped;

double speed(const Harness& harness) { return harness.latest<TwistStamped>("cmd_vel")->twist.linear.x; }

/// Commands 0.5 m/s at 10 Hz for `time`.
void drive(Harness& harness, Duration time) {
  for (Duration t{}; t < time; t += 100ms) {
    harness.feed("cmd_vel_raw", twist_of(0.5, 0.0));
    harness.advance(100ms);
  }
}

TEST(DriveGuardComponent, CommandsTheDriveTwentyTimesASecondWhateverTheInputsRate) {
  Harness harness("safety/drive_guard");
  drive(harness, 1s);
  harness.take<TwistStamped>("cmd_vel");
  drive(harness, 1s);
  EXPECT_EQ(harness.take<TwistStamped>("cmd_vel").size(), 20u);
  harness.advance(1s);
  EXPECT_EQ(harness.take<TwistStamped>("cmd_vel").size(), 20u);
}

TEST(DriveGuardComponent, StandsUntilTheFirstCommand) {
  Harness harness("safety/drive_guard");
  harness.advance(100ms);
  EXPECT_EQ(speed(harness), 0.0);
  EXPECT_EQ(harness.reason(), "cmd_vel_raw: nothing received yet");
}

TEST(DriveGuardComponent, BrakesWithin200MillisecondsSoThatTheDriveDoesWithin250AndStandsAfterItsBrakingTime) {
  Harness harness("safety/drive_guard");
  drive(harness, 3s);
  EXPECT_EQ(speed(harness), 0.5);
  EXPECT_EQ(harness.state(), ComponentState::active);
  harness.feed("cmd_vel_raw", twist_of(0.5, 0.0));
  harness.advance(149ms);
  EXPECT_EQ(speed(harness), 0.5);
  harness.advance(51ms);
  EXPECT_LT(speed(harness), 0.5);
  EXPECT_EQ(harness.state(), ComponentState::degraded);
  EXPECT_EQ(harness.reason(), "cmd_vel_raw: no fresh command, braking");
  harness.advance(850ms);
  EXPECT_EQ(speed(harness), 0.0);
  drive(harness, 1s);
  EXPECT_GT(speed(harness), 0.0);
  EXPECT_EQ(harness.state(), ComponentState::active);
}

TEST(DriveGuardComponent, RefusesACommandThatIsNotFiniteAndBrakes) {
  Harness harness("safety/drive_guard");
  drive(harness, 3s);
  for (int i = 0; i < 20; ++i) {
    harness.feed("cmd_vel_raw", twist_of(std::numeric_limits<double>::quiet_NaN(), 0.0));
    harness.advance(100ms);
  }
  EXPECT_EQ(speed(harness), 0.0);
  EXPECT_EQ(harness.reason(), "cmd_vel_raw: refused a command that is not finite");
}

TEST(DriveGuardComponent, RefusesATimeOutInWhichNoCommandReachesTheDrive) {
  EXPECT_NO_THROW(Harness("safety/drive_guard", {{"period", 0.1}, {"travel", 0.1}, {"timeout", 0.2}}));
  try {
    Harness("safety/drive_guard", {{"period", 0.1}, {"travel", 0.1}, {"timeout", 0.19}});
    FAIL() << "it was taken";
  } catch (const ParameterError& error) {
    EXPECT_EQ(error.parameter(), "subject.timeout");
    EXPECT_EQ(error.message(), "it is shorter than period and travel, so no command would ever be driven");
  }
}

TEST(DriveGuardComponent, SaysAZeroCommandAsItsLastWord) {
  Harness harness("safety/drive_guard");
  drive(harness, 3s);
  harness.end();
  EXPECT_EQ(speed(harness), 0.0);
}

}  // namespace
}  // namespace kervan::test
