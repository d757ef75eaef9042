#include "sim/odometry.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace kervan::sim {
namespace {

using namespace std::chrono_literals;

constexpr double track = 0.4;
constexpr int runs = 1000;

/// An odometry that is told of one movement after the other.
class Reckoning {
 public:
  explicit Reckoning(const OdometryErrors& errors, std::uint64_t seed = 1, double wheel_track = track)
      : random_(seed, "r1"), odometry_({}, errors, wheel_track, random_) {}

  Reckoning& add(const Motion& motion, int steps = 1) {
    for (int i = 0; i < steps; ++i) {
      odometry_.add({motion.distance / steps, motion.turn / steps}, random_, now_);
      now_ += 10ms;
    }
    return *this;
  }
  const Pose2& pose() const { return odometry_.pose(); }
  const Odometry& odometry() const { return odometry_; }

 private:
  RandomSource random_;
  Odometry odometry_;
  Duration now_{0};
};

struct Statistics {
  double mean;
  double deviation;
};

/// Of one figure over many seeds.
Statistics over_runs(const std::function<double(std::uint64_t)>& figure) {
  double sum = 0.0, squares = 0.0;
  for (std::uint64_t seed = 0; seed < runs; ++seed) {
    const double value = figure(seed);
    sum += value;
    squares += value * value;
  }
  const double mean = sum / runs;
  return {mean, std::sqrt(squares / runs - mean * mean)};
}

/// The estimates of 1000 runs are within five of their own standard deviations of what is expected.
void expect_spread(const Statistics& found, double deviation) {
  EXPECT_NEAR(found.mean, 0.0, 5.0 * deviation / std::sqrt(1.0 * runs));
  EXPECT_NEAR(found.deviation / deviation, 1.0, 5.0 / std::sqrt(2.0 * runs));
}

TEST(Odometry, WithoutErrorItIsTheTruth) {
  const RandomSource random(1, "r1");
  Odometry odometry({1.0, 2.0, 0.5}, {}, track, random);
  Pose2 truth{1.0, 2.0, 0.5};
  for (int i = 0; i < 1000; ++i) {
    const Motion motion{0.01 * (i % 3), 0.01 * (i % 5 - 2)};
    odometry.add(motion, random, i * 10ms);
    truth = advance(truth, motion);
  }
  EXPECT_EQ(odometry.pose(), truth);
  EXPECT_EQ(odometry.measured({0.5, 0.1}), (Twist2{0.5, 0.1}));
}

TEST(Odometry, DriftStaysWithinItsBoundAndFillsIt) {
  constexpr double error = 0.03;
  double smallest = 1.0, largest = 0.0;
  const auto drift_of = [&](std::uint64_t seed) {
    Reckoning odometry({.drift = error}, seed);
    const double drift = odometry.add({10.0, 0.0}).pose().x / 10.0 - 1.0;
    EXPECT_LE(std::abs(drift), error);
    smallest = std::min(smallest, drift);
    largest = std::max(largest, drift);
    EXPECT_LE(std::abs(odometry.add({0.0, 1.0}).pose().yaw - 1.0), error);
    return drift;
  };
  expect_spread(over_runs(drift_of), error / std::sqrt(3.0));
  EXPECT_LT(smallest, -0.98 * error);
  EXPECT_GT(largest, 0.98 * error);
  expect_spread(over_runs([](std::uint64_t seed) {
                  return Reckoning({.drift = error}, seed).add({0.0, 1.0}).pose().yaw - 1.0;
                }),
                error / std::sqrt(3.0));
}

TEST(Odometry, TheErrorsOfScaleAreDrawnOncePerRun) {
  for (const OdometryErrors& errors : {OdometryErrors{.drift = 0.03}, OdometryErrors{.wheel = 0.03}}) {
    Reckoning a(errors), b(errors);
    a.add({10.0, 1.0});
    b.add({10.0, 1.0}, 100);
    EXPECT_NEAR(a.pose().x, b.pose().x, 1e-12);
    EXPECT_NEAR(a.pose().yaw, b.pose().yaw, 1e-12);
  }
}

TEST(Odometry, WheelsOfDifferentSizeBendAStraightWay) {
  // Each wheel's scale is even within ± e: their difference turns the robot by e sqrt(2 / 3) L / b.
  constexpr double error = 0.004, way = 5.0;
  const auto yaw = [](std::uint64_t seed) { return Reckoning({.wheel = error}, seed).add({way, 0.0}).pose().yaw; };
  expect_spread(over_runs(yaw), error * std::sqrt(2.0 / 3.0) * way / track);
}

TEST(Odometry, WheelsOfDifferentSizeAreInTheMeasuredSpeedToo) {
  Reckoning odometry({.wheel = 0.05});
  const Twist2 measured = odometry.odometry().measured({0.5, 0.2});
  odometry.add({0.5, 0.2});
  const Pose2 expected = advance({}, {measured.linear, measured.angular});
  EXPECT_NEAR(odometry.pose().x, expected.x, 1e-12);
  EXPECT_NEAR(odometry.pose().yaw, expected.yaw, 1e-12);
  EXPECT_NE(measured.angular, 0.2);
}

TEST(Odometry, SlipGrowsWithTheRootOfTheWayHoweverItIsCut) {
  constexpr double slip = 0.001;
  for (const double way : {2.0, 8.0})
    for (const int steps : {10, 100}) {
      const auto end = [&](std::uint64_t seed) {
        return Reckoning({.slip = slip}, seed).add({way, 0.0}, steps).pose();
      };
      const Statistics yaw = over_runs([&](std::uint64_t seed) { return end(seed).yaw; });
      expect_spread(yaw, slip * std::sqrt(2.0 * way) / track);
      const Statistics along = over_runs([&](std::uint64_t seed) { return end(seed).x - way; });
      EXPECT_NEAR(along.deviation / (slip * std::sqrt(0.5 * way)), 1.0, 5.0 / std::sqrt(2.0 * runs));
    }
}

TEST(Odometry, AWheelThatStandsDoesNotSlip) {
  Reckoning odometry({.slip = 0.1});
  odometry.add({0.0, 0.0}, 100);
  EXPECT_EQ(odometry.pose(), Pose2{});
}

TEST(Odometry, EncodersCountFullTicks) {
  Reckoning odometry({.resolution = 0.01});
  for (int i = 1; i <= 100; ++i) {
    odometry.add({0.00137, 0.0});
    const double ticks = std::floor(0.00137 * i / 0.01 + 1e-9);
    EXPECT_NEAR(odometry.pose().x, 0.01 * ticks, 1e-12) << "after step " << i;
  }
  // Never farther off than a tick of each wheel, wherever it drives.
  Reckoning coarse({.resolution = 0.01});
  double turned = 0.0;
  for (int i = 0; i < 500; ++i) {
    const Motion motion{0.003, 0.002 * (i % 7 - 2)};
    coarse.add(motion);
    turned += motion.turn;
    EXPECT_NEAR(geometry::angle_between(turned, coarse.pose().yaw), 0.0, 2 * 0.01 / track);
  }
}

TEST(Odometry, OfASynchroDriveTheEncoderMeasuresTheWayAlone) {
  const auto end = [](std::uint64_t seed) {
    return Reckoning({.wheel = 0.02, .slip = 0.003, .resolution = 0.001}, seed, 0.0)
        .add({4.0, 0.0}, 50)
        .add({0.0, 1.0});
  };
  for (std::uint64_t seed = 0; seed < 20; ++seed) EXPECT_NEAR(end(seed).pose().yaw, 1.0, 1e-12);
  const Statistics along = over_runs([](std::uint64_t seed) {
    return Reckoning({.slip = 0.003}, seed, 0.0).add({4.0, 0.0}, 50).pose().x - 4.0;
  });
  expect_spread(along, 0.003 * std::sqrt(4.0));
}

TEST(Odometry, RefusesErrorsOutOfRange) {
  for (const OdometryErrors& errors : {OdometryErrors{.drift = 1.0}, OdometryErrors{.wheel = -0.1},
                                       OdometryErrors{.slip = -1.0}, OdometryErrors{.resolution = -0.1}})
    EXPECT_THROW(Odometry({}, errors, track, RandomSource(1, "r1")), std::invalid_argument);
}

}  // namespace
}  // namespace kervan::sim
