/// Which component runs in which container: `containers:` of the file, and what `--place` makes of it.
#pragma once

#include <string>
#include <vector>

#include "deploy/composition/composition.hpp"

namespace kervan::composition {

/// The containers of the file (nullptr: none are written, so one called `all` holds everything), changed by the values
/// of `--place`, each of which is one of
///
///   all             one container for everything; named containers may be split off it by further values
///   each            one container for each component
///   brain=r1/*,r2   these components move to that container; if the file has containers it must be one of them
///
/// Components that no value names stay where they are, and containers that lost all of theirs are gone. `implied` is a
/// component that need not be placed, the mission; it goes where the first container is. Throws ConfigError for a
/// component in two containers or none, and for unknown components and containers.
std::vector<Container> place_components(const Composition& composition, const config::Node* containers,
                                        const std::string& implied, const std::vector<std::string>& options);

}  // namespace kervan::composition
