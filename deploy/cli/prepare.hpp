/// From what the command line names to a composition that is loaded and resolved: the beginning of run and check.
#pragma once

#include <functional>

#include "deploy/cli/verbs.hpp"
#include "deploy/composition/resolve.hpp"
#include "framework/component/registry.hpp"

namespace kervan::cli {

/// Throws ConfigError for the first thing that cannot be used. Findings are left to the caller. `adjust` may change
/// what was loaded before it is resolved.
composition::ResolvedComposition prepare(const CompositionRequest& request, ComponentRegistry& registry,
                                         const std::function<void(composition::Composition&)>& adjust = {});

/// One line on stderr for each finding: `file:line:column: message`, warnings marked as such.
void print_findings(const composition::ResolvedComposition& composition);

/// Prints the warnings. If there are errors it throws the first as ConfigError and says how many more kervan check
/// shows.
void require_usable(const composition::ResolvedComposition& composition);

}  // namespace kervan::cli
