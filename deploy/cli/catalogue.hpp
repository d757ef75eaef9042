/// The component types of the modules that are installed, as the composition's resolver wants them.
#pragma once

#include "deploy/composition/resolve.hpp"
#include "framework/component/registry.hpp"

namespace kervan::cli {

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
