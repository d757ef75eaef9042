// One composition on two hosts that nothing but a cable without multicast joins.
#include <gtest/gtest.h>

#include <fstream>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "tests/deploy/supervised.hpp"
#include "tests/network/host.hpp"
#include "tests/program/eventually.hpp"

namespace kervan::test {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

/// `kervan run F --host NAME` on a host, in a folder of its own.
class RunOnHost {
 public:
  RunOnHost(const Host& host, const std::string& name, const std::string& composition) {
    std::ofstream(folder_.path() / "c.yaml") << composition;
    process_.emplace(
        host.command({"/bin/sh",
                      {"-c", "exec " KERVAN_PROGRAM " run c.yaml --json --host " + name + " 2>errors"},
                      {{"KERVAN_COMPONENT_PATH", TEST_COMPONENTS}, {"KERVAN_SHARE", KERVAN_SHARE_FOLDER}}}),
        folder_.path());
  }

  std::string said() const { return text_of(folder_.path() / "errors"); }

  /// The last line of what it prints; empty, with a failure, unless it ends with this code.
  nlohmann::json summary(int code) {
    const Result result = process_->wait();
    EXPECT_EQ(result.code, code) << said();
    const auto lines = lines_of(result.out);
    if (result.code != code || lines.empty()) return nullptr;
    return nlohmann::json::parse(lines.back());
  }

 private:
  Folder folder_;
  std::optional<Process> process_;
};

class TwoHosts : public testing::Test {
 protected:
  void SetUp() override {
    try {
      base_.emplace();
      robot_.emplace();
      base_->connect(*robot_, "cable", "10.77.0.1", "10.77.0.2");
    } catch (const NoHosts& error) {
      GTEST_SKIP() << "needs root and iproute2: " << error.what();
    }
  }

  static std::string head(const std::string& clock, const std::string& domain) {
    return "kervan: 1\nname: c\nclock: {mode: " + clock + "}\ndomain: {id: 17, " + domain + "}\n";
  }

  /// The laboratory: the world on one host, the robot in two containers on the other.
  static std::string lab(const std::string& clock, const std::string& domain) {
    std::string text = lab_over({{"sim", "[world, report, mission], host: base"},
                                 {"plan", "[r1/planner, r1/follower], host: robot"},
                                 {"drive", "[r1/control, r1/guard], host: robot"}});
    const std::string goal = "[[16.0 m, 7.8 m]]";
    const auto at = text.find(goal);
    if (at == std::string::npos) throw std::runtime_error("lab.yaml no longer has '" + goal + "'");
    return head(clock, domain) + text.replace(at, goal.size(), "[[4.0 m, 3.0 m]]");
  }

  /// Runs it to the end of the mission and returns the traces.
  std::vector<std::string> succeed(const std::string& composition) {
    RunOnHost base(*base_, "base", composition), robot(*robot_, "robot", composition);
    const nlohmann::json there = robot.summary(0), here = base.summary(0);
    if (there.is_null() || here.is_null()) return {};
    EXPECT_EQ(here["result"], "success") << here;
    EXPECT_EQ(there["result"], "success") << there;
    EXPECT_TRUE(here["robots"]["r1"]["reached"].get<bool>());
    EXPECT_EQ(here["containers"].size(), 1u);
    EXPECT_EQ(there["containers"].size(), 2u);
    return {here["trace_hash"], there["trace_hash"]};
  }

  std::optional<Host> base_, robot_;
};

const std::string addresses = "hosts: {base: {address: 10.77.0.1}, robot: {address: 10.77.0.2}}";

TEST_F(TwoHosts, HaveTheTraceOfOneContainerUnderLockstepWhateverTheyAreFoundBy) {
  const Folder folder;
  std::ofstream(folder.path() / "c.yaml") << lab("lockstep", addresses);
  const Result alone = run({KERVAN_PROGRAM,
                            {"run", "c.yaml", "--json", "--place", "all"},
                            {{"KERVAN_COMPONENT_PATH", TEST_COMPONENTS}, {"KERVAN_SHARE", KERVAN_SHARE_FOLDER}}},
                           folder.path());
  ASSERT_EQ(alone.code, 0) << alone.err;
  const std::string trace = nlohmann::json::parse(lines_of(alone.out).back())["trace_hash"];
  const std::vector<std::string> domains = {addresses, "multicast: false, " + addresses,
                                            "multicast: false, hosts: {base: {interface: cable, address: 10.77.0.1}, "
                                            "robot: {interface: cable, address: 10.77.0.2}}"};
  for (const std::string& domain : domains)
    EXPECT_EQ(succeed(lab("lockstep", domain)), std::vector<std::string>(2, trace)) << domain;
}

TEST_F(TwoHosts, SucceedUnderTheTimeOfASimulatorOnOneOfThem) { succeed(lab("sim, pace: 2x", addresses)); }

/// A beacon on each host, hearing the other one; they never come to an end.
const std::string beacons =
    "components:\n"
    "  a: {type: test/beacon, remap: {in: b/out}}\n"
    "  b: {type: test/beacon, remap: {in: a/out}}\n"
    "containers: {one: {host: base, components: [a]}, two: {host: robot, components: [b]}}\n";

TEST_F(TwoHosts, EachNameTheOtherWhenTheCableIsCutUnderLockstep) {
  const std::string composition = head("lockstep", addresses) + beacons;
  RunOnHost base(*base_, "base", composition), robot(*robot_, "robot", composition);
  for (const RunOnHost* run : {&base, &robot})
    ASSERT_TRUE(eventually([&] { return run->said().find("heard ") != std::string::npos; })) << run->said();
  const auto start = Clock::now();
  base_->ip("link set dev cable down");
  const std::string here = base.summary(1)["reason"], there = robot.summary(1)["reason"];
  std::cout << "both ended after " << std::chrono::duration<double>(Clock::now() - start).count() << " s\n";
  EXPECT_TRUE(here.starts_with("container 'two' died or stopped; the run was at t = ")) << here;
  EXPECT_TRUE(there.starts_with("container 'one' died or stopped; the run was at t = ")) << there;
}

}  // namespace
}  // namespace kervan::test
