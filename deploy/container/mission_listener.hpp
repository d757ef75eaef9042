/// Hears how the mission of a composition ended. It stands last in the composition's order and publishes nothing, so
/// the run is the same with and without it.
#pragma once

#include <optional>
#include <string_view>

#include "framework/component/registry.hpp"
#include "framework/runtime/container.hpp"
#include "kervan_msgs/msg/MissionResult.hpp"

namespace kervan::container {

/// Its component type, and its name in every composition that has a mission.
inline constexpr std::string_view kMissionListener = "kervan/mission_listener";

void add_mission_listener(ComponentRegistry& registry);

/// What the listener of this container heard; nothing if it heard none, or runs elsewhere.
std::optional<kervan_msgs::msg::MissionResult> mission_result(runtime::Container& container);

}  // namespace kervan::container
