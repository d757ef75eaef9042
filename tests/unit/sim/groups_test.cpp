// Groups of bodies: whoever is joined, by others too, belongs together, whichever thread says so first.
#include "sim/groups.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <utility>
#include <vector>

#include "framework/workers/worker_pool.hpp"

namespace kervan::sim {
namespace {

using Joins = std::vector<std::pair<std::size_t, std::size_t>>;

TEST(Groups, ListTheirBodiesInTheOrderGiven) {
  Groups groups;
  groups.reset(7, 2);
  for (const auto& [a, b] : Joins{{6, 3}, {3, 4}, {4, 6}}) groups.join(a, b);
  groups.sort(std::array<std::size_t, 5>{4, 3, 2, 1, 0});
  std::vector<std::vector<std::size_t>> all;
  for (std::size_t leader = 2; leader < 7; ++leader) {
    std::vector<std::size_t> group;
    groups.visit_led_by(leader, [&](std::size_t body) { group.push_back(body); });
    if (!group.empty()) all.push_back(group);
  }
  EXPECT_EQ(all, (std::vector<std::vector<std::size_t>>{{2}, {6, 4, 3}, {5}}));
}

TEST(Groups, HoldTheCommonBodiesAll) {
  Groups groups;
  groups.reset(4, 1);
  groups.join(1, 3);
  groups.sort(std::array<std::size_t, 3>{0, 1, 2});
  EXPECT_FALSE(groups.apart(1, 0));
  EXPECT_FALSE(groups.apart(2, 0));
  EXPECT_FALSE(groups.apart(1, 3));
  EXPECT_TRUE(groups.apart(1, 2));
}

TEST(Groups, DependNeitherOnTheOrderOfJoiningNorOnTheThreads) {
  constexpr std::size_t bodies = 2000;
  std::mt19937 random(1);
  std::uniform_int_distribution<std::size_t> any(0, bodies - 1);
  Joins joins(bodies / 2);
  for (auto& [a, b] : joins) a = any(random), b = any(random);

  // The rule, word by word: whoever is joined takes the least number around, until nothing changes.
  std::vector<std::size_t> least(bodies), order(bodies);
  for (std::size_t i = 0; i < bodies; ++i) least[i] = order[i] = i;
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& [a, b] : joins) {
      changed = changed || least[a] != least[b];
      least[a] = least[b] = std::min(least[a], least[b]);
    }
  }

  Groups groups;  // used again, as in every step
  for (const int threads : {1, 2, 4}) {
    workers::WorkerPool pool(threads);
    for (int round = 0; round < 10; ++round) {
      std::shuffle(joins.begin(), joins.end(), random);
      groups.reset(bodies, 0);
      pool.for_each(joins.size(), 1, [&](std::size_t i) { groups.join(joins[i].first, joins[i].second); });
      groups.sort(order);
      std::vector<std::size_t> found(bodies, bodies);
      for (std::size_t leader = 0; leader < bodies; ++leader)
        groups.visit_led_by(leader, [&](std::size_t body) { found[body] = leader; });
      ASSERT_EQ(found, least) << threads << " threads";
    }
  }
}

}  // namespace
}  // namespace kervan::sim
