#include "sim/odometry.hpp"

#include <gtest/gtest.h>

namespace kervan::sim {
namespace {

TEST(Odometry, WithoutErrorItIsTheTruth) {
  Odometry odometry({1.0, 2.0, 0.5}, 0.0, RandomSource(1, "r1"));
  Pose2 truth{1.0, 2.0, 0.5};
  for (int i = 0; i < 1000; ++i) {
    const Motion motion{0.01 * (i % 3), 0.01 * (i % 5 - 2)};
    odometry.add(motion);
    truth = advance(truth, motion);
  }
  EXPECT_EQ(odometry.pose(), truth);
  EXPECT_EQ(odometry.measured({0.5, 0.1}), (Twist2{0.5, 0.1}));
}

TEST(Odometry, DriftStaysWithinItsBoundAndFillsIt) {
  constexpr double error = 0.03;
  double smallest = 1.0, largest = 0.0, sum = 0.0;
  constexpr int runs = 1000;
  for (std::uint64_t seed = 0; seed < runs; ++seed) {
    Odometry odometry({}, error, RandomSource(seed, "r1"));
    odometry.add({10.0, 0.0});
    const double drift = odometry.pose().x / 10.0 - 1.0;
    EXPECT_LE(std::abs(drift), error);
    smallest = std::min(smallest, drift);
    largest = std::max(largest, drift);
    sum += drift;
    odometry.add({0.0, 1.0});
    EXPECT_LE(std::abs(odometry.pose().yaw - 1.0), error);
  }
  EXPECT_LT(smallest, -0.98 * error);
  EXPECT_GT(largest, 0.98 * error);
  EXPECT_NEAR(sum / runs, 0.0, 5 * error / std::sqrt(3.0 * runs));
}

TEST(Odometry, TheErrorIsDrawnOncePerRun) {
  Odometry a({}, 0.03, RandomSource(4, "r1")), b({}, 0.03, RandomSource(4, "r1"));
  a.add({10.0, 0.0});
  for (int i = 0; i < 10; ++i) b.add({1.0, 0.0});
  EXPECT_NEAR(a.pose().x, b.pose().x, 1e-12);
}

}  // namespace
}  // namespace kervan::sim
