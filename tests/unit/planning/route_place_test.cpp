#include "components/planning/route_place.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace kervan::planning {
namespace {

using geometry::Vector2;

TEST(RoutePlace, SaysHowFarTheRobotIsAlongItsRouteAndOffIt) {
  RoutePlace place;
  EXPECT_TRUE(place.empty());
  place.start({{0, 0}, {4, 0}, {4, 3}});
  EXPECT_EQ(place.remaining(), 7.0);
  place.move({1.0, 0.25});
  EXPECT_DOUBLE_EQ(place.along(), 1.0);
  EXPECT_DOUBLE_EQ(place.off(), 0.25);
  place.move({4.5, 1.0});
  EXPECT_DOUBLE_EQ(place.along(), 5.0);
  EXPECT_DOUBLE_EQ(place.remaining(), 2.0);
  EXPECT_DOUBLE_EQ(place.off(), 0.5);
  place.move({4.0, 9.0});
  EXPECT_DOUBLE_EQ(place.remaining(), 0.0);
  EXPECT_DOUBLE_EQ(place.off(), 6.0);
}

TEST(RoutePlace, DoesNotJumpToWhereTheRouteComesBy) {
  // Along a wall, round its end and back on its other side, 0.4 m away.
  RoutePlace place;
  place.start({{0, 0}, {10, 0}, {10, 0.4}, {0, 0.4}});
  for (double x = 0.0; x <= 5.0; x += 0.05) place.move({x, 0.25});
  EXPECT_NEAR(place.along(), 5.0, 0.06);
  EXPECT_NEAR(place.off(), 0.25, 1e-9);
}

TEST(RoutePlace, CannotBePushedBackBeyondItsPresentLeg) {
  RoutePlace place;
  place.start({{0, 0}, {4, 0}, {4, 3}});
  place.move({4.0, 1.0});
  place.move({2.0, 0.0});
  EXPECT_DOUBLE_EQ(place.along(), 4.0);
  EXPECT_DOUBLE_EQ(place.off(), 2.0);
}

TEST(RoutePlace, TakesNoNoticeOfWhatIsNoPosition) {
  RoutePlace place;
  place.move({1.0, 1.0});
  EXPECT_EQ(place.remaining(), 0.0);
  place.start({{0, 0}, {0, 0}, {4, 0}});
  place.move({1.0, 0.0});
  place.move({std::numeric_limits<double>::quiet_NaN(), 0.0});
  EXPECT_DOUBLE_EQ(place.along(), 1.0);
}

}  // namespace
}  // namespace kervan::planning
