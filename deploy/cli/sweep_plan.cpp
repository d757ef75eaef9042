#include "deploy/cli/sweep_plan.hpp"

#include <algorithm>
#include <cstdio>
#include <set>

#include "deploy/cli/catalogue.hpp"
#include "deploy/cli/prepare.hpp"
#include "deploy/cli/resources.hpp"
#include "deploy/composition/load.hpp"
#include "deploy/container/spec_json.hpp"
#include "deploy/container/specification.hpp"
#include "deploy/lab/experiment_file.hpp"
#include "deploy/lab/fingerprint.hpp"
#include "deploy/lab/results.hpp"
#include "framework/runtime/status.hpp"

namespace kervan::cli {
namespace {

namespace fs = std::filesystem;
using composition::ResolvedComposition;
using config::Node;

bool is_argument(const Node& setting) { return setting.name.find('.') == std::string::npos; }

/// The composition's file: as written if it is a path, seen from the sweep's folder; else a shipped one.
fs::path composition_file(const lab::Experiment& experiment, const Resources& resources) {
  const Node& named = experiment.composition;
  const bool is_path = named.text.find('/') != std::string::npos || named.text.ends_with(".yaml");
  if (is_path) {
    const fs::path file = experiment.folder / named.text;
    if (!fs::is_regular_file(file)) named.fail("there is no file " + composition::shown_path(file));
    return file;
  }
  try {
    return composition::find_composition(named.text, resources.compositions);
  } catch (const ConfigError& error) {
    named.fail(error.message());
  }
}

/// As in text, on the composition's clock.
std::string limit_text(const lab::Experiment& experiment) {
  if (!experiment.run_for) return "";
  char text[40];
  std::snprintf(text, sizeof text, "%.12g s", seconds(*experiment.run_for));
  return text;
}

/// The value of a setting as it stands after `--set NAME=`: what is a text because of its quotes keeps them.
std::string setting_text(const Node& value) {
  if (!value.is_scalar() || (!value.quoted && value.text.find_first_of("[{\"") != 0)) return lab::flow_text(value);
  Node list;
  list.kind = config::Kind::list;
  list.children.push_back(value);
  const std::string text = lab::flow_text(list);
  return text.substr(1, text.size() - 2);
}

std::vector<std::string> command(const lab::Experiment& experiment, const fs::path& file,
                                 const lab::Settings& settings) {
  std::vector<std::string> words{"run", composition::shown_path(file)};
  for (const Node& setting : settings) {
    if (is_argument(setting))
      words.insert(words.end(), {"--arg", setting.name + "=" + lab::flow_text(setting)});
    else
      words.insert(words.end(), {"--set", setting.name + "=" + setting_text(setting)});
  }
  if (experiment.run_for) words.insert(words.end(), {"--for", limit_text(experiment)});
  // One process a run: the trace does not depend on it, and the cores are busy with other runs.
  words.insert(words.end(), {"--place", "all", "--threads", "1"});
  return words;
}

class Planner {
 public:
  Planner(const lab::Experiment& experiment, lab::Fingerprints& fingerprints)
      : experiment_(experiment),
        fingerprints_(fingerprints),
        resources_(find_resources()),
        registry_(component_folders()),
        components_(registry_),
        file_(composition_file(experiment, resources_)) {}

  void add(const lab::Cell& cell, SweepPlan& plan) {
    const lab::Settings settings = lab::settings_of(experiment_, cell);
    const ResolvedComposition composition = resolve(cell, settings);
    const std::string specification = container::to_json(container::specifications(composition, {}).front());
    plan.runs.push_back({cell.name, command(experiment_, file_, settings),
                         fingerprints_.of(specification, limit_text(experiment_), modules_of(composition))});
    plan.worlds.push_back(world_of(composition));
  }

 private:
  /// What is wrong with the composition under these settings is said at the cell, unless it is at one of its settings.
  ResolvedComposition resolve(const lab::Cell& cell, const lab::Settings& settings) {
    try {
      composition::LoadOptions options{.place = {"all"}};
      for (const Node& setting : settings)
        (is_argument(setting) ? options.values : options.settings).push_back(setting);
      ResolvedComposition resolved = composition::resolve(composition::load(file_, options), components_,
                                                          {resources_.files, {runtime::kStatusTopic, "/rosout"}});
      for (const auto& finding : resolved.findings)
        if (finding.severity == composition::Severity::error) throw ConfigError(finding.location, finding.message);
      if (resolved.source.clock.mode != composition::ClockMode::lockstep)
        experiment_.composition.fail("'" + resolved.source.name + "' runs under clock " +
                                     std::string(composition::to_text(resolved.source.clock.mode)) +
                                     "; a sweep runs in lockstep");
      return resolved;
    } catch (const ConfigError& error) {
      if (error.location().file == experiment_.file) throw;
      throw ConfigError(experiment_.composition.location,
                        "the run " + lab::describe(experiment_, cell) + ": " + error.what());
    }
  }

  std::vector<fs::path> modules_of(const ResolvedComposition& composition) const {
    std::vector<fs::path> modules;
    for (const auto& component : composition.components)
      for (const fs::path& folder : registry_.folders()) {
        const fs::path module = folder / (component.manifest.type + ".so");
        if (!fs::is_regular_file(module)) continue;
        modules.push_back(module);
        break;
      }
    return modules;
  }

  static std::string world_of(const ResolvedComposition& composition) {
    for (const auto& component : composition.components) {
      if (component.manifest.type != "sim/world") continue;
      const auto map = component.parameters.find("map");
      if (map == component.parameters.end()) continue;
      if (const auto* file = std::get_if<std::string>(&map->second)) return *file;
    }
    return "";
  }

  const lab::Experiment& experiment_;
  lab::Fingerprints& fingerprints_;
  Resources resources_;
  ComponentRegistry registry_;
  InstalledComponents components_;
  fs::path file_;
};

/// Paths of several worlds in one picture would lead through walls.
void check_overlay(const SweepPlan& plan) {
  if (!plan.experiment.overlay) return;
  const auto fail = [&](const std::string& message) {
    throw ConfigError(plan.experiment.overlay->location, "overlay: " + message);
  };
  lab::Results results{plan.experiment, plan.cells, {}, {}};
  for (const lab::Group& group : lab::grouped(results, plan.experiment.overlay->by))
    for (const std::size_t cell : group.cells) {
      if (plan.worlds[cell].empty()) fail("the composition has no component of type sim/world");
      if (plan.worlds[cell] != plan.worlds[group.cells.front()])
        fail("runs in different worlds would be in one picture; add to 'by' what chooses the world");
    }
}

}  // namespace

SweepPlan plan_sweep(const std::string& name_or_file) {
  lab::Fingerprints fingerprints;
  const fs::path file = composition::find_composition(name_or_file, find_resources().experiments, "sweep");
  SweepPlan plan{.experiment = lab::load_experiment(file)};
  plan.cells = lab::cells(plan.experiment);
  Planner planner(plan.experiment, fingerprints);
  for (const lab::Cell& cell : plan.cells) planner.add(cell, plan);
  check_overlay(plan);
  return plan;
}

}  // namespace kervan::cli
