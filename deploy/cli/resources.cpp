#include "deploy/cli/resources.hpp"

#include <cstdlib>
#include <string>

#include "framework/component/error.hpp"

namespace kervan::cli {
namespace {

namespace fs = std::filesystem;

/// Without links, so that messages show the file that a person would edit.
void add(const fs::path& folder, Resources& resources) {
  std::error_code none;
  const fs::path compositions = fs::canonical(folder / "compositions", none);
  if (!none) resources.compositions.push_back(compositions);
  const fs::path experiments = fs::canonical(folder / "experiments", none);
  if (!none) resources.experiments.push_back(experiments);
  resources.files.push_back(folder);
}

}  // namespace

Resources find_resources() {
  Resources resources;
  if (const char* share = std::getenv("KERVAN_SHARE"); share && *share) {
    if (!fs::is_directory(share))
      throw ConfigError({"KERVAN_SHARE", 0, 0}, "there is no folder '" + std::string(share) + "'");
    add(share, resources);
  }
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (!error) add(program.parent_path().parent_path() / "share" / "kervan", resources);
  return resources;
}

}  // namespace kervan::cli
