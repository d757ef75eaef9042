#include "components/localization/correlative_matcher.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "tests/unit/localization/drifting_drive.hpp"

namespace kervan::localization {
namespace {

using geometry::Pose2;
using geometry::Vector2;

DrawnMap drawn(const Walls& walls) {
  DrawnMap map(4.0);
  for (const auto& [a, b] : walls) map.wall(a, b);
  return map;
}

/// 90 beams all round, seen from `truth`.
Echoes seen(const Walls& walls, const Pose2& truth, double farthest = 10.0) {
  Echoes echoes;
  for (int i = 0; i < 90; ++i) {
    const double angle = geometry::radians(4.0 * i);
    const double range = ray(truth.position(), truth.yaw + angle, walls);
    if (range < farthest) echoes.push_back(range * geometry::heading(angle));
  }
  return echoes;
}

TEST(CorrelativeMatcher, FindsThePoseBetweenTheCells) {
  const DrawnMap map = drawn(room);
  CorrelativeMatcher matcher({});
  std::mt19937 random(1);
  const auto uniform = [&](double bound) {
    return bound * (2.0 * static_cast<double>(random() % 10'001) / 10'000.0 - 1.0);
  };
  for (int i = 0; i < 30; ++i) {
    const Pose2 truth{uniform(0.8), uniform(0.8), uniform(3.0)};
    const Pose2 expected{truth.x + uniform(0.25), truth.y + uniform(0.25), truth.yaw + uniform(0.15)};
    const Match match = matcher.match(map, seen(room, truth), expected, {0.3, 0.2});
    ASSERT_EQ(match.kind, MatchKind::matched) << i;
    EXPECT_LT((match.pose.position() - truth.position()).norm(), 0.03) << i;
    EXPECT_LT(std::abs(geometry::angle_between(match.pose.yaw, truth.yaw)), 0.012) << i;
    EXPECT_GT(match.score, 0.8);
    EXPECT_LT(std::sqrt(match.covariance(0, 0)), 0.06);
    EXPECT_FALSE(match.line);
  }
}

TEST(CorrelativeMatcher, FindsTheSameEveryTime) {
  const DrawnMap map = drawn(room);
  const Echoes echoes = seen(room, {0.3, 0.2, 0.1});
  CorrelativeMatcher used({}), fresh({});
  used.match(map, seen(room, {-0.5, 0.1, 2.0}), {-0.5, 0.1, 2.0}, {0.5, 0.5});
  const Match a = used.match(map, echoes, {0.2, 0.3, 0.0}, {0.3, 0.2});
  const Match b = fresh.match(map, echoes, {0.2, 0.3, 0.0}, {0.3, 0.2});
  EXPECT_EQ(a.pose, b.pose);
  EXPECT_EQ(a.score, b.score);
  EXPECT_EQ(a.covariance, b.covariance);
}

/// Bounding leaves out only what cannot be the best: the pose found is at least as good as any other of the window.
TEST(CorrelativeMatcher, FindsNothingWorseThanAnExhaustiveSearch) {
  const DrawnMap map = drawn(room);
  CorrelativeMatcher matcher({.least_score = 0.0, .rival = 1.1});
  const Pose2 truth{0.31, -0.17, 0.4}, expected{0.45, 0.02, 0.46};
  const Echoes echoes = seen(room, truth);
  const SearchWindow window{0.3, 0.12};
  const Match match = matcher.match(map, echoes, expected, window);
  LikelihoodField field(0.07 / DrawnMap::resolution);
  field.build(map, {-90, -90, 180, 180});
  const auto score = [&](const Pose2& pose) {
    double sum = 0.0;
    for (const Vector2& place : echoes)
      sum += field.values()[field.index(grid::cell_of(pose * place, DrawnMap::resolution))] / 255.0;
    return sum / static_cast<double>(echoes.size());
  };
  double best = 0.0;
  for (double turn = -0.12; turn <= 0.12; turn += 0.01)
    for (double y = -0.3; y <= 0.3; y += 0.05)
      for (double x = -0.3; x <= 0.3; x += 0.05)
        best = std::max(best, score({expected.x + x, expected.y + y, expected.yaw + turn}));
  EXPECT_GE(match.score, best - 0.01);
  EXPECT_LT(match.tried, 13u * 13u * 40u / 2u) << "and without looking everywhere";
}

TEST(CorrelativeMatcher, SaysThatACorridorTellsNothingAlongIt) {
  const Walls corridor = {{{-3.9, -0.975}, {3.9, -0.975}}, {{-3.9, 0.975}, {3.9, 0.975}}};
  CorrelativeMatcher matcher({});
  const Match match =
      matcher.match(drawn(corridor), seen(corridor, {0.0, 0.1, 0.0}, 2.0), {0.1, 0.0, 0.02}, {0.3, 0.1});
  ASSERT_EQ(match.kind, MatchKind::matched);
  EXPECT_TRUE(match.line);
  EXPECT_NEAR(match.pose.y, 0.1, 0.02);
  EXPECT_GT(std::sqrt(match.covariance(0, 0)), 0.15) << "along it";
  EXPECT_LT(std::sqrt(match.covariance(1, 1)), 0.05) << "across it";
}

TEST(CorrelativeMatcher, SaysThatTwoPlacesFit) {
  // A corner of something, seen alone, where there are two.
  DrawnMap map(4.0);
  for (const double x : {-0.3, 0.3}) map.wall({x, 1.0}, {x + 0.4, 1.0}).wall({x, 1.0}, {x, 1.6});
  Echoes echoes;
  for (int i = 0; i < 30; ++i) {
    echoes.push_back({0.4 * i / 30, 1.0});
    echoes.push_back({0.0, 1.0 + 0.6 * i / 30});
  }
  CorrelativeMatcher matcher({});
  const Match match = matcher.match(map, echoes, {0.0, 0.0, 0.0}, {0.5, 0.02});
  EXPECT_EQ(match.kind, MatchKind::ambiguous);
  EXPECT_EQ(match.pose, (Pose2{0.0, 0.0, 0.0})) << "left to dead reckoning";
}

TEST(CorrelativeMatcher, SaysThatEchoesFitNowhere) {
  const Walls other = {
      {{-1.0, -1.0}, {1.0, -1.3}}, {{1.0, -1.3}, {0.7, 1.1}}, {{0.7, 1.1}, {-1.2, 0.9}}, {{-1.2, 0.9}, {-1.0, -1.0}}};
  CorrelativeMatcher matcher({});
  const Match match = matcher.match(drawn(room), seen(other, {}), {}, {0.3, 0.2});
  EXPECT_EQ(match.kind, MatchKind::poor);
  EXPECT_EQ(match.pose, Pose2{});
}

TEST(CorrelativeMatcher, SaysThatTheMapKnowsTooLittle) {
  CorrelativeMatcher matcher({});
  EXPECT_EQ(matcher.match(DrawnMap(0.5), seen(room, {}), {}, {0.3, 0.2}).kind, MatchKind::too_few);
  EXPECT_EQ(matcher.match(drawn(room), Echoes{}, {}, {0.3, 0.2}).kind, MatchKind::too_few) << "no echoes at all";
  EXPECT_EQ(matcher.match(drawn(room), seen(room, {}), {1e9, 0.0, 0.0}, {0.3, 0.2}).kind, MatchKind::too_few)
      << "nowhere";
}

}  // namespace
}  // namespace kervan::localization
