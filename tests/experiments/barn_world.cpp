#include "tests/experiments/barn_world.hpp"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <stdexcept>

#include "sim/files/world_file.hpp"

namespace kervan::test {
namespace {

using Row = std::vector<std::string>;

/// Without the carriage return that some tables end their lines with.
bool next_line(std::ifstream& file, std::string& line) {
  if (!std::getline(file, line)) return false;
  if (line.ends_with('\r')) line.pop_back();
  return true;
}

/// The rows of a table behind its heading, which must be this one.
std::vector<Row> table(const std::string& path, const std::string& heading) {
  std::ifstream file(path);
  std::string line;
  if (!next_line(file, line)) throw std::runtime_error(path + ": cannot be read");
  if (line != heading) throw std::runtime_error(path + ":1: the heading is not '" + heading + "'");
  const auto columns = static_cast<std::size_t>(std::count(heading.begin(), heading.end(), ',')) + 1;
  std::vector<Row> rows;
  for (int number = 2; next_line(file, line); ++number) {
    Row row(1);
    for (const char c : line)
      if (c == ',')
        row.emplace_back();
      else
        row.back() += c;
    if (row.size() != columns)
      throw std::runtime_error(path + ":" + std::to_string(number) + ": " + std::to_string(row.size()) +
                               " columns instead of " + std::to_string(columns));
    rows.push_back(std::move(row));
  }
  return rows;
}

double number_of(const std::string& text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) throw std::runtime_error("'" + text + "' is no number");
  return value;
}

}  // namespace

BarnWorld clutter_world() {
  const sim::World world = sim::load_world(KERVAN_SOURCES "/sim/worlds/clutter.yaml");
  return {.number = -1,
          .cylinders = {world.circles().begin(), world.circles().end()},
          .walls = {world.segments().begin(), world.segments().end()},
          .start = {-2.25, 3.0, std::numbers::pi / 2.0},
          .goal = {-2.25, 13.0},
          .optimal = 10.3};
}

std::string barn_folder() {
  const char* data = std::getenv("KERVAN_TEST_DATA");
  return (data ? std::string(data) : std::string(KERVAN_SOURCES "/../shared/data")) + "/barn";
}

std::vector<BarnWorld> barn_worlds(const std::string& folder) {
  if (!std::filesystem::exists(folder)) return {};
  std::vector<BarnWorld> worlds;
  for (const Row& row : table(folder + "/barn_index.csv",
                              "world,n_cylinders,start_x,start_y,start_th,goal_x,goal_y,optimal_path_m,dwa_runs,"
                              "dwa_success,dwa_mean_time_s")) {
    BarnWorld world;
    world.number = static_cast<int>(number_of(row[0]));
    world.start = {number_of(row[2]), number_of(row[3]), number_of(row[4])};
    world.goal = {number_of(row[5]), number_of(row[6])};
    world.optimal = number_of(row[7]);
    if (const double runs = number_of(row[8]); runs > 0.0) world.published = number_of(row[9]) / runs;
    worlds.push_back(std::move(world));
  }
  auto world = worlds.begin();
  for (const Row& row : table(folder + "/barn_cylinders.csv", "world,x_m,y_m,radius_m")) {
    const int number = static_cast<int>(number_of(row[0]));
    if (world == worlds.end() || world->number != number)
      world = std::find_if(worlds.begin(), worlds.end(), [&](const BarnWorld& w) { return w.number == number; });
    if (world == worlds.end()) throw std::runtime_error(folder + ": world " + row[0] + " is not in the index");
    world->cylinders.push_back({{number_of(row[1]), number_of(row[2])}, number_of(row[3])});
  }
  return worlds;
}

}  // namespace kervan::test
