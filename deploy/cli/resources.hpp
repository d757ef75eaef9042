/// The folders that ship with the program.
#pragma once

#include <filesystem>
#include <vector>

namespace kervan::cli {

struct Resources {
  std::vector<std::filesystem::path> compositions;  ///< lab.yaml, …
  std::vector<std::filesystem::path> experiments;   ///< plans of many runs
  std::vector<std::filesystem::path> files;         ///< worlds/, robots/
};

/// The folder that KERVAN_SHARE names, then share/kervan beside the program's folder: installed files, or in a build
/// tree links to the source tree. Throws ConfigError if KERVAN_SHARE names no folder.
Resources find_resources();

}  // namespace kervan::cli
