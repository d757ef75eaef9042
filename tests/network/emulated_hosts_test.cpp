// One composition on hosts that `kervan run --emulate-hosts` makes.
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <set>

#include "tests/deploy/supervised.hpp"
#include "tests/network/host.hpp"
#include "tests/program/eventually.hpp"

namespace kervan::test {
namespace {

namespace fs = std::filesystem;

const std::string kHosts = "{base: {address: 10.0.0.1}, robot: {}}";

class EmulatedHosts : public testing::Test {
 protected:
  void SetUp() override {
    try {
      const Host host;
    } catch (const NoHosts& error) {
      GTEST_SKIP() << "needs root: " << error.what();
    }
  }
};

/// The laboratory: the world on one host, the robot in two containers on the other. The way is short.
std::string lab(const std::string& links) {
  std::string text = lab_over({{"sim", "[world, report, mission], host: base"},
                               {"plan", "[r1/planner, r1/follower], host: robot"},
                               {"drive", "[r1/control, r1/guard], host: robot"}});
  const std::string goal = "[[16.0 m, 7.8 m]]";
  const auto at = text.find(goal);
  if (at == std::string::npos) throw std::runtime_error("lab.yaml no longer has '" + goal + "'");
  return text.replace(at, goal.size(), "[[4.0 m, 3.0 m]]") + links;
}

/// A beacon on each host, hearing the other one; they never come to an end.
std::string beacons(const std::string& links = "") {
  return "components:\n"
         "  a: {type: test/beacon, remap: {in: b/out}}\n"
         "  b: {type: test/beacon, remap: {in: a/out}}\n"
         "containers: {one: {host: base, components: [a]}, two: {host: robot, components: [b]}}\n" +
         links;
}

std::string network_of(pid_t pid) {
  std::error_code gone;
  return fs::read_symlink("/proc/" + std::to_string(pid) + "/ns/net", gone).string();
}

/// The processes in these network namespaces.
std::vector<pid_t> processes_in(const std::set<std::string>& networks) {
  std::vector<pid_t> found;
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const std::string pid = entry.path().filename();
    if (pid.find_first_not_of("0123456789") == std::string::npos && networks.contains(network_of(std::stoi(pid))))
      found.push_back(std::stoi(pid));
  }
  return found;
}

/// The child of `parent` that moves the packets.
pid_t mover_of(pid_t parent) {
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const std::string pid = entry.path().filename();
    if (pid.find_first_not_of("0123456789") != std::string::npos) continue;
    const std::string stat = text_of(entry.path() / "stat");
    if (stat.find("(kervan-network) ") == std::string::npos) continue;
    if (stat.find(") S " + std::to_string(parent) + " ") != std::string::npos ||
        stat.find(") R " + std::to_string(parent) + " ") != std::string::npos)
      return std::stoi(pid);
  }
  return -1;
}

TEST_F(EmulatedHosts, HaveTheTraceOfOneContainerUnderLockstepWhateverTheNetworkLoses) {
  Supervised alone(lab(""), "lockstep", "--place all", kHosts);
  ASSERT_EQ(alone.wait().code, 0) << alone.said();
  const std::string links = "links: {pairs: [{between: [base, robot], loss: 0.5 %}]}\n";
  Supervised apart(lab(links), "lockstep", "--emulate-hosts", kHosts);
  ASSERT_EQ(apart.wait().code, 0) << apart.said();
  EXPECT_EQ(apart.summary()["trace_hash"], alone.summary()["trace_hash"]);
  const auto passed = apart.summary()["links"];
  ASSERT_EQ(passed.size(), 2u);
  EXPECT_EQ(passed[0]["from"], "base");
  EXPECT_EQ(passed[0]["to"], "robot");
  for (const auto& one : passed) {
    EXPECT_GT(one["delivered"].get<int>(), 100) << one;
    EXPECT_GT(one["lost"].get<int>(), 0) << one;
  }
}

TEST_F(EmulatedHosts, SucceedOverAWirelessLinkUnderTheSimulatorsTime) {
  Supervised run(lab("links: {profile: wifi}\n"), "sim, pace: 2x", "--emulate-hosts", kHosts);
  EXPECT_EQ(run.wait().code, 0) << run.said();
  EXPECT_TRUE(run.summary()["robots"]["r1"]["reached"].get<bool>()) << run.said();
}

TEST_F(EmulatedHosts, CannotHearEachOtherDuringAnOutage) {
  Supervised run(beacons("links: {profile: ethernet, pairs: [{between: [base, robot], down: [0s..600s]}]}\n"), "wall",
                 "--emulate-hosts --for 2s", kHosts);
  run.wait();
  const nlohmann::json summary = run.summary();
  for (const auto& one : summary["links"]) {
    EXPECT_GT(one["down"].get<int>(), 0) << one;
    EXPECT_GT(one["delivered"].get<int>(), 0) << "they found each other before the schedule began: " << one;
  }
}

TEST_F(EmulatedHosts, LeaveNothingBehindWhenTheSupervisorIsKilled) {
  for (int round = 0; round < number_from("KERVAN_KILL_ROUNDS", 3); ++round) {
    Supervised run(beacons(), "wall", "--emulate-hosts", kHosts);
    run.wait_for("heard ");
    std::set<std::string> networks;
    for (const auto& [name, pid] : run.containers()) networks.insert(network_of(pid));
    ASSERT_EQ(networks.size(), 2u);
    ASSERT_FALSE(networks.contains(network_of(::getpid())));
    run.signal(SIGKILL);
    run.wait_until_nobody_lives();
    EXPECT_EQ(processes_in(networks), std::vector<pid_t>()) << "round " << round;
  }
}

TEST_F(EmulatedHosts, EndWithAReasonWhenWhatMovesThePacketsDies) {
  Supervised run(beacons(), "wall", "--emulate-hosts", kHosts);
  run.wait_for("heard ");
  const pid_t mover = mover_of(run.pid());
  ASSERT_GT(mover, 0);
  ::kill(mover, SIGKILL);
  EXPECT_EQ(run.wait().code, 1) << run.said();
  EXPECT_EQ(run.summary()["reason"], "the emulated network died");
}

TEST_F(EmulatedHosts, NeedPermission) {
  Folder folder;
  fs::permissions(folder.path(), fs::perms::all);
  const std::string text =
      "kervan: 1\nname: c\nclock: {mode: wall}\ndomain: {id: 91, hosts: " + kHosts + "}\n" + beacons();
  const std::string line = "cat > c.yaml <<'EOF'\n" + text + "EOF\n" +
                           "exec setpriv --reuid=65534 --regid=65534 --clear-groups " KERVAN_PROGRAM
                           " run c.yaml --emulate-hosts";
  const Result result = run(
      Command{
          "/bin/sh", {"-c", line}, {{"KERVAN_COMPONENT_PATH", TEST_COMPONENTS}, {"KERVAN_SHARE", KERVAN_SHARE_FOLDER}}},
      folder.path());
  EXPECT_EQ(result.code, 2) << result.out;
  EXPECT_NE(result.err.find("no network namespace can be made: Operation not permitted; network namespaces and their "
                            "interfaces need root, or CAP_SYS_ADMIN and CAP_NET_ADMIN\n"),
            std::string::npos)
      << result.err;
}

}  // namespace
}  // namespace kervan::test
