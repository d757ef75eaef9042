/// What can be wrong between a port and its peers, in words. Plain functions of what discovery says.
#pragma once

#include <string>
#include <vector>

#include "framework/dds/discovery.hpp"

namespace kervan::runtime {

/// Names an endpoint of another component: "reader r1/mapper.scan of container 'brain' (pid 12 on base)" with `port`
/// being the name of the port that it is in the composition; without, "writer of process 'rviz2' (pid 12 on base)".
std::string name_of(const dds::DiscoveredEndpoint& endpoint, const std::string& port);

/// As IDL has it: "sensor_msgs::msg::Range" of "sensor_msgs::msg::dds_::Range_".
std::string type_of(const dds::DiscoveredEndpoint& endpoint);

/// Why `own` and `peer`, two endpoints of one topic, do not get on, one sentence each; empty if they do. `peer_name` is
/// the peer's name_of(), `together` whether the composition has them belong together: otherwise that their partitions
/// differ is nothing wrong.
std::vector<std::string> conflicts(const dds::DiscoveredEndpoint& own, const dds::DiscoveredEndpoint& peer,
                                   const std::string& peer_name, bool together);

/// What two lines of a log have in common that differ in numbers only.
std::string shape_of(const std::string& line);

}  // namespace kervan::runtime
