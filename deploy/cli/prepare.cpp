#include "deploy/cli/prepare.hpp"

#include <iostream>

#include "deploy/cli/catalogue.hpp"
#include "deploy/cli/resources.hpp"
#include "deploy/composition/load.hpp"
#include "deploy/composition/settings.hpp"
#include "framework/runtime/status.hpp"

namespace kervan::cli {

composition::ResolvedComposition prepare(const CompositionRequest& request, ComponentRegistry& registry,
                                         const std::function<void(composition::Composition&)>& adjust) {
  const Resources resources = find_resources();
  const auto file = composition::find_composition(request.composition, resources.compositions);
  InstalledComponents components(registry);
  const composition::ResolveOptions options{resources.files, {runtime::kStatusTopic, "/rosout"}};
  composition::Composition loaded =
      composition::load(file, {.arguments = request.arguments,
                               .place = request.place,
                               .host = request.host,
                               .emulate_hosts = request.emulate_hosts,
                               .settings = composition::settings_from_command_line(request.settings)});
  if (adjust) adjust(loaded);
  return composition::resolve(std::move(loaded), components, options);
}

namespace {

void print(const composition::Finding& finding) {
  std::cerr << to_text(finding.location) << ": "
            << (finding.severity == composition::Severity::warning ? "warning: " : "") << finding.message << '\n';
}

}  // namespace

void print_findings(const composition::ResolvedComposition& composition) {
  for (const auto& finding : composition.findings) print(finding);
}

void require_usable(const composition::ResolvedComposition& composition) {
  std::vector<const composition::Finding*> errors;
  for (const auto& finding : composition.findings)
    if (finding.severity == composition::Severity::error) errors.push_back(&finding);
  // Beside an error, warnings would only hide it.
  if (errors.empty()) return print_findings(composition);
  const std::size_t more = errors.size() - 1;
  throw ConfigError(errors.front()->location,
                    errors.front()->message +
                        (more == 0 ? ""
                                   : "; and " + std::to_string(more) + (more == 1 ? " more error" : " more errors") +
                                         ", see kervan check " + composition.source.file));
}

}  // namespace kervan::cli
