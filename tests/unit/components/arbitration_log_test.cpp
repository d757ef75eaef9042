#include "components/observe/arbitration_log.hpp"

#include <gtest/gtest.h>

namespace kervan::observe {
namespace {

using Strings = std::vector<std::string>;

/// 10 s: follow, then front while follow waits, then nobody, then follow again.
ArbitrationLog some_log() {
  ArbitrationLog log;
  log.add(0.0, "follow", 20, {});
  log.add(1.0, "follow", 20, {});
  log.add(4.0, "front", 50, Strings{"follow"});
  log.add(6.0, "", 0, {});
  log.add(7.0, "follow", 20, {});
  log.end(10.0);
  return log;
}

TEST(ArbitrationLog, JoinsWhatGoesOn) {
  const ArbitrationLog log = some_log();
  const auto& follow = log.behaviours().at("follow");
  ASSERT_EQ(follow.in_charge.size(), 2u);
  EXPECT_EQ(follow.in_charge[0].from, 0.0);
  EXPECT_EQ(follow.in_charge[0].to, 4.0);
  EXPECT_EQ(follow.in_charge[1].from, 7.0);
  EXPECT_EQ(follow.in_charge[1].to, 10.0);
  ASSERT_EQ(follow.waiting.size(), 1u);
  EXPECT_EQ(follow.waiting[0].from, 4.0);
  EXPECT_EQ(follow.waiting[0].to, 6.0);
  EXPECT_EQ(log.behaviours().at("front").in_charge.size(), 1u);
  EXPECT_EQ(log.ranked(), (Strings{"front", "follow"})) << "highest priority first";
}

TEST(ArbitrationLog, GivesEachBehaviourAColour) {
  const ArbitrationLog log = some_log();
  EXPECT_STRNE(log.colour_of("front"), log.colour_of("follow"));
  EXPECT_STRNE(log.colour_of("front"), log.colour_of(""));
  EXPECT_STREQ(log.colour_of("unknown"), log.colour_of(""));
}

TEST(ArbitrationLog, DrawsARowForEachBehaviourWithItsShareOfTheTime) {
  const std::string svg = to_svg(some_log(), "r1 <follows>", 10.0);
  EXPECT_NE(svg.find(">r1 &lt;follows&gt;</text>"), std::string::npos);
  EXPECT_NE(svg.find(">follow</text>"), std::string::npos);
  EXPECT_NE(svg.find(">70.0 %</text>"), std::string::npos) << svg;
  EXPECT_NE(svg.find(">20.0 %</text>"), std::string::npos);
  EXPECT_EQ(svg, to_svg(some_log(), "r1 <follows>", 10.0));
}

TEST(ArbitrationLog, DrawsNothingButAxesWhenNobodyEverWantedToDrive) {
  ArbitrationLog log;
  log.add(0.0, "", 0, {});
  log.end(5.0);
  EXPECT_TRUE(log.empty());
  EXPECT_NE(to_svg(log, "r1", 5.0).find("</svg>"), std::string::npos);
}

}  // namespace
}  // namespace kervan::observe
