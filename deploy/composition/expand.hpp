/// From `components:` and `templates:` to the flat list of component instances.
#pragma once

#include <string>
#include <vector>

#include "deploy/composition/composition.hpp"

namespace kervan::composition {

/// `components` and `templates` as written; a template's `${}` are filled in for each of its instances.
std::vector<ComponentEntry> expand_components(const config::Node& components, const config::Node* templates,
                                              const std::vector<Argument>& arguments, const std::string& log_level);

/// Throws ConfigError at the node's key unless it is a name: a letter, then letters, digits and underscores.
void require_name(const config::Node& node, const char* what);

/// A level of the log.
std::string log_level_of(const config::Node& node);

}  // namespace kervan::composition
