/// What became of a request to a container or to one of its components.
#pragma once

#include <string>

namespace kervan::runtime {

/// Asking for what is so already is accepted.
struct Outcome {
  bool accepted = false;
  std::string reason;  ///< why not, or in what way ("already active"); one sentence, may be empty when accepted
};

}  // namespace kervan::runtime
