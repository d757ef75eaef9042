#include "framework/runtime/fences.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstdio>

#include "framework/component/error.hpp"
#include "framework/component/sample.hpp"
#include "kervan_msgs/msg/Fence.hpp"

namespace kervan::runtime {

namespace {

using namespace std::chrono_literals;
using kervan_msgs::msg::Fence;
using kervan_msgs::msg::FenceWish;
constexpr const char* kFenceTopic = "/kervan/fence";

/// A member that was not heard of for so long is lost: with the time it takes to tell everybody, less than 2 s.
constexpr Duration kLease = 1500ms;
/// How often a waiting or working container says that it is alive.
constexpr Duration kAssertPeriod = 200ms;
/// How often whoever waits looks whether it still should.
constexpr Duration kLookPeriod = 50ms;
/// Told to stop, a container waits so long for the others: whoever is at work agrees on an end with it.
constexpr Duration kStopPatience = 100ms;
/// The last fence may take so long to reach the others, and so long if one of them is no longer there.
constexpr Duration kLastWords = 1s, kLastWordsWithoutOne = 100ms;
/// Cyclone watches the lease and otherwise carries: "keep all" of a fence is two samples.
QosProfile fence_profile() {
  return {.name = "fence", .depth = 0, .liveliness = Liveliness::manual, .lease = kLease, .trace = false};
}

std::string place(Instant at) {
  char text[64];
  std::snprintf(text, sizeof text, "t = %.6f s, cycle %u", seconds(at.time), at.cycle);
  return at.time < Time{} ? "the start" : text;
}

bool before(const StopWish& a, const StopWish& b) {
  if (a.end != b.end) return a.end == RunEnd::finished;
  return a.component < b.component;
}

void require_runnable(const ContainerSpec& spec) {
  const std::string who =
      "container '" + spec.name + "' of a lockstep run in " + std::to_string(spec.members.size()) + " containers ";
  if (std::ranges::count(spec.members, spec.name) != 1) throw ConfigError({}, who + "is not one of its members");
  if (!spec.domain.network) throw ConfigError({}, who + "needs a network: domain.network is false");
  if (spec.domain.tag.empty())
    throw ConfigError({},
                      who + "needs a tag of its own for each run, or two runs hear each other: domain.tag is empty");
}

}  // namespace

Fences::Fences(Container& container)
    : container_(container),
      matching_(container),
      log_(container.make_logger({.name = "lockstep", .type = {}})),
      hearers_(matching_.writers().size()),
      longest_handler_(RunControl{}.longest_handler.count()) {
  const ContainerSpec& spec = container.spec();
  require_runnable(spec);
  for (const CompositionEndpoint& reader : matching_.readers())
    if (reader.topic.starts_with("/kervan/") || reader.topic == "/rosout")
      throw ConfigError({}, reader.name + " hears " + reader.topic +
                                ", which every container publishes in its own time; under lockstep only a composition "
                                "in one container can do that");
  for (const std::string& name : spec.members) {
    if (name == spec.name) self_ = static_cast<unsigned>(members_.size());
    members_.push_back({.name = name});
  }
  for (unsigned i = 0; i < matching_.writers().size(); ++i) {
    const CompositionEndpoint& writer = matching_.writers()[i];
    if (!writer.output) continue;
    const auto hears = [&](const CompositionEndpoint& reader) { return reader.topic == writer.topic; };
    const auto elsewhere = [&](const CompositionEndpoint& reader) { return hears(reader) && !reader.input; };
    if (std::ranges::any_of(matching_.readers(), hears))
      heard_.push_back({writer.output, std::ranges::any_of(matching_.readers(), elsewhere)});
  }
  const TypeSupport& type = type_support<Fence>();
  const auto part = dds::CyclonePart::whole_profile;
  writer_ = std::make_unique<dds::Writer>(container.domain(), kFenceTopic, type, fence_profile(), part, 0, self_);
  reader_ = std::make_unique<dds::Reader>(container.domain(), kFenceTopic, type, fence_profile(), part, *this, self_);
  watchdog_ = std::thread(&Fences::watch, this);
}

Fences::~Fences() {
  {
    const std::lock_guard lock(watch_mutex_);
    watch_ended_ = true;
  }
  watch_end_.notify_one();
  watchdog_.join();
  // Writers of a lockstep run do not linger.
  writer_->wait_for_acknowledgement(broken_off_ ? kLastWordsWithoutOne : kLastWords);
  reader_.reset();
  if (own_) dds::release(own_);
  release_fences();
  for (const Member& member : members_)
    for (unsigned i = 0; i < member.count; ++i) dds::release(member.fences[i]);
}

Fence& Fences::own() {
  if (!own_) own_ = writer_->loan(true);
  return *static_cast<Fence*>(dds::mutable_value_of(own_));
}

void Fences::send(Instant at) {
  Fence& fence = own();
  fence.container = self_;
  fence.t = at.time.time_since_epoch().count();
  fence.d = at.cycle;
  writer_->publish(std::exchange(own_, nullptr), at.time, false);
}

void Fences::on_sample(const dds::Arrival& arrival) noexcept {
  const auto& fence = *static_cast<const Fence*>(dds::value_of(arrival.block));
  if (fence.container >= members_.size() || fence.container == self_) return;
  Member& member = members_[fence.container];
  lock();
  if (fence.wish == FenceWish::FENCE_LOST || fence.wish == FenceWish::FENCE_GIVEN_UP) {
    if (words_.empty()) {
      words_ = fence.reason;
      given_up_ = fence.wish == FenceWish::FENCE_GIVEN_UP;
    }
    unlock();
    return member_gone(fence.who);
  }
  if (member.count == member.fences.size()) {
    unlock();
    return member_gone(fence.container);
  }
  dds::retain(arrival.block);
  member.fences[member.count++] = arrival.block;
  member.leaving = fence.wish == FenceWish::FENCE_LEAVING;
  const bool awaited = std::exchange(member.awaited, false);
  unlock();
  if (awaited) countdown_.done();
}

void Fences::on_writer_gone(std::uint64_t writer) noexcept {
  lock();
  const auto member = std::ranges::find(members_, writer, &Member::writer);
  const bool known = member != members_.end();
  if (!known) left_.push_back(writer);
  const bool lost = known && !member->leaving;
  unlock();
  if (lost) member_gone(static_cast<unsigned>(member - members_.begin()));
}

void Fences::member_gone(unsigned member) noexcept {
  int nobody = -1;
  gone_.compare_exchange_strong(nobody, static_cast<int>(member));
  countdown_.wake();
}

/// Until everything that was counted has happened; false if it is `until`, or if the others are not waited for any
/// more.
bool Fences::wait(Instant at, Steady::time_point until) {
  progress_.fetch_add(1, std::memory_order_relaxed);
  Steady::time_point words_at{}, told_at{};
  bool over = false;
  const bool all = countdown_.wait([&] {
    if (gone_.load() >= 0) return over = true;
    // The watchdog wakes us now and then.
    const Steady::time_point now = Steady::now();
    if (told_at == Steady::time_point{} && told_to_stop()) told_at = now;
    if (told_at != Steady::time_point{} && now - told_at >= kStopPatience) return over = true;
    if (words_at == Steady::time_point{}) words_at = now + kPatience;
    if (now >= words_at) {
      log_->warn("{}: waiting for {}", place(at), still_missing());
      words_at = now + kPatience;
    }
    return now >= until;
  });
  progress_.fetch_add(1, std::memory_order_relaxed);
  if (over) break_off(at, still_missing());
  return all;
}

/// The end, for this container alone: somebody is lost, or it was told to stop, or another one was, while `missing`
/// kept it waiting.
void Fences::break_off(Instant at, const std::string& missing) {
  const int gone = gone_.load();
  lock();
  const std::string words = words_;
  const bool given_up = gone < 0 || given_up_;
  unlock();
  // Whoever misses this container from now on must not take it for the one that failed.
  Fence& fence = own();
  fence.wish = given_up ? FenceWish::FENCE_GIVEN_UP : FenceWish::FENCE_LOST;
  fence.who = gone < 0 ? self_ : static_cast<unsigned>(gone);
  if (!words.empty())
    fence.reason = (fence.who == self_ ? "the others gave this container up: " : "") + words;
  else if (given_up)
    fence.reason = "container '" + members_[self_].name + "' was told to stop while it waited for " + missing;
  else
    fence.reason = "container '" + (fence.who < members_.size() ? members_[fence.who].name : "?") +
                   "' died or stopped; the run was at " + place(at);
  broken_off_ = RunReport{.end = given_up ? RunEnd::interrupted : RunEnd::peer_lost,
                          .reason = given_up && told_to_stop() ? "interrupted" : fence.reason,
                          .broken_off = true};
  if (given_up) log_->info("{}: {}", place(at), fence.reason);
  send(at);
}

/// The next fence of every other member.
bool Fences::receive(Instant at, Steady::time_point until) {
  countdown_.add(1);
  lock();
  for (Member& member : members_) {
    if (&member == &members_[self_] || member.count > 0) continue;
    member.awaited = true;
    countdown_.add(1);
  }
  unlock();
  countdown_.done();
  if (!wait(at, until)) return false;
  release_fences();
  lock();
  for (Member& member : members_) {
    if (&member == &members_[self_]) continue;
    blocks_.push_back(member.fences[0]);
    member.fences[0] = member.fences[1];
    --member.count;
  }
  unlock();
  for (const dds::SampleBlock* block : blocks_) fences_.push_back(static_cast<const Fence*>(dds::value_of(block)));
  for (const Fence* fence : fences_) {
    if (fence->t == at.time.time_since_epoch().count() && fence->d == at.cycle) continue;
    broken_off_ = RunReport{.end = RunEnd::peer_lost,
                            .reason = "container '" + members_[fence->container].name + "' is at " +
                                      place({Time(Duration(fence->t)), fence->d}) + " and this one at " + place(at) +
                                      ": they are out of step",
                            .broken_off = true};
    return false;
  }
  return true;
}

void Fences::release_fences() {
  for (dds::SampleBlock* block : blocks_) dds::release(block);
  blocks_.clear();
  fences_.clear();
}

bool Fences::grew() {
  bool grew = false;
  for (HeardWriter& writer : heard_) {
    const std::uint64_t sent = writer.output->published();
    if (sent == writer.sent) continue;
    writer.sent = sent;
    grew = true;
    if (!writer.elsewhere) continue;
    auto& count = own().sent.emplace_back();
    count.writer = writer.output->index();
    count.sent = sent;
  }
  return grew;
}

bool Fences::exchange(Instant at, Round& round) {
  Fence& fence = own();
  fence.more = round.more;
  fence.next = round.next.time_since_epoch().count();
  if (round.stop) {
    fence.wish = round.stop->end == RunEnd::finished ? FenceWish::FENCE_FINISHED : FenceWish::FENCE_INTERRUPTED;
    fence.who = round.stop->component;
    fence.reason = round.stop->reason;
  }
  fence.ran.assign(round.loop.begin(), round.loop.end());
  send(at);
  if (!receive(at)) return false;

  countdown_.add(1);
  for (const Fence* other : fences_) {
    for (const auto& count : other->sent) {
      if (count.writer >= hearers_.size()) continue;
      for (const Hearer& hearer : hearers_[count.writer]) hearer.input->expect(hearer.place, count.sent, countdown_);
    }
    round.more = round.more || other->more;
    round.next = std::min(round.next, Time(Duration(other->next)));
    round.loop.insert(round.loop.end(), other->ran.begin(), other->ran.end());
    if (other->wish != FenceWish::FENCE_FINISHED && other->wish != FenceWish::FENCE_INTERRUPTED) continue;
    StopWish wish{.end = other->wish == FenceWish::FENCE_FINISHED ? RunEnd::finished : RunEnd::interrupted,
                  .component = other->who,
                  .reason = other->reason};
    if (!round.stop || before(wish, *round.stop)) round.stop = std::move(wish);
  }
  countdown_.done();
  return wait(at);
}

bool Fences::leave(Instant at) {
  Fence& fence = own();
  fence.wish = FenceWish::FENCE_LEAVING;
  for (const CompositionEndpoint& writer : matching_.writers()) {
    if (!writer.output) continue;
    auto& trace = fence.traces.emplace_back();
    trace.writer = writer.output->index();
    trace.trace = writer.output->trace();
  }
  send(at);
  if (!receive(at)) return false;
  for (const Fence* other : fences_)
    for (const auto& trace : other->traces) traces_.emplace_back(trace.writer, trace.trace);
  return true;
}

/// What is still waited for; for a person who wonders why nothing goes on.
std::string Fences::still_missing() const {
  std::string text;
  lock();
  for (const Member& member : members_)
    if (member.awaited) text += (text.empty() ? "the fence of container " : ", of container ") + member.name;
  unlock();
  if (!text.empty()) return text;
  for (const CompositionEndpoint& reader : matching_.readers()) {
    if (!reader.input) continue;
    for (const CountedWriters::Writer& writer : reader.input->counted_writers()) {
      if (writer.arrived >= writer.awaited) continue;
      const CompositionEndpoint& from = matching_.writers()[writer.index];
      text += (text.empty() ? "" : "; ") + reader.name + ", which has " + std::to_string(writer.arrived) + " of " +
              std::to_string(writer.awaited) + " samples of " + from.name + " in container " + from.container;
    }
  }
  return text.empty() ? "nothing any more" : text;
}

void Fences::watch() {
  std::uint64_t seen = progress_.load(std::memory_order_relaxed);
  Steady::time_point since = Steady::now(), assert_at = since;
  std::unique_lock lock(watch_mutex_);
  while (!watch_end_.wait_for(lock, kLookPeriod, [this] { return watch_ended_; })) {
    const Steady::time_point now = Steady::now();
    const std::uint64_t progress = progress_.load(std::memory_order_relaxed);
    if (std::exchange(seen, progress) != progress) since = now;
    const bool waiting = progress % 2 == 1;
    // A container that works in one handler for ever is no better than a dead one, and the others should hear of it.
    const bool lives = waiting || now - since < Duration(longest_handler_.load(std::memory_order_relaxed));
    if (lives && now >= assert_at) {
      writer_->assert_alive();
      assert_at = now + kAssertPeriod;
    }
    if (waiting) countdown_.wake();
  }
}

}  // namespace kervan::runtime
