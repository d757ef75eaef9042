/// What the component sim/world can be asked while it runs, on logical time.
#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>

#include "framework/test/harness.hpp"
#include "geometry_msgs/msg/TwistStamped.hpp"
#include "kervan_msgs/msg/SonarArray.hpp"
#include "nav_msgs/msg/Odometry.hpp"
#include "rosgraph_msgs/msg/Clock.hpp"
#include "sensor_msgs/msg/Range.hpp"

namespace kervan::sim {
namespace {

using namespace std::chrono_literals;
using geometry_msgs::msg::TwistStamped;
using nav_msgs::msg::Odometry;

ValueList pose(double x, double y, double yaw) { return {x, y, yaw}; }

ValueMap p3dx(ValueList start, bool present = true) {
  return {{"model", KERVAN_SIM_FOLDER "/robots/p3dx.yaml"}, {"start", std::move(start)}, {"present", present}};
}

/// r1 in the hall; r2 may come, 4 m ahead of it, and r3 where r1 stands at the start.
ValueMap hall() {
  return {{"map", KERVAN_SIM_FOLDER "/worlds/hall.yaml"},
          {"robots", ValueMap{{"r1", p3dx(pose(2.0, 6.0, 0.0))},
                              {"r2", p3dx(pose(6.0, 6.0, 0.0), false)},
                              {"r3", p3dx(pose(2.0, 6.0, 0.0), false)}}}};
}

class SimulatorRequests : public ::testing::Test {
 protected:
  /// "yes: " and the answer, or "no: " and the reason.
  std::string ask(const std::string& request, const ValueMap& arguments = {}) {
    try {
      return "yes: " + harness_.call(request, arguments);
    } catch (const std::invalid_argument& refused) {
      return std::string("no: ") + refused.what();
    }
  }
  std::string ask_of(const std::string& request, const char* robot) { return ask(request, {{"robot", robot}}); }

  /// Commands r1 at 20 Hz for `time`.
  void drive(Duration time, double speed = 0.5) {
    TwistStamped wanted;
    wanted.twist.linear.x = speed;
    for (Duration t{}; t < time; t += 50ms) {
      harness_.feed("r1/cmd_vel", wanted);
      harness_.advance(50ms);
    }
  }
  double x_of(const std::string& robot) const {
    return harness_.latest<Odometry>(robot + "/truth")->pose.pose.position.x;
  }
  std::size_t truths(const std::string& robot) { return harness_.take<Odometry>(robot + "/truth").size(); }
  bool knows(const std::string& robot) const { return harness_.latest<Odometry>(robot + "/truth") != nullptr; }

  test::Harness harness_{"sim/world", hall()};
};

TEST_F(SimulatorRequests, PausedTheWorldStandsStillAndTheClockRunsOn) {
  drive(1s);
  const double x = x_of("r1");
  EXPECT_EQ(ask("pause"), "yes: ");
  EXPECT_EQ(ask("pause"), "yes: already paused");
  EXPECT_EQ(harness_.state(), ComponentState::degraded);
  EXPECT_EQ(harness_.reason(), "paused on request");
  truths("r1");
  harness_.take<rosgraph_msgs::msg::Clock>("/clock");
  drive(2s);
  EXPECT_EQ(truths("r1"), 0u);
  EXPECT_EQ(harness_.take<rosgraph_msgs::msg::Clock>("/clock").size(), 200u);
  EXPECT_EQ(harness_.latest<rosgraph_msgs::msg::Clock>("/clock")->clock.sec, 3);
  EXPECT_EQ(ask("resume"), "yes: ");
  EXPECT_EQ(ask("resume"), "yes: already running");
  EXPECT_EQ(harness_.state(), ComponentState::active);
  harness_.advance(10ms);
  EXPECT_NEAR(x_of("r1"), x, 0.006) << "the robot goes on from where it stood, with the speed it had";
  EXPECT_GT(x_of("r1"), x);
}

TEST_F(SimulatorRequests, AWorldThatWasPausedGoesOnAsIfItHadNotBeen) {
  test::Harness other("sim/world", hall());
  const auto run = [](test::Harness& harness) {
    TwistStamped wanted;
    wanted.twist.linear.x = 0.4;
    wanted.twist.angular.z = 0.3;
    for (int i = 0; i < 20; ++i) {
      harness.feed("r1/cmd_vel", wanted);
      harness.advance(50ms);
    }
    return *harness.latest<kervan_msgs::msg::SonarArray>("r1/sonar");
  };
  run(harness_);
  run(other);
  ask("pause");
  harness_.advance(3s);
  ask("resume");
  EXPECT_EQ(run(harness_).readings, run(other).readings);
}

TEST_F(SimulatorRequests, StepsWhilePausedAndStandsStillAgain) {
  EXPECT_EQ(ask("step"), "no: the world is not paused; pause it first");
  drive(500ms);
  ask("pause");
  truths("r1");
  EXPECT_EQ(ask("step", {{"steps", 3}}), "yes: ");
  EXPECT_EQ(ask("step"), "yes: ");
  harness_.advance(1s);
  const auto steps = harness_.take<Odometry>("r1/truth");
  ASSERT_EQ(steps.size(), 4u);
  EXPECT_EQ(steps[1]->header.stamp.nanosec - steps[0]->header.stamp.nanosec, 10'000'000u);
  EXPECT_EQ(ask("step", {{"steps", 0}}), "no: steps: 0 is out of range; allowed: 1 .. 1e+06");
  EXPECT_EQ(ask("step", {{"step", 2}}), "no: step: there is no such parameter; did you mean 'steps'? allowed: steps");
  ask("resume");
  harness_.advance(1s);
  EXPECT_EQ(truths("r1"), 100u);
}

TEST_F(SimulatorRequests, AResetWorldDoesTheSameAgain) {
  harness_.advance(0ms);
  const auto run = [this] {
    drive(1s);
    return std::pair(harness_.latest<kervan_msgs::msg::SonarArray>("r1/sonar")->readings, x_of("r1"));
  };
  const auto first = run();
  ask_of("spawn", "r2");
  EXPECT_EQ(ask("reset"), "yes: ");
  truths("r2");
  harness_.advance(10ms);
  EXPECT_DOUBLE_EQ(x_of("r1"), 2.0);
  EXPECT_EQ(harness_.latest<Odometry>("r1/odom")->pose.pose.position.x, 2.0);
  const auto second = run();
  EXPECT_EQ(first.first, second.first);
  EXPECT_EQ(first.second, second.second);
  EXPECT_EQ(truths("r2"), 0u) << "it was not there at the start";
}

TEST_F(SimulatorRequests, ContactsAndClearanceBeginAgainAfterAReset) {
  harness_.advance(0ms);
  const float at_start = harness_.latest<sensor_msgs::msg::Range>("r1/clearance")->range;
  ask("teleport", {{"robot", "r1"}, {"pose", pose(1.0, 6.0, 0.0)}});
  harness_.advance(10ms);
  EXPECT_LT(harness_.latest<sensor_msgs::msg::Range>("r1/clearance")->range, at_start);
  ask("reset");
  harness_.advance(10ms);
  EXPECT_EQ(harness_.latest<sensor_msgs::msg::Range>("r1/clearance")->range, at_start);
}

TEST_F(SimulatorRequests, ARobotComesAndGoes) {
  harness_.advance(100ms);
  EXPECT_FALSE(knows("r2"));
  EXPECT_EQ(ask_of("remove", "r2"), "yes: not there any more");
  EXPECT_EQ(ask_of("spawn", "r2"), "yes: ");
  EXPECT_EQ(ask_of("spawn", "r2"), "yes: already there");
  harness_.advance(100ms);
  ASSERT_TRUE(knows("r2"));
  EXPECT_DOUBLE_EQ(x_of("r2"), 6.0);
  ASSERT_NE(harness_.latest<kervan_msgs::msg::SonarArray>("r2/sonar"), nullptr);
  EXPECT_LT(harness_.latest<kervan_msgs::msg::SonarArray>("r1/sonar")->readings[3].range, 4.0f) << "it stands ahead";
  EXPECT_EQ(ask_of("remove", "r1"), "yes: ");
  truths("r1");
  truths("r2");
  drive(1s);
  EXPECT_EQ(truths("r1"), 0u);
  EXPECT_EQ(truths("r2"), 100u);
  EXPECT_EQ(ask_of("spawn", "r1"), "yes: ");
  truths("r1");
  harness_.advance(50ms);
  EXPECT_DOUBLE_EQ(x_of("r1"), 2.0) << "what was commanded while it was away is forgotten";
}

TEST_F(SimulatorRequests, RefusesToSpawnWhatCannotBe) {
  EXPECT_EQ(ask_of("spawn", "r3"), "no: 'r3' would stand in r1");
  EXPECT_EQ(ask("spawn", {{"robot", "r3"}, {"pose", pose(5.0, 3.0, 0.0)}}),
            "no: 'r3' would stand in an obstacle of hall");
  EXPECT_EQ(ask("spawn", {{"robot", "r3"}, {"pose", pose(8.0, 6.0, 1.0)}}), "yes: ");
  EXPECT_EQ(ask("spawn", {{"robot", "r3"}, {"pose", pose(9.0, 6.0, 1.0)}}),
            "no: 'r3' is in the world already; teleport puts it elsewhere");
  EXPECT_EQ(ask_of("spawn", "r9"),
            "no: there is no robot 'r9' in the parameters; did you mean 'r1'? robots: r1, r2, r3");
  EXPECT_EQ(ask_of("remove", "robot"), "no: there is no robot 'robot' in the parameters; robots: r1, r2, r3");
  EXPECT_EQ(ask("spawn"), "no: robot: is missing: One of the parameter robots that is not in the world.");
  EXPECT_EQ(ask("spawn", {{"robot", "r2"}, {"pose", pose(1e7, 0.0, 0.0)}}),
            "no: pose[0]: 1e+07 is out of range; allowed: -1e+06 .. 1e+06");
}

TEST_F(SimulatorRequests, ATeleportedRobotIsElsewhereAndItsOdometryDoesNotNotice) {
  drive(1s);
  const double odometry = harness_.latest<Odometry>("r1/odom")->pose.pose.position.x;
  EXPECT_EQ(ask("teleport", {{"robot", "r1"}, {"pose", pose(12.0, 6.0, 0.5)}}), "yes: ");
  harness_.advance(50ms);
  EXPECT_NEAR(x_of("r1"), 12.0, 0.03);
  EXPECT_NEAR(harness_.latest<Odometry>("r1/odom")->pose.pose.position.x, odometry, 0.03);
}

TEST_F(SimulatorRequests, RefusesToTeleportIntoSomethingAndLeavesTheRobotWhereItIs) {
  ask_of("spawn", "r2");
  EXPECT_EQ(ask("teleport", {{"robot", "r1"}, {"pose", pose(6.1, 6.0, 0.0)}}), "no: 'r1' would stand in r2");
  EXPECT_EQ(ask("teleport", {{"robot", "r1"}, {"pose", pose(0.0, 0.0, 0.0)}}),
            "no: 'r1' would stand in an obstacle of hall");
  EXPECT_EQ(ask("teleport", {{"robot", "r3"}, {"pose", pose(9.0, 6.0, 0.0)}}),
            "no: 'r3' is not in the world; spawn puts it there");
  EXPECT_EQ(ask_of("teleport", "r1"), "no: pose: is missing: Pose of base_link in map.");
  harness_.advance(50ms);
  EXPECT_DOUBLE_EQ(x_of("r1"), 2.0);
}

TEST_F(SimulatorRequests, WhoWatchesAPausedWorldSeesWhoComesAndIsMoved) {
  harness_.advance(100ms);
  ask("pause");
  ask_of("spawn", "r2");
  ask("teleport", {{"robot", "r1"}, {"pose", pose(12.0, 6.0, 0.0)}});
  harness_.advance(100ms);
  EXPECT_DOUBLE_EQ(x_of("r1"), 12.0);
  ASSERT_TRUE(knows("r2"));
  EXPECT_DOUBLE_EQ(x_of("r2"), 6.0);
}

TEST_F(SimulatorRequests, AnUnknownRequestIsNamedWithThoseThatAreThere) {
  EXPECT_EQ(
      ask("teleprot"),
      "no: 'subject' has no request 'teleprot'; did you mean 'teleport'? it has: pause, resume, step, reset, spawn, "
      "remove, teleport");
}

TEST(SimulatorRequestsTrace, TheSameRequestsAtTheSameTimesGiveTheSameTrace) {
  const auto trace = [](Duration when) {
    test::Harness harness("sim/world", hall());
    TwistStamped wanted;
    wanted.twist.linear.x = 0.5;
    const auto drive = [&](Duration time) {
      for (Duration t{}; t < time; t += 50ms) {
        harness.feed("r1/cmd_vel", wanted);
        harness.advance(50ms);
      }
    };
    drive(when);
    harness.call("spawn", {{"robot", "r2"}});
    drive(500ms);
    harness.call("pause");
    drive(200ms);
    harness.call("step", {{"steps", 7}});
    harness.call("teleport", {{"robot", "r2"}, {"pose", pose(10.0, 6.0, 1.0)}});
    drive(500ms);
    harness.call("resume");
    drive(500ms);
    harness.call("remove", {{"robot", "r2"}});
    drive(500ms);
    harness.call("reset");
    drive(500ms);
    return harness.trace_hash();
  };
  EXPECT_EQ(trace(1s), trace(1s));
  EXPECT_NE(trace(1s), trace(1050ms));
}

}  // namespace
}  // namespace kervan::sim
