#include "sim/random.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kervan::sim {
namespace {

using Block = std::array<std::uint32_t, 4>;

TEST(Random, PhiloxGivesThePublishedAnswers) {
  // Known answers of the authors' own distribution, Random123, philox4x32 with 10 rounds.
  EXPECT_EQ(philox4x32({0, 0, 0, 0}, {0, 0}), (Block{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(philox4x32({~0u, ~0u, ~0u, ~0u}, {~0u, ~0u}), (Block{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox4x32({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Block{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(Random, EveryPartOfTheKeyMatters) {
  const auto draw = [](std::uint64_t seed, const char* robot, RandomUse use, std::uint16_t part, std::uint64_t at) {
    return RandomSource(seed, robot).at(use, part, at).uniform();
  };
  const double reference = draw(1, "r1", RandomUse::sonar, 3, 7);
  EXPECT_EQ(reference, draw(1, "r1", RandomUse::sonar, 3, 7));
  EXPECT_NE(reference, draw(2, "r1", RandomUse::sonar, 3, 7));
  EXPECT_NE(reference, draw(1ull << 32 | 1, "r1", RandomUse::sonar, 3, 7));
  EXPECT_NE(reference, draw(1, "r2", RandomUse::sonar, 3, 7));
  EXPECT_NE(reference, draw(1, "r1", RandomUse::odometry_scale, 3, 7));
  EXPECT_NE(reference, draw(1, "r1", RandomUse::sonar, 4, 7));
  EXPECT_NE(reference, draw(1, "r1", RandomUse::sonar, 3, 8));
}

TEST(Random, NumbersDoNotDependOnWhatWasDrawnBefore) {
  const RandomSource source(5, "r1");
  auto first = source.at(RandomUse::sonar, 0, 10);
  const double a = first.gaussian();
  const double b = first.uniform();
  EXPECT_NE(a, b);
  source.at(RandomUse::sonar, 1, 10).gaussian();
  auto again = source.at(RandomUse::sonar, 0, 10);
  EXPECT_EQ(again.gaussian(), a);
  EXPECT_EQ(again.uniform(), b);
}

TEST(Random, UniformAndGaussianHaveTheirMoments) {
  const RandomSource source(1, "r1");
  constexpr int count = 20'000;
  double sum = 0.0, normal_sum = 0.0, normal_squares = 0.0;
  int beyond_two = 0;
  for (int i = 0; i < count; ++i) {
    auto sequence = source.at(RandomUse::sonar, 0, static_cast<std::uint64_t>(i));
    const double u = sequence.uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    sum += u;
    const double g = sequence.gaussian();
    normal_sum += g;
    normal_squares += g * g;
    beyond_two += std::abs(g) > 2.0;
  }
  // Five standard errors each.
  EXPECT_NEAR(sum / count, 0.5, 5 * 0.2887 / std::sqrt(count));
  EXPECT_NEAR(normal_sum / count, 0.0, 5 / std::sqrt(count));
  EXPECT_NEAR(normal_squares / count, 1.0, 5 * std::sqrt(2.0 / count));
  EXPECT_NEAR(beyond_two, 0.0455 * count, 5 * std::sqrt(0.0455 * count));
}

}  // namespace
}  // namespace kervan::sim
