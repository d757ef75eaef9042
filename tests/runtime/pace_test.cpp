#include "framework/runtime/pace.hpp"

#include <gtest/gtest.h>

namespace kervan::runtime {
namespace {

using namespace std::chrono_literals;

Time at(Duration since_start) { return Time(since_start); }

class PaceTest : public testing::Test {
 protected:
  Pace::Steady::time_point start_{5h};
};

TEST_F(PaceTest, AtFourTimesRealTimeFourSecondsTakeOne) {
  Pace pace(4.0, at(1s), start_);
  EXPECT_EQ(pace.due(at(5s), start_), start_ + 1s);
}

TEST_F(PaceTest, WithoutAFactorEverythingIsDueAtOnce) {
  Pace pace(0.0, at(0s), start_);
  EXPECT_EQ(pace.due(at(1h), start_ + 3s), start_ + 3s);
}

TEST_F(PaceTest, AShortDelayIsMadeUp) {
  Pace pace(1.0, at(0s), start_);
  EXPECT_EQ(pace.due(at(100ms), start_ + 115ms), start_ + 100ms);
  EXPECT_EQ(pace.due(at(200ms), start_ + 115ms), start_ + 200ms);
}

TEST_F(PaceTest, ALongDelayIsLost) {
  Pace pace(1.0, at(0s), start_);
  EXPECT_EQ(pace.due(at(100ms), start_ + 10s), start_ + 10s);
  EXPECT_EQ(pace.due(at(200ms), start_ + 10s), start_ + 10s + 100ms) << "and nothing of it is made up later";
}

TEST_F(PaceTest, WhatCountsAsLongIsSimulatedTime) {
  Pace pace(4.0, at(0s), start_);
  EXPECT_EQ(pace.due(at(0s), start_ + Pace::most_made_up / 4), start_);
  EXPECT_EQ(pace.due(at(0s), start_ + 6ms), start_ + 6ms);
}

}  // namespace
}  // namespace kervan::runtime
