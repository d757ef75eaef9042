#include "deploy/lab/statistics.hpp"

#include <gtest/gtest.h>

#include <vector>

using namespace kervan::lab;

namespace {

/// The ten hours of additional sleep of Student's own example (drug 2), 1908.
const std::vector<double> sleep_hours = {1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4};

TEST(Mean, HasTheIntervalOfStudentsOwnExample) {
  const auto estimate = mean_of(sleep_hours);
  ASSERT_TRUE(estimate);
  EXPECT_NEAR(estimate->value, 2.33, 1e-12);
  // R 4: t.test(extra ~ 1, sleep, subset = group == 2)
  EXPECT_NEAR(estimate->low, 0.8976775, 1e-6);
  EXPECT_NEAR(estimate->high, 3.7623225, 1e-6);
  EXPECT_EQ(estimate->n, 10u);
}

TEST(Mean, OfTwoRunsHasAWideInterval) {
  const auto estimate = mean_of(std::vector{1.0, 3.0});
  ASSERT_TRUE(estimate);
  EXPECT_NEAR(estimate->high - estimate->value, 12.7062047, 1e-6);  // t(0.975, 1), and s / sqrt(2) = 1
}

TEST(Mean, OfOneRunIsAllThatIsKnown) {
  const auto estimate = mean_of(std::vector{7.0});
  ASSERT_TRUE(estimate);
  EXPECT_EQ(estimate->value, 7.0);
  EXPECT_EQ(estimate->low, 7.0);
  EXPECT_EQ(estimate->high, 7.0);
}

TEST(Mean, OfEqualRunsHasNoWidth) {
  const auto estimate = mean_of(std::vector{2.0, 2.0, 2.0});
  ASSERT_TRUE(estimate);
  EXPECT_EQ(estimate->low, 2.0);
  EXPECT_EQ(estimate->high, 2.0);
}

TEST(Mean, OfNothingIsNothing) { EXPECT_FALSE(mean_of({})); }

/// Newcombe, "Two-sided confidence intervals for the single proportion", Statistics in Medicine 17, 1998, table I, the
/// score method without continuity correction.
TEST(Share, HasTheIntervalsOfNewcombesTable) {
  struct Case {
    std::size_t hits, n;
    double low, high;
  };
  for (const Case& c :
       {Case{81, 263, 0.2553, 0.3662}, {15, 148, 0.0624, 0.1605}, {0, 20, 0.0, 0.1611}, {1, 29, 0.0061, 0.1718}}) {
    const auto estimate = share_of(c.hits, c.n);
    ASSERT_TRUE(estimate);
    EXPECT_NEAR(estimate->low, c.low, 5e-5) << c.hits << " of " << c.n;
    EXPECT_NEAR(estimate->high, c.high, 5e-5) << c.hits << " of " << c.n;
  }
}

TEST(Share, OfAllEndsAtOneAndBeginsBelow) {
  const auto estimate = share_of(20, 20);
  ASSERT_TRUE(estimate);
  EXPECT_EQ(estimate->value, 1.0);
  EXPECT_EQ(estimate->high, 1.0);
  EXPECT_NEAR(estimate->low, 0.8389, 5e-5);
}

TEST(Share, OfNothingIsNothing) { EXPECT_FALSE(share_of(0, 0)); }

}  // namespace
