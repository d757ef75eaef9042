#include "components/localization/odometry_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace kervan::localization {
namespace {

using namespace std::chrono_literals;
using geometry::Pose2;

Time at(int samples) { return Time(50ms * samples); }

TEST(OdometryFilter, SaysExactlyWhatTheWheelsSayAsLongAsNothingCorrectsIt) {
  const Pose2 start{3.0, -2.0, 0.7};
  OdometryFilter filter({}, start);
  Pose2 odom{0.5, 0.25, -0.1};
  for (int i = 0; i < 10'000; ++i) {
    ASSERT_EQ(filter.odometry(at(i), odom), OdometryResult::taken);
    odom = odom * Pose2{0.05, 0.0, 0.01};
  }
  ASSERT_EQ(filter.odometry(at(10'000), odom), OdometryResult::taken);
  EXPECT_EQ(filter.pose(), start * odom);
  EXPECT_EQ(filter.map_to_odom(), start);
}

TEST(OdometryFilter, IsAsUnsureAsScaleErrorsMakeIt) {
  OdometryFilter filter({.distance_error = 0.02, .turn_error = 0.01, .slip = 0.0}, {});
  for (int i = 0; i <= 100; ++i) filter.odometry(at(i), {0.1 * i, 0.0, 0.0});
  EXPECT_NEAR(std::sqrt(filter.covariance()(0, 0)), 0.02 * 10.0, 0.02) << "2 % of 10 m, and what fades";
  EXPECT_NEAR(std::sqrt(filter.covariance()(1, 1)), 0.0, 1e-9);
  for (int i = 1; i <= 20; ++i) filter.odometry(at(100 + i), {10.0, 0.0, 0.1 * i});
  EXPECT_NEAR(std::sqrt(filter.covariance()(2, 2)), 0.01 * 2.0, 0.002);
}

/// 10,000 robots with errors as the parameters say: their spread is the covariance.
TEST(OdometryFilter, TellsTheSpreadOfManyRobots) {
  const OdometryFilterParams params{.distance_error = 0.02, .turn_error = 0.03, .slip = 0.0};
  const auto way = [](double distance_scale, double turn_scale, auto use) {
    Pose2 pose;
    for (int i = 0; i < 200; ++i) {
      use(i, pose);
      pose = pose * Pose2{0.05 * distance_scale, 0.0, (i / 50 % 2 == 0 ? 0.03 : -0.01) * turn_scale};
    }
    use(200, pose);
    return pose;
  };
  OdometryFilter filter(params, {});
  const Pose2 believed = way(1.0, 1.0, [&](int i, const Pose2& pose) { filter.odometry(at(i), pose); });
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  Covariance spread = Covariance::Zero();
  constexpr int robots = 10'000;
  for (int i = 0; i < robots; ++i) {
    const double distance = 1.0 + params.distance_error * normal(random),
                 turn = 1.0 + params.turn_error * normal(random);
    const Pose2 pose = way(distance, turn, [](int, const Pose2&) {});
    const Eigen::Vector3d off(pose.x - believed.x, pose.y - believed.y,
                              geometry::angle_between(believed.yaw, pose.yaw));
    spread += off * off.transpose() / robots;
  }
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(std::sqrt(filter.covariance()(i, i)) / std::sqrt(spread(i, i)), 1.0, 0.05) << i;
}

TEST(OdometryFilter, LearnsTheScalesOfItsWheels) {
  OdometryFilter filter({.distance_error = 0.03, .turn_error = 0.03}, {});
  const double distance_scale = 1.02, turn_scale = 0.98;  // of the truth, seen from the wheels
  Pose2 odom, truth;
  for (int i = 0; i < 2000; ++i) {
    ASSERT_EQ(filter.odometry(at(i), odom), OdometryResult::taken);
    if (i % 10 == 0)
      filter.correct(
          {truth.x - filter.pose().x, truth.y - filter.pose().y, geometry::angle_between(filter.pose().yaw, truth.yaw)},
          Covariance(Eigen::Vector3d(1e-4, 1e-4, 1e-5).asDiagonal()));
    odom = odom * Pose2{0.05, 0.0, 0.02};
    truth = truth * Pose2{0.05 * distance_scale, 0.0, 0.02 * turn_scale};
  }
  EXPECT_NEAR(filter.distance_scale(), 0.02, 0.004);
  EXPECT_NEAR(filter.turn_scale(), -0.02, 0.002);
  EXPECT_NEAR((filter.map_to_odom() * odom).x, filter.pose().x, 0.2) << "the frames are those of the last pose";
}

TEST(OdometryFilter, MovesTowardsACorrectionByAsMuchAsItIsUnsure) {
  OdometryFilter filter({.distance_error = 0.01, .turn_error = 0.0, .slip = 0.0}, {});
  for (int i = 0; i <= 100; ++i) filter.odometry(at(i), {0.1 * i, 0.0, 0.0});
  const double before = filter.covariance()(0, 0);
  filter.correct({0.1, 0.1, 0.0}, Covariance(Eigen::Vector3d(before, 1.0, 1.0).asDiagonal()));
  EXPECT_NEAR(filter.pose().x, 10.05, 1e-6) << "equally sure: half way";
  EXPECT_NEAR(filter.pose().y, 0.0, 1e-6) << "sure that it did not move sideways";
  EXPECT_NEAR(filter.covariance()(0, 0), before / 2.0, 1e-9);
}

TEST(OdometryFilter, LeavesOutPosesThatAreNoneOrOld) {
  OdometryFilter filter({}, {});
  ASSERT_EQ(filter.odometry(at(1), {1.0, 0.0, 0.0}), OdometryResult::taken);
  EXPECT_EQ(filter.odometry(at(2), {std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}), OdometryResult::refused_pose);
  EXPECT_EQ(filter.odometry(at(2), {0.0, 0.0, std::numeric_limits<double>::infinity()}), OdometryResult::refused_pose);
  EXPECT_EQ(filter.odometry(at(1), {1.1, 0.0, 0.0}), OdometryResult::refused_stamp);
  EXPECT_EQ(filter.odometry(at(0), {1.1, 0.0, 0.0}), OdometryResult::refused_stamp);
  EXPECT_EQ(filter.pose(), (Pose2{1.0, 0.0, 0.0}));
}

TEST(OdometryFilter, StandsWhereItStoodWhenItsFrameBeginsAnew) {
  OdometryFilter filter({}, {1.0, 1.0, 0.0});
  filter.odometry(at(1), {0.0, 0.0, 0.0});
  filter.odometry(at(2), {0.5, 0.0, 0.5});
  const Pose2 stood = filter.pose();
  EXPECT_EQ(filter.odometry(at(3), {40.0, 3.0, -1.0}), OdometryResult::began_anew) << "too far for wheels";
  EXPECT_EQ(filter.pose(), stood);
  EXPECT_EQ(filter.odometry(at(-100), {0.0, 0.0, 0.0}), OdometryResult::began_anew) << "the sender was started again";
  EXPECT_EQ(filter.pose(), stood);
  EXPECT_EQ(filter.odometry(at(-99), {0.1, 0.0, 0.0}), OdometryResult::taken);
  EXPECT_NEAR(filter.pose().x, stood.x + 0.1 * std::cos(0.5), 1e-12);
  EXPECT_NEAR(filter.pose().y, stood.y + 0.1 * std::sin(0.5), 1e-12);
}

}  // namespace
}  // namespace kervan::localization
