/// Starts the containers of this host as processes, keeps them running by their restart policies, and stops them. It
/// takes no part in what they say to each other.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "deploy/composition/composition.hpp"
#include "deploy/container/control_channel.hpp"
#include "deploy/container/report.hpp"
#include "deploy/supervisor/restart_budget.hpp"
#include "framework/runtime/spec.hpp"

namespace kervan::supervisor {

struct ManagedContainer {
  runtime::ContainerSpec spec;
  composition::Restart restart;
  int network = -1;  ///< descriptor of the network namespace where it runs; -1: ours
};

struct SupervisorConfig {
  std::filesystem::path program;             ///< kervan-container
  std::filesystem::path spec_folder;         ///< gets container-<name>.json
  Duration limit = forever;                  ///< of the run, on the composition's clock
  std::vector<ManagedContainer> containers;  ///< of this host, in the composition's order
  std::function<std::string()> trouble;      ///< asked again and again: why the run cannot go on; empty: it can
};

/// What a person may be shown on the way. All are called from run(), and may be empty.
struct SupervisorEvents {
  std::function<void(const std::string&)> say;      ///< one sentence about a container, for good
  std::function<void(const std::string&)> waiting;  ///< whom the start waits for; about once a second
  std::function<void(Duration)> progress;           ///< the composition's time, about ten times a second
  std::function<void()> all_active = {};            ///< once, when all containers have become active
};

/// One row of the table at the end.
struct ContainerRecord {
  std::string name;
  pid_t pid = 0;  ///< of its last process
  int restarts = 0;
  std::string exit;  ///< of its last process: "exit 0", "SIGKILL"; "stopped" with the reason if it was given up
  container::Counters counters;
};

struct SupervisedRun {
  std::vector<container::EndReport> reports;  ///< of the containers that ended in good order
  std::vector<ContainerRecord> containers;
  std::vector<std::string> given_up;  ///< one sentence for each container that was stopped being restarted
  std::string aborted;                ///< why the supervisor ended the run; empty if it did not
  bool unusable = false;              ///< `aborted` is a mistake in the configuration
  int signal = 0;                     ///< SIGINT or SIGTERM, if one asked for the end
  double wall_s = 0.0;                ///< from the moment when the first container was active
};

class Supervisor {
 public:
  Supervisor(SupervisorConfig config, SupervisorEvents events);
  ~Supervisor();
  Supervisor(const Supervisor&) = delete;
  Supervisor& operator=(const Supervisor&) = delete;

  /// Returns when every process is gone. SIGINT, SIGTERM and SIGHUP meanwhile end the run: in reverse order SIGINT,
  /// then SIGTERM, then SIGKILL for all, which is over within 3 s; a second one kills at once. To be called from the
  /// main thread of a process that has no other. Throws ConfigError if a specification cannot be written.
  SupervisedRun run();

 private:
  struct Managed;
  enum class End { running, orderly, quick, at_once };

  void start(Managed& container);
  void poll();
  void read_signals();
  void read_control(Managed& container);
  void take(Managed& container, container::Message message);
  void handle_exit(Managed& container, int status);
  void handle_report(Managed& container);
  void handle_death(Managed& container, int status);
  bool quarantine(Managed& container);
  void give_up(Managed& container, const std::string& why);
  void restart_later(Managed& container, const std::string& why);
  void abort(const std::string& why, bool unusable = false);
  void begin_ending(End how);
  void advance_ending();
  void check_hangs();
  void show();
  bool all_gone() const;
  Duration next_timer() const;
  SteadyTime now() const { return std::chrono::steady_clock::now(); }
  void say(const std::string& text) const;
  ContainerRecord record_of(const Managed& container) const;
  std::string time_of_death(const Managed& container) const;

  SupervisorConfig config_;
  SupervisorEvents events_;
  std::vector<std::unique_ptr<Managed>> containers_;
  runtime::ClockMode clock_ = runtime::ClockMode::wall;
  std::string time_keeper_;  ///< the container that writes /clock; empty unless under clock sim
  int signals_ = -1;         ///< a descriptor that tells of signals
  End end_ = End::running;
  SteadyTime active_since_{}, ending_since_{}, shown_{};
  bool was_active_ = false;  ///< some container
  bool were_all_active_ = false;
  SupervisedRun result_;
};

}  // namespace kervan::supervisor
