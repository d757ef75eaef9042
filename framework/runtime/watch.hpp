/// Watches who a container's ports are matched with, in a thread of its own. It knows which pairs of the composition
/// are missing, and names what is wrong with peers, foreign ones included: in the log when it begins and when it is
/// over, in the port's health as long as it lasts.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "framework/dds/discovery.hpp"
#include "framework/runtime/bell.hpp"
#include "framework/runtime/members.hpp"
#include "framework/runtime/port_health.hpp"

namespace kervan::runtime {

class ComponentInstance;
class Container;

class Watch {
 public:
  /// `members`, if any, says how the other containers are. `bell` is what the ports ring when their peers change;
  /// `tick` is called by the watch's thread after every ring and at least once a second. What is given must outlive the
  /// watch.
  Watch(Container& container, const Members* members, Bell& bell, std::function<void()> tick);
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;
  ~Watch();

  /// The pairs of ports, one here and one in another container, that are not matched:
  /// "r1/world.sonar with r1/mapper.sonar of container 'brain'".
  std::vector<std::string> missing_pairs() const;

  /// Waits until what missing_pairs() or the other containers say may have changed, at most this long.
  void wait_for_change(Duration patience) { changed_.wait_for(patience); }

  /// Before the run begins nobody is missing yet, and after its end the others may go unmentioned.
  void run_begins() { stage_ = Stage::running; }
  void run_ends() { stage_ = Stage::ending; }

 private:
  using Clock = std::chrono::steady_clock;
  enum class Stage { starting, running, ending };

  /// A port of another container that one of ours belongs together with.
  struct Expected {
    unsigned index;    ///< among the composition's writers or readers
    std::string name;  ///< "r1/mapper.sonar"
    std::string container;
    bool matched = false;  ///< under mutex_
    Clock::time_point missing_since;
  };
  struct Port {
    std::string name;        ///< "r1/world.sonar"
    std::string short_name;  ///< "sonar"
    std::string topic;
    bool writer;
    std::uint64_t handle;  ///< Cyclone's, of our endpoint
    std::uint64_t layout_hash;
    ComponentInstance* owner;
    PortHealth* health;
    std::function<std::vector<dds::MatchedPeer>()> matched_now;
    std::vector<Expected> expected;
    std::vector<std::string> troubles;                    ///< told so far, and not yet over
    std::map<dds::Guid, std::uint64_t> undecodable = {};  ///< counted so far, by writer
  };

  void run();
  void take_discovered();
  void look_at(Port& port);
  std::vector<std::string> troubles_of(Port& port);
  std::string why_missing(const Expected& expected) const;
  std::string port_name(const dds::DiscoveredEndpoint& endpoint) const;
  void tell(Port& port, std::vector<std::string> troubles);
  void pass_on_log();

  Container& container_;
  const Members* members_;
  Bell& bell_;
  std::function<void()> tick_;
  dds::Discovery discovery_;
  std::vector<std::string> writer_names_;  ///< of the composition's ports, by index
  std::vector<std::string> reader_names_;
  /// By topic and handle; the watch's thread only, like what follows.
  std::map<std::string, std::map<std::uint64_t, dds::DiscoveredEndpoint>> endpoints_;
  std::map<dds::Guid, std::uint64_t> undecodable_;
  std::map<std::string, Members::Other> others_;
  struct Throttled {
    Clock::time_point last;
    std::uint64_t held_back = 0;
  };
  std::map<std::string, Throttled> log_lines_;  ///< by shape
  mutable std::mutex mutex_;
  std::vector<Port> ports_;
  Bell changed_;
  std::atomic<Stage> stage_{Stage::starting};
  std::atomic<bool> stopped_{false};
  std::thread thread_;  ///< last: it uses the members above
};

}  // namespace kervan::runtime
