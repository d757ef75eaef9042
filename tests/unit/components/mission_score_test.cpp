#include "components/observe/mission_score.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace kervan::observe {
namespace {

using geometry::Pose2;
using geometry::Twist2;
using namespace std::chrono_literals;

Time at(Duration since_start) { return Time(since_start); }

MissionParams to_ten() {
  MissionParams params;
  params.goals = {{10.0, 0.0}};
  return params;
}

/// Truth at 20 Hz from `from` to `to`, moving linearly.
void drive(MissionScore& score, Time from, Time to, double x0, double x1) {
  const double speed = (x1 - x0) / seconds(to - from);
  for (Time now = from; now <= to; now += 50ms)
    score.truth(now, {x0 + speed * seconds(now - from), 0.0, 0.0}, {speed, 0.0});
}

TEST(MissionScore, IsReachedByStandingWithinTheTolerance) {
  MissionScore score(to_ten(), at(0s));
  drive(score, at(0s), at(20s), 0.0, 9.95);
  EXPECT_EQ(score.figures().outcome, MissionOutcome::running);
  drive(score, at(20050ms), at(21s), 9.95, 9.95);
  EXPECT_EQ(score.figures().outcome, MissionOutcome::reached);
  EXPECT_NEAR(score.figures().error, 0.05, 1e-9);
  EXPECT_NEAR(score.figures().path, 9.95, 1e-9);
  EXPECT_NEAR(score.figures().time, 20.05, 1e-9) << "the half second of standing still is not part of the way";
}

TEST(MissionScore, IsNotReachedByDrivingOverTheGoal) {
  MissionScore score(to_ten(), at(0s));
  drive(score, at(0s), at(40s), 0.0, 20.0);
  EXPECT_EQ(score.figures().outcome, MissionOutcome::running);
  EXPECT_NEAR(score.figures().closest, 0.0, 1e-9);
  EXPECT_NEAR(score.figures().error, 10.0, 1e-9);
}

TEST(MissionScore, IsReachedByDrivingPastIfThatIsAskedFor) {
  MissionParams params = to_ten();
  params.standing = false;
  params.tolerance = 1.0;
  MissionScore score(params, at(0s));
  drive(score, at(0s), at(40s), 0.0, 20.0);
  EXPECT_EQ(score.figures().outcome, MissionOutcome::reached);
  EXPECT_NEAR(score.figures().time, 18.0, 0.051);
}

TEST(MissionScore, AContactEndsItOnlyIfThatIsAskedFor) {
  for (const bool ends : {false, true}) {
    MissionParams params = to_ten();
    params.contact_ends = ends;
    MissionScore score(params, at(0s));
    drive(score, at(0s), at(2s), 0.0, 1.0);
    score.contact(1);
    score.tick(at(2050ms));
    EXPECT_EQ(score.figures().outcome, ends ? MissionOutcome::touched : MissionOutcome::running);
    EXPECT_EQ(score.ended(), ends);
    EXPECT_EQ(score.figures().contacts, 1u);
  }
}

TEST(MissionScore, IsNotReachedByTurningAtTheGoal) {
  MissionScore score(to_ten(), at(0s));
  for (Time now = at(0s); now < at(5s); now += 50ms) score.truth(now, {10.0, 0.0, 0.0}, {0.0, 0.5});
  EXPECT_EQ(score.figures().outcome, MissionOutcome::running);
}

TEST(MissionScore, CountsTheTimeAtRestAnewAfterAMovement) {
  MissionScore score(to_ten(), at(0s));
  drive(score, at(0s), at(400ms), 10.0, 10.0);
  drive(score, at(450ms), at(500ms), 10.0, 10.01);
  drive(score, at(550ms), at(950ms), 10.01, 10.01);
  EXPECT_EQ(score.figures().outcome, MissionOutcome::running);
  drive(score, at(1s), at(1050ms), 10.01, 10.01);
  EXPECT_EQ(score.figures().outcome, MissionOutcome::reached);
  EXPECT_NEAR(score.figures().time, 0.55, 1e-9);
}

TEST(MissionScore, FailsAtTheTimeOutWhenTheRobotRestsElsewhere) {
  MissionScore score(to_ten(), at(1s));
  drive(score, at(1s), at(20s), 0.0, 9.726);
  drive(score, at(20050ms), at(20100ms), 9.726, 9.704);
  drive(score, at(20150ms), at(90950ms), 9.704, 9.704);
  EXPECT_EQ(score.figures().outcome, MissionOutcome::running);
  score.truth(at(91s), {9.704, 0.0, 0.0}, {});
  EXPECT_EQ(score.figures().outcome, MissionOutcome::timed_out);
  EXPECT_NEAR(score.figures().time, 90.0, 1e-9);
  EXPECT_NEAR(score.figures().error, 0.296, 1e-9);
  EXPECT_NEAR(score.figures().closest, 0.274, 1e-9);
  EXPECT_NEAR(score.figures().closest_at.x(), 9.726, 1e-9);
}

TEST(MissionScore, AsksForOneGoalAfterTheOther) {
  MissionParams params = to_ten();
  params.goals = {{5.0, 0.0}, {10.0, 0.0}};
  MissionScore score(params, at(0s));
  drive(score, at(0s), at(10s), 0.0, 5.0);
  EXPECT_EQ(score.goal().x(), 5.0);
  drive(score, at(10050ms), at(10550ms), 5.0, 5.0);
  EXPECT_EQ(score.goal().x(), 10.0);
  EXPECT_EQ(score.figures().outcome, MissionOutcome::running);
  drive(score, at(10600ms), at(20s), 5.0, 9.0);
  EXPECT_NEAR(score.figures().closest, 1.0, 1e-9) << "of the second goal";
  drive(score, at(20050ms), at(25s), 9.0, 10.0);
  drive(score, at(25050ms), at(25600ms), 10.0, 10.0);
  EXPECT_EQ(score.figures().outcome, MissionOutcome::reached);
  EXPECT_NEAR(score.figures().path, 10.0, 1e-9);
}

TEST(MissionScore, FailsAtTheTimeOutWithoutAnyTruth) {
  MissionScore score(to_ten(), at(0s));
  score.tick(at(89999ms));
  EXPECT_EQ(score.figures().outcome, MissionOutcome::running);
  score.tick(at(90s));
  EXPECT_EQ(score.figures().outcome, MissionOutcome::timed_out);
}

TEST(MissionScore, KeepsTheLeastClearanceAndCountsContacts) {
  MissionScore score(to_ten(), at(0s));
  EXPECT_FALSE(score.figures().min_clearance);
  for (const double distance : {0.4, 0.163, 0.2, std::numeric_limits<double>::quiet_NaN()}) score.clearance(distance);
  score.contact(1);
  EXPECT_EQ(score.figures().min_clearance, 0.163);
  EXPECT_EQ(score.figures().contacts, 1u);
}

TEST(MissionScore, ChangesNothingOnceItHasEnded) {
  MissionScore score(to_ten(), at(0s));
  score.tick(at(90s));
  drive(score, at(91s), at(95s), 9.0, 10.0);
  score.contact(1);
  score.clearance(0.1);
  EXPECT_EQ(score.figures().outcome, MissionOutcome::timed_out);
  EXPECT_EQ(score.figures().path, 0.0);
  EXPECT_EQ(score.figures().contacts, 0u);
  EXPECT_FALSE(score.figures().min_clearance);
}

}  // namespace
}  // namespace kervan::observe
