#include "deploy/supervisor/supervisor.hpp"

#include <signal.h>
#include <sys/poll.h>
#include <sys/signalfd.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <optional>
#include <system_error>
#include <utility>

#include "deploy/container/spec_json.hpp"
#include "deploy/container/specification.hpp"
#include "deploy/supervisor/child_process.hpp"

namespace kervan::supervisor {
namespace {

using namespace std::chrono_literals;
using container::Crash;
using container::EndReport;
using container::Failure;
using container::Phase;
using runtime::ClockMode;
using runtime::RunEnd;

/// An active container tells its progress ten times a second; one that is silent for so long hangs.
constexpr Duration kSilence = 5s;
/// Whom a start waits for is said after this time, and then again and again.
constexpr Duration kPatience = 1s;

/// When the containers are told to end, counted from the beginning of the end.
struct Ladder {
  Duration interrupt;      ///< the last container gets SIGINT, and each other once those behind it are gone
  Duration interrupt_all;  ///< at the latest
  Duration terminate;      ///< SIGTERM, which ends a container at once
  Duration kill;
};
/// The run is over: all end by themselves, and write their files on the way.
constexpr Ladder kOrderly{500ms, 2s, 8s, 9s};
/// Somebody wants it to end: everything is gone within 3 s.
constexpr Ladder kQuick{0s, 1s, 2400ms, 2800ms};
/// Something broke. A writer whose reader died waits a second for it when it is taken apart; that must not add up over
/// the containers. Under lockstep those who are left notice within 2 s that somebody is missing, and end with what
/// results there are.
constexpr Ladder kBroken{0s, 200ms, 2400ms, 2800ms};

/// Takes the signals that end a run, and those about children, off their usual way: they are read from a descriptor.
class SignalGuard {
 public:
  SignalGuard() {
    // An ignored SIGCHLD, which a parent may have left us, would throw our children's exits away.
    ::signal(SIGCHLD, SIG_DFL);
    sigset_t wanted;
    ::sigemptyset(&wanted);
    for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGCHLD}) ::sigaddset(&wanted, number);
    ::sigprocmask(SIG_BLOCK, &wanted, &before_);
    descriptor_ = ::signalfd(-1, &wanted, SFD_NONBLOCK | SFD_CLOEXEC);
    if (descriptor_ < 0) throw std::system_error(errno, std::generic_category(), "cannot watch signals");
  }
  ~SignalGuard() {
    ::close(descriptor_);
    ::sigprocmask(SIG_SETMASK, &before_, nullptr);
  }
  SignalGuard(const SignalGuard&) = delete;
  SignalGuard& operator=(const SignalGuard&) = delete;
  int descriptor() const { return descriptor_; }

 private:
  sigset_t before_{};
  int descriptor_ = -1;
};

std::string decimal(double value, const char* format) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

std::string dashed(std::string name) {
  std::ranges::replace(name, '/', '-');
  return name;
}

}  // namespace

struct Supervisor::Managed {
  enum class State { running, waiting, stopped };

  explicit Managed(ManagedContainer given) : plan(std::move(given)), budget(plan.restart) {}

  const std::string& name() const { return plan.spec.name; }
  /// SIGINT, SIGTERM, SIGKILL: each at most once, and none after a stronger one.
  void tell(int signal, int strength) {
    if (state != State::running || told >= strength) return;
    told = strength;
    process->signal(signal);
  }
  Duration active_for(SteadyTime now) const { return phase == Phase::active ? now - active_since : Duration::zero(); }

  ManagedContainer plan;
  RestartBudget budget;
  State state = State::stopped;
  SteadyTime restart_at{};
  std::map<std::string, std::deque<SteadyTime>> crashes;  ///< of each component, within the window
  bool ever_active = false;
  bool on_its_own = false;  ///< holds a component in quarantine: what becomes of it does not concern the run
  std::string last_exit;
  pid_t last_pid = 0;
  int restarts = 0;
  container::Counters earlier;  ///< of processes that are gone

  // Of the process that runs, or ran last.
  std::optional<ChildProcess> process;
  container::ControlReader reader;
  bool control_open = false;
  Phase phase = Phase::starting;
  SteadyTime active_since{}, heard{}, ended{};
  std::optional<Crash> crash;
  std::optional<Failure> failure;
  std::optional<EndReport> report;
  std::string killed_because;  ///< we did it ourselves
  container::Progress progress;
  int told = 0;
};

Supervisor::Supervisor(SupervisorConfig config, SupervisorEvents events)
    : config_(std::move(config)), events_(std::move(events)) {
  for (ManagedContainer& container : config_.containers)
    containers_.push_back(std::make_unique<Managed>(std::move(container)));
  if (containers_.empty()) return;
  const runtime::ContainerSpec& spec = containers_.front()->plan.spec;
  clock_ = spec.clock;
  if (clock_ == ClockMode::sim) time_keeper_ = container::time_keeper(spec);
}

Supervisor::~Supervisor() = default;

void Supervisor::say(const std::string& text) const {
  if (events_.say) events_.say(text);
}

SupervisedRun Supervisor::run() {
  const SignalGuard signals;
  signals_ = signals.descriptor();
  active_since_ = shown_ = now();
  for (const auto& container : containers_)
    if (end_ == End::running) start(*container);
  while (!all_gone()) {
    poll();
    read_signals();
    // A container in quarantine joins the list on the way.
    for (std::size_t i = 0; i < containers_.size(); ++i) {
      Managed& container = *containers_[i];
      read_control(container);
      if (container.state != Managed::State::running) continue;
      if (container.process->take_stopped() && end_ == End::running) {
        container.killed_because = "was stopped (SIGSTOP), which is as good as dead";
        container.process->signal(SIGKILL);
      }
      if (const auto status = container.process->reap()) handle_exit(container, *status);
    }
    for (const auto& container : containers_)
      if (container->state == Managed::State::waiting && end_ == End::running && now() >= container->restart_at)
        start(*container);
    check_hangs();
    if (end_ == End::running && config_.trouble)
      if (const std::string why = config_.trouble(); !why.empty()) abort(why);
    advance_ending();
    show();
  }
  if (end_ == End::running) ending_since_ = now();
  result_.wall_s = std::chrono::duration<double>(ending_since_ - active_since_).count();
  for (const auto& container : containers_) result_.containers.push_back(record_of(*container));
  return std::move(result_);
}

bool Supervisor::all_gone() const {
  return std::ranges::all_of(containers_, [](const auto& one) { return one->state == Managed::State::stopped; });
}

void Supervisor::start(Managed& container) {
  const auto file = config_.spec_folder / ("container-" + container.name() + ".json");
  container::write_spec(container.plan.spec, file);
  std::vector<std::string> arguments = {file.string(), container.name()};
  if (config_.limit != forever) arguments.insert(arguments.end(), {"--for-ns", std::to_string(config_.limit.count())});
  container.reader = {};
  container.phase = Phase::starting;
  container.crash.reset();
  container.failure.reset();
  container.report.reset();
  container.killed_because.clear();
  container.told = 0;
  container.process.reset();
  try {
    container.process.emplace(config_.program, std::move(arguments), container.plan.network);
  } catch (const std::system_error& error) {
    container.state = Managed::State::stopped;
    abort("the container " + container.name() + " cannot be started: " + error.what());
    return;
  }
  if (container.last_pid != 0) ++container.restarts;
  container.last_pid = container.process->pid();
  container.control_open = true;
  container.heard = now();
  container.state = Managed::State::running;
}

Duration Supervisor::next_timer() const {
  Duration wait = 100ms;
  for (const auto& container : containers_)
    if (container->state == Managed::State::waiting)
      wait = std::min(wait, std::max(Duration::zero(), Duration(container->restart_at - now())));
  return end_ == End::running ? wait : std::min<Duration>(wait, 20ms);
}

void Supervisor::poll() {
  std::vector<pollfd> watched = {{signals_, POLLIN, 0}};
  for (const auto& container : containers_) {
    if (container->state == Managed::State::running)
      watched.push_back({container->process->ended_descriptor(), POLLIN, 0});
    if (container->process && container->control_open)
      watched.push_back({container->process->control_descriptor(), POLLIN, 0});
  }
  // Rounded up: a wait that ends before its time would be followed by one of no length.
  const auto wait = std::chrono::ceil<std::chrono::milliseconds>(next_timer()).count();
  ::poll(watched.data(), watched.size(), static_cast<int>(wait));
}

void Supervisor::read_signals() {
  signalfd_siginfo info{};
  while (::read(signals_, &info, sizeof info) == sizeof info) {
    const int signal = static_cast<int>(info.ssi_signo);
    if (signal == SIGCHLD) continue;  // only wakes us up: who it was is found out elsewhere
    if (result_.signal == 0) {
      result_.signal = signal == SIGINT ? SIGINT : SIGTERM;
      say(container::signal_name(signal) + ": the containers are told to end; another one kills them");
      begin_ending(End::quick);
    } else {
      begin_ending(End::at_once);
    }
  }
}

void Supervisor::read_control(Managed& container) {
  if (!container.process || !container.control_open) return;
  for (const std::string& line :
       container.reader.read_lines(container.process->control_descriptor(), container.control_open)) {
    container.heard = now();
    try {
      take(container, container::parse_line(line));
    } catch (const ConfigError& error) {
      say("the container " + container.name() + " says what nobody understands: " + error.message());
    }
  }
}

void Supervisor::take(Managed& container, container::Message message) {
  if (const auto* phase = std::get_if<Phase>(&message)) {
    container.phase = *phase;
    if (*phase != Phase::active) return;
    container.active_since = now();
    container.ever_active = true;
    if (container.restarts > 0)
      say("the container " + container.name() + " is active again, " +
          decimal(std::chrono::duration<double>(now() - container.ended).count(), "%.2f s") + " after its end");
    if (!std::exchange(was_active_, true)) active_since_ = now();
    if (!were_all_active_ && std::ranges::all_of(containers_, [](const auto& one) { return one->ever_active; })) {
      were_all_active_ = true;
      if (events_.all_active) events_.all_active();
    }
  } else if (const auto* progress = std::get_if<container::Progress>(&message)) {
    container.progress = *progress;
  } else if (auto* crash = std::get_if<Crash>(&message)) {
    container.crash = std::move(*crash);
  } else if (auto* failure = std::get_if<Failure>(&message)) {
    container.failure = std::move(*failure);
  } else {
    container.report = std::move(std::get<EndReport>(message));
  }
}

void Supervisor::handle_exit(Managed& container, int status) {
  read_control(container);  // its last words may still be in the pipe
  container.state = Managed::State::stopped;
  container.ended = now();
  container.last_exit = exit_text(status);
  if (container.report)
    handle_report(container);
  else if (end_ == End::running)
    handle_death(container, status);
  container.earlier.worst_latency_s =
      std::max(container.earlier.worst_latency_s, container.progress.counters.worst_latency_s);
  container.earlier.missed_deadlines += container.progress.counters.missed_deadlines;
  container.progress.counters = {};
}

void Supervisor::handle_report(Managed& container) {
  const EndReport& report = *container.report;
  container.progress = {report.simulated_s, report.counters};
  if (end_ == End::running && report.end == RunEnd::interrupted && clock_ != ClockMode::lockstep) {
    // Not by us: somebody told this container alone to end.
    if (container.plan.restart.policy == composition::RestartPolicy::always)
      return restart_later(container, "was ended from outside");
    say("the container " + container.name() + " was ended from outside");
  }
  result_.reports.push_back(report);
  if (end_ != End::running || report.end == RunEnd::interrupted) return;
  // Those who are left end by themselves; the one they lost may hang.
  begin_ending(report.end == RunEnd::peer_lost ? End::quick : End::orderly);
}

void Supervisor::handle_death(Managed& container, int status) {
  std::string cause = !container.killed_because.empty() ? container.killed_because
                      : container.crash                 ? container::to_text(*container.crash)
                      : container.failure               ? "failed: " + container.failure->message
                      : WIFSIGNALED(status)             ? "died of " + exit_text(status)
                                                        : "ended without a report (" + exit_text(status) + ")";
  const std::string who = "the container " + container.name() + " ";
  if (container.failure && container.failure->configuration && !container.ever_active && !container.on_its_own)
    return abort("container " + container.name() + ": " + container.failure->message, true);
  const std::string when = " at " + time_of_death(container);
  if (clock_ == ClockMode::lockstep)
    return abort(who + cause + when + "; under clock lockstep no container is started again");
  if (container.name() == time_keeper_) return abort(who + cause + when + "; it keeps the time, so the run is over");
  if (quarantine(container)) return;
  if (container.plan.restart.policy == composition::RestartPolicy::never) return give_up(container, cause);
  restart_later(container, cause);
}

void Supervisor::restart_later(Managed& container, const std::string& why) {
  const auto delay = container.budget.spend(now(), container.active_for(now()));
  const composition::Restart& limits = container.plan.restart;
  const std::string window = decimal(seconds(limits.window), "%g s");
  if (!delay)
    return give_up(container, "was started again " + std::to_string(limits.max) + " times within " + window +
                                  "; the last time it " + why);
  container.state = Managed::State::waiting;
  container.restart_at = now() + *delay;
  say("the container " + container.name() + " " + why + "; it is started again in " +
      decimal(seconds(*delay), "%.1f s") + " (" + std::to_string(container.budget.recent()) + " of " +
      std::to_string(limits.max) + " within " + window + ")");
}

void Supervisor::give_up(Managed& container, const std::string& why) {
  const std::string text = "the container " + container.name() + " stays stopped: it " + why;
  if (!container.ever_active && !container.on_its_own) return abort(text);
  say(text);
  result_.given_up.push_back(text);
  if (all_gone()) abort("no container is left; " + text);
}

/// Moves a component that crashed too often into a container of its own; false if none did.
bool Supervisor::quarantine(Managed& container) {
  if (!container.crash || container.crash->component.empty() || container.plan.restart.quarantine == 0) return false;
  const std::string culprit = container.crash->component;
  std::deque<SteadyTime>& crashes = container.crashes[culprit];
  crashes.push_back(now());
  while (now() - crashes.front() > container.plan.restart.window) crashes.pop_front();
  if (static_cast<int>(crashes.size()) < container.plan.restart.quarantine) return false;
  runtime::ContainerSpec& spec = container.plan.spec;
  const auto here = [&](const runtime::ComponentSpec& one) { return runtime::is_local(spec, one); };
  if (std::ranges::count_if(spec.components, here) < 2) return false;  // it is by itself already
  const std::string cell = container.name() + "-" + dashed(culprit);
  std::ranges::find(spec.components, culprit, &runtime::ComponentSpec::name)->container = cell;
  spec.members.push_back(cell);
  ManagedContainer alone = container.plan;
  alone.spec.name = cell;
  alone.restart.quarantine = 0;
  containers_.push_back(std::make_unique<Managed>(std::move(alone)));
  containers_.back()->on_its_own = true;
  say(culprit + " made the container " + container.name() + " crash " + std::to_string(crashes.size()) +
      " times; from now on it runs by itself in the container " + cell);
  container.crashes.clear();
  container.budget.forgive();
  container.state = Managed::State::waiting;
  container.restart_at = now();
  start(*containers_.back());
  return true;
}

void Supervisor::abort(const std::string& why, bool unusable) {
  if (result_.aborted.empty()) {
    if (!unusable) say(why);
    result_.aborted = why;
    result_.unusable = unusable;
  }
  begin_ending(End::quick);
}

void Supervisor::begin_ending(End how) {
  if (how <= end_) return;
  // From an orderly end to a quick one the clock begins again; what was said before is not said twice.
  end_ = how;
  ending_since_ = now();
  for (const auto& container : containers_)
    if (container->state == Managed::State::waiting) container->state = Managed::State::stopped;
}

void Supervisor::advance_ending() {
  if (end_ == End::running) return;
  const Ladder& ladder = end_ == End::orderly ? kOrderly : result_.aborted.empty() ? kQuick : kBroken;
  const Duration passed = now() - ending_since_;
  const bool kill = end_ == End::at_once || passed >= ladder.kill;
  bool in_turn = true;
  for (auto one = containers_.rbegin(); one != containers_.rend(); ++one) {
    Managed& container = **one;
    if (container.state != Managed::State::running) continue;
    if (kill) container.tell(SIGKILL, 3);
    if (passed >= ladder.terminate) container.tell(SIGTERM, 2);
    if (passed >= ladder.interrupt && (in_turn || passed >= ladder.interrupt_all)) container.tell(SIGINT, 1);
    in_turn = false;  // the one before it gets its turn when this one is gone
  }
}

void Supervisor::check_hangs() {
  if (end_ != End::running || clock_ == ClockMode::lockstep) return;
  for (const auto& container : containers_) {
    if (container->state != Managed::State::running || container->phase != Phase::active) continue;
    if (now() - container->heard < kSilence || !container->killed_because.empty()) continue;
    container->killed_because = "hangs: nothing was heard of it for " + decimal(seconds(kSilence), "%g s");
    container->process->signal(SIGKILL);
  }
}

void Supervisor::show() {
  if (end_ != End::running) return;
  if (were_all_active_) {
    double simulated = 0.0;
    for (const auto& container : containers_) simulated = std::max(simulated, container->progress.simulated_s);
    if (clock_ == ClockMode::wall) simulated = std::chrono::duration<double>(now() - active_since_).count();
    if (events_.progress) events_.progress(from_seconds(simulated));
  } else if (events_.waiting && now() - shown_ >= kPatience) {
    shown_ = now();
    std::string text;
    for (const auto& container : containers_)
      if (container->state == Managed::State::waiting || container->phase != Phase::active)
        text += (text.empty() ? "" : ", ") + container->name() + " (" +
                (container->state == Managed::State::waiting ? "to be started again"
                                                             : std::string(to_text(container->phase))) +
                ")";
    events_.waiting("waiting for " + text);
  }
}

ContainerRecord Supervisor::record_of(const Managed& container) const {
  return {container.name(), container.last_pid, container.restarts, container.last_exit, container.earlier};
}

/// When the container died, on the composition's clock: by its crash report, else as far as anybody had come.
std::string Supervisor::time_of_death(const Managed& container) const {
  double time = 0.0;
  for (const auto& one : containers_) time = std::max(time, one->progress.simulated_s);
  if (container.crash && container.crash->time_ns > 0 && clock_ != ClockMode::wall)
    time = seconds(Duration(container.crash->time_ns));
  return decimal(time, "%.2f s");
}

}  // namespace kervan::supervisor
