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
#include "framework/runtime/operations.hpp"
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

/// Writers that have gone and whose indices are still known, for samples that nobody has looked at yet.
constexpr std::size_t kDepartedWriters = 256;

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
    : spec_(std::move(spec)),
      registry_(registry),
      clock_(spec_.clock == ClockMode::sim),
      operations_(std::make_unique<Operations>(*this, registry)) {
  spec_.domain.user_data = dds::to_user_data({spec_.name, composition_hash(spec_)});
  // Under lockstep whoever ends knows already that the others have everything; or that somebody never will.
  if (spec_.clock == ClockMode::lockstep) spec_.domain.linger = Duration::zero();
  domain_ = std::make_unique<dds::Domain>(spec_.domain, clock_.stamp());
  // Several processes would write over each other's lines in one file.
  const std::string log_file = spec_.members.size() > 1 ? "log-" + spec_.name + ".txt" : "log.txt";
  log_sinks_ = std::make_unique<LogSinks>(spec_.log_to_console,
                                          spec_.run_folder.empty() ? spec_.run_folder : spec_.run_folder / log_file,
                                          spec_.publish_log ? domain_.get() : nullptr);
  log_ = log_sinks_->make("kervan/" + spec_.name, "info");
  status_writer_ = std::make_unique<StatusWriter>(*domain_);
  if (spec_.clock == ClockMode::lockstep) lockstep_ = std::make_unique<Lockstep>(*this, instant_, spec_.threads);
  // An endpoint's index counts those of all components before it, wherever they run.
  Slot slot;
  for (const ComponentSpec& component : spec_.components) {
    slots_.push_back(slot);
    ++slot.index;
    if (is_local(spec_, component) && std::ranges::count(spec_.absent, component.name) == 0) {
      const ComponentInstance& instance = add(component);
      slot.first_writer += static_cast<unsigned>(instance.outputs().size());
      slot.first_reader += static_cast<unsigned>(instance.inputs().size());
    } else {
      for (const PortBinding& port : component.ports)
        ++(port.direction == PortDirection::output ? slot.first_writer : slot.first_reader);
    }
  }
  slots_.push_back(slot);
  for (const ComponentSpec& component : spec_.loaded) add(component);
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
  watch_anew();
}

/// It looks at the ports in a thread of its own, so none may go while it does.
void Container::watch_anew() {
  watch_.reset();
  watch_ = std::make_unique<Watch>(*this, members_.get(), bell_, [this] { hear_members(); });
  if (expects_peers_) watch_->run_begins();
}

Slot Container::slot_of(const ComponentSpec& spec) const {
  for (std::size_t i = 0; i < spec_.components.size(); ++i)
    if (spec_.components[i].name == spec.name && spec_.components[i].type == spec.type) return slots_[i];
  // Behind the composition's. The endpoints of several containers lie between each other, so that no two are the same.
  const auto self = std::ranges::find(spec_.members, spec_.name);
  const auto place = self == spec_.members.end() ? 0u : static_cast<unsigned>(self - spec_.members.begin());
  const unsigned stride = std::max(1u, static_cast<unsigned>(spec_.members.size()));
  const Slot& behind = slots_.back();
  return {.index = behind.index + loaded_ever_,
          .first_writer = behind.first_writer + stride * loaded_writers_ + place,
          .first_reader = behind.first_reader + stride * loaded_readers_ + place,
          .stride = stride};
}

ComponentInstance& Container::add(const ComponentSpec& spec) {
  const ComponentClass* type = registry_.find(spec.type);
  if (!type) throw ConfigError({}, "there is no component type '" + spec.type + "'");
  const Slot slot = slot_of(spec);
  std::unique_ptr<ComponentInstance> made;
  try {
    made = std::make_unique<ComponentInstance>(*this, spec, *type, slot);
  } catch (const ParameterError& error) {
    throw ParameterError(spec.name + "." + error.parameter(), error.message());
  } catch (...) {
    if (lockstep_) lockstep_->forget_departed();  // it may have had samples already
    throw;
  }
  if (slot.index >= slots_.back().index && slots_.size() > spec_.components.size()) {
    ++loaded_ever_;
    loaded_writers_ += static_cast<unsigned>(made->outputs().size());
    loaded_readers_ += static_cast<unsigned>(made->inputs().size());
  }
  {
    const std::lock_guard lock(writer_indices_mutex_);
    for (const auto& output : made->outputs()) writer_indices_.emplace(output->writer().handle(), output->index());
  }
  for (const auto& output : made->outputs()) {
    const auto departed = departed_traces_.find(output->index());
    if (departed == departed_traces_.end()) continue;
    output->continue_trace(departed->second.first, departed->second.second);
    departed_traces_.erase(departed);
  }
  const auto behind = std::ranges::find_if(instances_, [&](const auto& other) { return other->index() > slot.index; });
  ComponentInstance& added = **instances_.insert(behind, std::move(made));
  if (watch_) watch_anew();
  return added;
}

void Container::remove(ComponentInstance& instance) {
  Dispatcher* const dispatcher = instance.dispatcher.load();
  if (dispatcher) dispatcher->forget(instance);
  for (const auto& output : instance.outputs()) {
    if (output->trace() != 0) departed_traces_[output->index()] = {output->published(), output->trace()};
    departed_writers_.push_back(output->writer().handle());
  }
  status_writer_->remove(instance, spec_.name, present().time);
  const auto place = std::ranges::find_if(instances_, [&](const auto& other) { return other.get() == &instance; });
  const bool watched = watch_ != nullptr;
  watch_.reset();
  {
    // Its endpoints go first: what they set off still finds its dispatcher.
    const std::unique_ptr<ComponentInstance> leaving = std::move(*place);
    instances_.erase(place);
  }
  if (watched) watch_anew();
  if (lockstep_) lockstep_->forget_departed();
  detach(dispatcher);
  const std::lock_guard lock(writer_indices_mutex_);
  for (; departed_writers_.size() > kDepartedWriters; departed_writers_.pop_front())
    writer_indices_.erase(departed_writers_.front());
}

Instant Container::present() const { return lockstep_ ? instant_ : Instant{clock_.now(), 0}; }

bool Container::ending() const {
  return finish_requested_.load(std::memory_order_relaxed) || (stop_ && stop_->load(std::memory_order_relaxed));
}

void Container::wake() {
  const std::lock_guard lock(finish_mutex_);
  finish_wanted_.notify_one();
}

Container::~Container() = default;

ComponentInstance* Container::find(const std::string& name) {
  for (const auto& instance : instances_)
    if (instance->name() == name) return instance.get();
  return nullptr;
}

std::uint64_t Container::trace_hash() const {
  std::map<unsigned, std::uint64_t> traces;
  for (const auto& [index, departed] : departed_traces_) traces[index] = departed.second;
  for (const auto& instance : instances_)
    for (const auto& output : instance->outputs()) traces[output->index()] = output->trace();
  if (lockstep_)
    for (const auto& [index, trace] : lockstep_->traces_elsewhere()) traces[index] = trace;
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
    if (instance->take_status_due(instant_.time)) publish_status(*instance);
}

std::shared_ptr<spdlog::logger> Container::make_logger(const ComponentSpec& spec) {
  return log_sinks_->make(spec.name, spec.log_level);
}

void Container::activate() {
  instant_ = {spec_.clock == ClockMode::lockstep ? Time{} : clock_.now(), 0};
  started_ = instant_.time;
  for (const auto& instance : instances_) {
    if (std::ranges::count(spec_.inactive, instance->name()) == 0)
      instance->activate(instant_);
    else
      instance->stop("deactivated on request");
  }
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
  stop_ = control.stop;
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
    expects_peers_ = true;
    if (watch_) watch_->run_begins();
    if (members_) members_->publish(kervan_msgs::msg::ContainerPhase::CONTAINER_ACTIVE, {}, instant_.time);
    if (control.phase) control.phase(RunPhase::active);
    report = lockstep_ ? lockstep_->run(control) : run_dispatchers(control);
    expects_peers_ = false;
    if (watch_) watch_->run_ends();
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
    // Perhaps only while everybody was ending.
    if (const auto& broken_off = lockstep_->broken_off()) {
      report.end = broken_off->end;
      report.reason = broken_off->reason;
      report.broken_off = true;
    }
  }
  return report;
}

}  // namespace kervan::runtime
