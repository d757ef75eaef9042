// `kervan link` between two network namespaces, over which the test itself sends packets.
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "deploy/lab/link/ethernet_switch.hpp"
#include "tests/deploy/supervised.hpp"
#include "tests/network/endpoint.hpp"
#include "tests/network/host.hpp"
#include "tests/program/eventually.hpp"

namespace kervan::test {
namespace {

using composition::LinkSettings;

constexpr std::size_t kSize = 200;
constexpr std::size_t kOnTheWire = kSize + Endpoint::kHeaders;

class TwoNamespaces : public testing::Test {
 protected:
  void SetUp() override {
    try {
      a_.emplace();
      b_.emplace();
    } catch (const NoHosts& error) {
      GTEST_SKIP() << "needs root and iproute2: " << error.what();
    }
    // So that nothing but what the test sends comes over the link; where there is no IPv6, that is so anyway.
    for (Host* host : {&*a_, &*b_})
      run(host->command({"/bin/sh", {"-c", "echo 1 > /proc/sys/net/ipv6/conf/default/disable_ipv6"}}), folder_.path());
  }

  /// Begins, and returns when packets can pass.
  void link(const std::string& options) {
    const std::string line =
        "exec " KERVAN_PROGRAM " link " + a_->network() + " " + b_->network() + " --json " + options + " 2>errors";
    std::filesystem::remove(folder_.path() / "errors");
    process_.emplace(Command{"/bin/sh", {"-c", line}}, folder_.path());
    ASSERT_TRUE(eventually([&] { return said().find(" are joined by ") != std::string::npos; })) << said();
    // Whoever looks for a neighbour sends packets, too.
    a_->ip("neigh replace 10.77.0.2 lladdr 02:6b:76:6e:00:02 dev link0");
    b_->ip("neigh replace 10.77.0.1 lladdr 02:6b:76:6e:00:01 dev link0");
  }

  std::string said() const { return text_of(folder_.path() / "errors"); }

  /// What passed from A to B, once the program has ended at Ctrl-C.
  nlohmann::json end() {
    process_->signal(SIGINT);
    const Result result = process_->wait();
    EXPECT_EQ(result.code, 130) << said();
    return nlohmann::json::parse(lines_of(result.out).back())["links"][0];
  }

  /// Sends packets one after the other, no more at a time than the kernel keeps, and returns which of them came.
  /// `model` says how many will.
  std::set<std::uint32_t> send(std::uint32_t packets, link::LinkModel model) {
    const Endpoint from = at(*a_, "10.77.0.1"), to = at(*b_, "10.77.0.2");
    std::set<std::uint32_t> came;
    std::size_t will_come = 0;
    for (std::uint32_t i = 0; i < packets; ++i) {
      from.send({i}, kSize, "10.77.0.2");
      will_come += model.decide(kOnTheWire, {}).copies;
      if (i % 50 != 49 && i + 1 != packets) continue;
      for (; will_come > 0; --will_come) {
        const auto packet = to.receive(kPatience);
        if (!packet) {
          ADD_FAILURE() << will_come << " packets are missing when " << i + 1 << " were sent";
          return came;
        }
        came.insert(packet->number);
      }
    }
    return came;
  }

  static Endpoint at(const Host& host, const std::string& address) {
    return Endpoint(link::NetworkNamespace::open(host.network()), address);
  }

  bool has_interface(const Host& host) const {
    return run(host.command({"/bin/sh", {"-c", "PATH=$PATH:/usr/sbin:/sbin exec ip link show link0"}}), folder_.path())
               .code == 0;
  }

  Folder folder_;
  std::optional<Host> a_, b_;
  std::optional<Process> process_;
};

TEST_F(TwoNamespaces, LoseThePacketsThatTheSeedSays) {
  link("--loss '20 %' --burst-loss '5 %' --seed 7");
  link::LinkModel model({.loss = 20.0, .burst_loss = 5.0}, 7, "A>B");
  const auto came = send(10000, model);
  std::set<std::uint32_t> expected;
  for (std::uint32_t i = 0; i < 10000; ++i)
    if (model.decide(kOnTheWire, {}).copies > 0) expected.insert(i);
  EXPECT_EQ(came, expected);
  EXPECT_NEAR(static_cast<double>(came.size()), 10000 * 0.8 * 0.95, 0.02 * 10000);
  const auto passed = end();
  EXPECT_EQ(passed["from"], a_->network());
  EXPECT_EQ(passed["packets"], 10000);
  EXPECT_EQ(passed["delivered"], came.size());
  EXPECT_EQ(passed["lost"].get<std::size_t>() + passed["lost_in_burst"].get<std::size_t>(), 10000 - came.size());
}

TEST_F(TwoNamespaces, GetPacketsTwice) {
  link("--duplicate '30 %'");
  send(1000, link::LinkModel({.duplicate = 30.0}, 1, "A>B"));
  EXPECT_NEAR(end()["duplicated"].get<double>(), 300.0, 50.0);
}

TEST_F(TwoNamespaces, RefuseWhatWasCorruptedByItsChecksum) {
  link("--corrupt '100 %'");
  const Endpoint from = at(*a_, "10.77.0.1");
  for (std::uint32_t i = 0; i < 20; ++i) from.send({i}, kSize, "10.77.0.2");
  // The kernel fills the checksum in, so whatever comes has passed it.
  ASSERT_TRUE(eventually([&] {
    const std::string counters = "grep -c . /proc/net/dev && awk '/link0/ {print $3}' /proc/net/dev";
    const auto lines = lines_of(run(b_->command({"/bin/sh", {"-c", counters}}), folder_.path()).out);
    return !lines.empty() && std::stoi(lines.back()) >= 20;
  }));
  const auto passed = end();
  EXPECT_EQ(passed["corrupted"], 20);
  EXPECT_EQ(passed["delivered"], 20);
}

TEST_F(TwoNamespaces, HearNothingOfEachOtherDuringAnOutage) {
  link("--down 0s..600s");
  const Endpoint from = at(*a_, "10.77.0.1");
  for (std::uint32_t i = 0; i < 20; ++i) from.send({i}, kSize, "10.77.0.2");
  ASSERT_TRUE(eventually([&] {
    const std::string counters = "awk '/link0/ {print $11}' /proc/net/dev";
    const auto lines = lines_of(run(a_->command({"/bin/sh", {"-c", counters}}), folder_.path()).out);
    return !lines.empty() && std::stoi(lines.back()) >= 20;
  }));
  const auto passed = end();
  EXPECT_EQ(passed["down"], 20);
  EXPECT_EQ(passed["delivered"], 0);
}

TEST_F(TwoNamespaces, AreAsBeforeWhateverEndsTheLink) {
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGKILL}) {
    link("--profile lossy");
    EXPECT_TRUE(has_interface(*a_) && has_interface(*b_));
    process_->signal(number);
    process_->wait();
    EXPECT_TRUE(eventually([&] { return !has_interface(*a_) && !has_interface(*b_); })) << "signal " << number;
  }
}

TEST_F(TwoNamespaces, EndAfterTheTimeThatIsAskedFor) {
  link("--for 100ms");
  const Result result = process_->wait();
  EXPECT_EQ(result.code, 0) << said();
  EXPECT_EQ(nlohmann::json::parse(lines_of(result.out).back())["result"], "good");
}

TEST_F(TwoNamespaces, AreJoinedByTheKernelsNetemJustAsWell) {
  const auto refused = [&] { return said().find("this kernel has no netem") != std::string::npos; };
  const std::string line =
      "exec " KERVAN_PROGRAM " link " + a_->network() + " " + b_->network() + " --netem --loss '20 %' --json 2>errors";
  process_.emplace(Command{"/bin/sh", {"-c", line}}, folder_.path());
  ASSERT_TRUE(eventually([&] { return refused() || said().find(" are joined by ") != std::string::npos; })) << said();
  if (refused()) GTEST_SKIP() << said();
  const Endpoint from = at(*a_, "10.77.0.1");
  from.send({}, kSize, "10.77.0.2");
  for (std::uint32_t i = 1; i < 10000; ++i) {
    from.send({i}, kSize, "10.77.0.2");
    if (i % 200 == 0) ::usleep(1000);
  }
  const auto passed = end();
  // Of one share; five standard deviations.
  EXPECT_NEAR(passed["lost"].get<double>() / passed["packets"].get<double>(), 0.2, 0.02);
}

TEST(Link, NeedsPermission) {
  if (::geteuid() != 0) GTEST_SKIP() << "needs root, to give it up";
  const Folder folder;
  const Result result = run({"/usr/bin/setpriv",
                             {"--reuid=65534", "--regid=65534", "--clear-groups", KERVAN_PROGRAM, "link",
                              "/proc/self/ns/net", "/proc/self/ns/net"}},
                            "/tmp");
  EXPECT_EQ(result.code, 2);
  EXPECT_TRUE(
      result.err.ends_with("network namespaces and their interfaces need root, or CAP_SYS_ADMIN and "
                           "CAP_NET_ADMIN\n"))
      << result.err;
  EXPECT_EQ(lines_of(result.err).size(), 1u) << result.err;
}

TEST(Link, RefusesWhatCannotBeInOneLine) {
  const Folder folder;
  const auto refused = [&](const std::string& options) {
    const Result result = run_line(KERVAN_PROGRAM, "link 1 1 " + options, folder.path());
    EXPECT_EQ(result.code, 2) << options;
    EXPECT_EQ(lines_of(result.err).size(), 1u) << result.err;
    return lines_of(result.err).empty() ? std::string() : lines_of(result.err)[0];
  };
  EXPECT_EQ(refused("--loss '120 %'"), "--loss 120 %: loss: 120 % is out of range; allowed: 0 .. 100 %");
  EXPECT_EQ(refused("--address-b 10.78.0.2"),
            "--address-b 10.78.0.2: not in one network with 10.77.0.1; let them differ in the last number");
  EXPECT_EQ(refused("--address-a 10.77.0"), "--address-a 10.77.0: this is no IPv4 address; write e.g. 10.77.0.1");
  EXPECT_EQ(refused("--interface a-name-that-is-long"),
            "--interface a-name-that-is-long: longer than the 15 letters that a name may have");
  EXPECT_EQ(refused("--profile wify"),
            "--profile wify: there is no profile 'wify'; did you mean 'wifi'? there are: ethernet, wifi, lossy");
  EXPECT_EQ(refused("--down 5s..2s"), "--down 5s..2s: 5s..2s ends before it has begun");
  EXPECT_EQ(refused("--seed -1"), "--seed -1: out of range; allowed: at least 0");
}

}  // namespace
}  // namespace kervan::test
