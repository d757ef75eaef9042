#include "components/mapping/sonar_mapper.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "framework/geometry/angle.hpp"

namespace kervan::mapping {
namespace {

using geometry::Pose2;
using geometry::radians;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr SonarLimits limits{0.15, 5.0};

SonarMapperParams with(UpdateRule update, double resolution = 0.1) {
  SonarMapperParams params;
  params.update = update;
  params.resolution = resolution;
  return params;
}

int percent(const SonarMapper& mapper, double x, double y) {
  std::int8_t value = 0;
  const grid::Cell cell = grid::cell_of({x, y}, mapper.resolution());
  mapper.read_percent({cell.x, cell.y, 1, 1}, {&value, 1});
  return value;
}

/// In the middle of the cell (0, 0), looking along x.
const Pose2 here{0.05, 0.05, 0.0};

class EveryRule : public testing::TestWithParam<UpdateRule> {};

TEST_P(EveryRule, PutsAnEchoWhereItCameFromAndClearsTheWay) {
  SonarMapper mapper(with(GetParam()));
  for (int i = 0; i < 5; ++i) EXPECT_EQ(mapper.add(here, 2.0, limits), ReadingResult::echo);
  EXPECT_GT(percent(mapper, 2.05, 0.05), 60);
  EXPECT_LT(percent(mapper, 1.05, 0.05), 20);
  EXPECT_EQ(percent(mapper, 2.35, 0.05), -1);
  EXPECT_EQ(percent(mapper, -0.35, 0.05), -1);
  EXPECT_EQ(percent(mapper, 1.05, 0.65), -1) << "outside of the cone";
}

TEST_P(EveryRule, ClearsOnlyAsFarAsTheLimitWithoutAnEcho) {
  for (const double range : {infinite, 5.0, 7.5}) {
    SonarMapperParams params = with(GetParam());
    params.no_echo_limit = 1.0;
    SonarMapper mapper(params);
    EXPECT_EQ(mapper.add(here, range, limits), ReadingResult::no_echo);
    const int near = percent(mapper, 0.85, 0.05);
    EXPECT_TRUE(near >= 0 && near < 50) << near;
    EXPECT_EQ(percent(mapper, 1.25, 0.05), -1);
    EXPECT_EQ(percent(mapper, 5.05, 0.05), -1) << "where the range ends nothing is";
  }
  SonarMapper deaf(with(GetParam()));
  EXPECT_EQ(deaf.add(here, 0.7, {0.15, 0.6}), ReadingResult::no_echo) << "beyond what the transducer hears";
  EXPECT_EQ(percent(deaf, 0.75, 0.05), -1);
}

TEST_P(EveryRule, LeavesOutWhatIsNoDistance) {
  SonarMapper mapper(with(GetParam()));
  for (const double range : {-1.0, -infinite, 0.0, 0.149, -0.0})
    EXPECT_EQ(mapper.add(here, range, limits), ReadingResult::refused_range) << range;
  EXPECT_EQ(mapper.add(here, nan, limits), ReadingResult::not_fired);
  for (const Pose2& pose :
       {Pose2{nan, 0, 0}, Pose2{0, infinite, 0}, Pose2{0, 0, nan}, Pose2{1e7, 0, 0}, Pose2{0, 0, -1e300}})
    EXPECT_EQ(mapper.add(pose, 1.0, limits), ReadingResult::refused_place);
  EXPECT_TRUE(mapper.box().empty());
  EXPECT_TRUE(mapper.take_touched().empty());
}

TEST_P(EveryRule, GrowsNoFurtherThanItsMemoryAndKeepsWhatItHas) {
  SonarMapperParams small = with(GetParam());
  small.most_bytes = 4 * 64 * 64 * 8;
  SonarMapper mapper(small);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(mapper.add(here, 2.0, limits), ReadingResult::echo);
  const int before = percent(mapper, 2.05, 0.05);
  const grid::CellBox box = mapper.box();
  EXPECT_EQ(mapper.add({500.0, 500.0, 0.0}, 2.0, limits), ReadingResult::refused_memory);
  EXPECT_EQ(percent(mapper, 2.05, 0.05), before);
  EXPECT_EQ(mapper.box(), box);
  EXPECT_EQ(mapper.add(here, 2.0, limits), ReadingResult::echo);
}

/// As sure to be there as a cell can be, then taken away: the sonar hears the wall behind it.
TEST_P(EveryRule, ForgetsWhatWasTakenAwayWithinTheStatedNumberOfReadings) {
  for (const auto& [distance, most] : {std::pair{1.0, 8}, {2.0, 8}, {2.5, 8}}) {
    const SonarMapperParams params = with(GetParam());
    SonarMapper mapper(params);
    for (int i = 0; i < 200; ++i) mapper.add(here, distance, limits);
    ASSERT_GT(percent(mapper, distance + 0.05, 0.05), 90);
    const int stated = readings_to_clear(params, distance, 0.0);
    EXPECT_LE(stated, most);
    int needed = 0;
    while (percent(mapper, distance + 0.05, 0.05) > 50 && needed < 1000) {
      mapper.add(here, 4.5, limits);
      ++needed;
    }
    EXPECT_LE(needed, stated) << distance;
    EXPECT_GE(needed, stated - 1) << distance;
  }
}

TEST_P(EveryRule, GivesMirroredMapsOfMirroredReadings) {
  SonarMapper left(with(GetParam())), right(with(GetParam()));
  for (int i = 0; i < 40; ++i) {
    const double yaw = radians(4.5 * i), range = 0.5 + 0.1 * i;
    left.add({0.05, 0.05, yaw}, range, limits);
    right.add({0.05, 0.05, -yaw}, range, limits);
  }
  int known = 0;
  for (int x = -50; x < 50; ++x)
    for (int y = -50; y < 50; ++y) {
      const double px = 0.1 * x + 0.05, py = 0.1 * y + 0.05;
      ASSERT_EQ(percent(left, px, py), percent(right, px, 0.1 - py)) << px << ", " << py;
      if (percent(left, px, py) >= 0) ++known;
    }
  EXPECT_GT(known, 100);
}

TEST_P(EveryRule, TellsTheTilesThatChanged) {
  SonarMapper mapper(with(GetParam()));
  mapper.add({6.0, 3.0, 0.0}, 1.5, limits);
  EXPECT_EQ(mapper.take_touched(), (std::vector<grid::Cell>{{0, 0}, {1, 0}}));
  EXPECT_TRUE(mapper.take_touched().empty());
}

INSTANTIATE_TEST_SUITE_P(All, EveryRule,
                         testing::Values(UpdateRule::bayes, UpdateRule::dempster_shafer, UpdateRule::himm),
                         [](const auto& test) {
                           return test.param == UpdateRule::bayes  ? "Bayes"
                                  : test.param == UpdateRule::himm ? "Himm"
                                                                   : "DempsterShafer";
                         });

/// The table of the component's page.
TEST(ReadingsToClear, AreThoseThatThePageStates) {
  const auto stated = [](UpdateRule update, double r) { return readings_to_clear(with(update), r, 0.0); };
  const int table[4][3] = {{3, 3, 8}, {4, 5, 8}, {6, 8, 8}, {12, 18, 8}};
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(stated(UpdateRule::bayes, 1.0 + i), table[i][0]);
    EXPECT_EQ(stated(UpdateRule::dempster_shafer, 1.0 + i), table[i][1]);
    EXPECT_EQ(stated(UpdateRule::himm, 1.0 + i), table[i][2]);
  }
  EXPECT_EQ(readings_to_clear(with(UpdateRule::bayes), 4.5, radians(10.0)), std::numeric_limits<int>::max())
      << "at the far edge the model says nothing";
}

TEST(SonarMapper, MakesAPlaceAsLikelyAsTheFormulaByEitherRule) {
  for (const UpdateRule rule : {UpdateRule::bayes, UpdateRule::dempster_shafer}) {
    SonarMapper mapper(with(rule));
    mapper.add(here, 2.0, limits);
    EXPECT_EQ(percent(mapper, 2.0, 0.05), 56) << "0.5 (3/5 + 1) 0.7";
    EXPECT_EQ(percent(mapper, 1.0, 0.05), 10) << "1 - 0.5 (4/5 + 1)";
  }
  SonarMapperParams literal = with(UpdateRule::dempster_shafer);
  literal.model.literal = true;
  SonarMapper mapper(literal);
  mapper.add(here, 2.0, limits);
  EXPECT_EQ(percent(mapper, 2.0, 0.05), 78) << "a mass of 0.56, and half of the rest";
}

/// The worked example once more, through cells of sixteen bits.
TEST(SonarMapper, GivesTheGoldensOfEquation15) {
  SonarMapperParams book{.model = {.max_range = 10.0, .tolerance = 0.5}, .resolution = 0.1};
  SonarMapper twice(book);
  const auto probability = [](const SonarMapper& mapper, double x) { return percent(mapper, x, 0.05); };
  twice.add(here, 6.0, {0.0, 10.0});
  EXPECT_EQ(probability(twice, 3.55), 18) << "0.175";
  twice.add(here, 6.0, {0.0, 10.0});
  EXPECT_EQ(probability(twice, 3.55), 4) << "0.0431";
}

TEST(SonarMapper, PlacesAnEchoByWhereTheTransducerIsWithinItsCell) {
  for (const double x : {0.001, 0.05, 0.099}) {
    SonarMapper mapper({.model = {.tolerance = 0.03}, .resolution = 0.1});
    mapper.add({x, 0.05, 0.0}, 2.05 - x, limits);
    EXPECT_GT(percent(mapper, 2.05, 0.05), 50) << x;
    EXPECT_LT(percent(mapper, 1.95, 0.05), 50) << x;
    EXPECT_EQ(percent(mapper, 2.15, 0.05), -1) << x;
  }
}

/// Murphy's evidence is weak at the edge of the cone. Taken at its word it makes empty space occupied.
TEST(SonarMapper, TakenLiterallyMakesTheEdgeOfAnEmptyConeOccupied) {
  for (const bool literal : {false, true}) {
    SonarMapper mapper({.model = {.literal = literal}, .resolution = 0.1});
    for (int i = 0; i < 5; ++i) mapper.add(here, 4.5, limits);
    EXPECT_EQ(percent(mapper, 3.65, 0.75) > 50, literal);
  }
}

TEST(SonarMapper, MarksWithTheBooksCertaintyFartherAwayThanWithOurs) {
  for (const double max_occupied : {0.7, 0.98}) {
    SonarMapper mapper({.model = {.max_occupied = max_occupied}, .resolution = 0.1});
    mapper.add(here, 3.5, limits);
    EXPECT_EQ(percent(mapper, 3.55, 0.05) > 50, max_occupied == 0.98);
    EXPECT_LT(percent(mapper, 2.05, 0.05), 50);
  }
}

TEST(SonarMapper, RecordsOnlyWhatThePaperRecords) {
  const SonarModelParams paper{.max_occupied = 1.0, .regions = Regions::fixed, .record_above = 0.95};
  SonarMapper mapper({.model = paper, .resolution = 0.05});
  mapper.add({0.025, 0.025, 0.0}, 0.42, limits);
  EXPECT_GT(percent(mapper, 0.425, 0.025), 90);
  EXPECT_EQ(percent(mapper, 0.425, 0.075), -1) << "6.7 degrees off the axis";
  EXPECT_LT(percent(mapper, 0.225, 0.025), 50);
}

/// A robot drives along a wall and hears it with a sonar at its side. The paper's maps have gaps, as it says because of
/// its threshold.
TEST(SonarMapper, ClosesTheGapsOfARecordedWallAsTheThresholdFalls) {
  const auto recorded = [](double threshold) {
    SonarMapper mapper(
        {.model = {.max_occupied = 1.0, .regions = Regions::fixed, .record_above = threshold}, .resolution = 0.02});
    // 0.2 m/s, ten readings a second, the wall 0.4 m away: one reading in three cells.
    for (double x = 0.01; x < 3.0; x += 0.06) mapper.add({x, 0.01, radians(90.0)}, 0.40, limits);
    int cells = 0;
    for (double x = 0.01; x < 3.0; x += 0.02) cells += percent(mapper, x, 0.41) > 50 ? 1 : 0;
    return cells;
  };
  EXPECT_EQ(recorded(0.95), 50) << "of 150";
  EXPECT_GE(recorded(0.85), 149);
}

TEST(Himm, CountsAlongTheAxisAlone) {
  SonarMapper mapper(with(UpdateRule::himm));
  mapper.add(here, 2.0, limits);
  EXPECT_EQ(percent(mapper, 2.05, 0.05), 20) << "3 of 15";
  EXPECT_EQ(percent(mapper, 1.95, 0.05), 0);
  EXPECT_EQ(percent(mapper, 2.05, 0.15), -1);
  mapper.add(here, 3.0, limits);
  EXPECT_EQ(percent(mapper, 2.05, 0.05), 13) << "2 of 15";
}

}  // namespace
}  // namespace kervan::mapping
