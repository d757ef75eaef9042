#include "components/exploration/frontier_choice.hpp"

#include <gtest/gtest.h>

namespace kervan::exploration {
namespace {

using namespace std::chrono_literals;
using geometry::Vector2;

const Frontier near{{2, 0}, 1.0, 2.0}, far{{9, 0}, 1.0, 9.0}, long_one{{6, 0}, 3.0, 6.0};

TEST(FrontierChoice, TakesTheNearest) {
  FrontierChoice choice({});
  EXPECT_EQ(choice.choose(Time(0s), std::vector{far, long_one, near}, {}), Choice::chosen);
  EXPECT_EQ(choice.chosen().place, near.place);
}

TEST(FrontierChoice, LengthIsWorthAWay) {
  FrontierChoice choice({.gain = 3.0});
  EXPECT_EQ(choice.choose(Time(0s), std::vector{far, long_one, near}, {}), Choice::chosen);
  EXPECT_EQ(choice.chosen().place, long_one.place) << "6 - 9 is less than 2 - 3";
}

TEST(FrontierChoice, LeavesToOthersWhatTheyChose) {
  FrontierChoice choice({});
  EXPECT_EQ(choice.choose(Time(0s), std::vector{far, near}, std::vector{Vector2(2.5, 1)}), Choice::chosen);
  EXPECT_EQ(choice.chosen().place, far.place);
  EXPECT_EQ(choice.choose(Time(0s), std::vector{near}, std::vector{Vector2(2.5, 1)}), Choice::waiting);
}

TEST(FrontierChoice, WhatFailedWaitsAndIsGivenUpTheSecondTime) {
  FrontierChoice choice({});
  choice.put_aside(Time(0s), near.place);
  EXPECT_EQ(choice.choose(Time(1s), std::vector{far, near}, {}), Choice::chosen);
  EXPECT_EQ(choice.chosen().place, far.place);
  EXPECT_EQ(choice.choose(Time(1s), std::vector{near}, {}), Choice::waiting);
  EXPECT_EQ(choice.choose(Time(31s), std::vector{near}, {}), Choice::chosen);
  choice.put_aside(Time(40s), near.place + Vector2(0.3, 0));
  EXPECT_EQ(choice.choose(Time(41s), std::vector{near}, {}), Choice::explored);
  EXPECT_EQ(choice.choose(Time(400s), std::vector{near}, {}), Choice::explored);
  EXPECT_EQ(choice.choose(Time(400s), std::vector{near, far}, {}), Choice::chosen);
}

TEST(FrontierChoice, NothingLeftIsExplored) {
  FrontierChoice choice({});
  EXPECT_EQ(choice.choose(Time(0s), {}, std::vector{Vector2(2.5, 1)}), Choice::explored);
}

}  // namespace
}  // namespace kervan::exploration
