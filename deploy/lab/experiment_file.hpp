/// Reads the file of a sweep. README.md beside this says what may stand in it.
#pragma once

#include <filesystem>
#include <string>

#include "deploy/lab/experiment.hpp"

namespace kervan::lab {

/// Throws ConfigError at the place of the first thing that cannot be used. Whether the composition has the arguments,
/// components and parameters that are named shows only when its runs are resolved.
Experiment load_experiment(const std::filesystem::path& file);

/// The same for a text; `shown_as` names it in messages, `folder` is where its relative paths begin.
Experiment parse_experiment(const std::string& text, const std::string& shown_as, const std::filesystem::path& folder);

/// More runs than this are a slip of the pen.
inline constexpr std::size_t most_runs = 100'000;

/// A value as one would write it in a line of YAML: `0.5 m`, `[1 m, 2 m, 90 deg]`.
std::string flow_text(const config::Node& value);

}  // namespace kervan::lab
