// kervan draw: a world as a picture.
#include <fstream>
#include <iostream>
#include <set>

#include "components/observe/map_drawing.hpp"
#include "deploy/cli/resources.hpp"
#include "deploy/cli/verbs.hpp"
#include "framework/config/node.hpp"
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

observe::DrawnWorld drawn(const sim::World& world) {
  observe::DrawnWorld drawn;
  const auto add = [&](std::span<const sim::Segment> segments) {
    for (const sim::Segment& segment : segments) drawn.walls.push_back({segment.a, segment.b});
  };
  add(world.segments());
  for (const sim::CellMap& map : world.bitmaps()) add(map.edges().segments());
  for (const sim::Circle& circle : world.circles()) drawn.circles.push_back({circle.center, circle.radius});
  for (const sim::Box& box : world.boxes()) {
    const auto corners = sim::corners(box);
    drawn.polygons.emplace_back(corners.begin(), corners.end());
  }
  return drawn;
}

/// "23 walls, 3 discs, 18 boxes", without what there is none of.
std::string contents(const sim::World& world) {
  std::string text;
  const auto add = [&](std::size_t count, const char* one, const char* many) {
    if (count == 0) return;
    text += (text.empty() ? "" : ", ") + std::to_string(count) + ' ' + (count == 1 ? one : many);
  };
  add(world.segments().size(), "wall", "walls");
  add(world.circles().size(), "disc", "discs");
  add(world.boxes().size(), "box", "boxes");
  add(world.bitmaps().size(), "bitmap", "bitmaps");
  return text.empty() ? "empty" : text;
}

}  // namespace

int draw(const DrawRequest& request) {
  const fs::path file = find_world(request.world);
  const sim::World world = sim::load_world(file.string());
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
