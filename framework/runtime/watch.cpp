#include "framework/runtime/watch.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <set>

#include "framework/runtime/container.hpp"
#include "framework/runtime/log.hpp"
#include "framework/runtime/matching.hpp"
#include "framework/runtime/trouble.hpp"

namespace kervan::runtime {

namespace {

constexpr std::chrono::milliseconds kLongestSleep{250};
/// How often components are given the occasion to publish changed counters.
constexpr std::chrono::seconds kStatusPeriod{1};
/// A peer may be missing for so long without a word: that is how long a restart takes.
constexpr std::chrono::seconds kMissingAfter{1};
/// Lines of Cyclone that differ in numbers only are passed on this often.
constexpr std::chrono::seconds kLogPeriod{10};

}  // namespace

Watch::Watch(Container& container, const Members* members, Bell& bell, std::function<void()> tick)
    : container_(container),
      members_(members),
      bell_(bell),
      tick_(std::move(tick)),
      discovery_(container.domain(), [&bell] { bell.ring(); }) {
  const Matching matching(container);
  const auto add = [&](auto& port, const CompositionEndpoint& endpoint, bool writer, std::uint64_t handle) {
    port.health().set_trouble({});
    port.health().mark_changed();  // an earlier watch may have looked already
    ports_.push_back({.name = endpoint.name,
                      .short_name = port.name(),
                      .topic = endpoint.topic,
                      .writer = writer,
                      .handle = handle,
                      .layout_hash = port.type().layout_hash,
                      .owner = &port.owner(),
                      .health = &port.health(),
                      .matched_now = [&port] { return port.matched(); },
                      .expected = {},
                      .troubles = {}});
    return &ports_.back();
  };
  const auto expect = [](Port& port, unsigned index, const CompositionEndpoint& other) {
    port.expected.push_back({index, other.name, other.container, false, Clock::now()});
  };
  for (unsigned reader = 0; reader < matching.readers().size(); ++reader) {
    const CompositionEndpoint& endpoint = matching.readers()[reader];
    reader_names_.push_back(endpoint.name);
    if (!endpoint.input) continue;
    Port& port = *add(*endpoint.input, endpoint, false, endpoint.input->reader().handle());
    for (const Matching::Pair& pair : matching.pairs())
      if (pair.reader == reader) expect(port, pair.writer, matching.writers()[pair.writer]);
  }
  for (unsigned writer = 0; writer < matching.writers().size(); ++writer) {
    const CompositionEndpoint& endpoint = matching.writers()[writer];
    writer_names_.push_back(endpoint.name);
    if (!endpoint.output) continue;
    Port& port = *add(*endpoint.output, endpoint, true, endpoint.output->writer().handle());
    for (const Matching::Pair& pair : matching.pairs())
      if (pair.writer == writer) expect(port, pair.reader, matching.readers()[pair.reader]);
  }
  container.domain().reports().listen([&bell] { bell.ring(); });
  thread_ = std::thread(&Watch::run, this);
}

Watch::~Watch() {
  stopped_ = true;
  bell_.ring();
  thread_.join();
  container_.domain().reports().listen(nullptr);
}

void Watch::run() {
  Clock::time_point next_status = Clock::now() + kStatusPeriod;
  while (!stopped_) {
    take_discovered();
    if (members_) others_ = members_->others();
    undecodable_ = container_.domain().reports().undecodable();
    const LogTime log_time(container_.clock().now());
    for (Port& port : ports_) {
      if (port.health->take_changed()) look_at(port);
      if (stage_ != Stage::ending) tell(port, troubles_of(port));
    }
    pass_on_log();
    tick_();
    changed_.ring();
    if (Clock::now() >= next_status) {
      for (const Port& port : ports_) port.owner->notify();
      next_status = Clock::now() + kStatusPeriod;
    }
    bell_.wait_for(kLongestSleep);
  }
}

void Watch::take_discovered() {
  for (dds::DiscoveryEvent& event : discovery_.take()) {
    auto& topic = endpoints_[event.endpoint.topic];
    if (event.gone)
      topic.erase(event.endpoint.handle);
    else
      topic.insert_or_assign(event.endpoint.handle, std::move(event.endpoint));
  }
}

void Watch::look_at(Port& port) {
  std::set<unsigned> matched;
  for (const dds::MatchedPeer& peer : port.matched_now())
    if (peer.identity && peer.identity->layout_hash == port.layout_hash) matched.insert(peer.identity->index);
  const std::lock_guard lock(mutex_);
  for (Expected& expected : port.expected) {
    const bool is_matched = matched.contains(expected.index);
    if (expected.matched && !is_matched) expected.missing_since = Clock::now();
    expected.matched = is_matched;
  }
}

std::vector<std::string> Watch::missing_pairs() const {
  std::vector<std::string> missing;
  const std::lock_guard lock(mutex_);
  for (const Port& port : ports_)
    for (const Expected& expected : port.expected)
      if (!expected.matched)
        missing.push_back(port.name + " with " + expected.name + " of container '" + expected.container + "'");
  return missing;
}

std::vector<std::string> Watch::troubles_of(Port& port) {
  std::vector<std::string> troubles;
  std::set<unsigned> explained;  // expected peers about which something is said already
  const auto& on_topic = endpoints_[port.topic];
  if (const auto own = on_topic.find(port.handle); own != on_topic.end()) {
    for (const auto& [handle, peer] : on_topic) {
      if (handle == port.handle) continue;
      const bool together = peer.writer != port.writer && peer.identity &&
                            std::ranges::count(port.expected, peer.identity->index, &Expected::index) > 0;
      const std::string name = name_of(peer, port_name(peer));
      const std::vector<std::string> sentences = conflicts(own->second, peer, name, together);
      if (together && !sentences.empty()) explained.insert(peer.identity->index);
      troubles.insert(troubles.end(), sentences.begin(), sentences.end());
      const auto undecodable = undecodable_.find(peer.guid);
      if (port.writer || undecodable == undecodable_.end()) continue;
      port.health->add_undecodable(undecodable->second -
                                   std::exchange(port.undecodable[peer.guid], undecodable->second));
      troubles.push_back("samples of " + name + " are no " + type_of(own->second) + " as this port knows it");
    }
  }
  if (stage_ != Stage::running) return troubles;
  for (const Expected& expected : port.expected) {
    if (explained.contains(expected.index)) continue;
    const std::string why = why_missing(expected);
    if (!why.empty())
      troubles.push_back(std::string("no match with ") + (port.writer ? "reader " : "writer ") + expected.name +
                         " of container '" + expected.container + "': " + why);
  }
  return troubles;
}

/// Empty if it is matched, or has been missing for a moment only.
std::string Watch::why_missing(const Expected& expected) const {
  const auto other = others_.find(expected.container);
  if (other != others_.end() && !other->second.answers) return "it does not answer";
  if (expected.matched || Clock::now() - expected.missing_since < kMissingAfter) return {};
  if (other == others_.end()) return "it is not there";
  return other->second.status.phase == kervan_msgs::msg::ContainerPhase::CONTAINER_STARTING ? "it is starting"
                                                                                            : "it has no such port";
}

/// The name in the composition of one of its ports; empty for others.
std::string Watch::port_name(const dds::DiscoveredEndpoint& endpoint) const {
  const std::vector<std::string>& names = endpoint.writer ? writer_names_ : reader_names_;
  const bool ours = endpoint.identity && endpoint.participant.identity && endpoint.identity->index < names.size();
  return ours && (!members_ || endpoint.participant.identity->composition == members_->composition())
             ? names[endpoint.identity->index]
             : std::string();
}

void Watch::tell(Port& port, std::vector<std::string> troubles) {
  if (troubles == port.troubles) return;
  const std::string where = port.short_name + " on " + port.topic + ": ";
  for (const std::string& sentence : troubles)
    if (std::ranges::count(port.troubles, sentence) == 0) port.owner->log().warn("{}{}", where, sentence);
  for (const std::string& sentence : port.troubles)
    if (std::ranges::count(troubles, sentence) == 0) port.owner->log().info("{}over: {}", where, sentence);
  port.owner->log().flush();
  std::string all;
  for (const std::string& sentence : troubles) all += (all.empty() ? "" : "; ") + sentence;
  port.troubles = std::move(troubles);
  if (port.health->set_trouble(std::move(all))) port.owner->touch_status();
}

void Watch::pass_on_log() {
  for (const dds::LogLine& line : container_.domain().reports().take_lines()) {
    // Said for each port and writer, with their names, as a trouble.
    if (line.text.find("data(application") != std::string::npos &&
        line.text.find("deserialization") != std::string::npos)
      continue;
    Throttled& like_it = log_lines_[shape_of(line.text)];
    const Clock::time_point now = Clock::now();
    if (like_it.last != Clock::time_point{} && now - like_it.last < kLogPeriod) {
      ++like_it.held_back;
      continue;
    }
    const std::uint64_t held_back = std::exchange(like_it.held_back, 0);
    like_it.last = now;
    container_.log().log(line.error ? spdlog::level::err : spdlog::level::warn, "Cyclone DDS: {}{}", line.text,
                         held_back == 0 ? "" : " (and " + std::to_string(held_back) + " more like it)");
  }
}

}  // namespace kervan::runtime
