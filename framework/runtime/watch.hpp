/// Watches who a container's ports are matched with, in a thread of its own: which pairs of the composition are
/// missing.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "framework/dds/discovery.hpp"
#include "framework/runtime/bell.hpp"
#include "framework/runtime/port_health.hpp"

namespace kervan::runtime {

class Container;

class Watch {
 public:
  /// `bell` is what the ports ring when their peers change; `tick` is called by the watch's thread after every ring and
  /// at least once a second. The container's components must outlive the watch.
  Watch(Container& container, Bell& bell, std::function<void()> tick);
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;
  ~Watch();

  /// The pairs of ports, one here and one in another container, that are not matched:
  /// "r1/world.sonar with r1/mapper.sonar of container 'brain'".
  std::vector<std::string> missing_pairs() const;

  /// Waits until what missing_pairs() or the other containers say may have changed, at most this long.
  void wait_for_change(Duration patience) { changed_.wait_for(patience); }

 private:
  /// A port of another container that one of ours belongs together with.
  struct Expected {
    unsigned index;    ///< among the composition's writers or readers
    std::string name;  ///< "r1/mapper.sonar"
    std::string container;
    bool matched = false;  ///< under mutex_
  };
  struct Port {
    std::string name;  ///< "r1/world.sonar"
    std::string topic;
    std::uint64_t layout_hash;
    PortHealth* health;
    std::function<std::vector<dds::MatchedPeer>()> matched_now;
    std::vector<Expected> expected;
  };

  void run();
  void take_discovered();
  void look_at(Port& port);

  Bell& bell_;
  std::function<void()> tick_;
  dds::Discovery discovery_;
  std::map<std::uint64_t, dds::DiscoveredEndpoint> endpoints_;  ///< by handle; the watch's thread only
  mutable std::mutex mutex_;
  std::vector<Port> ports_;
  Bell changed_;
  std::atomic<bool> stopped_{false};
  std::thread thread_;  ///< last: it uses the members above
};

}  // namespace kervan::runtime
