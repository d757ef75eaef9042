// kervan systemd: the units that run a host's containers in the field.
#include <fstream>
#include <iostream>

#include "deploy/cli/catalogue.hpp"
#include "deploy/cli/prepare.hpp"
#include "deploy/cli/print_json.hpp"
#include "deploy/cli/run_composition.hpp"
#include "deploy/cli/verbs.hpp"
#include "deploy/composition/hosts.hpp"
#include "deploy/container/specification.hpp"
#include "deploy/supervisor/systemd_units.hpp"

namespace kervan::cli {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  stream << text;
  if (!stream.flush()) throw ConfigError({file.string(), 0, 0}, "cannot be written");
}

}  // namespace

int systemd(const SystemdRequest& request) {
  ComponentRegistry registry(component_folders());
  const composition::ResolvedComposition composition = prepare(request, registry);
  require_usable(composition);
  if (composition.source.clock.mode == composition::ClockMode::lockstep)
    throw ConfigError(composition.source.clock.location,
                      "a lockstep run ends, and nothing in it is started again; units are for the clocks wall and sim");
  const auto here = composition::containers_here(composition.source);
  const auto specs = container::specifications(composition, {.log_to_console = true});
  std::vector<supervisor::UnitPlan> plans;
  for (std::size_t i = 0; i < specs.size(); ++i) {
    const composition::Container& container = composition.source.containers[i];
    if (std::ranges::find(here, &container) != here.end()) plans.push_back({specs[i], container.restart});
  }
  const fs::path folder = fs::absolute(request.out.empty() ? "systemd-" + composition.source.name : request.out);
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw ConfigError({"--out " + folder.string(), 0, 0}, "cannot make the folder: " + error.message());

  supervisor::UnitOptions options{composition.source.name, container_program(), folder, {}};
  if (const char* path = std::getenv("KERVAN_COMPONENT_PATH"); path && *path)
    for (const fs::path& module_folder : component_folders()) options.modules.push_back(fs::absolute(module_folder));
  nlohmann::ordered_json files = nlohmann::ordered_json::array();
  for (const auto& [name, text] : supervisor::systemd_units(plans, options)) {
    write(folder / name, text);
    files.push_back((folder / name).string());
    if (!request.json) std::cout << (folder / name).string() << '\n';
  }
  if (request.json) print_json({{"result", "good"}, {"files", files}});
  return exit_good;
}

}  // namespace kervan::cli
