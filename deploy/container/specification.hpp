/// From a resolved composition to what each of its containers is told to run.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "deploy/composition/resolve.hpp"
#include "framework/runtime/spec.hpp"

namespace kervan::container {

struct SpecificationOptions {
  std::filesystem::path run_folder = {};  ///< empty: nothing is written
  unsigned threads = 0;              ///< of every container; 0: as the composition says
  bool log_to_console = true;
  std::string tag = {};  ///< of a lockstep run over several containers; runs with different tags do not meet
};

/// One specification for each container, in the composition's order. They differ in name, threads and network interface
/// alone.
std::vector<runtime::ContainerSpec> specifications(const composition::ResolvedComposition& composition,
                                                   const SpecificationOptions& options);

/// The container whose component writes /clock, and with it everybody's time under clock sim; empty if none does.
std::string time_keeper(const runtime::ContainerSpec& spec);

}  // namespace kervan::container
