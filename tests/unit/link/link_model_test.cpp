// Links do what they are asked, to the packet: 10,000 packets and more, no network, no clock.
#include "deploy/lab/link/link_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace kervan::link {
namespace {

using namespace std::chrono_literals;
using composition::LinkSettings;

constexpr int kPackets = 10000;
constexpr std::size_t kSize = 200;

struct Sent {
  Duration at{};
  Decision decision;
};

/// Packets of one size, one every `period`.
std::vector<Sent> send(LinkModel& model, int packets = kPackets, Duration period = 1ms, std::size_t size = kSize) {
  std::vector<Sent> sent;
  for (int i = 0; i < packets; ++i) sent.push_back({i * period, model.decide(size, i * period)});
  return sent;
}

/// In order of their sizes, seconds.
std::vector<double> delays(const std::vector<Sent>& sent) {
  std::vector<double> delays;
  for (const Sent& one : sent)
    if (one.decision.copies > 0) delays.push_back(seconds(one.decision.deliveries[0].at - one.at));
  std::ranges::sort(delays);
  return delays;
}

double percentile(const std::vector<double>& sorted, double share) {
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

double delivered_share(const LinkModel& model) {
  return static_cast<double>(model.counters().delivered) / static_cast<double>(model.counters().packets);
}

bool same(const std::vector<Sent>& a, const std::vector<Sent>& b) {
  return std::ranges::equal(a, b, [](const Sent& x, const Sent& y) {
    if (x.decision.fate != y.decision.fate || x.decision.copies != y.decision.copies) return false;
    for (std::size_t i = 0; i < x.decision.copies; ++i)
      if (x.decision.deliveries[i].at != y.decision.deliveries[i].at ||
          x.decision.deliveries[i].flip != y.decision.deliveries[i].flip)
        return false;
    return true;
  });
}

TEST(LinkModel, DeliversEverythingAtOnceUnlessItIsAskedForSomethingElse) {
  LinkModel model({}, 1, "a>b");
  for (const Sent& one : send(model)) {
    ASSERT_EQ(one.decision.copies, 1u);
    ASSERT_EQ(one.decision.deliveries[0].at, one.at);
    ASSERT_FALSE(one.decision.deliveries[0].flip);
  }
  EXPECT_EQ(model.counters().delivered_bytes, kPackets * kSize);
  EXPECT_EQ(model.counters().delayed, 0u);
}

TEST(LinkModel, LosesTheShareThatIsAskedFor) {
  for (const double loss : {1.0, 5.0, 20.0, 40.0, 100.0})
    for (const std::uint64_t seed : {1, 2, 3}) {
      LinkModel model({.loss = loss}, seed, "a>b");
      send(model);
      EXPECT_NEAR(delivered_share(model), 1.0 - loss / 100.0, 0.02) << loss << " %, seed " << seed;
      EXPECT_EQ(model.counters().lost + model.counters().delivered, kPackets);
    }
}

TEST(LinkModel, LosesInBurstsOfTheLengthThatIsAskedFor) {
  // A burst counts as one packet in the statistics of its kind, so there are more packets here.
  LinkModel model({.burst_loss = 10.0, .burst_length = 5.0}, 1, "a>b");
  const auto sent = send(model, 20 * kPackets);
  int bursts = 0, lost = 0;
  for (std::size_t i = 0; i < sent.size(); ++i) {
    if (sent[i].decision.fate != Fate::lost_in_burst) continue;
    ++lost;
    if (i == 0 || sent[i - 1].decision.fate != Fate::lost_in_burst) ++bursts;
  }
  EXPECT_NEAR(delivered_share(model), 0.9, 0.01);
  EXPECT_NEAR(static_cast<double>(lost) / bursts, 5.0, 0.15);
  EXPECT_EQ(model.counters().lost_in_burst, static_cast<std::uint64_t>(lost));
}

TEST(LinkModel, LosesOnlySomePacketsOfABurstIfItIsAskedTo) {
  LinkModel model({.burst_loss = 10.0, .burst_length = 20.0, .loss_in_burst = 50.0}, 1, "a>b");
  send(model, 20 * kPackets);
  EXPECT_NEAR(delivered_share(model), 0.9, 0.01);
}

TEST(LinkModel, DelaysByTheTimeThatIsAskedForGiveOrTakeTheJitter) {
  LinkModel model({.delay = 50ms, .jitter = 20ms}, 1, "a>b");
  const auto found = delays(send(model));
  for (const double share : {0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99}) {
    const double wanted = 0.030 + share * 0.040;
    EXPECT_NEAR(percentile(found, share), wanted, 0.02 * wanted) << share;
  }
  EXPECT_GE(found.front(), 0.030);
  EXPECT_LE(found.back(), 0.070);
}

TEST(LinkModel, LetsPacketsWithJitterOvertakeEachOtherUnlessTheirOrderIsKept) {
  LinkSettings settings{.delay = 50ms, .jitter = 20ms};
  LinkModel free(settings, 1, "a>b");
  send(free);
  EXPECT_GT(free.counters().reordered, 1000u);
  settings.keep_order = true;
  LinkModel kept(settings, 1, "a>b");
  Duration last{};
  for (const Sent& one : send(kept)) {
    EXPECT_GE(one.decision.deliveries[0].at, last);
    last = one.decision.deliveries[0].at;
  }
  EXPECT_EQ(kept.counters().reordered, 0u);
}

TEST(LinkModel, PassesNoMoreThanItsRateAndKeepsItsQueueShort) {
  // Twice what the link can carry: 2000 bytes a millisecond over 8 Mbit/s.
  LinkModel model({.rate = 8e6, .queue = 20e3}, 1, "a>b");
  const auto sent = send(model, kPackets, 500us, 1000);
  const auto found = delays(sent);
  const double time = seconds(sent.back().at);
  EXPECT_NEAR(static_cast<double>(model.counters().delivered_bytes) * 8.0 / time, 8e6, 0.02 * 8e6);
  EXPECT_EQ(model.counters().queue_full + model.counters().delivered, kPackets);
  EXPECT_LE(found.back(), 0.021 + 1e-9) << "20 kB and the packet itself take 21 ms";
  EXPECT_NEAR(found.front(), 0.001, 1e-9);
}

TEST(LinkModel, TakesOnlyThePacketsOwnTimeWhereTheRateIsEnough) {
  LinkModel model({.rate = 8e6}, 1, "a>b");
  for (const double delay : delays(send(model, kPackets, 2ms, 1000))) EXPECT_NEAR(delay, 0.001, 1e-9);
}

TEST(LinkModel, DuplicatesAndCorruptsTheSharesThatAreAskedFor) {
  LinkModel model({.duplicate = 10.0, .corrupt = 5.0}, 1, "a>b");
  std::vector<std::uint32_t> flips;
  for (const Sent& one : send(model))
    for (std::size_t copy = 0; copy < one.decision.copies; ++copy)
      if (one.decision.deliveries[copy].flip) flips.push_back(*one.decision.deliveries[copy].flip % 1600);
  const double copies = kPackets + static_cast<double>(model.counters().duplicated);
  EXPECT_NEAR(static_cast<double>(model.counters().duplicated) / kPackets, 0.10, 0.01);
  EXPECT_NEAR(static_cast<double>(model.counters().corrupted) / copies, 0.05, 0.01);
  EXPECT_EQ(model.counters().corrupted, flips.size());
  EXPECT_GT(*std::ranges::max_element(flips) - *std::ranges::min_element(flips), 1400u) << "bits all over the packet";
}

TEST(LinkModel, LetsTheShareThatIsAskedForSkipTheDelay) {
  LinkModel model({.delay = 10ms, .reorder = 25.0}, 1, "a>b");
  const auto sent = send(model);
  const auto skipped = std::ranges::count_if(sent, [](const Sent& s) { return s.decision.deliveries[0].at == s.at; });
  EXPECT_NEAR(static_cast<double>(skipped) / kPackets, 0.25, 0.02);
  EXPECT_NEAR(static_cast<double>(model.counters().reordered), static_cast<double>(skipped), 10.0);
}

TEST(LinkModel, PassesNothingWhileItIsDownCountedFromTheBeginning) {
  LinkModel model({.down = {{2s, 3s}, {5s, 5500ms}}}, 1, "a>b");
  EXPECT_EQ(model.decide(kSize, 2500ms).fate, Fate::delivered) << "nothing has begun";
  model.begin(10s);
  std::vector<int> lost_ms;
  for (int ms = 0; ms < 8000; ms += 100)
    if (model.decide(kSize, 10s + std::chrono::milliseconds(ms)).fate == Fate::down) lost_ms.push_back(ms);
  EXPECT_EQ(lost_ms, (std::vector<int>{2000, 2100, 2200, 2300, 2400, 2500, 2600, 2700, 2800, 2900, 5000, 5100, 5200,
                                       5300, 5400}));
  EXPECT_EQ(model.counters().down, lost_ms.size());
}

const LinkSettings everything{.loss = 5.0,
                              .burst_loss = 5.0,
                              .delay = 20ms,
                              .jitter = 10ms,
                              .rate = 2e6,
                              .duplicate = 2.0,
                              .reorder = 3.0,
                              .corrupt = 2.0};

TEST(LinkModel, DoesTheSameToTheSamePacketsAndSomethingElseWithAnotherSeedOrName) {
  LinkModel first(everything, 7, "a>b"), again(everything, 7, "a>b"), seed(everything, 8, "a>b"),
      back(everything, 7, "b>a");
  const auto sent = send(first);
  EXPECT_TRUE(same(sent, send(again)));
  EXPECT_EQ(first.counters(), again.counters());
  EXPECT_FALSE(same(sent, send(seed)));
  EXPECT_FALSE(same(sent, send(back)));
}

TEST(LinkModel, LosesTheSamePacketsWhateverElseItDoes) {
  const auto numbers_of_lost = [](LinkSettings settings) {
    LinkModel model(settings, 3, "a>b");
    std::vector<int> lost;
    const auto sent = send(model);
    for (int i = 0; i < kPackets; ++i)
      if (sent[static_cast<std::size_t>(i)].decision.fate == Fate::lost) lost.push_back(i);
    return lost;
  };
  EXPECT_EQ(numbers_of_lost({.loss = 10.0}),
            numbers_of_lost({.loss = 10.0, .delay = 9ms, .jitter = 5ms, .duplicate = 9.0, .corrupt = 9.0}));
}

TEST(ShippedProfiles, AreWithoutContradictionAndLoseWhatTheySay) {
  for (const composition::LinkProfile& profile : composition::shipped_link_profiles()) {
    EXPECT_FALSE(composition::contradiction(profile.settings)) << profile.name;
    LinkModel model(profile.settings, 1, "a>b");
    send(model, 10 * kPackets, 10ms);
    const double wanted = (1.0 - profile.settings.loss / 100.0) * (1.0 - profile.settings.burst_loss / 100.0);
    EXPECT_NEAR(delivered_share(model), wanted, 0.01) << profile.name;
  }
}

}  // namespace
}  // namespace kervan::link
