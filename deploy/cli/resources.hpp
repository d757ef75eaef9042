/// The folders that ship with the program.
#pragma once

#include <filesystem>
#include <vector>

namespace kervan::cli {

struct Resources {
  std::vector<std::filesystem::path> compositions;  ///< lab.yaml, …
  std::vector<std::filesystem::path> files;         ///< worlds/, robots/
};

/// Installed: share/kervan beside the program. In a source tree: deploy/compositions and sim, found above the program or
/// above the working folder. The folder in KERVAN_SHARE comes before both.
Resources find_resources();

}  // namespace kervan::cli
