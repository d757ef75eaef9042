#include "deploy/lab/overlay.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <map>
#include <string_view>

#include "components/observe/trajectory_csv.hpp"

namespace kervan::lab {
namespace {

/// The fields of a line without quotes.
std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  for (std::size_t comma = line.find(','); comma != std::string_view::npos; comma = line.find(',')) {
    fields.push_back(line.substr(0, comma));
    line.remove_prefix(comma + 1);
  }
  fields.push_back(line);
  return fields;
}

bool read_number(std::string_view text, double& value) {
  return std::from_chars(text.data(), text.data() + text.size(), value).ptr == text.data() + text.size() &&
         !text.empty();
}

std::string subtitle_of(std::size_t paths) { return std::to_string(paths) + (paths == 1 ? " path" : " paths"); }

}  // namespace

std::vector<observe::Polyline> read_paths(const std::filesystem::path& run_folder) {
  std::ifstream stream(run_folder / "trajectory.csv");
  std::string line;
  if (!std::getline(stream, line) || line != observe::trajectory_header) return {};
  std::vector<observe::Polyline> paths;
  std::map<std::string, std::size_t, std::less<>> robots;
  while (std::getline(stream, line)) {
    const auto fields = fields_of(line);
    geometry::Vector2 at;
    if (fields.size() < 4 || !read_number(fields[2], at.x()) || !read_number(fields[3], at.y())) continue;
    const auto [robot, is_new] = robots.try_emplace(std::string(fields[1]), paths.size());
    if (is_new) paths.emplace_back();
    paths[robot->second].push_back(at);
  }
  return paths;
}

observe::MapDrawing overlay_of(const Results& results, const Group& group, const observe::DrawnWorld& world,
                               const std::filesystem::path& runs) {
  const Overlay& overlay = *results.experiment.overlay;
  const std::vector<std::string> colour_factors =
      overlay.colour.empty() ? std::vector<std::string>{} : std::vector{overlay.colour};
  observe::MapDrawing drawing;
  drawing.title = results.experiment.name;
  for (std::size_t i = 0; i < group.labels.size(); ++i)
    drawing.title += (i == 0 ? ": " : ", ") + overlay.by[i] + " " + group.labels[i];
  drawing.world = world;
  std::size_t paths = 0;
  for (const Group& colour : grouped(results, colour_factors)) {
    observe::DrawnBundle bundle{colour.labels.empty() ? "driven, truth" : overlay.colour + " " + colour.labels.front(),
                                {}};
    for (const std::size_t cell : common(group, colour)) {
      if (results.records[cell].state != RunState::done) continue;
      for (observe::Polyline& path : read_paths(runs / results.cells[cell].name))
        bundle.paths.push_back(std::move(path));
    }
    paths += bundle.paths.size();
    drawing.bundles.push_back(std::move(bundle));
  }
  drawing.subtitle = subtitle_of(paths);
  return drawing;
}

}  // namespace kervan::lab
