/// The component types of the modules that are installed, as the composition's resolver wants them.
#pragma once

#include <filesystem>
#include <vector>

#include "deploy/composition/resolve.hpp"
#include "framework/component/registry.hpp"

namespace kervan::cli {

/// Where modules are looked for. Throws ConfigError if KERVAN_COMPONENT_PATH names a folder that is not there: what it
/// was meant to bring would be missed much later, and elsewhere.
std::vector<std::filesystem::path> component_folders();

class InstalledComponents final : public composition::ComponentCatalogue {
 public:
  explicit InstalledComponents(ComponentRegistry& registry) : registry_(registry) {}

  std::vector<std::string> types() const override { return registry_.names(); }
  std::vector<ParameterInfo> parameters(const std::string& type) override;
  Manifest manifest(const std::string& type, const ValueMap& values) override;

 private:
  ComponentRegistry& registry_;
};

}  // namespace kervan::cli
