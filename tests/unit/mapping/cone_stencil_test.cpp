#include "components/mapping/cone_stencil.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "components/grid/grid.hpp"
#include "components/mapping/cone_kernel.hpp"
#include "framework/geometry/angle.hpp"

namespace kervan::mapping {
namespace {

using geometry::radians;
using Stencil = ConeStencil<std::int16_t>;

constexpr double resolution = 0.1;

std::int16_t empty_weight(const SonarModel& model, double r, double alpha) {
  return static_cast<std::int16_t>(-grid::log_odds_of(model.counted_empty(r, alpha)));
}
std::int16_t occupied_weight(const SonarModel& model, double r, double alpha) {
  return grid::log_odds_of(model.counted_occupied(r, alpha));
}
float empty_mass(const SonarModel& model, double r, double alpha) {
  return static_cast<float>(std::min(model.empty(r, alpha), 0.98));
}
float occupied_mass(const SonarModel& model, double r, double alpha) {
  return static_cast<float>(std::min(model.occupied(r, alpha), 0.98));
}

Stencil stencil() { return Stencil(SonarModel({.max_range = 3.0}), resolution, empty_weight, occupied_weight); }

/// The cells of a cone that are told anything, with their weights.
std::map<grid::Cell, std::pair<int, int>> weights(const PlacedCone<std::int16_t>& placed) {
  const Cone<std::int16_t>& cone = placed.cone;
  std::map<grid::Cell, std::pair<int, int>> result;
  for (std::size_t i = 0; i < cone.places.size(); ++i)
    for (std::size_t k = 0; k < 8; ++k)
      if (cone.distance[i].of[k] != never_reached)
        result[{cone.places[i].x + static_cast<int>(k), (placed.mirrored ? -1 : 1) * cone.places[i].y}] = {
            cone.empty[i].of[k], cone.occupied[i].of[k]};
  return result;
}

TEST(Cone, IsTheSameOnBothSidesOfItsAxis) {
  Stencil cones = stencil();
  const auto mirrored = [&](int heading, int other, auto mirror) {
    const auto cells = weights(cones.cone(heading)), others = weights(cones.cone(other));
    ASSERT_GT(cells.size(), 20u);
    ASSERT_EQ(cells.size(), others.size());
    for (const auto& [cell, weight] : cells) {
      const auto found = others.find(mirror(cell));
      ASSERT_NE(found, others.end()) << heading << ": " << cell.x << ", " << cell.y;
      EXPECT_EQ(found->second, weight) << heading;
    }
  };
  const auto about_x = [](grid::Cell c) { return grid::Cell{c.x, -c.y}; };
  for (int heading = 0; heading <= 128; ++heading) mirrored(heading, (256 - heading) % 256, about_x);
}

TEST(Cone, HasItsWeightOnItsAxis) {
  Stencil cones = stencil();
  for (int heading = 0; heading < 256; ++heading) {
    const double yaw = radians(360.0) * heading / 256;
    double sum = 0.0, across = 0.0;
    for (const auto& [cell, weight] : weights(cones.cone(heading))) {
      sum += weight.first;
      across += weight.first * (cell.y * std::cos(yaw) - cell.x * std::sin(yaw));
    }
    EXPECT_LT(std::abs(across / sum), 0.05) << "of a cell, at heading " << heading;
  }
}

TEST(Cone, HasExactlyTheCellsThatTheModelTellsSomething) {
  Stencil cones = stencil();
  const SonarModel model({.max_range = 3.0});
  for (const int heading : {0, 17, 64, 100, 128, 200}) {
    const double yaw = radians(360.0) * heading / 256;
    auto cells = weights(cones.cone(heading));
    for (int y = -31; y <= 31; ++y)
      for (int x = -31; x <= 31; ++x) {
        const double r = resolution * std::hypot(x, y);
        const double alpha = r == 0.0 ? 0.0 : std::abs(geometry::angle_between(yaw, std::atan2(y, x)));
        // A cell on the very border may fall to either side.
        if (std::abs(alpha / radians(15.0) + r / 3.0 - 1.0) < 1e-3 || std::abs(alpha - radians(15.0)) < 1e-6) continue;
        const bool told = alpha < radians(15.0) && r <= 3.0 && model.counted_empty(r, alpha) > 0.5;
        const auto found = cells.find({x, y});
        ASSERT_EQ(found != cells.end(), told) << heading << ": " << x << ", " << y;
        if (told) {
          EXPECT_NEAR(found->second.first, empty_weight(model, r, alpha), 1);
          EXPECT_NEAR(found->second.second, occupied_weight(model, r, alpha), 1);
        }
      }
  }
}

TEST(Cone, LiesWithinItsBoxOnEitherSide) {
  Stencil cones = stencil();
  for (int heading = 0; heading < 256; ++heading) {
    const PlacedCone<std::int16_t> placed = cones.cone(heading);
    const grid::CellBox box = placed.box(placed.cone.places.size());
    for (const auto& [cell, weight] : weights(placed)) EXPECT_TRUE(box.contains(cell)) << heading;
    EXPECT_NEAR(placed.axis.y(), std::sin(radians(360.0) * heading / 256), 1e-12);
    EXPECT_NEAR(placed.axis.x(), std::cos(radians(360.0) * heading / 256), 1e-12);
  }
}

TEST(Distances, AreCountedAsByBisection) {
  std::mt19937 random(1);
  for (const int most : {10, 300, 32000}) {
    std::vector<std::int16_t> values;
    for (int i = 0; i < 200; ++i) values.push_back(static_cast<std::int16_t>(random() % static_cast<unsigned>(most)));
    std::sort(values.begin(), values.end());
    const Distances distances(values);
    for (int limit = -1; limit < most + 100; ++limit)
      ASSERT_EQ(distances.up_to(limit), std::upper_bound(values.begin(), values.end(), limit) - values.begin())
          << limit << " of " << most;
  }
  EXPECT_EQ(Distances().up_to(100), 0u);
}

TEST(Headings, AreTheNearestToAnAngle) {
  EXPECT_EQ(Headings::nearest(0.0), 0);
  EXPECT_EQ(Headings::nearest(radians(90.0)), 64);
  EXPECT_EQ(Headings::nearest(radians(-90.0)), 192);
  EXPECT_EQ(Headings::nearest(radians(359.9)), 0);
  EXPECT_EQ(Headings::nearest(radians(360.0 * 5 + 1.4)), 1);
  EXPECT_EQ(Headings::nearest(radians(-360.0 * 5 - 1.4)), 255);
}

TEST(Headings, GiveDirectionsToTheFourteenthDigit) {
  const Headings headings;
  for (int i = -20000; i <= 20000; ++i) {
    const double yaw = 0.001 * i;
    EXPECT_NEAR(headings.direction(yaw).x(), std::cos(yaw), 1e-14) << yaw;
    EXPECT_NEAR(headings.direction(yaw).y(), std::sin(yaw), 1e-14) << yaw;
  }
}

TEST(Cone, ReachesNoFartherThanSixteenBitsOfMillimetres) {
  EXPECT_THROW(Stencil(SonarModel({.max_range = 32.1}), 0.1, empty_weight, occupied_weight), std::invalid_argument);
}

/// Random readings into a grid by each way; they must agree to the bit.
template <class Value, class Weight>
void expect_equal_kernels(ConeStencil<Weight> cones) {
  const grid::CellBox box{-64, -64, 128, 128};
  grid::Grid<Value> wide(resolution, {}, 1 << 24), portable(resolution, {}, 1 << 24);
  wide.cover(box);
  portable.cover(box);
  std::mt19937 random(1);
  for (int i = 0; i < 500; ++i) {
    const PlacedCone<Weight> placed = cones.cone(static_cast<int>(random() % 256));
    const Cone<Weight>& cone = placed.cone;
    const auto empty_below = static_cast<std::int16_t>(random() % 3200);
    const ConeReading reading{empty_below, static_cast<std::int16_t>(empty_below + random() % 300 - 50)};
    const std::size_t count = cone.up_to(std::max(reading.empty_below, reading.occupied_to));
    add_cone(wide.place({0, 0}), placed.stride(wide.stride()), cone, count, reading);
    add_cone_portably(portable.place({0, 0}), placed.stride(portable.stride()), cone, count, reading);
  }
  EXPECT_EQ(wide.values(), portable.values());
  EXPECT_NE(wide.at({3, 0}), Value{});
}

TEST(ConeKernel, OfLogOddsIsTheSameWithAndWithoutVectorInstructions) { expect_equal_kernels<grid::LogOdds>(stencil()); }

TEST(ConeKernel, OfMassesIsTheSameWithAndWithoutVectorInstructions) {
  expect_equal_kernels<grid::MassCell>(
      ConeStencil<float>(SonarModel({.max_range = 3.0}), resolution, empty_mass, occupied_mass));
}

TEST(ConeKernel, OfMassesIsDempstersRule) {
  Cone<float> cone;
  constexpr auto off = never_reached;
  cone.distance.push_back({{100, 200, 300, 400, off, off, off, off}});
  cone.empty.push_back({{0.825f, 0.825f, 0.825f, 0.825f}});
  cone.occupied.push_back({{0.5227f, 0.5227f, 0.5227f, 0.5227f}});
  cone.nearest = Distances({100});
  cone.within = Distances({400});
  cone.places.push_back({0, 0});
  std::array<grid::MassCell, 8> cells{};
  cells[1] = {0.5227f, 0.0f};
  cells[5] = {0.3f, 0.4f};
  add_cone(cells.data(), 8, cone, 1, {250, 350});
  EXPECT_NEAR(cells[0].empty, 0.825, 1e-6);
  EXPECT_NEAR(cells[1].occupied, 0.1608, 5e-5);
  EXPECT_NEAR(cells[1].empty, 0.6923, 5e-5);
  EXPECT_NEAR(cells[2].occupied, 0.5227, 1e-6);
  EXPECT_EQ(cells[3], grid::MassCell{});
  EXPECT_EQ(cells[5], (grid::MassCell{0.3f, 0.4f})) << "what is told nothing keeps its bits";
}

}  // namespace
}  // namespace kervan::mapping
