// Bodies near a place: what is found in the cells is what asking every body finds.
#include "sim/bodies.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <set>

#include "sim/surroundings.hpp"
#include "tests/unit/sim/p3dx.hpp"

namespace kervan::sim {
namespace {

Outline outline(int kind) {
  if (kind == 0) return p3dx().outline;
  if (kind == 1) return Outline({{0.9, -0.2}, {0.9, 0.2}, {-0.1, 0.2}, {-0.1, -0.2}});
  return Outline({{0.1, 0.0}, {-0.05, 0.08}, {-0.05, -0.08}});
}

/// Bodies at random places, which may overlap: the questions must be answered all the same.
class Crowd : public testing::TestWithParam<int> {
 protected:
  Crowd() : random_(static_cast<unsigned>(GetParam())), size_(GetParam() % 3 == 0 ? 4.0 : 30.0) {
    const int count = GetParam() % 2 == 0 ? 150 : 12;
    for (int i = 0; i < count; ++i) bodies_.add("b" + std::to_string(i), outline(i % 3), pose());
    bodies_.sort();
    // Some have moved since they were sorted, a few have come and some have gone.
    for (std::size_t i = 0; i < bodies_.size(); i += 3) {
      const Pose2& old = bodies_.pose(i);
      bodies_.move(i, {old.x + number(-0.3, 0.3), old.y + number(-0.3, 0.3), number(-9.0, 9.0)});
    }
    if (GetParam() % 5 == 1) bodies_.remove(bodies_.size() / 2);
    for (int i = 0; i < 5; ++i) bodies_.add("n" + std::to_string(i), outline(1), pose());
  }

  double number(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }
  Pose2 pose() { return {number(-size_, size_), number(-size_, size_), number(-pi, pi)}; }

  std::mt19937 random_;
  double size_;
  Bodies bodies_;
  World world_{{.segments = {{{-3.0, 1.0}, {2.0, 2.5}}}, .circles = {{{1.0, -2.0}, 0.4}}}};
};

TEST_P(Crowd, ABoxHoldsWhomItHolds) {
  for (int i = 0; i < 200; ++i) {
    const Vector2 low = pose().position(), high = low + Vector2(number(0.0, 9.0), number(0.0, 9.0));
    std::set<std::size_t> found, inside;
    bodies_.visit_box(low, high, [&](std::size_t body) { found.insert(body); });
    for (std::size_t body = 0; body < bodies_.size(); ++body)
      if ((bodies_.center(body) - low).minCoeff() >= 0.0 && (high - bodies_.center(body)).minCoeff() >= 0.0)
        inside.insert(body);
    EXPECT_TRUE(std::includes(found.begin(), found.end(), inside.begin(), inside.end()));
  }
}

TEST_P(Crowd, RoomIsThatOfAskingEverybody) {
  for (int i = 0; i < 200; ++i) {
    const std::size_t self = static_cast<std::size_t>(i) % (bodies_.size() + 1);  // one is not among them
    const Outline body = outline(i % 3);
    const Pose2 at = i % 20 == 0 ? Pose2{1e4, -1e5, 1.0} : pose();
    for (const World& world : {world_, World({})}) {
      Clearance nearest = world.clearance(body, at);
      const std::string* name = nullptr;
      double among = infinity;
      for (std::size_t other = 0; other < bodies_.size(); ++other) {
        if (other == self) continue;
        const Clearance found = clearance(bodies_, other, body, at);
        among = std::min(among, found.distance);
        const double within = number(0.0, 3.0), limited = clearance(bodies_, other, body, at, within).distance;
        if (found.distance <= within)
          EXPECT_EQ(limited, found.distance);
        else
          EXPECT_GT(limited, within);
        if (found.distance > nearest.distance) continue;
        if (found.distance == nearest.distance && (!name || bodies_.name(other) >= *name)) continue;
        nearest = found;
        name = &bodies_.name(other);
      }
      const Surroundings around(world, bodies_, self);
      const Room room = around.room(body, at);
      EXPECT_EQ(room.all.distance, nearest.distance);
      EXPECT_EQ(room.all.on_obstacle, nearest.on_obstacle);
      EXPECT_EQ(room.all.on_outline, nearest.on_outline);
      EXPECT_EQ(room.other, name);
      EXPECT_EQ(room.world, world.clearance(body, at).distance);
      for (const double within : {0.1, 1.0, 10.0, infinity}) {
        const double found = around.room_among_bodies(body, at, within);
        if (found < within) {
          EXPECT_LE(found, among);
        } else {
          EXPECT_GE(among, within);
        }
      }
    }
  }
}

TEST_P(Crowd, RaysMeetWhatAskingEverybodyMeets) {
  for (int i = 0; i < 100; ++i) {
    const std::size_t self = static_cast<std::size_t>(i) % (bodies_.size() + 1);
    const Vector2 origin = pose().position();
    const double field = i % 3 == 0 ? number(1e-3, 0.5) : number(0.5, 2.0 * pi - 1e-3), range = number(0.5, 12.0);
    const int count = i % 4 == 0 ? 1 + i % 7 : 2 + i;
    const double yaw = number(-pi, pi);
    std::vector<Vector2> directions;
    for (int k = 0; k < count; ++k) directions.push_back(geometry::heading(yaw + k * field / std::max(1, count - 1)));
    std::vector<RayHit> hits(directions.size()), expected(directions.size());
    // Part of the rays come from another place.
    const std::size_t half = directions.size() / 2;
    const std::array<RayFan, 2> fans{{{origin, {directions.data(), half}},
                                      {pose().position(), {directions.data() + half, directions.size() - half}}}};
    Surroundings(world_, bodies_, self).cast(fans, range, hits);
    world_.cast(fans, range, expected);
    for (std::size_t k = 0; k < directions.size(); ++k) {
      const Ray ray{fans[k < half ? 0 : 1].origin, directions[k]};
      for (std::size_t body = 0; body < bodies_.size(); ++body) {
        if (body == self) continue;
        const auto corners = bodies_.corners(body);
        for (std::size_t corner = 0; corner < corners.size(); ++corner) {
          const Segment edge{corners[corner], corners[(corner + 1) % corners.size()]};
          const double distance = hit_distance(ray, edge);
          if (distance < expected[k].distance && distance <= range) expected[k] = {distance, hit_normal(ray, edge)};
        }
      }
      EXPECT_EQ(hits[k].distance, expected[k].distance) << "ray " << k << " of " << count;
      if (expected[k].distance < infinity) {
        EXPECT_EQ(hits[k].normal, expected[k].normal);
      }
    }
  }
}

TEST_P(Crowd, EverySetOfInstructionsFindsTheSameRaysNearADisc) {
  constexpr std::size_t count = 48;
  std::array<float, count> x, y, dx, dy, length;
  const auto small = [this](double low, double high) { return static_cast<float>(number(low, high)); };
  for (int round = 0; round < 100; ++round) {
    for (std::size_t i = 0; i < count; ++i) {
      const Vector2 direction = geometry::heading(number(-pi, pi));
      x[i] = small(-0.3, 0.3);
      y[i] = small(-0.3, 0.3);
      dx[i] = static_cast<float>(direction.x());
      dy[i] = static_cast<float>(direction.y());
      length[i] = small(0.0, 5.0);
    }
    const RayPaths paths{x.data(), y.data(), dx.data(), dy.data(), length.data(), count};
    const Vector2 center(small(-5.0, 5.0), small(-5.0, 5.0));
    const float radius = small(0.0, 2.0);
    const auto near = [&](Instructions instructions) {
      std::array<std::uint16_t, count / 16> found;
      find_near(paths, static_cast<float>(center.x()), static_cast<float>(center.y()), radius, found.data(),
                instructions);
      return found;
    };
    const auto expected = near(Instructions::scalar);
    for (std::size_t i = 0; i < count; ++i) {
      const Segment path{{x[i], y[i]}, {x[i] + length[i] * dx[i], y[i] + length[i] * dy[i]}};
      if ((nearest_point(path, center) - center).norm() < radius - 1e-4) {
        EXPECT_TRUE(expected[i / 16] >> (i % 16) & 1);
      }
    }
    for (const Instructions instructions : {Instructions::avx2, Instructions::avx512}) {
      if (!available(instructions)) continue;
      EXPECT_EQ(near(instructions), expected);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, Crowd, testing::Range(0, 12));

TEST(Bodies, AreFoundHoweverFarApartTheyAre) {
  Bodies bodies;
  std::vector<Vector2> places;
  for (int i = 0; i < 20; ++i) {
    places.push_back({std::pow(10.0, i), i % 2 == 0 ? 0.0 : -std::pow(10.0, i)});
    bodies.add("b" + std::to_string(i), p3dx().outline, {places.back().x(), places.back().y(), 0.0});
  }
  bodies.sort();
  for (std::size_t i = 0; i < places.size(); ++i) {
    bool found = false;
    bodies.visit_box(places[i] - Vector2(1.0, 1.0), places[i] + Vector2(1.0, 1.0),
                     [&](std::size_t body) { found |= body == i; });
    EXPECT_TRUE(found) << i;
  }
}

}  // namespace
}  // namespace kervan::sim
