#include "components/control/nearest_echo.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <vector>

namespace kervan::control {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double inf = std::numeric_limits<double>::infinity();

TEST(NearestEcho, PutsTheEchoOnTheAxisOfItsTransducer) {
  const std::vector<SonarEcho> echoes{{{0.069, -0.136, -pi / 2}, 0.4}};
  const auto point = nearest_echo(echoes, 5.0);
  ASSERT_TRUE(point);
  EXPECT_NEAR(point->x(), 0.069, 1e-12);
  EXPECT_NEAR(point->y(), -0.536, 1e-12);
}

TEST(NearestEcho, MeasuresFromTheRobotsCentreAndNotFromTheTransducer) {
  const std::vector<SonarEcho> echoes{{{0.5, 0.0, 0.0}, 0.3}, {{0.0, 0.1, pi / 2}, 0.5}};
  const auto point = nearest_echo(echoes, 5.0);
  ASSERT_TRUE(point);
  EXPECT_NEAR(point->y(), 0.6, 1e-12) << "0.8 m ahead is farther than 0.6 m to the left";
}

TEST(NearestEcho, LeavesOutWhatIsNoEcho) {
  EXPECT_FALSE(nearest_echo({}, 5.0));
  const std::vector<SonarEcho> echoes{{{}, 5.01}, {{}, nan}, {{}, inf}};
  EXPECT_FALSE(nearest_echo(echoes, 5.0));
}

TEST(NearestEcho, TakesANegativeRangeAsTouching) {
  const std::vector<SonarEcho> echoes{{{0.2, 0.0, 0.0}, -0.1}};
  EXPECT_NEAR(nearest_echo(echoes, 5.0)->x(), 0.2, 1e-12);
}

}  // namespace
}  // namespace kervan::control
