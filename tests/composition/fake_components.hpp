/// Component types that exist only as manifests, so that compositions can be tested without modules.
#pragma once

#include "deploy/composition/resolve.hpp"

namespace kervan::test {

/// sim/world, planning/astar, control/field, control/pursuit, safety/guard, observe/mission, observe/log,
/// sim/ghost, broken/module and a few below test/. The world's ports depend on its `robots`, as the real one's do.
class FakeComponents final : public composition::ComponentCatalogue {
 public:
  std::vector<std::string> types() const override;
  std::vector<ParameterInfo> parameters(const std::string& type) override;
  Manifest manifest(const std::string& type, const ValueMap& values) override;
};

}  // namespace kervan::test
