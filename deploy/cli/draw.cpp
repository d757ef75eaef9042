// kervan draw: a world as a picture, or the plan of its walls as a map.
#include <fstream>
#include <iostream>
#include <set>

#include "components/observe/map_drawing.hpp"
#include "components/observe/map_truth.hpp"
#include "deploy/cli/drawn_world.hpp"
#include "deploy/cli/resources.hpp"
#include "deploy/cli/verbs.hpp"
#include "framework/config/node.hpp"
#include "framework/map_file/map_file.hpp"
#include "sim/files/world_file.hpp"

namespace kervan::cli {
namespace {

namespace fs = std::filesystem;

/// A file if it has an ending or a slash, else NAME.yaml among the shipped worlds.
fs::path find_world(const std::string& name_or_file) {
  if (fs::path(name_or_file).has_extension() || name_or_file.find('/') != std::string::npos) {
    if (!fs::is_regular_file(name_or_file)) throw ConfigError({name_or_file, 0, 0}, "there is no such file");
    return name_or_file;
  }
  std::set<std::string> known;
  for (const fs::path& folder : find_resources().files) {
    const fs::path file = folder / "worlds" / (name_or_file + ".yaml");
    if (fs::is_regular_file(file)) return file;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(folder / "worlds", none))
      if (entry.path().extension() == ".yaml") known.insert(entry.path().stem().string());
  }
  throw ConfigError({}, "there is no world '" + name_or_file + "'" +
                            config::hint(name_or_file, {known.begin(), known.end()}, "there are"));
}

/// A cell is occupied if a wall passes through it or along its border.
map_file::GridMap plan(const sim::World& world) {
  constexpr double resolution = 0.05;
  const observe::MapTruth truth(drawn_plan(world), {}, resolution);
  const grid::CellBox box = truth.cells().box();
  map_file::GridMap map{{box.x * resolution, box.y * resolution, 0.0}, resolution, box.columns, box.rows, {}};
  for (int y = box.y; y < box.y + box.rows; ++y)
    for (int x = box.x; x < box.x + box.columns; ++x) {
      const observe::TrueCell cell = truth.at({x, y});
      const bool wall = cell == observe::TrueCell::occupied || cell == observe::TrueCell::border;
      map.occupancy.push_back(wall ? std::int8_t{100} : std::int8_t{0});
    }
  return map;
}

/// "23 walls, 3 discs, 18 boxes", without what there is none of.
std::string contents(const sim::World& world) {
  std::string text;
  const auto count = [&](std::size_t number, const char* one, const char* many) {
    if (number == 0) return;
    text += (text.empty() ? "" : ", ") + std::to_string(number) + ' ' + (number == 1 ? one : many);
  };
  count(world.segments().size() + world.low().segments().size(), "wall", "walls");
  count(world.circles().size() + world.low().circles().size(), "disc", "discs");
  count(world.boxes().size() + world.low().boxes().size(), "box", "boxes");
  count(world.bitmaps().size(), "bitmap", "bitmaps");
  count(world.moving().size(), "moving obstacle", "moving obstacles");
  return text.empty() ? "empty" : text;
}

}  // namespace

int draw(const DrawRequest& request) {
  const fs::path file = find_world(request.world);
  const sim::World world = sim::load_world(file.string());
  if (!request.plan.empty()) {
    if (fs::path(request.plan).extension() != ".yaml")
      throw ConfigError({request.plan, 0, 0}, "a map of map_server ends with .yaml");
    try {
      map_file::save(plan(world), request.plan, map_file::Mode::trinary);
    } catch (const std::invalid_argument& error) {
      throw ConfigError({}, error.what());
    }
    std::cout << request.plan << '\n';
    return exit_good;
  }
  observe::MapDrawing drawing;
  drawing.title = world.name();
  drawing.subtitle = contents(world);
  drawing.world = drawn(world);
  const fs::path out = request.out.empty() ? fs::path(file.stem().string() + ".svg") : fs::path(request.out);
  std::ofstream picture(out, std::ios::binary | std::ios::trunc);
  picture << observe::to_svg(drawing);
  if (!picture.flush()) throw ConfigError({out.string(), 0, 0}, "cannot be written");
  std::cout << out.string() << '\n';
  return exit_good;
}

}  // namespace kervan::cli
