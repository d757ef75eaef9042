/// The one line of JSON that scripts read.
#pragma once

#include <iostream>
#include <nlohmann/json.hpp>

namespace kervan::cli {

/// A name that came from a command line may be no UTF-8; what JSON cannot hold is replaced.
inline void print_json(const nlohmann::ordered_json& object) {
  std::cout << object.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << std::endl;
}

}  // namespace kervan::cli
