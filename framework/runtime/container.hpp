/// Runs the components of one process. The clock decides who drives it: dispatchers (wall, sim) or lockstep.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "framework/component/registry.hpp"
#include "framework/dds/endpoint.hpp"
#include "framework/runtime/bell.hpp"
#include "framework/runtime/clock.hpp"
#include "framework/runtime/instance.hpp"
#include "framework/runtime/spec.hpp"

namespace kervan::runtime {

class Activity;
class ClockReader;
class Dispatcher;
class Lockstep;
class LogSinks;
class Members;
class Operations;
class StatusWriter;
struct StopWish;
class Watch;

/// How a run ended.
enum class RunEnd {
  finished,     ///< a component called finish()
  time_limit,   ///< the time asked for has passed
  interrupted,  ///< the stop flag was set
  idle,         ///< lockstep and sim: no timer is left and no sample, so nothing would ever happen again
  livelock,     ///< lockstep only: a loop of ports publishes for ever at one time
  peer_lost,    ///< lockstep only: another container died, stopped, or never came
  clock_lost,   ///< sim only: the container that runs the simulated time is gone, or its time stands still
};
std::string_view to_text(RunEnd end);

struct RunReport {
  RunEnd end = RunEnd::finished;
  std::string reason = {};   ///< one sentence
  Time ended_at{};           ///< on the composition's clock
  std::uint64_t cycles = 0;  ///< delta cycles run
  /// Lockstep only: this container ended apart from the others, so they have no trace in common.
  bool broken_off = false;
};

/// How far a run is before it runs.
enum class RunPhase {
  matched,  ///< this container's ports are matched with those of all other containers
  active,   ///< so are all others', and every component is active
};

inline constexpr Duration kProgressPeriod = std::chrono::milliseconds(100);  ///< of wall time

struct RunControl {
  Duration limit = forever;                            ///< on the composition's clock, from the start of the run
  const std::atomic<bool>* stop = nullptr;             ///< ends the run in good order when set
  Duration members_within = std::chrono::seconds(30);  ///< lockstep: wall time in which the other containers must come
  /// Lockstep: wall time after which a handler that does not return counts as stuck, and its container as lost.
  Duration longest_handler = std::chrono::seconds(60);
  std::function<void(Time)> progress = {};   ///< called about every kProgressPeriod
  std::function<void(RunPhase)> phase = {};  ///< called when the run reaches it
};

class Container {
 public:
  /// Constructs all components and all endpoints; nothing runs yet. Throws ConfigError, ParameterError or DdsError;
  /// ParameterError names the parameter as "<component>.<parameter>".
  Container(ContainerSpec spec, ComponentRegistry& registry);
  ~Container();
  Container(const Container&) = delete;
  Container& operator=(const Container&) = delete;

  /// Waits for the other containers, activates every component, runs until one of the ends, deactivates and shuts them
  /// down.
  RunReport run(const RunControl& control);

  // The same in pieces, for tests under lockstep.
  void activate();
  /// Handles everything at the present time, then moves to `until`, handling every time on the way.
  void advance(Time until);
  void end();

  Time now() const { return instant_.time; }
  bool finish_requested() const { return finish_requested_.load(); }
  const ContainerSpec& spec() const { return spec_; }
  const ContainerClock& clock() const { return clock_; }  ///< of wall and sim
  dds::Domain& domain() { return *domain_; }
  const std::vector<std::unique_ptr<ComponentInstance>>& instances() const { return instances_; }
  ComponentInstance* find(const std::string& name);

  /// What can be asked of the container while it runs.
  Operations& operations() { return *operations_; }
  /// The run is over, or will be as soon as nobody is in a handler.
  bool ending() const;
  /// Lets the thread that is in run() look at what was posted.
  void wake();

  /// The chain of every traced writer, combined in writer order.
  std::uint64_t trace_hash() const;

  // Used by whatever drives the components.
  /// The wish of the first component, in the composition's order, that called finish().
  std::optional<StopWish> finish_wish();
  void publish_changed_statuses();

  // Used by the ports and instances.
  void input_ready(InputPort& port) noexcept;
  Bell& bell() { return bell_; }  ///< to be rung when a port's peers change
  void request_finish(unsigned component, std::string why);
  /// The place in the composition of a writer that `port` has had samples of; ~0u if it has none.
  unsigned writer_index(const InputPort& port, std::uint64_t handle);
  void publish_status(ComponentInstance& instance);
  std::shared_ptr<spdlog::logger> make_logger(const ComponentSpec& spec);
  spdlog::logger& log() const { return *log_; }

 private:
  friend class Operations;

  Slot slot_of(const ComponentSpec& spec) const;
  /// Constructs a component with its endpoints and puts it into its place. Throws what its constructor throws.
  ComponentInstance& add(const ComponentSpec& spec);
  /// Takes a component that nobody is in out of everything, and destroys it.
  void remove(ComponentInstance& instance);
  /// From now on a dispatcher runs it, if dispatchers are what runs this container.
  void attach(ComponentInstance& instance);
  void detach(Dispatcher* dispatcher);
  void tell_dispatchers_the_time();
  /// The present, for what happens outside of any handler.
  Instant present() const;

  /// Under the clocks wall and sim: until this container's ports are matched and all other containers say the same of
  /// theirs. A report, if the run ended before that.
  std::optional<RunReport> wait_for_peers(const RunControl& control);
  void hear_members();
  void watch_anew();
  RunReport run_dispatchers(const RunControl& control);
  void start_dispatchers(Activity* activity);
  RunReport supervise(const RunControl& control);
  RunReport run_simulated_time(const RunControl& control, const Activity& activity);
  /// Does what was posted. A report if the run is over: a component wished it, or the stop flag is set.
  std::optional<RunReport> over(std::unique_lock<std::mutex>& finish_lock, const RunControl& control);
  std::optional<RunReport> wait_for_clock(const RunControl& control);
  std::optional<RunReport> lost_clock() const;

  ContainerSpec spec_;
  ComponentRegistry& registry_;
  ContainerClock clock_;
  std::vector<Slot> slots_;      ///< of the composition's components, wherever they run, and of what would follow
  unsigned loaded_ever_ = 0;     ///< components that had a place behind the composition's
  unsigned loaded_writers_ = 0;  ///< the writers of these
  unsigned loaded_readers_ = 0;  ///< the readers of these
  Instant instant_;
  Time started_{};
  std::unique_ptr<dds::Domain> domain_;
  std::unique_ptr<LogSinks> log_sinks_;
  std::shared_ptr<spdlog::logger> log_;  ///< of the container itself
  std::unique_ptr<StatusWriter> status_writer_;
  Bell bell_;
  std::mutex writer_indices_mutex_;
  std::map<std::uint64_t, unsigned> writer_indices_;  ///< by Cyclone's instance handle; under the mutex
  std::deque<std::uint64_t> departed_writers_;        ///< handles whose indices are still known, oldest first
  std::map<unsigned, std::pair<std::uint64_t, std::uint64_t>> departed_traces_;  ///< writer -> sequence and trace
  std::atomic<bool> finish_requested_{false};
  std::mutex finish_mutex_;
  std::condition_variable finish_wanted_;
  std::optional<std::pair<unsigned, std::string>> finish_;  ///< component index and reason
  const std::atomic<bool>* stop_ = nullptr;                 ///< of the run that is under way
  bool expects_peers_ = false;                              ///< the run is on: a missing peer is a trouble
  Activity* activity_ = nullptr;  ///< of the run that is under way, if simulated time is run here
  std::unique_ptr<Operations> operations_;

  // Endpoints call into what stands above them until they are gone, so the order is that of construction.
  std::unique_ptr<Lockstep> lockstep_;
  std::vector<std::unique_ptr<Dispatcher>> dispatchers_;       ///< the first is everybody's; others serve one component
  std::vector<std::unique_ptr<ComponentInstance>> instances_;  ///< by index; only the thread in run() changes it
  std::unique_ptr<ClockReader> clock_reader_;                  ///< clock sim, when another container runs the time
  std::unique_ptr<Members> members_;  ///< not under lockstep, nor in a composition of one container
  std::unique_ptr<Watch> watch_;      ///< not under lockstep
};

}  // namespace kervan::runtime
