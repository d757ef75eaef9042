// Patterns over topics and component names.
#include "deploy/composition/glob.hpp"

#include <gtest/gtest.h>

using namespace kervan::composition;

namespace {

TEST(Glob, StarStaysWithinASegment) {
  EXPECT_TRUE(matches("/r1/*", "/r1/sonar"));
  EXPECT_TRUE(matches("/*/sonar", "/r2/sonar"));
  EXPECT_TRUE(matches("/r*/cmd*", "/r1/cmd_vel"));
  EXPECT_FALSE(matches("/*", "/r1/sonar"));
  EXPECT_FALSE(matches("/r1/*", "/r1/front/sonar"));
}

TEST(Glob, TwoStarsCrossSegments) {
  EXPECT_TRUE(matches("/**", "/r1/front/sonar"));
  EXPECT_TRUE(matches("/**/sonar", "/r1/front/sonar"));
  EXPECT_FALSE(matches("/r2/**", "/r1/sonar"));
}

TEST(Glob, CoversWhatStandsBelowAMatch) {
  EXPECT_TRUE(covers("r*", "r1/control"));
  EXPECT_TRUE(covers("*", "r1/control"));
  EXPECT_TRUE(covers("r1/control", "r1/control"));
  EXPECT_FALSE(covers("control", "r1/control"));
  EXPECT_FALSE(covers("r1/control", "r1"));
}

TEST(Glob, PrefersTheMoreSpecific) {
  EXPECT_TRUE(more_specific("/r1/sonar", "/r1/son*"));
  EXPECT_TRUE(more_specific("/r1/*", "/*"));
  EXPECT_TRUE(more_specific("/r1/*", "/r1/**"));
  EXPECT_FALSE(more_specific("/r1/*", "/*/r1"));
  EXPECT_FALSE(more_specific("/*/r1", "/r1/*"));
}

}  // namespace
