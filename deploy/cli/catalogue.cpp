#include "deploy/cli/catalogue.hpp"

#include <cstdlib>
#include <sstream>
#include <stdexcept>

namespace kervan::cli {
namespace {

const ComponentClass& class_of(ComponentRegistry& registry, const std::string& type) {
  if (const ComponentClass* found = registry.find(type)) return *found;
  throw std::runtime_error("there is no module for it");
}

}  // namespace

std::vector<std::filesystem::path> component_folders() {
  if (const char* path = std::getenv("KERVAN_COMPONENT_PATH")) {
    std::istringstream parts(path);
    for (std::string folder; std::getline(parts, folder, ':');)
      if (!folder.empty() && !std::filesystem::is_directory(folder))
        throw ConfigError({"KERVAN_COMPONENT_PATH", 0, 0}, "there is no folder '" + folder + "'");
  }
  return ComponentRegistry::default_folders();
}

std::vector<ParameterInfo> InstalledComponents::parameters(const std::string& type) {
  return parameters_of(class_of(registry_, type));
}

Manifest InstalledComponents::manifest(const std::string& type, const ValueMap& values) {
  return kervan::describe(class_of(registry_, type), values);
}

}  // namespace kervan::cli
