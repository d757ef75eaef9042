/// Who else is on the network: a watch on Cyclone's built-in topics. Cyclone matches and refuses peers without a word
/// about those whose type differs; here every endpoint is a value, foreign ones (ROS 2, plain Cyclone) included.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "framework/component/qos_match.hpp"
#include "framework/dds/endpoint.hpp"

namespace kervan::dds {

/// What one of our participants says of itself to every peer.
struct ParticipantIdentity {
  std::string container;
  std::uint64_t composition = 0;  ///< hash of what its composition consists of
};

/// The user data of a participant: "enclave=/;", for ROS 2, and its identity.
std::string to_user_data(const ParticipantIdentity& identity);
/// Reads a participant's user data; nothing if it is none of ours.
std::optional<ParticipantIdentity> parse_participant(std::string_view user_data);

struct DiscoveredParticipant {
  std::string process;  ///< name of its program; empty if it does not say
  std::string host;
  long pid = 0;
  std::optional<ParticipantIdentity> identity;  ///< nothing: not one of ours
};

struct DiscoveredEndpoint {
  std::uint64_t handle = 0;  ///< Cyclone's, as in MatchedPeer
  Guid guid{};
  bool writer = false;
  std::string topic;                         ///< "/r1/scan"; of topics that are not ROS 2's "rt/…", the name as it is
  std::string wire_type;                     ///< "sensor_msgs::msg::dds_::LaserScan_"
  std::optional<EndpointIdentity> identity;  ///< nothing: not one of ours
  EndpointQos qos;                           ///< what it offers or requests
  DiscoveredParticipant participant;
};

struct DiscoveryEvent {
  bool gone = false;
  DiscoveredEndpoint endpoint;
};

/// Endpoints of this process are reported like those of others. One thread at a time may take().
class Discovery {
 public:
  /// `wake` is called under Cyclone's locks when there is something to take; it may only mark and notify.
  /// Throws DdsError.
  Discovery(Domain& domain, std::function<void()> wake);
  Discovery(const Discovery&) = delete;
  Discovery& operator=(const Discovery&) = delete;
  ~Discovery();

  /// What has appeared, changed (as appeared again) or gone since the last call. Not from a sink's call.
  std::vector<DiscoveryEvent> take();

 private:
  void take_participants();
  void take_endpoints(std::int32_t reader, bool writers, std::vector<DiscoveryEvent>& events);

  std::function<void()> wake_;
  std::map<Guid, DiscoveredParticipant> participants_;
  std::map<std::uint64_t, DiscoveredEndpoint> endpoints_;
  std::map<std::uint64_t, Guid> participant_of_;
  std::int32_t participant_reader_ = 0;
  std::int32_t publication_reader_ = 0;
  std::int32_t subscription_reader_ = 0;
};

}  // namespace kervan::dds
