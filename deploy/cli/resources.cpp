#include "deploy/cli/resources.hpp"

#include <cstdlib>

namespace kervan::cli {
namespace {

namespace fs = std::filesystem;

/// Adds what ships below `folder`, if anything does.
bool add_from(const fs::path& folder, Resources& resources) {
  std::error_code none;
  if (fs::is_directory(folder / "share" / "kervan" / "compositions", none)) {
    resources.compositions.push_back(folder / "share" / "kervan" / "compositions");
    resources.files.push_back(folder / "share" / "kervan");
    return true;
  }
  if (fs::is_directory(folder / "deploy" / "compositions", none)) {
    resources.compositions.push_back(folder / "deploy" / "compositions");
    resources.files.push_back(folder / "sim");
    return true;
  }
  return false;
}

/// The first of `folder` and the folders above it that ships something.
bool add_above(fs::path folder, Resources& resources) {
  for (;; folder = folder.parent_path()) {
    if (add_from(folder, resources)) return true;
    if (folder == folder.parent_path()) return false;
  }
}

}  // namespace

Resources find_resources() {
  Resources resources;
  if (const char* share = std::getenv("KERVAN_SHARE")) {
    resources.compositions.push_back(fs::path(share) / "compositions");
    resources.files.emplace_back(share);
  }
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (error || !add_above(program.parent_path(), resources)) add_above(fs::current_path(error), resources);
  return resources;
}

}  // namespace kervan::cli
