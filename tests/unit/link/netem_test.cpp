// How a link's settings read in tc's language, and how tc's counters read.
#include "deploy/lab/link/netem.hpp"

#include <gtest/gtest.h>

namespace kervan::link {
namespace {

using namespace std::chrono_literals;
using composition::LinkSettings;

std::string line(const LinkSettings& settings) {
  std::string line;
  for (const std::string& word : netem_arguments(settings)) line += (line.empty() ? "" : " ") + word;
  return line;
}

std::string refusal(const LinkSettings& settings) {
  try {
    return line(settings);
  } catch (const ConfigError& error) {
    return error.what();
  }
}

TEST(Netem, IsToldWhatALinkIsLike) {
  EXPECT_EQ(line({}), "limit 100000");
  EXPECT_EQ(line({.loss = 20.0, .delay = 50ms, .jitter = 10ms}), "limit 100000 delay 50000us 10000us loss random 20%");
  EXPECT_EQ(line({.rate = 2e6, .queue = 15140}), "limit 10 rate 2000000bit");
  EXPECT_EQ(line({.delay = 1ms, .duplicate = 1.0, .reorder = 25.0, .corrupt = 0.1}),
            "limit 100000 delay 1000us corrupt 0.1% duplicate 1% reorder 25%");
}

TEST(Netem, IsToldOfBurstsByTheProbabilitiesOfGilbertAndElliott) {
  // One packet in ten in bursts of five: out of them at 1/5, into them at 1/45; beside them one in a hundred is lost.
  EXPECT_EQ(line({.loss = 1.0, .burst_loss = 10.0, .burst_length = 5.0}),
            "limit 100000 loss gemodel 2.22222% 20% 100% 1%");
}

TEST(Netem, RefusesWhatItCannotDo) {
  EXPECT_EQ(refusal({.down = {{1s, 2s}}}), "netem knows no schedule; leave --down out, or --netem");
  EXPECT_EQ(refusal({.delay = 5ms, .jitter = 1ms, .keep_order = true}),
            "netem lets packets with jitter overtake each other; leave --keep-order out, or --netem");
}

TEST(Netem, CountsWhatPassedAndWhatDidNot) {
  const LinkCounters counters =
      netem_counters(R"([{"kind":"netem","handle":"8001:","root":true,"refcnt":2,"options":{"limit":1000},)"
                     R"("bytes":80400,"packets":804,"drops":196,"overlimits":0,"requeues":0,"backlog":0,"qlen":0}])");
  EXPECT_EQ(counters.packets, 1000u);
  EXPECT_EQ(counters.delivered, 804u);
  EXPECT_EQ(counters.lost, 196u);
  EXPECT_EQ(counters.delivered_bytes, 80400u);
  EXPECT_THROW(netem_counters(R"([{"kind":"noqueue"}])"), std::runtime_error);
  EXPECT_THROW(netem_counters("no JSON"), std::runtime_error);
}

}  // namespace
}  // namespace kervan::link
