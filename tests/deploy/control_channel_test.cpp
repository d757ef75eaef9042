#include "deploy/container/control_channel.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <csignal>

#include "framework/component/error.hpp"

namespace kervan::container {
namespace {

template <class Kind>
Kind there_and_back(const Message& message) {
  return std::get<Kind>(parse_line(to_line(message)));
}

TEST(ControlChannel, CarriesEveryKindOfMessage) {
  for (const Phase phase : {Phase::starting, Phase::constructed, Phase::matched, Phase::active})
    EXPECT_EQ(there_and_back<Phase>(phase), phase);

  const auto progress = there_and_back<Progress>(Progress{1.0 / 3.0, {0.25, 7}});
  EXPECT_EQ(progress.simulated_s, 1.0 / 3.0);
  EXPECT_EQ(progress.counters.worst_latency_s, 0.25);
  EXPECT_EQ(progress.counters.missed_deadlines, 7u);

  const auto crash = there_and_back<Crash>(Crash{SIGSEGV, "0x10", "r1/control", "a timer", 42});
  EXPECT_EQ(crash.signal, SIGSEGV);
  EXPECT_EQ(to_text(crash), "crashed: SIGSEGV at address 0x10 in r1/control (in a timer)");
  EXPECT_EQ(crash.time_ns, 42);

  const auto failure = there_and_back<Failure>(Failure{"no \"such\" thing", true});
  EXPECT_EQ(failure.message, "no \"such\" thing");
  EXPECT_TRUE(failure.configuration);
}

TEST(ControlChannel, CarriesAReportWithItsMission) {
  EndReport report;
  report.container = "brain";
  report.end = runtime::RunEnd::peer_lost;
  report.reason = "sim is gone";
  report.simulated_s = 50.5;
  report.trace_hash = 0x0123456789abcdefU;
  kervan_msgs::msg::MissionResult mission;
  mission.result = kervan_msgs::msg::MissionOutcome::MISSION_FAILED;
  mission.reason = "the time is up";
  auto& robot = mission.robots.emplace_back();
  robot.robot = "r1";
  robot.reached = true;
  robot.error_m = 0.1;
  robot.contacts = 3;
  robot.min_clearance_m = std::nan("");
  report.mission = mission;
  report.failed.push_back({"r1/control", "it threw"});
  report.counters = {0.5, 9};
  const auto back = there_and_back<EndReport>(report);
  EXPECT_EQ(back.container, "brain");
  EXPECT_EQ(back.end, runtime::RunEnd::peer_lost);
  EXPECT_EQ(back.reason, "sim is gone");
  EXPECT_EQ(back.simulated_s, 50.5);
  EXPECT_EQ(back.trace_hash, 0x0123456789abcdefU);
  ASSERT_TRUE(back.mission);
  EXPECT_EQ(back.mission->result, mission.result);
  EXPECT_EQ(back.mission->reason, mission.reason);
  ASSERT_EQ(back.mission->robots.size(), 1u);
  EXPECT_EQ(back.mission->robots[0].error_m, 0.1);
  EXPECT_EQ(back.mission->robots[0].contacts, 3u);
  EXPECT_TRUE(std::isnan(back.mission->robots[0].min_clearance_m));
  ASSERT_EQ(back.failed.size(), 1u);
  EXPECT_EQ(back.failed[0].component, "r1/control");
  EXPECT_EQ(back.counters.missed_deadlines, 9u);
}

TEST(ControlChannel, RefusesWhatItDoesNotKnow) {
  EXPECT_THROW(parse_line("hello"), ConfigError);
  EXPECT_THROW(parse_line("{}"), ConfigError);
  EXPECT_THROW(parse_line(R"({"phase":"asleep"})"), ConfigError);
  EXPECT_THROW(parse_line(R"({"report":{"container":"a","end":"somehow"}})"), ConfigError);
}

TEST(ControlChannel, CutsTheStreamIntoLines) {
  int ends[2];
  ASSERT_EQ(::pipe2(ends, O_NONBLOCK), 0);
  ControlReader reader;
  bool open = false;
  ASSERT_EQ(::write(ends[1], "one\ntw", 6), 6);
  EXPECT_EQ(reader.read_lines(ends[0], open), std::vector<std::string>{"one"});
  EXPECT_TRUE(open);
  ASSERT_EQ(::write(ends[1], "o\n", 2), 2);
  ::close(ends[1]);
  EXPECT_EQ(reader.read_lines(ends[0], open), std::vector<std::string>{"two"});
  EXPECT_FALSE(open);
  ::close(ends[0]);
}

TEST(ControlChannel, LosesProgressButNothingElseWhenNobodyReads) {
  int ends[2];
  ASSERT_EQ(::pipe2(ends, O_NONBLOCK), 0);
  ControlChannel channel(ends[1]);
  for (int i = 0; i < 10000; ++i) channel.send(Progress{});
  ControlReader reader;
  bool open = false;
  const std::size_t kept = reader.read_lines(ends[0], open).size();
  EXPECT_GT(kept, 0u);
  EXPECT_LT(kept, 10000u);
  channel.send(Phase::active);
  EXPECT_EQ(reader.read_lines(ends[0], open).size(), 1u);
  ::close(ends[0]);
  ::close(ends[1]);
}

}  // namespace
}  // namespace kervan::container
