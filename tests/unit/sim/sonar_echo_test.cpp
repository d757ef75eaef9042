// What a sonar's cone makes of walls, corners and gaps, beside what geometry says.
#include <gtest/gtest.h>

#include <array>

#include "sim/simulation.hpp"
#include "sim/sonar.hpp"
#include "tests/unit/sim/p3dx.hpp"

namespace kervan::sim {
namespace {

constexpr double degree = pi / 180.0;
constexpr double lobe = 15.0 * degree;
constexpr double tolerance = 0.005;  // share of the distance
const RandomSource source(1, "r1");

/// One sonar at the origin that looks along x.
SonarRing single() { return {.min_range = 0.15, .max_range = 5.0, .field_of_view = 2.0 * lobe, .poses = {Pose2{}}}; }

double read(const World& world, double yaw, const SonarSettings& settings, std::uint64_t round = 0) {
  double range = 0.0;
  Sonars(single(), settings).measure(world, {0.0, 0.0, yaw}, source, round, {&range, 1});
  return range;
}

World wall_at(double x) { return World({.segments = {{{x, -50.0}, {x, 50.0}}}}); }

/// A flat wall at the distance d that is met at the incidence a.
double answer(double d, double a) { return d / std::cos(std::max(0.0, std::abs(a) - lobe)); }

TEST(SonarEcho, AWallAnswersWithinHalfAPercentAtEveryIncidenceThatTheLimitAllows) {
  const SonarSettings specular{.noise = 0.0, .incidence_limit = 25.0 * degree};
  const World world = wall_at(2.0);
  for (double incidence = -39.5; incidence <= 39.5; incidence += 0.5) {
    const double expected = answer(2.0, incidence * degree);
    EXPECT_NEAR(read(world, incidence * degree, specular), expected, tolerance * expected) << incidence << " degrees";
  }
}

TEST(SonarEcho, BeyondTheLimitAndTheLobeNoEchoComesBack) {
  const World world = wall_at(2.0);
  for (const double limit : {10.0, 25.0, 40.0})
    for (double incidence = limit + 15.01; incidence < 90.0; incidence += 0.5)
      for (const double side : {-1.0, 1.0})
        EXPECT_EQ(read(world, side * incidence * degree, {.noise = 0.0, .incidence_limit = limit * degree}), infinity)
            << incidence << " degrees, limit " << limit;
}

TEST(SonarEcho, WithoutALimitMoreRaysKeepTheHalfPercent) {
  const SonarSettings fine{.rays = 128, .noise = 0.0};
  const World world = wall_at(1.0);
  for (double incidence = -75.0; incidence <= 75.0; incidence += 0.5) {
    const double expected = answer(1.0, incidence * degree);
    EXPECT_NEAR(read(world, incidence * degree, fine), expected, tolerance * expected) << incidence << " degrees";
  }
}

TEST(SonarEcho, TheErrorOfTheOutermostRayIsThatOfTheHeader) {
  const World world = wall_at(1.0);
  for (const double incidence : {20.0, 30.0, 40.0, 50.0, 60.0}) {
    const double beyond = incidence * degree - lobe, half_a_share = lobe / 32;
    const double range = read(world, incidence * degree, {.noise = 0.0});
    EXPECT_NEAR(range, 1.0 / std::cos(beyond + half_a_share), 1e-9) << incidence << " degrees";
    EXPECT_NEAR(range * std::cos(beyond) - 1.0, 0.0082 * std::tan(beyond), 2e-4) << incidence << " degrees";
  }
}

TEST(SonarEcho, IntoACornerTheNearerWallAnswers) {
  const World corner({.segments = {{{2.0, -9.0}, {2.0, 2.0}}, {{2.0, 2.0}, {-9.0, 2.0}}}});
  for (const double yaw : {0.0, 10.0, 30.0, 45.0, 60.0, 90.0}) {
    const double expected = std::min(answer(2.0, yaw * degree), answer(2.0, (90.0 - yaw) * degree));
    EXPECT_NEAR(read(corner, yaw * degree, {.noise = 0.0}), expected, tolerance * expected) << yaw << " degrees";
  }
  EXPECT_EQ(read(corner, 45.0 * degree, {.noise = 0.0, .incidence_limit = 25.0 * degree}), infinity)
      << "both walls throw the pulse away";
}

TEST(SonarEcho, OfACornerThatStandsOutTheEdgeAnswers) {
  // A box on its corner, which points at the sonar.
  const double side = 1.0;
  const World box({.boxes = {{{2.0 + side / std::sqrt(2.0), 0.0, 0.25 * pi}, {side, side}}}});
  for (const double yaw : {-14.0, -5.0, 0.0, 7.0, 14.0}) {
    const double range = read(box, yaw * degree, {.rays = 128, .noise = 0.0});
    EXPECT_GE(range, 2.0 - 1e-9);
    EXPECT_NEAR(range, 2.0, tolerance * 2.0) << yaw << " degrees";
  }
}

TEST(SonarEcho, AGapNarrowerThanTheConeIsNotSeen) {
  const auto through = [](double width) {
    const World world(
        {.segments = {
             {{2.0, 0.5 * width}, {2.0, 9.0}}, {{2.0, -9.0}, {2.0, -0.5 * width}}, {{4.0, -9.0}, {4.0, 9.0}}}});
    return read(world, 0.0, {.noise = 0.0});
  };
  const double cone = 2.0 * 2.0 * std::tan(lobe);  // its width at the wall
  for (const double width : {0.2 * cone, 0.5 * cone, 0.9 * cone}) {
    const double jamb = std::hypot(2.0, 0.5 * width);
    EXPECT_NEAR(through(width), jamb, tolerance * jamb) << width << " m";
  }
  for (const double width : {1.02 * cone, 1.5 * cone}) EXPECT_NEAR(through(width), 4.0, tolerance * 4.0) << width;
}

TEST(SonarEcho, NearTheLimitEchoesBecomeRare) {
  // 10 degrees below the limit of 25 all come back, half way 50 %, at the limit none.
  const World world = wall_at(2.0);
  constexpr int count = 4000;
  for (const auto& [incidence, probability] : {std::pair{14.9, 1.0}, {17.5, 0.75}, {20.0, 0.5}, {25.1, 0.0}}) {
    const SonarSettings settings{
        .rays = 1, .noise = 0.0, .incidence_limit = 25.0 * degree, .incidence_drop_off = 10.0 * degree};
    int heard = 0;
    for (std::uint64_t round = 0; round < count; ++round)
      heard += std::isfinite(read(world, incidence * degree, settings, round)) ? 1 : 0;
    EXPECT_NEAR(heard, probability * count, 5.0 * std::sqrt(probability * (1.0 - probability) * count))
        << incidence << " degrees";
  }
}

TEST(SonarEcho, TheDropOffChangesNothingOfTheEchoesThatComeBack) {
  const World world = wall_at(2.0);
  SonarSettings hard{.rays = 1, .noise = 0.01, .drop_out = 0.1, .incidence_limit = 25.0 * degree}, soft = hard;
  soft.incidence_drop_off = 10.0 * degree;
  for (std::uint64_t round = 0; round < 500; ++round) {
    const double range = read(world, 20.0 * degree, soft, round);
    if (range != infinity) {
      EXPECT_EQ(range, read(world, 20.0 * degree, hard, round));
    }
  }
}

/// Two sonars that look along x, the second half a metre to the left of the first, and a third that looks back.
SonarRing three() {
  return {.min_range = 0.15,
          .max_range = 5.0,
          .field_of_view = 2.0 * lobe,
          .poses = {{0.0, 0.0, 0.0}, {0.0, 0.5, 0.0}, {0.0, 0.0, pi}}};
}
/// A wall 3 m before the first, a post 1 m before the second and a wall 0.5 m behind the third.
const Obstacles yard{.segments = {{{3.0, -9.0}, {3.0, 0.3}}, {{1.0, 0.45}, {1.0, 0.55}}, {{-0.5, -9.0}, {-0.5, 9.0}}}};

std::array<double, 3> crossed(double probability, std::uint64_t round, SonarFiring firing = SonarFiring::all) {
  static const World world(yard);
  std::array<double, 3> ranges{};
  Sonars(three(), {.rays = 1, .noise = 0.0, .crosstalk = probability, .firing = firing})
      .measure(world, Pose2{}, source, round, ranges);
  return ranges;
}

TEST(SonarCrosstalk, AnothersPulseIsReadAsHalfOfItsWay) {
  const double way = 0.5 * (1.0 + std::hypot(1.0, 0.5));  // from the second to the post and on to the first
  int disturbed = 0;
  for (std::uint64_t round = 0; round < 100; ++round) {
    const auto ranges = crossed(1.0, round);
    // The first hears the second, or the third, whose echo lies behind it.
    EXPECT_TRUE(std::abs(ranges[0] - way) < 1e-12 || ranges[0] == 3.0) << ranges[0];
    disturbed += ranges[0] == 3.0 ? 0 : 1;
    EXPECT_EQ(ranges[1], 1.0) << "nobody's way is shorter";
    EXPECT_EQ(ranges[2], 0.5);
  }
  EXPECT_NEAR(disturbed, 50, 5 * 5) << "each of the others as likely";
}

TEST(SonarCrosstalk, ComesAsOftenAsAskedAndNotAtAllByDefault) {
  constexpr int count = 4000;
  int disturbed = 0;
  for (std::uint64_t round = 0; round < count; ++round) {
    disturbed += crossed(0.3, round)[0] < 3.0 ? 1 : 0;
    EXPECT_EQ(crossed(0.0, round)[0], 3.0);
  }
  EXPECT_NEAR(disturbed, 0.15 * count, 5.0 * std::sqrt(0.15 * 0.85 * count)) << "of two others, one is heard";
}

TEST(SonarCrosstalk, SonarsThatFireOneAfterTheOtherDoNotHearEachOther) {
  for (std::uint64_t round = 0; round < 300; round += 3)
    EXPECT_EQ(crossed(1.0, round, SonarFiring::sequential)[0], 3.0);
}

TEST(SonarFiring, InTurnOneOfEachArrayFires) {
  const SonarRing& ring = p3dx().sonars;
  const World world = wall_at(1.0);
  std::array<double, 16> ranges{};
  Sonars sonars(ring, {.firing = SonarFiring::sequential});
  for (std::uint64_t slot = 0; slot < 20; ++slot) {
    sonars.measure(world, Pose2{}, source, slot, ranges);
    for (std::size_t i = 0; i < 16; ++i)
      EXPECT_EQ(std::isnan(ranges[i]), i % 8 != slot % 8) << "sonar " << i << " in slot " << slot;
  }
}

TEST(SonarFiring, WithoutArraysOneFiresAfterTheOther) {
  SonarRing ring = p3dx().sonars;
  ring.arrays.clear();
  std::array<double, 16> ranges{};
  Sonars sonars(ring, {.firing = SonarFiring::sequential});
  for (std::uint64_t slot = 0; slot < 32; ++slot) {
    sonars.measure(wall_at(1.0), Pose2{}, source, slot, ranges);
    for (std::size_t i = 0; i < 16; ++i) EXPECT_EQ(std::isnan(ranges[i]), i != slot % 16);
  }
}

TEST(SonarFiring, WhoFiresHearsWhatItHearsWhenAllFire) {
  const World world = wall_at(1.0);
  std::array<double, 16> together{}, in_turn{};
  const SonarSettings settings{.noise = 0.01, .drop_out = 0.1};
  SonarSettings sequential = settings;
  sequential.firing = SonarFiring::sequential;
  for (std::uint64_t round = 0; round < 8; ++round) {
    Sonars(p3dx().sonars, settings).measure(world, Pose2{}, source, round, together);
    Sonars(p3dx().sonars, sequential).measure(world, Pose2{}, source, round, in_turn);
    EXPECT_EQ(in_turn[round], together[round]);
    EXPECT_EQ(in_turn[8 + round], together[8 + round]);
  }
}

TEST(SonarFiring, OfARobotInItsOwnSlots) {
  using namespace std::chrono_literals;
  RobotSetup setup = perfect("r1", {});
  setup.sonar.firing = SonarFiring::sequential;
  setup.sonar_period = 40ms;
  Simulation simulation(std::make_shared<const World>(wall_at(1.0)), {setup}, 1);
  std::vector<Duration> stamps{simulation.robots()[0].sonar().stamp};
  for (int i = 0; i < 32; ++i) {
    simulation.step(tick);
    const SonarScan& scan = simulation.robots()[0].sonar();
    if (scan.stamp != simulation.now()) continue;
    stamps.push_back(scan.stamp);
    EXPECT_FALSE(std::isnan(scan.ranges[static_cast<std::size_t>(scan.stamp / 40ms) % 8]));
  }
  ASSERT_EQ(stamps.size(), 9u) << "a sweep of eight takes 320 ms";
  for (int i = 0; i < 9; ++i) EXPECT_EQ(stamps[static_cast<std::size_t>(i)], i * 40ms);
}

}  // namespace
}  // namespace kervan::sim
