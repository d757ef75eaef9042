/// The units with which systemd starts, watches and restarts the containers of one host, from the restart policy of the
/// composition.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "deploy/composition/composition.hpp"
#include "framework/runtime/spec.hpp"

namespace kervan::supervisor {

/// A container as its unit needs it.
struct UnitPlan {
  runtime::ContainerSpec spec;  ///< its run folder is replaced by the unit's own
  composition::Restart restart;
};

struct UnitOptions {
  std::string composition;                     ///< its name
  std::filesystem::path program;               ///< kervan-container, absolute
  std::filesystem::path folder;                ///< where the specifications will lie, absolute
  std::vector<std::filesystem::path> modules;  ///< KERVAN_COMPONENT_PATH; may be empty
};

/// How long a container may go without a sign of life before systemd ends it.
inline constexpr Duration kUnitWatchdog = std::chrono::seconds(5);

/// "kervan-lab-brain.service"
std::string unit_name(const std::string& composition, const std::string& container);

/// Texts by file name: one unit and one specification for each container, and a target that starts them all.
std::map<std::string, std::string> systemd_units(const std::vector<UnitPlan>& plans, const UnitOptions& options);

}  // namespace kervan::supervisor
