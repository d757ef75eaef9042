/// Units for the field, judged by systemd's own tools without starting anything, and what kervan-container tells a
/// service manager.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <fstream>

#include "deploy/container/spec_json.hpp"
#include "deploy/supervisor/systemd_units.hpp"
#include "tests/deploy/supervised.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;
using composition::RestartPolicy;

bool has_line(const std::string& text, const std::string& line) {
  return ("\n" + text).find("\n" + line + "\n") != std::string::npos;
}

std::map<std::string, std::string> units(const fs::path& folder, const composition::Restart& restart = {}) {
  std::vector<supervisor::UnitPlan> plans;
  for (const char* name : {"brain", "sim"}) {
    runtime::ContainerSpec spec;
    spec.name = name;
    spec.members = {"brain", "sim"};
    spec.run_folder = "/somewhere/else";
    plans.push_back({spec, restart});
  }
  return supervisor::systemd_units(plans,
                                   {"lab", KERVAN_CONTAINER_PROGRAM, folder, {"/opt/my components", "/opt/50%"}});
}

TEST(SystemdUnits, AreOneForEachContainerWithItsSpecificationAndATargetForAll) {
  const auto files = units("/etc/kervan");
  ASSERT_EQ(files.size(), 5u);
  const std::string& unit = files.at("kervan-lab-brain.service");
  EXPECT_TRUE(has_line(unit, "LoadCredential=specification:/etc/kervan/kervan-lab-brain.service.json")) << unit;
  EXPECT_TRUE(has_line(unit, "ExecStart=\"" KERVAN_CONTAINER_PROGRAM "\" \"%d/specification\" \"brain\"")) << unit;
  EXPECT_TRUE(has_line(unit, "Environment=\"KERVAN_COMPONENT_PATH=/opt/my components:/opt/50%%\"")) << unit;
  EXPECT_TRUE(has_line(unit, "WatchdogSec=5s"));
  const auto spec = container::spec_from_json(files.at("kervan-lab-brain.service.json"), "unit");
  EXPECT_EQ(spec.name, "brain");
  EXPECT_EQ(spec.run_folder, "/var/lib/kervan-lab-brain");
  EXPECT_TRUE(has_line(unit, "StateDirectory=kervan-lab-brain"));
  EXPECT_TRUE(has_line(files.at("kervan-lab.target"), "Wants=kervan-lab-sim.service"));
}

TEST(SystemdUnits, HaveTheRestartPolicyOfTheComposition) {
  const auto unit = [](const composition::Restart& restart) {
    return units("/etc/kervan", restart).at("kervan-lab-sim.service");
  };
  std::string text = unit({.policy = RestartPolicy::always, .max = 3, .window = 10s, .backoff = 250ms});
  EXPECT_TRUE(has_line(text, "Restart=always"));
  EXPECT_TRUE(has_line(text, "RestartSec=250ms"));
  EXPECT_TRUE(has_line(text, "StartLimitIntervalSec=10s"));
  EXPECT_TRUE(has_line(text, "StartLimitBurst=3"));
  EXPECT_TRUE(has_line(unit({.policy = RestartPolicy::on_failure}), "Restart=on-failure"));
  EXPECT_TRUE(has_line(unit({.policy = RestartPolicy::never}), "Restart=no"));
}

/// Nothing is started: systemd-analyze reads files.
TEST(SystemdUnits, PassSystemdsOwnChecks) {
  if (::access("/usr/bin/systemd-analyze", X_OK) != 0)
    GTEST_SKIP() << "systemd-analyze is not installed; it is in the package systemd";
  const Folder folder;
  std::string names;
  for (const auto& [name, text] : units(folder.path())) {
    std::ofstream(folder.path() / name) << text;
    if (!name.ends_with(".json")) names += " ./" + name;
  }
  const auto analyze = [&](const std::string& arguments) {
    return run({"/bin/sh", {"-c", "systemd-analyze " + arguments}, {}}, folder.path());
  };
  const Result verified = analyze("verify --man=no" + names);
  EXPECT_EQ(verified.code, 0);
  EXPECT_EQ(verified.out + verified.err, "");  // an unknown key is only a warning
  for (const char* unit : {"kervan-lab-brain.service", "kervan-lab-sim.service"}) {
    const Result exposure = analyze(std::string("security --offline=true --no-pager --threshold=30 ./") + unit);
    EXPECT_EQ(exposure.code, 0) << exposure.out << exposure.err;
  }
}

/// The socket of a service manager.
class Manager {
 public:
  Manager() {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path().c_str(), sizeof address.sun_path - 1);
    if (::bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) throw std::runtime_error("bind");
  }
  ~Manager() { ::close(socket_); }

  std::string path() const { return folder_.path() / "notify"; }

  /// The next message; empty if none comes within this time.
  std::string next(std::chrono::milliseconds patience) const {
    pollfd readable{socket_, POLLIN, 0};
    if (::poll(&readable, 1, static_cast<int>(patience.count())) != 1) return {};
    std::array<char, 4096> buffer{};
    const auto size = ::recv(socket_, buffer.data(), buffer.size(), 0);
    return {buffer.data(), static_cast<std::size_t>(std::max<ssize_t>(size, 0))};
  }

  /// Waits for a message with this in it; false if it does not come within a minute.
  bool hears(const std::string& text) const {
    for (;;) {
      const std::string message = next(60s);
      if (message.empty()) return false;
      if (message.find(text) != std::string::npos) return true;
    }
  }

 private:
  Folder folder_;
  int socket_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
};

/// kervan-container with a component that stays in a handler from 0.3 s on, or never.
class Watched {
 public:
  explicit Watched(bool hangs) {
    runtime::ContainerSpec spec;
    spec.name = "brain";
    spec.domain = {.id = 92, .tag = "systemd-" + std::to_string(::getpid()) + (hangs ? "-hangs" : "")};
    spec.run_folder = folder_.path();
    spec.components.push_back({.name = "saboteur", .type = "test/saboteur", .parameters = {{"how", "hang"}}});
    if (hangs) {
      spec.components.front().parameters["where"] = "timer";
      spec.components.front().parameters["after"] = 0.3;
    }
    container::write_spec(spec, folder_.path() / "spec.json");
    process_.emplace(Command{KERVAN_CONTAINER_PROGRAM,
                             {"spec.json", "brain"},
                             {{"KERVAN_COMPONENT_PATH", TEST_COMPONENTS},
                              {"NOTIFY_SOCKET", manager.path()},
                              {"WATCHDOG_USEC", "1000000"}}},
                     folder_.path());
  }
  Process& process() { return *process_; }

  Manager manager;

 private:
  Folder folder_;
  std::optional<Process> process_;
};

TEST(ServiceManager, HearsThatAContainerIsReadyThatItLivesAndThatItStops) {
  Watched watched(false);
  EXPECT_TRUE(watched.manager.hears("READY=1\nSTATUS=active"));
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(watched.manager.hears("WATCHDOG=1"));
  watched.process().signal(SIGTERM);
  EXPECT_TRUE(watched.manager.hears("STOPPING=1\nSTATUS=interrupted"));
  EXPECT_EQ(watched.process().wait().code, 0);
}

TEST(ServiceManager, HearsNoSignOfLifeOfAContainerWhoseHandlerHangs) {
  Watched watched(true);
  EXPECT_TRUE(watched.manager.hears("READY=1"));
  ASSERT_TRUE(watched.manager.hears("STATUS=saboteur has been in a handler for "));
  for (int i = 0; i < 10; ++i) EXPECT_EQ(watched.manager.next(60s).find("WATCHDOG=1"), std::string::npos);
}

}  // namespace
}  // namespace kervan::test
