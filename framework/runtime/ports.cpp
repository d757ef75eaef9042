#include "framework/runtime/ports.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>

#include "framework/dds/cdr.hpp"
#include "framework/dds/hash.hpp"
#include "framework/runtime/container.hpp"
#include "framework/runtime/countdown.hpp"
#include "framework/runtime/instance.hpp"

namespace kervan::runtime {

namespace {

/// How many samples may wait for a component that does not come to look. Only then does an inbox fill up, and without a
/// bound it would take all memory. Under lockstep nothing may depend on how fast anybody is, so everything is kept.
std::size_t inbox_limit(ClockMode clock, const QosProfile& profile, bool keyed) {
  if (clock == ClockMode::lockstep) return std::numeric_limits<std::size_t>::max();
  if (profile.limit > 0) return static_cast<std::size_t>(profile.limit);
  return static_cast<std::size_t>(keyed || profile.depth == 0 ? kMostKept : profile.depth + 64);
}

/// In this time after its first sample a writer's history has reached a late joiner.
constexpr Duration kHistoryComes = std::chrono::seconds(2);

dds::CyclonePart part_of(ClockMode clock) {
  switch (clock) {
    case ClockMode::wall: return dds::CyclonePart::whole_profile;
    case ClockMode::sim: return dds::CyclonePart::untimed;
    case ClockMode::lockstep: return dds::CyclonePart::carrier;
  }
  return dds::CyclonePart::carrier;
}

}  // namespace

InputPort::InputPort(InputBase& input, const PortBinding& binding, ComponentInstance& owner, dds::Domain& domain,
                     ClockMode clock, unsigned index)
    : input_(input),
      binding_(binding),
      owner_(owner),
      index_(index),
      clock_(clock),
      inbox_limit_(inbox_limit(clock, binding.profile, input.type().keyed)),
      cache_(binding.profile, input.info().qos.max_age(), input.type().keyed, static_cast<bool>(input.deliver_),
             clock != ClockMode::wall) {
  reader_ = std::make_unique<dds::Reader>(domain, binding.topic, input.type(), binding.profile, part_of(clock), *this,
                                          index_);
  input.port_ = this;
}

InputPort::~InputPort() {
  input_.port_ = nullptr;
  reader_.reset();  // no sample arrives from here on
  for (std::size_t i = inbox_first_; i < inbox_.size(); ++i) dds::release(inbox_[i].block);
  for (const dds::Arrival& arrival : early_) dds::release(arrival.block);
  for (dds::SampleBlock* block : given_) dds::release(block);
}

void InputPort::on_sample(const dds::Arrival& arrival) noexcept {
  dds::retain(arrival.block);
  dds::SampleBlock* overflow = nullptr;
  lock();
  count_gap(arrival);
  if (inbox_.size() - inbox_first_ >= inbox_limit_ && binding_.profile.limit > 0) {
    // The profile says that what waits already counts more than what comes.
    ++overflowed_;
    unlock();
    dds::release(arrival.block);
    return;
  }
  if (inbox_.size() - inbox_first_ >= inbox_limit_) {
    overflow = inbox_[inbox_first_++].block;
    ++overflowed_;
    // The gap in front is closed once it is as long as what waits behind it.
    if (inbox_first_ > inbox_limit_) {
      inbox_.erase(inbox_.begin(), inbox_.begin() + static_cast<std::ptrdiff_t>(inbox_first_));
      inbox_first_ = 0;
    }
  }
  inbox_.push_back(arrival);
  // What comes from another container is only looked at when a fence says that its time has come.
  CountedWriters::Writer* const elsewhere = counted_.empty() ? nullptr : counted_.find(arrival.writer);
  Countdown* const last_awaited = elsewhere && ++elsewhere->arrived == elsewhere->awaited ? arrivals_ : nullptr;
  unlock();
  if (overflow) dds::release(overflow);
  if (!elsewhere) mark_ready();
  if (last_awaited) last_awaited->done();
}

/// Under spin_.
void InputPort::count_gap(const dds::Arrival& arrival) {
  if (arrival.sequence == 0) return;
  const auto known = std::ranges::find(sequences_, arrival.writer, &Sequence::writer);
  if (known == sequences_.end()) {
    sequences_.push_back({arrival.writer, arrival.sequence, dds::received_at(arrival.block)});
    return;
  }
  const bool gap = arrival.sequence > known->last + 1;
  // What a writer kept for late joiners has gaps where newer samples took the place of older ones.
  const bool history = gap && binding_.profile.durability == Durability::transient_local &&
                       dds::received_at(arrival.block) - known->since < kHistoryComes;
  if (gap && !history) gaps_ += arrival.sequence - known->last - 1;
  known->last = std::max(known->last, arrival.sequence);
}

void InputPort::on_writer_gone(std::uint64_t writer) noexcept {
  lock();
  gone_.push_back(writer);
  std::erase_if(sequences_, [&](const Sequence& sequence) { return sequence.writer == writer; });
  unlock();
  mark_ready();
}

void InputPort::mark_ready() noexcept {
  if (!ready_.exchange(true, std::memory_order_release)) owner_.container().input_ready(*this);
}

void InputPort::on_writer_lost(std::uint64_t writer) noexcept {
  lock();
  lost_.push_back(writer);
  unlock();
  mark_ready();
}

std::size_t InputPort::count_writer(std::uint64_t handle, unsigned index) {
  lock();
  counted_.add(handle, index);
  const std::size_t place = counted_.all().size() - 1;
  unlock();
  return place;
}

void InputPort::expect(std::size_t place, std::uint64_t sent, Countdown& arrivals) {
  lock();
  CountedWriters::Writer& writer = counted_[place];
  writer.allowed = sent;
  writer.awaited = sent;
  arrivals_ = &arrivals;
  if (writer.arrived < sent) arrivals.add(1);
  unlock();
  mark_ready();
}

std::vector<CountedWriters::Writer> InputPort::counted_writers() const {
  lock();
  std::vector<CountedWriters::Writer> writers = counted_.all();
  unlock();
  return writers;
}

void InputPort::on_status() noexcept {
  health_.mark_changed();
  owner_.container().bell().ring();
}

PortCounters InputPort::counters() const {
  PortCounters counters = cache_.counters();
  lock();
  counters.refused += overflowed_;
  counters.lost = gaps_;
  unlock();
  counters.undecodable = health_.undecodable();
  counters.late = late_;
  counters.worst_latency = worst_latency_;
  return counters;
}

/// Its place in the composition, where that matters.
unsigned InputPort::writer_of(const dds::Arrival& arrival) const {
  const bool matters = clock_ == ClockMode::lockstep || binding_.profile.ownership == Ownership::exclusive ||
                       binding_.profile.liveliness == Liveliness::manual;
  return matters ? owner_.container().writer_index(*this, arrival.writer) : 0;
}

void InputPort::stage(Time now) {
  lock();
  arrived_.swap(inbox_);
  const std::size_t first = std::exchange(inbox_first_, 0);
  const std::vector<std::uint64_t> gone = std::exchange(gone_, {});
  const std::vector<std::uint64_t> lost = std::exchange(lost_, {});
  unlock();
  const bool ordered = clock_ == ClockMode::lockstep;
  staged_.clear();
  const auto stage_if_due = [&](const dds::Arrival& arrival) {
    CountedWriters::Writer* const elsewhere = counted_.find(arrival.writer);
    if (elsewhere && elsewhere->staged == elsewhere->allowed) return false;
    if (elsewhere) ++elsewhere->staged;
    const unsigned writer = elsewhere ? elsewhere->index : writer_of(arrival);
    const Time received = ordered ? now : dds::received_at(arrival.block);
    staged_.push_back({arrival.block, writer, arrival.instance, arrival.strength, received});
    return true;
  };
  std::erase_if(early_, stage_if_due);
  for (std::size_t i = first; i < arrived_.size(); ++i)
    if (!stage_if_due(arrived_[i])) early_.push_back(arrived_[i]);
  arrived_.clear();
  // Each writer's samples arrived in the order of their sequence, so sorting by writer gives (writer, sequence).
  if (ordered && !std::ranges::is_sorted(staged_, {}, &StagedSample::writer))
    std::ranges::stable_sort(staged_, {}, &StagedSample::writer);
  cache_.stage(staged_);
  for (const std::uint64_t writer : gone) cache_.writer_gone(owner_.container().writer_index(*this, writer));
  for (const std::uint64_t writer : lost) cache_.writer_lost(owner_.container().writer_index(*this, writer));
}

void InputPort::deliver(Time now) {
  if (!input_.deliver_) return;
  const bool logical = clock_ == ClockMode::lockstep;
  for (bool first = true; dds::SampleBlock* block = cache_.take(now); first = false) {
    struct Release {
      dds::SampleBlock* block;
      ~Release() { dds::release(block); }
    } const release{block};
    // The first handler begins now, the next ones when those before them are done. Logical time stands still meanwhile,
    // and what it stages is received at the time of staging.
    const Duration latency =
        logical ? Duration::zero() : (first ? now : owner_.container().clock().now()) - dds::received_at(block);
    worst_latency_ = std::max(worst_latency_, latency);
    if (latency > input_.info().qos.max_age()) ++late_;
    input_.deliver_(block, now);
  }
}

dds::SampleBlock* InputPort::latest() const { return cache_.latest(owner_.instant().time); }

std::vector<dds::SampleBlock*> InputPort::take() {
  for (dds::SampleBlock* block : given_) dds::release(block);
  given_.clear();
  while (dds::SampleBlock* block = cache_.take(owner_.instant().time)) given_.push_back(block);
  return given_;
}

std::vector<dds::SampleBlock*> InputPort::instances() const { return cache_.instances(owner_.instant().time); }

std::string InputPort::missing() const {
  const Time now = owner_.instant().time;
  if (cache_.latest(now)) return {};
  Time last;
  if (!cache_.last_received(last)) return input_.name() + ": nothing received yet";
  const Duration allowed = std::min(input_.info().qos.max_age(), binding_.profile.lifespan);
  if (allowed == forever) return input_.name() + ": its last sample was disposed of";
  // The same sentence for as long as it stays so: a status that changes with every period says nothing new.
  char text[64];
  std::snprintf(text, sizeof text, ": no sample for more than %.2f s", seconds(allowed));
  return input_.name() + text;
}

bool InputPort::waiting() const {
  if (clock_ == ClockMode::lockstep) return false;
  lock();
  const bool some = inbox_.size() > inbox_first_;
  unlock();
  return some;
}

OutputPort::OutputPort(OutputBase& output, const PortBinding& binding, ComponentInstance& owner, dds::Domain& domain,
                       ClockMode clock, unsigned index)
    : output_(output),
      binding_(binding),
      owner_(owner),
      index_(index),
      traced_(clock == ClockMode::lockstep && binding.profile.trace && output.info().qos.traced()),
      keeps_last_(clock != ClockMode::wall && binding.profile.liveliness == Liveliness::manual),
      writer_(domain, binding.topic, output.type(), binding.profile, part_of(clock),
              binding.strength.value_or(output.info().qos.strength()), index, this) {
  output.port_ = this;
}

OutputPort::~OutputPort() {
  output_.port_ = nullptr;
  if (last_) dds::release(last_);
}

void OutputPort::assert_alive() {
  if (!keeps_last_) {
    writer_.assert_alive();
    return;
  }
  if (!last_) return;  // nobody has heard of this writer, so nobody can miss it
  dds::SampleBlock* repeated = writer_.loan(false);
  type().copy(dds::mutable_value_of(repeated), dds::value_of(last_));
  publish(repeated, Operation::assertion);
}

void OutputPort::on_status() noexcept {
  health_.mark_changed();
  owner_.container().bell().ring();
}

void OutputPort::publish(dds::SampleBlock* block, Operation operation) {
  const Instant& at = owner_.instant();
  // A handler may have run for long when it publishes, and age counts from here.
  const Container& container = owner_.container();
  const Time stamp = container.spec().clock == ClockMode::lockstep ? at.time : container.clock().now();
  ++sequence_;
  if (traced_) {
    Hash64 hash(trace_);
    hash.number(at.time.time_since_epoch().count());
    hash.number(at.cycle);
    hash.number(sequence_);
    hash.number(static_cast<int>(operation));
    output_.type().hash(dds::value_of(block), hash);
    trace_ = hash.value();
  }
  if (operation == Operation::assertion) {
    writer_.publish_assertion(block, stamp);
    return;
  }
  if (output_.type().keyed) {
    output_.type().key_bytes(dds::value_of(block), key_);
    if (operation == Operation::dispose)
      alive_.erase(key_);
    else
      alive_.insert(key_);
  }
  if (keeps_last_) {
    if (last_) dds::release(last_);
    last_ = operation == Operation::write ? block : nullptr;
    if (last_) dds::retain(last_);
  }
  writer_.publish(block, stamp, operation == Operation::dispose);
}

void OutputPort::dispose_all() {
  for (const std::string& key : std::set<std::string>(alive_)) {
    dds::SampleBlock* block = loan(true);
    cdr::Reader reader(key.data(), key.size(), cdr::Endian::big);
    if (output_.type().read_key(dds::mutable_value_of(block), reader))
      publish(block, Operation::dispose);
    else
      dds::release(block);
  }
}

void OutputPort::continue_trace(std::uint64_t sequence, std::uint64_t trace) {
  sequence_ = sequence;
  trace_ = trace;
}

}  // namespace kervan::runtime
