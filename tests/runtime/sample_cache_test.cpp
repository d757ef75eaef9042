/// History, lifespan, deadline, max age and ownership, as every port has them.
#include "framework/runtime/sample_cache.hpp"

#include <gtest/gtest.h>

#include "framework/component/sample.hpp"
#include "framework/dds/endpoint.hpp"
#include "kervan_msgs/msg/MotionRequest.hpp"

namespace {

using namespace std::chrono_literals;
using kervan::Duration;
using kervan::QosProfile;
using kervan::Time;
using kervan::runtime::SampleCache;
using kervan::runtime::StagedSample;
using kervan_msgs::msg::MotionRequest;

constexpr Time at(Duration t) { return Time(t); }

class SampleCacheTest : public ::testing::Test {
 protected:
  kervan::dds::Domain domain_{{.id = 204, .network = false}};
  kervan::dds::Writer writer_{
      domain_, "/requests", kervan::type_support<MotionRequest>(), QosProfile{}, kervan::dds::CyclonePart::carrier, 0,
      0};

  StagedSample sample(int number, Duration received, std::uint64_t instance = 1, unsigned writer = 0,
                      std::int32_t strength = 0) {
    kervan::dds::SampleBlock* block = writer_.loan(true);
    static_cast<MotionRequest*>(kervan::dds::mutable_value_of(block))->priority = number;
    return {block, writer, instance, strength, at(received)};
  }

  static int number(const kervan::dds::SampleBlock* block) {
    return static_cast<const MotionRequest*>(kervan::dds::value_of(block))->priority;
  }

  static std::vector<int> take_all(SampleCache& cache, Duration now) {
    std::vector<int> numbers;
    while (auto* block = cache.take(at(now))) {
      numbers.push_back(number(block));
      kervan::dds::release(block);
    }
    return numbers;
  }
};

TEST_F(SampleCacheTest, KeepsTheLastSamplesOfEachInstance) {
  SampleCache cache({.depth = 2}, kervan::forever, true);
  cache.take(at(0s));  // from now on lost samples count
  cache.stage({sample(1, 0s, 7), sample(2, 0s, 7), sample(10, 0s, 8), sample(3, 0s, 7)});
  EXPECT_EQ(take_all(cache, 0s), (std::vector{2, 10, 3}));
  EXPECT_EQ(cache.counters().overwritten, 1u);
  EXPECT_EQ(cache.counters().handled, 3u);
}

TEST_F(SampleCacheTest, DepthZeroKeepsAll) {
  SampleCache cache({.depth = 0}, kervan::forever, false);
  for (int i = 0; i < 1000; ++i) cache.stage({sample(i, 0s)});
  EXPECT_EQ(take_all(cache, 0s).size(), 1000u);
}

TEST_F(SampleCacheTest, APortThatOnlyLooksAtTheNewestLosesNothingAndDoesNotGrow) {
  SampleCache cache({.depth = 1}, kervan::forever, false);
  for (int i = 0; i < 10000; ++i) cache.stage({sample(i, 0s)});
  EXPECT_EQ(number(cache.latest(at(0s))), 9999);
  EXPECT_EQ(cache.counters().overwritten, 0u);
}

TEST_F(SampleCacheTest, AnExpiredSampleIsNeitherHandedOutNorTheLatest) {
  SampleCache cache({.depth = 5, .lifespan = 100ms}, kervan::forever, false);
  cache.stage({sample(1, 0ms), sample(2, 50ms)});
  EXPECT_EQ(number(cache.latest(at(149ms))), 2);
  EXPECT_EQ(cache.latest(at(150ms)), nullptr);
  EXPECT_EQ(take_all(cache, 120ms), (std::vector{2}));
  EXPECT_EQ(cache.counters().expired, 1u);
}

TEST_F(SampleCacheTest, MaxAgeHidesTheLatestButStillHandsItOut) {
  SampleCache cache({.depth = 5}, 100ms, false);
  cache.stage({sample(1, 0ms)});
  EXPECT_NE(cache.latest(at(100ms)), nullptr);
  EXPECT_EQ(cache.latest(at(101ms)), nullptr);
  EXPECT_EQ(take_all(cache, 1s), (std::vector{1}));
}

TEST_F(SampleCacheTest, CountsEveryMissedDeadlineOfEveryInstance) {
  SampleCache cache({.deadline = 100ms}, kervan::forever, true);
  EXPECT_EQ(cache.next_deadline(), Time::max());
  cache.stage({sample(1, 0ms, 1), sample(2, 50ms, 2)});
  EXPECT_EQ(cache.next_deadline(), at(100ms));
  EXPECT_FALSE(cache.check_deadlines(at(99ms)));
  EXPECT_TRUE(cache.check_deadlines(at(100ms)));
  EXPECT_EQ(cache.counters().deadline_missed, 1u);
  EXPECT_EQ(cache.next_deadline(), at(150ms));
  cache.check_deadlines(at(300ms));
  EXPECT_EQ(cache.counters().deadline_missed, 3u + 3u - 1u);  // 100, 200, 300 ms and 150, 250 ms
}

TEST_F(SampleCacheTest, TheStrongestWriterOwnsAnInstanceUntilItGoesOrMissesItsDeadline) {
  SampleCache cache({.depth = 10, .deadline = 100ms, .ownership = kervan::Ownership::exclusive}, kervan::forever, true);
  cache.stage({sample(1, 0ms, 1, 0, 5), sample(2, 0ms, 1, 1, 9), sample(3, 0ms, 1, 0, 5)});
  EXPECT_EQ(take_all(cache, 0ms), (std::vector{1, 2}));
  EXPECT_EQ(cache.counters().not_owner, 1u);
  cache.writer_gone(1);
  cache.stage({sample(4, 10ms, 1, 0, 5)});
  EXPECT_EQ(take_all(cache, 10ms), (std::vector{4}));
  cache.stage({sample(5, 20ms, 1, 1, 9)});
  cache.check_deadlines(at(120ms));
  cache.stage({sample(6, 121ms, 1, 0, 5)});
  EXPECT_EQ(take_all(cache, 121ms), (std::vector{5, 6}));
}

TEST_F(SampleCacheTest, BeyondTheLimitTheNewestIsRefusedAndCounted) {
  SampleCache cache({.depth = 0, .limit = 3}, kervan::forever, true, true);
  cache.stage({sample(1, 0s, 1), sample(2, 0s, 2), sample(3, 0s, 1), sample(4, 0s, 1), sample(5, 0s, 3)});
  EXPECT_EQ(take_all(cache, 0s), (std::vector{1, 2, 3}));
  EXPECT_EQ(cache.counters().refused, 2u);
  cache.stage({sample(6, 1s, 1)});
  EXPECT_EQ(take_all(cache, 1s), (std::vector{6}));
  EXPECT_EQ(cache.counters().handled, 4u);
}

TEST_F(SampleCacheTest, APortThatOnlyLooksAtTheNewestGetsItWhateverTheLimit) {
  SampleCache cache({.depth = 0, .limit = 3}, kervan::forever, false);
  for (int i = 0; i < 10; ++i) cache.stage({sample(i, 0s)});
  EXPECT_EQ(number(cache.latest(at(0s))), 9);
  EXPECT_EQ(cache.counters().refused, 0u);
}

TEST_F(SampleCacheTest, AWriterThatIsSilentForALeaseIsLostUntilItIsHeardOfAgain) {
  SampleCache cache({.depth = 10,
                     .liveliness = kervan::Liveliness::manual,
                     .lease = 100ms,
                     .ownership = kervan::Ownership::exclusive},
                    kervan::forever, false, true, true);
  EXPECT_EQ(cache.next_deadline(), Time::max());
  cache.stage({sample(1, 0ms, 1, 4, 9), sample(2, 20ms, 1, 7, 5)});
  EXPECT_EQ(cache.next_deadline(), at(100ms));
  EXPECT_FALSE(cache.check_deadlines(at(99ms)));
  EXPECT_TRUE(cache.check_deadlines(at(100ms)));
  EXPECT_EQ(cache.counters().liveliness_lost, 1u);
  EXPECT_EQ(cache.next_deadline(), at(120ms));
  cache.stage({sample(3, 110ms, 1, 7, 5)});  // the weaker one takes over
  cache.stage({sample(4, 130ms, 1, 4, 9)});  // the stronger one is back
  EXPECT_EQ(take_all(cache, 130ms), (std::vector{1, 3, 4}));
  EXPECT_EQ(cache.next_deadline(), at(210ms));
  EXPECT_TRUE(cache.check_deadlines(at(1s)));
  EXPECT_EQ(cache.counters().liveliness_lost, 3u);
  EXPECT_FALSE(cache.check_deadlines(at(2s))) << "a lost writer is counted once";
}

TEST_F(SampleCacheTest, AWriterThatEndedIsNotMissed) {
  SampleCache cache({.liveliness = kervan::Liveliness::manual, .lease = 100ms}, kervan::forever, false, true, true);
  cache.stage({sample(1, 0ms, 1, 4)});
  cache.writer_gone(4);
  EXPECT_FALSE(cache.check_deadlines(at(1s)));
  EXPECT_EQ(cache.counters().liveliness_lost, 0u);
}

TEST_F(SampleCacheTest, LeavesTheLeaseToWhoeverElseWatchesIt) {
  SampleCache cache({.liveliness = kervan::Liveliness::manual, .lease = 100ms}, kervan::forever, false, true);
  cache.stage({sample(1, 0ms, 1, 4)});
  EXPECT_EQ(cache.next_deadline(), Time::max());
  cache.writer_lost(4);
  EXPECT_EQ(cache.counters().liveliness_lost, 1u);
}

TEST_F(SampleCacheTest, InstancesStandInTheOrderOfTheirFirstSample) {
  SampleCache cache({.depth = 1}, kervan::forever, true);
  cache.stage({sample(3, 0s, 9), sample(1, 0s, 2), sample(2, 0s, 5), sample(4, 1s, 9)});
  std::vector<int> numbers;
  for (const auto* block : cache.instances(at(1s))) numbers.push_back(number(block));
  EXPECT_EQ(numbers, (std::vector{4, 1, 2}));
  EXPECT_EQ(number(cache.latest(at(1s))), 4);
}

TEST_F(SampleCacheTest, EquallyStrongWritersAreToldApartByTheirPlaceInTheComposition) {
  SampleCache cache({.depth = 10, .ownership = kervan::Ownership::exclusive}, kervan::forever, false);
  cache.stage({sample(1, 0ms, 1, 3, 5), sample(2, 0ms, 1, 2, 5), sample(3, 0ms, 1, 3, 5)});
  EXPECT_EQ(take_all(cache, 0ms), (std::vector{1, 2}));
}

}  // namespace
