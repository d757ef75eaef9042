#include "components/control/vfh_openings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

namespace kervan::control {
namespace {

constexpr float inf = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr double degree = std::numbers::pi / 180.0;

/// All beams meet something at 1 m, but those from `first` to `last` of each pair, which see 5 m.
OpeningBeams beams_with(std::initializer_list<std::pair<int, int>> openings) {
  OpeningBeams beams;
  beams.fill(1.0F);
  for (const auto& [first, last] : openings) std::fill(beams.begin() + first, beams.begin() + last + 1, 5.0F);
  return beams;
}

geometry::Scan scan_of(std::span<const float> beams) { return {-90.0 * degree, degree, 0.05, 32.0, beams}; }

TEST(VfhOpenings, ItsCandidatesAreTheMiddlesOfTheOpenings) {
  EXPECT_EQ(best_opening({}, beams_with({{30, 60}}), {}), 45.0);
  EXPECT_EQ(best_opening({}, beams_with({{0, 180}}), {.target = 20.0}), 90.0) << "in the open it never turns";
  EXPECT_EQ(best_opening({}, beams_with({{30, 61}}), {}), 45.5);
}

TEST(VfhOpenings, AnOpeningSpansTwentyDegrees) {
  EXPECT_EQ(best_opening({}, beams_with({{30, 50}}), {}), 40.0);
  EXPECT_EQ(best_opening({}, beams_with({{30, 49}}), {}), std::nullopt);
  EXPECT_EQ(best_opening({}, beams_with({{160, 180}}), {}), 170.0) << "up to the last beam";
}

TEST(VfhOpenings, ABeamIsFreeBeyondTwoMetres) {
  OpeningBeams beams = beams_with({});
  beams.fill(2.0F);
  EXPECT_EQ(best_opening({}, beams, {}), std::nullopt);
  beams.fill(2.01F);
  EXPECT_EQ(best_opening({}, beams, {}), 90.0);
  beams.fill(inf);
  EXPECT_EQ(best_opening({}, beams, {}), 90.0);
  beams.fill(nan);
  EXPECT_EQ(best_opening({}, beams, {}), std::nullopt);
}

TEST(VfhOpenings, TheCostIsAsPrinted) {
  const OpeningBeams beams = beams_with({{20, 40}, {120, 160}});  // 30 and 140
  const auto best = [&](double a, double b, double c) {
    return best_opening({.a = a, .b = b, .c = c}, beams, {.target = 30.0, .heading = 90.0, .before = 140.0});
  };
  EXPECT_EQ(best(1.0, 0.0, 0.0), 30.0) << "the target's";
  EXPECT_EQ(best(0.0, 1.0, 0.0), 140.0) << "50 degrees from the heading, not 60";
  EXPECT_EQ(best(0.0, 0.0, 1.0), 140.0) << "the one before";
  // G(30) = 60 b + 110 c, G(140) = 110 a + 50 b.
  EXPECT_EQ(best(2.0, 1.0, 1.9), 30.0);    // 269 and 270
  EXPECT_EQ(best(2.0, 1.0, 1.95), 140.0);  // 274.5 and 270
}

TEST(VfhOpenings, WithoutAPreviousChoiceTheOthersDecide) {
  const OpeningBeams beams = beams_with({{20, 40}, {120, 160}});
  EXPECT_EQ(best_opening({.a = 1.0, .b = 0.0, .c = 100.0}, beams, {.target = 30.0}), 30.0);
}

TEST(VfhOpenings, OfEqualOnesTheLowerIsChosen) {
  EXPECT_EQ(best_opening({}, beams_with({{20, 60}, {120, 160}}), {}), 40.0);
  // Both cost (7 + 77 + 147) / 3, which in doubles is less by a bit for the upper one.
  EXPECT_EQ(best_opening({.a = 1.0, .b = 1.0, .c = 1.0}, beams_with({{3, 23}, {157, 177}}),
                         {.target = 20.0, .heading = 90.0, .before = 160.0}),
            13.0);
}

TEST(VfhOpenings, AnglesAreTakenTheShortWay) {
  EXPECT_EQ(best_opening({.a = 1.0, .b = 0.0, .c = 0.0}, beams_with({{0, 40}, {140, 180}}), {.target = -100.0}), 160.0)
      << "100 degrees from 160, 120 from 20";
}

TEST(VfhOpenings, OnlyTheRatiosOfTheWeightsMatter) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> range(0.5F, 3.5F);
  for (int round = 0; round < 200; ++round) {
    std::vector<VfhOpenings> laws;
    for (const double weight : {1.0, 2.0, 3.0})
      laws.emplace_back(OpeningParams{.least_width = 3.0, .a = weight, .b = weight, .c = weight}, HeadingDriveParams{});
    OpeningBeams beams;
    for (int step = 0; step < 20; ++step) {
      std::generate(beams.begin(), beams.end(), [&] { return range(random); });
      const PlacedScan seen{{}, scan_of(beams)};
      const geometry::Vector2 target(static_cast<double>(range(random)), static_cast<double>(range(random)) - 2.0);
      const Steering first = laws[0].step({}, target, seen);
      for (std::size_t i : {1u, 2u}) EXPECT_EQ(laws[i].step({}, target, seen).twist, first.twist);
    }
  }
}

TEST(VfhOpenings, ClippedItDrivesThroughAWideOpeningWhereTheTargetIs) {
  const OpeningParams clip{.clip = true};
  const OpeningBeams beams = beams_with({{30, 100}});
  EXPECT_EQ(best_opening(clip, beams, {.target = 60.0}), 60.0);
  EXPECT_EQ(best_opening(clip, beams, {.target = 20.0}), 40.0) << "ten degrees from the edge";
  EXPECT_EQ(best_opening(clip, beams, {.target = 170.0}), 90.0);
  EXPECT_EQ(best_opening(clip, beams_with({{30, 50}}), {.target = 20.0}), 40.0) << "a narrow one has but its middle";
}

TEST(VfhOpenings, DrivesTowardsWhatItChose) {
  const OpeningBeams beams = beams_with({{90, 120}});
  VfhOpenings law({}, {});
  const Steering steering = law.step({{1.0, 1.0, 0.5}}, {9.0, 1.0}, {{1.2, 1.1, 0.5}, scan_of(beams)});
  EXPECT_EQ(steering.outcome, Outcome::drives);
  EXPECT_NEAR(steering.twist.angular, 2.0 * 15.0 * degree, 1e-9);
  EXPECT_NEAR(steering.twist.linear, 0.6 * std::cos(15.0 * degree), 1e-9);
}

TEST(VfhOpenings, TheDirectionBeforeIsOneOfTheWorld) {
  const OpeningBeams left = beams_with({{110, 130}}), both = beams_with({{80, 100}, {110, 130}});
  OpeningParams params{.a = 0.0, .b = 0.0, .c = 1.0};
  VfhOpenings law(params, {});
  law.step({}, {9.0, 0.0}, {{}, scan_of(left)});  // 30 degrees to the left
  const double turned = 30.0 * degree;            // the robot has turned there, so that it is straight ahead now
  EXPECT_NEAR(law.step({{0.0, 0.0, turned}}, {9.0, 0.0}, {{0.0, 0.0, turned}, scan_of(both)}).twist.angular, 0.0, 1e-9);
  law.reset();
  EXPECT_NEAR(law.step({}, {9.0, 0.0}, {{}, scan_of(both)}).twist.angular, 0.0, 1e-9) << "forgotten: the lower";
}

TEST(VfhOpenings, WithoutAnOpeningItTurnsOnTheSpotToOneSideUntilThereIsOne) {
  const OpeningBeams none = beams_with({}), some = beams_with({{60, 120}});
  VfhOpenings law({}, {});
  const Steering left = law.step({}, {1.0, 1.0}, {{}, scan_of(none)});
  EXPECT_EQ(left.outcome, Outcome::hindered);
  EXPECT_EQ(left.why, "no opening is wide enough: it turns to find one");
  EXPECT_EQ(left.twist, (geometry::Twist2{0.0, 0.75}));
  EXPECT_EQ(law.step({}, {1.0, -1.0}, {{}, scan_of(none)}).twist.angular, 0.75) << "it does not waver";
  EXPECT_EQ(law.step({}, {1.0, -1.0}, {{}, scan_of(some)}).outcome, Outcome::drives);
  EXPECT_EQ(law.step({}, {1.0, -1.0}, {{}, scan_of(none)}).twist.angular, -0.75);
}

TEST(VfhOpenings, AFinerOrWiderScanIsResampledToTheNearestThatEachDegreeSees) {
  std::vector<float> ranges(2 * 270 + 1, 5.0F);  // half a degree apart, from -135 degrees
  const auto beam_at = [&](double angle) -> float& { return ranges[static_cast<std::size_t>(2.0 * (angle + 135.0))]; };
  beam_at(10.5) = 1.5F;
  beam_at(-20.0) = nan;
  beam_at(-30.5) = beam_at(-30.0) = beam_at(-29.5) = nan;
  OpeningBeams beams;
  EXPECT_EQ(resample({-135.0 * degree, 0.5 * degree, 0.05, 32.0, ranges}, beams), "");
  EXPECT_EQ(std::min(beams[100], beams[101]), 1.5F);
  EXPECT_EQ(beams[70], 5.0F) << "its neighbours know";
  EXPECT_TRUE(std::isnan(beams[60]));
  EXPECT_EQ(beams[0], 5.0F);
  EXPECT_EQ(beams[180], 5.0F);

  std::reverse(ranges.begin(), ranges.end());  // the same, measured from left to right
  OpeningBeams reversed;
  EXPECT_EQ(resample({135.0 * degree, -0.5 * degree, 0.05, 32.0, ranges}, reversed), "");
  EXPECT_EQ(std::min(reversed[100], reversed[101]), 1.5F);
}

TEST(VfhOpenings, TakesTheScanOfSinglePrecisionAngles) {
  OpeningBeams beams;
  const std::vector<float> ranges(181, 5.0F);
  EXPECT_EQ(resample({static_cast<double>(-1.5707964F), static_cast<double>(0.017453292F), 0.05, 32.0, ranges}, beams),
            "");
  EXPECT_TRUE(std::all_of(beams.begin(), beams.end(), [](float range) { return range == 5.0F; }));
}

TEST(VfhOpenings, RefusesAnotherGeometryInASentence) {
  const std::vector<float> ranges(181, 5.0F);
  const auto why = [&](const RobotState& robot, const geometry::Vector2& target, const PlacedScan& seen) {
    VfhOpenings law({}, {});
    const Steering steering = law.step(robot, target, seen);
    EXPECT_EQ(steering.outcome, Outcome::fault);
    EXPECT_EQ(steering.twist, geometry::Twist2{});
    return steering.why;
  };
  const geometry::Vector2 target(9.0, 0.0);
  EXPECT_EQ(why({}, target, {{}, {-80.0 * degree, degree, 0.05, 32.0, ranges}}), "it does not cover 180 degrees ahead");
  EXPECT_EQ(why({}, target, {{}, {-90.0 * degree, degree, 0.05, 32.0, {}}}), "it does not cover 180 degrees ahead");
  EXPECT_EQ(why({}, target, {{}, {-180.0 * degree, 2.0 * degree, 0.05, 32.0, ranges}}),
            "its beams are more than a degree apart");
  EXPECT_EQ(why({}, target, {{}, {-90.0 * degree, 0.0, 0.05, 32.0, ranges}}), "its angles or limits are none");
  EXPECT_EQ(why({}, target, {{0.0, 0.0, std::nan("")}, scan_of(ranges)}), "it is not known where it was taken");
  EXPECT_EQ(why({{0.0, std::nan(""), 0.0}}, target, {{}, scan_of(ranges)}), "the pose is not finite");
}

}  // namespace
}  // namespace kervan::control
