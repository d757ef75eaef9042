#include "framework/runtime/container.hpp"

#include <algorithm>
#include <iterator>

#include "framework/component/error.hpp"
#include "framework/dds/discovery.hpp"
#include "framework/dds/hash.hpp"
#include "framework/runtime/clock_reader.hpp"
#include "framework/runtime/dispatcher.hpp"
#include "framework/runtime/lockstep.hpp"
#include "framework/runtime/log.hpp"
#include "framework/runtime/members.hpp"
#include "framework/runtime/status.hpp"
#include "framework/runtime/watch.hpp"

namespace kervan::runtime {

namespace {

/// Whether simulated time is run here.
bool writes_clock(const std::vector<std::unique_ptr<ComponentInstance>>& instances) {
  for (const auto& instance : instances)
    for (const auto& output : instance->outputs())
      if (output->binding().topic == kClockTopic) return true;
  return false;
}

}  // namespace

std::string_view to_text(RunEnd end) {
  switch (end) {
    case RunEnd::finished: return "finished";
    case RunEnd::time_limit: return "time limit";
    case RunEnd::interrupted: return "interrupted";
    case RunEnd::idle: return "idle";
    case RunEnd::livelock: return "livelock";
    case RunEnd::peer_lost: return "peer lost";
    case RunEnd::clock_lost: return "clock lost";
  }
  return "unknown";
}

Container::Container(ContainerSpec spec, ComponentRegistry& registry)
    : spec_(std::move(spec)), clock_(spec_.clock == ClockMode::sim) {
  spec_.domain.user_data = dds::to_user_data({spec_.name, composition_hash(spec_)});
  domain_ = std::make_unique<dds::Domain>(spec_.domain, clock_.stamp());
  // Several processes would write over each other's lines in one file.
  const std::string log_file = spec_.members.size() > 1 ? "log-" + spec_.name + ".txt" : "log.txt";
  log_sinks_ = std::make_unique<LogSinks>(spec_.log_to_console,
                                          spec_.run_folder.empty() ? spec_.run_folder : spec_.run_folder / log_file,
                                          spec_.publish_log ? domain_.get() : nullptr);
  status_writer_ = std::make_unique<StatusWriter>(*domain_);
  if (spec_.clock == ClockMode::lockstep) lockstep_ = std::make_unique<Lockstep>(*this, instant_, spec_.threads);
  // An endpoint's index counts those of all components before it, wherever they run.
  FirstIndices first;
  for (unsigned index = 0; index < spec_.components.size(); ++index) {
    const ComponentSpec& component = spec_.components[index];
    if (!is_local(spec_, component)) {
      for (const PortBinding& port : component.ports)
        ++(port.direction == PortDirection::output ? first.writer : first.reader);
      continue;
    }
    const ComponentClass* type = registry.find(component.type);
    if (!type) throw ConfigError({}, "there is no component type '" + component.type + "'");
    try {
      instances_.push_back(std::make_unique<ComponentInstance>(*this, component, *type, index, first));
    } catch (const ParameterError& error) {
      throw ParameterError(component.name + "." + error.parameter(), error.message());
    }
    for (const auto& output : instances_.back()->outputs())
      writer_indices_.emplace(output->writer().handle(), output->index());
    first.writer += static_cast<unsigned>(instances_.back()->outputs().size());
    first.reader += static_cast<unsigned>(instances_.back()->inputs().size());
  }
  if (lockstep_) {
    lockstep_->connect();
    return;
  }
  if (spec_.clock == ClockMode::sim && !writes_clock(instances_)) {
    const auto writer = clock_writer(spec_);
    clock_reader_ =
        std::make_unique<ClockReader>(*domain_, clock_, writer ? writer->reliability : Reliability::reliable);
  }
  if (spec_.members.size() > 1) members_ = std::make_unique<Members>(*domain_, spec_, [this] { bell_.ring(); });
  watch_ = std::make_unique<Watch>(*this, bell_, [this] { hear_members(); });
}

Container::~Container() {
  watch_.reset();
  members_.reset();
  clock_reader_.reset();
  instances_.clear();
  status_writer_.reset();
  log_sinks_.reset();
}

ComponentInstance* Container::find(const std::string& name) {
  for (const auto& instance : instances_)
    if (instance->name() == name) return instance.get();
  return nullptr;
}

std::uint64_t Container::trace_hash() const {
  std::vector<std::pair<unsigned, std::uint64_t>> traces;
  for (const auto& instance : instances_)
    for (const auto& output : instance->outputs()) traces.emplace_back(output->index(), output->trace());
  if (lockstep_) std::ranges::copy(lockstep_->traces_elsewhere(), std::back_inserter(traces));
  std::ranges::sort(traces);
  Hash64 hash;
  for (const auto& [writer, trace] : traces) {
    hash.number(writer);
    hash.number(trace);
  }
  return hash.value();
}

void Container::input_ready(InputPort& port) noexcept {
  ComponentInstance& instance = port.owner();
  if (spec_.clock != ClockMode::lockstep) {
    instance.notify();
    return;
  }
  lockstep_->arrived(instance);
}

void Container::request_finish(unsigned component, std::string why) {
  const std::lock_guard lock(finish_mutex_);
  // The first component in the composition's order gives the reason, whichever thread came first.
  if (!finish_ || component < finish_->first) finish_.emplace(component, std::move(why));
  finish_requested_ = true;
  finish_wanted_.notify_one();
}

std::optional<StopWish> Container::finish_wish() {
  if (!finish_requested_.load(std::memory_order_relaxed)) return std::nullopt;
  const std::lock_guard lock(finish_mutex_);
  if (!finish_) return std::nullopt;
  return StopWish{.end = RunEnd::finished, .component = finish_->first, .reason = finish_->second};
}

unsigned Container::writer_index(const InputPort& port, std::uint64_t handle) {
  const std::lock_guard lock(writer_indices_mutex_);
  if (const auto found = writer_indices_.find(handle); found != writer_indices_.end()) return found->second;
  // Of another process: it says so itself. One that said nothing, or is gone already, comes last.
  const std::optional<dds::EndpointIdentity> identity = port.reader().matched_writer(handle);
  if (!identity) return ~0u;
  writer_indices_.emplace(handle, identity->index);
  return identity->index;
}

void Container::publish_status(ComponentInstance& instance) {
  status_writer_->publish(instance, spec_.name, instance.instant().time);
}

void Container::publish_changed_statuses() {
  for (const auto& instance : instances_)
    if (instance->take_status_changed()) publish_status(*instance);
}

std::shared_ptr<spdlog::logger> Container::make_logger(const ComponentSpec& spec) {
  return log_sinks_->make(spec.name, spec.log_level);
}

void Container::activate() {
  instant_ = {spec_.clock == ClockMode::lockstep ? Time{} : clock_.now(), 0};
  started_ = instant_.time;
  for (const auto& instance : instances_) instance->activate(instant_);
  publish_changed_statuses();
}

void Container::advance(Time until) { lockstep_->advance(until); }

void Container::end() {
  if (lockstep_) return lockstep_->end();
  // Last words first, then everybody hears them, then nobody speaks any more.
  for (const auto& instance : instances_) instance->deactivate(instant_);
  for (const auto& instance : instances_) {
    instance->stage(instant_.time);
    instance->run_inputs(instant_);
  }
  for (const auto& instance : instances_) instance->shutdown(instant_);
  publish_changed_statuses();
}

RunReport Container::run(const RunControl& control) {
  if (lockstep_) {
    if (const auto impossible = lockstep_->join(control)) return *impossible;
  }
  RunReport report;
  if (const std::optional<RunReport> ended = wait_for_peers(control)) {
    report = *ended;
  } else if (const std::optional<RunReport> no_time = wait_for_clock(control)) {
    report = *no_time;
  } else {
    activate();
    if (members_) members_->publish(kervan_msgs::msg::ContainerPhase::CONTAINER_ACTIVE, {}, instant_.time);
    if (control.phase) control.phase(RunPhase::active);
    report = lockstep_ ? lockstep_->run(control) : run_dispatchers(control);
    end();
  }
  // Neither a limit of time nor an interruption of this container ends the others' runs.
  if (members_ && report.end == RunEnd::finished) {
    members_->publish(kervan_msgs::msg::ContainerPhase::CONTAINER_FINISHED, report.reason, instant_.time);
    members_->wait_until_heard();
  }
  report.ended_at = instant_.time;
  if (lockstep_) {
    report.cycles = lockstep_->cycles();
    // Lost while everybody was ending: then there is no common trace.
    if (!lockstep_->lost().empty()) report.end = RunEnd::peer_lost, report.reason = lockstep_->lost();
  }
  return report;
}

}  // namespace kervan::runtime
