#include "components/control/vfh_plus.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace kervan::control {
namespace {

using geometry::Vector2;

constexpr float inf = std::numeric_limits<float>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double degree = std::numbers::pi / 180.0;

/// What a laser with 181 beams, one a degree, sees from `robot` of discs of 5 cm radius at `posts`.
struct Laser {
  explicit Laser(std::vector<Vector2> things) : posts(std::move(things)) {}

  PlacedScan operator()(const geometry::Pose2& robot) {
    ranges.assign(181, inf);
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      const Vector2 beam = geometry::heading(robot.yaw + (static_cast<double>(i) - 90.0) * degree);
      for (const Vector2& post : posts) {
        const Vector2 way = post - robot.position();
        const double along = way.dot(beam), off2 = way.squaredNorm() - along * along;
        if (along > 0.0 && off2 < 0.05 * 0.05)
          ranges[i] = std::min(ranges[i], static_cast<float>(along - std::sqrt(0.05 * 0.05 - off2)));
      }
    }
    return {robot, {-90.0 * degree, degree, 0.05, 30.0, ranges}};
  }

  std::vector<Vector2> posts;
  std::vector<float> ranges;
};

/// Posts from `from` to `to`, 5 cm apart.
std::vector<Vector2> wall(const Vector2& from, const Vector2& to) {
  std::vector<Vector2> posts;
  const int count = static_cast<int>((to - from).norm() / 0.05);
  for (int i = 0; i <= count; ++i) posts.push_back(from + static_cast<double>(i) / count * (to - from));
  return posts;
}

std::vector<Vector2> both(std::vector<Vector2> one, const std::vector<Vector2>& other) {
  one.insert(one.end(), other.begin(), other.end());
  return one;
}

/// Steps of 0.1 s in which the robot does what it is told, until it is within `near` of the target or `steps` are over.
struct Drive {
  geometry::Pose2 robot = {};
  VfhPlus law = VfhPlus({}, {});
  double clearance = std::numeric_limits<double>::infinity();  ///< m, least from its middle to the middle of a post

  bool reaches(const Vector2& target, Laser laser, int steps = 400, double near = 0.15) {
    geometry::Twist2 twist;
    for (int i = 0; i < steps && (target - robot.position()).norm() > near; ++i) {
      twist = law.step({robot, twist}, target, laser(robot)).twist;
      robot.x += 0.1 * twist.linear * std::cos(robot.yaw);
      robot.y += 0.1 * twist.linear * std::sin(robot.yaw);
      robot.yaw = geometry::wrap_angle(robot.yaw + 0.1 * twist.angular);
      for (const Vector2& post : laser.posts) clearance = std::min(clearance, (post - robot.position()).norm());
    }
    return (target - robot.position()).norm() <= near;
  }
};

TEST(VfhPlus, IsStraightAndFastInTheOpen) {
  Laser laser({});
  const Steering steering = VfhPlus({}, {}).step({}, {9.0, 0.0}, laser({}));
  EXPECT_EQ(steering.outcome, Outcome::drives);
  EXPECT_EQ(steering.twist, (geometry::Twist2{0.6, 0.0}));
}

TEST(VfhPlus, TurnsToATargetAsideInTheOpen) {
  Laser laser({});
  VfhPlus law({}, {});
  EXPECT_NEAR(law.step({}, 9.0 * geometry::heading(0.3), laser({})).twist.angular, 0.6, 1e-9);
  EXPECT_NEAR(*law.view().direction, 0.3, 1e-12);
}

TEST(VfhPlus, EnlargesAnObstacleByTheAngleThatItsRadiusHidesAtItsDistance) {
  Laser laser({{1.05, 0.0}});  // its face at 1 m
  VfhPlus law({.half_width = 0.4, .margin = 0.1}, {});
  law.step({}, {9.0, 0.0}, laser({}));
  // gamma = asin(0.5 / 1.0) = 30 degrees = 12 sectors to either side of what the post itself covers.
  const auto nearest = [&](int sector) {
    return law.view().nearest[static_cast<std::size_t>((sector + vfh_sectors) % vfh_sectors)];
  };
  EXPECT_NEAR(nearest(0), 1.0F, 0.01F);
  EXPECT_LT(nearest(12), 1.1F);
  EXPECT_LT(nearest(-13), 1.1F);
  EXPECT_EQ(nearest(15), 3.0F) << "nothing within the look";
  EXPECT_EQ(nearest(-16), 3.0F);
}

TEST(VfhPlus, ASectorStaysWhatItWasBetweenTheTwoThresholds) {
  VfhPlus law({.block_within = 1.2, .free_beyond = 1.4}, {});
  const auto blocked_by_a_face_at = [&](double range) {
    Laser laser({{range + 0.05, 0.0}});
    law.step({}, {9.0, 0.0}, laser({}));
    return law.view().blocked[0] != 0;
  };
  EXPECT_FALSE(blocked_by_a_face_at(1.3));
  EXPECT_TRUE(blocked_by_a_face_at(1.1));
  EXPECT_TRUE(blocked_by_a_face_at(1.3));
  EXPECT_FALSE(blocked_by_a_face_at(1.5));
  EXPECT_TRUE(blocked_by_a_face_at(1.1));
  law.reset();
  EXPECT_FALSE(blocked_by_a_face_at(1.3)) << "forgotten";
}

TEST(VfhPlus, OfTwoWaysRoundItTakesTheOneThatTurnsLeastFromTheTarget) {
  Laser left_free(wall({1.0, -0.5}, {1.0, 0.2})), right_free(wall({1.0, -0.2}, {1.0, 0.5}));
  EXPECT_GT(VfhPlus({}, {}).step({}, {5.0, 0.0}, left_free({})).twist.angular, 0.0);
  EXPECT_LT(VfhPlus({}, {}).step({}, {5.0, 0.0}, right_free({})).twist.angular, 0.0);
}

TEST(VfhPlus, KeepsToTheWayItChoseBefore) {
  Laser left_free(wall({1.0, -0.5}, {1.0, 0.2})), hardly_right(wall({1.0, -0.25}, {1.0, 0.3}));
  VfhPlus law({.mu3 = 2.9}, {}), fresh({.mu3 = 2.9}, {});
  law.step({}, {5.0, 0.0}, left_free({}));
  EXPECT_GT(law.step({}, {5.0, 0.0}, hardly_right({})).twist.angular, 0.0);
  EXPECT_LT(fresh.step({}, {5.0, 0.0}, hardly_right({})).twist.angular, 0.0);
}

TEST(VfhPlus, DrivesToATargetThatLiesBeforeAWall) {
  Drive drive;
  EXPECT_TRUE(drive.reaches({2.0, 0.0}, Laser(wall({2.5, -2.0}, {2.5, 2.0}))));
}

TEST(VfhPlus, PassesADoorLittleWiderThanTheRobot) {
  Drive drive;
  EXPECT_TRUE(drive.reaches({4.0, 0.3}, Laser(both(wall({2.0, -3.0}, {2.0, -0.5}), wall({2.0, 0.5}, {2.0, 3.0})))));
  EXPECT_GT(drive.clearance, 0.2525 + 0.05) << "half a width and a post";
}

TEST(VfhPlus, DrivesRoundWhatStandsInItsWay) {
  Drive drive;
  EXPECT_TRUE(drive.reaches({5.0, 0.0}, Laser(wall({2.5, -0.4}, {2.5, 0.3}))));
  EXPECT_GT(drive.clearance, 0.2525 + 0.05);
}

TEST(VfhPlus, StandsBeforeWhatBlocksItsWay) {
  // Straight ahead a wall, so near that the robot could not stop from full speed.
  Laser laser(wall({0.75, -0.3}, {0.75, 0.3}));
  VfhPlus law({}, {});
  const double room = 0.70 - 0.313 - 0.08;
  const Steering steering = law.step({}, {9.0, 0.0}, laser({}));
  EXPECT_LE(steering.twist.linear, stopping_speed(room, 0.5, 0.2) + 1e-6);
  Laser nearer(wall({0.40, -0.3}, {0.40, 0.3}));
  EXPECT_EQ(law.step({}, {9.0, 0.0}, nearer({})).twist.linear, 0.0);
}

TEST(VfhPlus, IsSlowerBesideSomething) {
  Laser laser(wall({0.0, 0.42}, {3.0, 0.42}));  // 0.1175 m from its side
  const Steering steering = VfhPlus({}, {}).step({}, {2.0, 0.0}, laser({}));
  EXPECT_NEAR(steering.twist.angular, 0.0, 0.3);
  EXPECT_LT(steering.twist.linear, 0.55);
  EXPECT_GT(steering.twist.linear, 0.4 * 0.6);
}

TEST(VfhPlus, RemembersWhatWentOutOfSight) {
  Laser laser({{0.4, 0.4}});
  VfhPlus law({}, {}), forgetful({.remember = 0.0}, {});
  const auto sees_it = [&](VfhPlus& by, double yaw) {
    const geometry::Pose2 robot{0.0, 0.0, yaw};
    by.step({robot}, {9.0, 0.0}, laser(robot));
    return std::count(by.view().blocked.begin(), by.view().blocked.end(), 1) > 0;
  };
  EXPECT_TRUE(sees_it(law, 0.0));
  EXPECT_TRUE(sees_it(law, -2.0)) << "behind it now";
  EXPECT_TRUE(sees_it(forgetful, 0.0));
  EXPECT_FALSE(sees_it(forgetful, -2.0));
  laser.posts.clear();
  EXPECT_FALSE(sees_it(law, 0.0)) << "seen again, it is gone";
}

TEST(VfhPlus, TurnsOnTheSpotToOneSideWhenAllIsBlocked) {
  std::vector<Vector2> ring;
  for (int i = 0; i < 72; ++i) ring.push_back(0.6 * geometry::heading(5.0 * degree * i));
  Laser laser(ring), open({});
  VfhPlus law({}, {});
  law.step({{0.0, 0.0, std::numbers::pi}}, {9.0, 0.0}, laser({0.0, 0.0, std::numbers::pi}));  // and remembers it
  const Steering left = law.step({}, {2.0, 2.0}, laser({}));
  EXPECT_EQ(left.outcome, Outcome::hindered);
  EXPECT_EQ(left.why, "all directions are blocked: it turns to find a free one");
  EXPECT_EQ(left.twist, (geometry::Twist2{0.0, 0.75}));
  EXPECT_EQ(law.view().direction, std::nullopt);
  EXPECT_EQ(law.step({}, {2.0, -2.0}, laser({})).twist.angular, 0.75) << "it does not waver";
  EXPECT_EQ(law.step({}, {2.0, -2.0}, open({})).outcome, Outcome::drives);
}

TEST(VfhPlus, RangesThatAreNoDistanceSayNothingAndAreCounted) {
  Laser laser({});
  VfhPlus law({}, {});
  const PlacedScan seen = laser({});
  laser.ranges[90] = static_cast<float>(nan);
  laser.ranges[91] = -0.5F;
  laser.ranges[92] = 0.01F;  // below range_min
  EXPECT_EQ(law.step({}, {9.0, 0.0}, seen).twist.linear, 0.6);
  EXPECT_EQ(law.refused_ranges(), 2u);
  laser.ranges[90] = -inf;  // something, too near to measure
  EXPECT_EQ(law.step({}, {9.0, 0.0}, seen).twist.linear, 0.0);
  EXPECT_EQ(law.refused_ranges(), 3u);
}

TEST(VfhPlus, RefusesWhatIsNotFiniteInASentence) {
  Laser laser({});
  const auto why = [](const RobotState& robot, const Vector2& target, const PlacedScan& seen) {
    const Steering steering = VfhPlus({}, {}).step(robot, target, seen);
    EXPECT_EQ(steering.outcome, Outcome::fault);
    EXPECT_EQ(steering.twist, geometry::Twist2{});
    return steering.why;
  };
  const PlacedScan seen = laser({});
  EXPECT_EQ(why({{nan, 0.0, 0.0}}, {9.0, 0.0}, seen), "the pose is not finite");
  EXPECT_EQ(why({{}, {nan, 0.0}}, {9.0, 0.0}, seen), "the speed is not finite");
  EXPECT_EQ(why({}, {9.0, nan}, seen), "the target is not finite");
  EXPECT_EQ(why({}, {9.0, 0.0}, {{nan, 0.0, 0.0}, seen.scan}), "it is not known where it was taken");
  PlacedScan without_angles = seen;
  without_angles.scan.angle_increment = nan;
  EXPECT_EQ(why({}, {9.0, 0.0}, without_angles), "its angles or limits are none");
}

TEST(VfhPlus, ATargetMayJump) {
  Laser laser(wall({1.0, -0.3}, {1.0, 0.3}));
  VfhPlus law({}, {});
  law.step({}, {5.0, 0.0}, laser({}));
  const Steering steering = law.step({}, {-5.0, -5.0}, laser({}));
  EXPECT_EQ(steering.twist, (geometry::Twist2{0.0, -0.75})) << "turns to where it is now, on the spot";
  EXPECT_EQ(law.step({}, {0.0, 0.0}, laser({})).twist, geometry::Twist2{}) << "right here";
}

}  // namespace
}  // namespace kervan::control
