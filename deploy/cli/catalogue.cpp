#include "deploy/cli/catalogue.hpp"

#include <stdexcept>

namespace kervan::cli {
namespace {

const ComponentClass& class_of(ComponentRegistry& registry, const std::string& type) {
  if (const ComponentClass* found = registry.find(type)) return *found;
  throw std::runtime_error("there is no module for it");
}

}  // namespace

std::vector<ParameterInfo> InstalledComponents::parameters(const std::string& type) {
  return parameters_of(class_of(registry_, type));
}

Manifest InstalledComponents::manifest(const std::string& type, const ValueMap& values) {
  return kervan::describe(class_of(registry_, type), values);
}

}  // namespace kervan::cli
