#include "components/behavior/arbiter.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace kervan::behavior {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

Time at(Duration since_start) { return Time(since_start); }

Request request(const std::string& behaviour, int priority, double speed = 0.2, int hold = 0) {
  return {behaviour, priority, hold, true, 150ms, {speed, 0.0}, behaviour + " says why"};
}

Request idle(const std::string& behaviour, int priority) {
  Request request{behaviour, priority, 0, false, 150ms, {}, "nothing"};
  return request;
}

TEST(Arbiter, LetsNobodyDriveWithoutARequest) {
  Arbiter arbiter(50ms);
  EXPECT_EQ(arbiter.decide(at(0s)).behaviour, "");
  EXPECT_EQ(arbiter.decide(at(0s)).why, "no behaviour says anything");
  arbiter.take(at(0s), idle("a", 1));
  const Decision decision = arbiter.decide(at(0s));
  EXPECT_EQ(decision.behaviour, "");
  EXPECT_EQ(decision.twist, geometry::Twist2{});
  EXPECT_EQ(decision.why, "no behaviour wants to drive");
}

TEST(Arbiter, FollowsTheActiveRequestOfHighestPriority) {
  Arbiter arbiter(50ms);
  arbiter.take(at(0s), request("low", 1, 0.1));
  arbiter.take(at(0s), request("high", 3, 0.3));
  arbiter.take(at(0s), request("middle", 2, 0.2));
  arbiter.take(at(0s), idle("highest", 4));
  const Decision decision = arbiter.decide(at(0s));
  EXPECT_EQ(decision.behaviour, "high");
  EXPECT_EQ(decision.priority, 3);
  EXPECT_EQ(decision.twist.linear, 0.3);
  EXPECT_EQ(decision.why, "high says why");
  EXPECT_THAT(decision.waiting, ElementsAre("middle", "low"));
  EXPECT_THAT(decision.expired, IsEmpty());
}

TEST(Arbiter, ForgetsARequestBeforeItIsTooOldAndSaysSoOnce) {
  Arbiter arbiter(50ms);
  arbiter.take(at(0s), request("high", 2));
  arbiter.take(at(0s), request("low", 1));
  EXPECT_EQ(arbiter.decide(at(100ms)).behaviour, "high") << "driven until 150 ms";
  arbiter.take(at(100ms), request("low", 1));
  const Decision decision = arbiter.decide(at(101ms));
  EXPECT_EQ(decision.behaviour, "low");
  EXPECT_THAT(decision.expired, ElementsAre("high"));
  EXPECT_THAT(arbiter.decide(at(102ms)).expired, IsEmpty());
}

TEST(Arbiter, PrefersWhoDrivesAndThenTheFirstByNameAmongEquals) {
  Arbiter arbiter(50ms);
  arbiter.take(at(0s), request("b", 1));
  EXPECT_EQ(arbiter.decide(at(0s)).behaviour, "b");
  arbiter.take(at(0s), request("a", 1));
  EXPECT_EQ(arbiter.decide(at(0s)).behaviour, "b");
  arbiter.take(at(0s), idle("b", 1));
  EXPECT_EQ(arbiter.decide(at(0s)).behaviour, "a");
  arbiter.take(at(0s), request("b", 1));
  EXPECT_EQ(arbiter.decide(at(0s)).behaviour, "a");
}

TEST(Arbiter, HoldsWhoAsksForItAgainstLittleHigherPriorities) {
  Arbiter arbiter(50ms);
  arbiter.take(at(0s), request("find", 10, 0.2, 15));
  EXPECT_EQ(arbiter.decide(at(0s)).behaviour, "find");
  arbiter.take(at(0s), request("follow", 20));
  const Decision held = arbiter.decide(at(0s));
  EXPECT_EQ(held.behaviour, "find");
  EXPECT_EQ(held.priority, 10);
  EXPECT_THAT(held.waiting, ElementsAre("follow"));
  arbiter.take(at(0s), request("front", 30));
  EXPECT_EQ(arbiter.decide(at(0s)).behaviour, "front");
  arbiter.take(at(0s), idle("front", 30));
  EXPECT_EQ(arbiter.decide(at(0s)).behaviour, "follow") << "find does not drive any more, so nothing holds it";
}

TEST(Arbiter, RefusesWhatCannotBeAndKeepsWhatWasAskedForBefore) {
  Arbiter arbiter(50ms);
  EXPECT_TRUE(arbiter.take(at(0s), request("a", 1)));
  for (const double speed : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    EXPECT_FALSE(arbiter.take(at(0s), request("a", 1, speed)));
  EXPECT_FALSE(arbiter.take(at(0s), request("", 1)));
  Request expired = request("a", 1, 0.5);
  expired.valid_for = 0ms;
  EXPECT_FALSE(arbiter.take(at(0s), expired));
  EXPECT_EQ(arbiter.refused(), 4u);
  EXPECT_EQ(arbiter.decide(at(0s)).twist.linear, 0.2);
}

TEST(Arbiter, DropsABehaviourThatHasEndedInGoodOrder) {
  Arbiter arbiter(50ms);
  arbiter.take(at(0s), request("a", 1));
  arbiter.withdraw("a");
  const Decision decision = arbiter.decide(at(0s));
  EXPECT_EQ(decision.behaviour, "");
  EXPECT_THAT(decision.expired, IsEmpty());
}

}  // namespace
}  // namespace kervan::behavior
