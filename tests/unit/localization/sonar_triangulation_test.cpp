#include "components/localization/sonar_triangulation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace kervan::localization {
namespace {

using geometry::Pose2;
using geometry::Vector2;

constexpr mapping::SonarLimits limits{0.15, 5.0};
constexpr double infinity = std::numeric_limits<double>::infinity();

/// One sonar 0.2 m left of the middle that looks to the left.
const Pose2 left{0.0, 0.2, geometry::radians(90.0)};

/// What it reads before a wall along y = 1.5 + slope x, which it meets within its cone.
double to_slanted_wall(const Pose2& robot, double slope) {
  const Vector2 at = (robot * left).position(), normal = Vector2(-slope, 1.0).normalized();
  return normal.dot(Vector2(0.0, 1.5) - at);
}

TEST(SonarTriangulation, FindsWhereOnItsArcAWallAnswered) {
  SonarTriangulation triangulation({});
  const double slope = 0.15;  // 8.5 degrees
  std::vector<SonarPoint> points;
  for (int i = 0; i < 20; ++i) {
    const Pose2 robot{0.03 * i, 0.0, 0.0};
    const std::vector<SonarEcho> echoes{{left, to_slanted_wall(robot, slope)}};
    for (const SonarPoint& point : triangulation.round(robot, echoes, limits)) {
      const Vector2 at = robot * point.point;
      EXPECT_NEAR(at.y(), 1.5 + slope * at.x(), 0.01) << i;
      EXPECT_NEAR((robot * point.transducer).y(), 0.2, 1e-9) << "somewhere on its way";
      points.push_back(point);
    }
  }
  ASSERT_GT(points.size(), 5u);
  EXPECT_LT(points.back().point.x(), points.back().transducer.x() - 0.1)
      << "behind the axis, where the normal of the wall is";
}

TEST(SonarTriangulation, FindsTheSamePlaceOfAPost) {
  SonarTriangulation triangulation({});
  const Vector2 post(0.5, 1.0);
  int found = 0;
  for (int i = 0; i < 40; ++i) {
    const Pose2 robot{0.025 * i, 0.0, 0.0};
    const Vector2 way = post - (robot * left).position();
    const bool in_cone = std::abs(std::atan2(way.x(), way.y())) < geometry::radians(15.0);
    const std::vector<SonarEcho> echoes{{left, in_cone ? way.norm() : infinity}};
    for (const SonarPoint& point : triangulation.round(robot, echoes, limits)) {
      EXPECT_LT((robot * point.point - post).norm(), 0.05);
      ++found;
    }
  }
  EXPECT_GT(found, 3);
}

TEST(SonarTriangulation, SaysNothingWhileItStandsAndAfterAFewReadings) {
  SonarTriangulation triangulation({});
  const std::vector<SonarEcho> echoes{{left, 2.5}};
  for (int i = 0; i < 50; ++i) EXPECT_TRUE(triangulation.round({}, echoes, limits).empty()) << i;
}

TEST(SonarTriangulation, SaysNothingOfAWallStraightAhead) {
  SonarTriangulation triangulation({});
  const Pose2 ahead{0.2, 0.0, 0.0};
  for (int i = 0; i < 50; ++i) {
    const Pose2 robot{0.03 * i, 0.0, 0.0};
    const std::vector<SonarEcho> echoes{{ahead, 3.5 - robot.x}};
    EXPECT_TRUE(triangulation.round(robot, echoes, limits).empty())
        << "the distance shrinks by the whole way, wherever in the cone the wall answers";
  }
}

TEST(SonarTriangulation, BeginsAnewWhereTheDistanceJumps) {
  SonarTriangulation triangulation({});
  for (int i = 0; i < 12; ++i) {
    const Pose2 robot{0.03 * i, 0.0, 0.0};
    triangulation.round(robot, std::vector<SonarEcho>{{left, 1.3}}, limits);
  }
  for (int i = 12; i < 16; ++i) {
    const Pose2 robot{0.03 * i, 0.0, 0.0};
    EXPECT_TRUE(triangulation.round(robot, std::vector<SonarEcho>{{left, 0.8}}, limits).empty()) << i;
  }
}

TEST(SonarTriangulation, EndsWithAReadingThatIsNoEchoButNotWithOneThatDidNotFire) {
  for (const double range : {infinity, -1.0, 0.1, 5.0, std::numeric_limits<double>::quiet_NaN()}) {
    SonarTriangulation triangulation({});
    std::size_t points = 0;
    for (int i = 0; i < 13; ++i) {
      const Pose2 robot{0.03 * i, 0.0, 0.0};
      points = triangulation.round(robot, std::vector<SonarEcho>{{left, i == 10 ? range : 1.3}}, limits).size();
    }
    EXPECT_EQ(points, std::isnan(range) ? 1u : 0u) << range;
  }
}

}  // namespace
}  // namespace kervan::localization
