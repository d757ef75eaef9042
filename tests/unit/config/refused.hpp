/// What a refusal says, for tests that compare whole messages.
#pragma once

#include <string>

#include "framework/component/error.hpp"

namespace kervan::test {

/// The message of the ConfigError that `attempt` throws, or "nothing was refused".
template <class Attempt>
std::string refused(Attempt attempt) {
  try {
    attempt();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "nothing was refused";
}

}  // namespace kervan::test
