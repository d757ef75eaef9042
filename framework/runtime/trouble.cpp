#include "framework/runtime/trouble.hpp"

#include <algorithm>
#include <string_view>

#include "framework/component/qos_match.hpp"

namespace kervan::runtime {

std::string name_of(const dds::DiscoveredEndpoint& endpoint, const std::string& port) {
  const dds::DiscoveredParticipant& participant = endpoint.participant;
  std::string name = endpoint.writer ? "writer" : "reader";
  if (!port.empty()) name += " " + port;
  if (participant.identity)
    name += " of container '" + participant.identity->container + "'";
  else if (!participant.process.empty())
    name += " of process '" + participant.process + "'";
  else
    name += " of an unnamed process";
  if (participant.pid != 0) name += " (pid " + std::to_string(participant.pid) + " on " + participant.host + ")";
  return name;
}

std::string type_of(const dds::DiscoveredEndpoint& endpoint) {
  constexpr std::string_view ros = "::dds_::";
  std::string type = endpoint.wire_type;
  const std::size_t at = type.find(ros);
  if (at == std::string::npos || !type.ends_with('_')) return type;
  type.pop_back();
  return type.replace(at, ros.size(), "::");
}

std::vector<std::string> conflicts(const dds::DiscoveredEndpoint& own, const dds::DiscoveredEndpoint& peer,
                                   const std::string& peer_name, bool together) {
  if (peer.wire_type != own.wire_type)
    return {peer_name + " has type " + type_of(peer) + ", this port " + type_of(own)};
  if (peer.identity && own.identity && peer.identity->layout_hash != own.identity->layout_hash)
    return {peer_name + " was built with another layout of " + type_of(own) +
            "; rebuild both against the same IDL package"};
  if (peer.writer == own.writer) return {};
  std::string policies;
  for (const QosConflict& conflict : own.writer ? qos_conflicts(own.qos, peer.qos) : qos_conflicts(peer.qos, own.qos)) {
    if (conflict.policy == QosPolicy::partition && !together) return {};  // they were never meant to meet
    policies += (policies.empty() ? "" : ", ") + std::string(to_text(conflict.policy)) + " offered " +
                conflict.offered + ", requested " + conflict.requested;
  }
  if (policies.empty()) return {};
  return {"incompatible with " + peer_name + ": " + policies};
}

std::string shape_of(const std::string& line) {
  std::string shape = line;
  std::erase_if(shape, [](char c) { return std::string_view("0123456789abcdef:#").find(c) != std::string_view::npos; });
  return shape;
}

}  // namespace kervan::runtime
