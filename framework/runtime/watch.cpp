#include "framework/runtime/watch.hpp"

#include <algorithm>
#include <chrono>
#include <set>

#include "framework/runtime/container.hpp"
#include "framework/runtime/matching.hpp"

namespace kervan::runtime {

namespace {

constexpr Duration kLongestSleep = std::chrono::seconds(1);

}  // namespace

Watch::Watch(Container& container, Bell& bell, std::function<void()> tick)
    : bell_(bell), tick_(std::move(tick)), discovery_(container.domain(), [&bell] { bell.ring(); }) {
  const Matching matching(container);
  const auto add = [&](auto& port, const CompositionEndpoint& endpoint) {
    ports_.push_back({endpoint.name,
                      endpoint.topic,
                      port.type().layout_hash,
                      &port.health(),
                      [&port] { return port.matched(); },
                      {}});
    return &ports_.back();
  };
  const auto expect = [](Port& port, unsigned index, const CompositionEndpoint& other) {
    port.expected.push_back({index, other.name, other.container});
  };
  for (unsigned reader = 0; reader < matching.readers().size(); ++reader) {
    const CompositionEndpoint& endpoint = matching.readers()[reader];
    if (!endpoint.input) continue;
    Port& port = *add(*endpoint.input, endpoint);
    for (const Matching::Pair& pair : matching.pairs())
      if (pair.reader == reader) expect(port, pair.writer, matching.writers()[pair.writer]);
  }
  for (unsigned writer = 0; writer < matching.writers().size(); ++writer) {
    const CompositionEndpoint& endpoint = matching.writers()[writer];
    if (!endpoint.output) continue;
    Port& port = *add(*endpoint.output, endpoint);
    for (const Matching::Pair& pair : matching.pairs())
      if (pair.writer == writer) expect(port, pair.reader, matching.readers()[pair.reader]);
  }
  thread_ = std::thread(&Watch::run, this);
}

Watch::~Watch() {
  stopped_ = true;
  bell_.ring();
  thread_.join();
}

void Watch::run() {
  while (!stopped_) {
    take_discovered();
    for (Port& port : ports_)
      if (port.health->take_changed()) look_at(port);
    tick_();
    changed_.ring();
    bell_.wait_for(kLongestSleep);
  }
}

void Watch::take_discovered() {
  std::set<std::string> topics;
  for (dds::DiscoveryEvent& event : discovery_.take()) {
    topics.insert(event.endpoint.topic);
    if (event.gone)
      endpoints_.erase(event.endpoint.handle);
    else
      endpoints_.insert_or_assign(event.endpoint.handle, std::move(event.endpoint));
  }
  for (Port& port : ports_)
    if (topics.contains(port.topic)) port.health->mark_changed();
}

void Watch::look_at(Port& port) {
  std::set<unsigned> matched;
  for (const dds::MatchedPeer& peer : port.matched_now())
    if (peer.identity && peer.identity->layout_hash == port.layout_hash) matched.insert(peer.identity->index);
  const std::lock_guard lock(mutex_);
  for (Expected& expected : port.expected) expected.matched = matched.contains(expected.index);
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

}  // namespace kervan::runtime
