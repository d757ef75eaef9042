/// What a mission remembers beyond its own process: one small file, so that it goes on where it was when its component
/// is started again.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "components/observe/mission_score.hpp"

namespace kervan::observe {

/// By the robots' names, which hold no spaces.
using MissionMemories = std::map<std::string, MissionMemory>;

/// One line a robot. Numbers are written so that they are read back to the last bit, whatever the locale.
std::string to_text(const MissionMemories& memories);

/// Nothing if the text is not what to_text() writes.
std::optional<MissionMemories> memories_of(const std::string& text);

}  // namespace kervan::observe
