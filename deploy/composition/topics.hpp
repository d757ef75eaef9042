/// The second half of resolving: which port meets which on what topic, and whether that can work.
#pragma once

#include "deploy/composition/resolve.hpp"

namespace kervan::composition {

/// Sets the topic of every port from its component's scope and remaps. Throws ConfigError for a wrong remap, or if a
/// port's name makes no topic.
void name_topics(ResolvedComposition& resolved);

/// Fills topics, pairs and findings, these in the order of the file. Throws ConfigError for an entry of `topics:` that
/// fits no topic.
void connect(ResolvedComposition& resolved, const ResolveOptions& options);

}  // namespace kervan::composition
