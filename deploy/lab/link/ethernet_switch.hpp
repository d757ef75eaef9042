/// Joins interfaces through emulated links: reads their Ethernet frames, asks the link model of each direction what
/// becomes of them, and writes them where they belong when their time has come. In user space, on one thread.
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <optional>
#include <queue>
#include <string>
#include <vector>

#include "deploy/lab/link/counters_json.hpp"
#include "deploy/lab/link/descriptor.hpp"
#include "deploy/lab/link/link_model.hpp"
#include "deploy/lab/link/network_namespace.hpp"

namespace kervan::link {

/// The hardware address of the interface behind the port of this number, 0 to 65,534.
MacAddress mac_of_port(std::size_t number);

struct SwitchPort {
  std::string name;  ///< of the host, for links and reports
  Descriptor tap;    ///< made with mac_of_port()
};

class EthernetSwitch {
 public:
  /// A frame goes to the port of its address, or to all others if its address is a group's; each direction between two
  /// ports is a link of its own.
  EthernetSwitch(std::vector<SwitchPort> ports, const composition::Links& links);

  /// Returns when `control` is closed at its other end, says 'q', or after `limit`. A 'b' from it begins the schedule
  /// of outages. Throws std::system_error.
  void run(int control, Duration limit = forever);

  /// Begins the schedule of outages.
  void begin();

  std::vector<LinkReport> reports() const;

 private:
  static constexpr std::size_t kLongestFrame = 1600;  ///< interfaces have an MTU of 1500 bytes
  struct Frame {
    std::array<std::byte, kLongestFrame> bytes;
    std::size_t size = 0;
  };
  struct Pending {
    Duration at;
    std::uint64_t order;  ///< of those with one time the first that was sent goes first
    std::size_t frame, link;
    bool operator<(const Pending& other) const {  // the queue's top is the greatest
      return at != other.at ? at > other.at : order > other.order;
    }
  };
  struct Link {
    std::size_t from, to;
    LinkModel model;
    LinkReport report;
  };

  static Duration now();
  void receive(std::size_t port);
  void send(const Frame& frame, Link& link, Duration now);
  void put_off(const Frame& frame, std::size_t link, const Delivery& delivery);
  void hand_over(const Frame& frame, Link& link, Duration at);
  void deliver_due();
  std::size_t link_index(std::size_t from, std::size_t to) const;
  bool obey(int control);

  std::vector<SwitchPort> ports_;
  std::vector<Link> links_;  ///< from port 0 to all others, from port 1 to all others, …
  std::deque<Frame> frames_;
  std::vector<std::size_t> free_frames_;
  std::priority_queue<Pending> pending_;
  std::uint64_t order_ = 0;
};

}  // namespace kervan::link
