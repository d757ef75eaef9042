#include "tests/bench/maps.hpp"

#include <cstdlib>
#include <filesystem>
#include <random>

#include "framework/map_file/image.hpp"

namespace kervan::bench {

namespace {

constexpr int side = 1000;

std::vector<std::uint8_t> random_discs() {
  std::vector<std::uint8_t> solid(side * side, 0);
  std::mt19937 random(1);
  for (int disc = 0; disc < 150; ++disc) {
    const auto number = [&](int below) { return static_cast<int>(random() % static_cast<unsigned>(below)); };
    const int x = number(side), y = number(side), radius = 4 + number(25);
    for (int row = std::max(0, y - radius); row < std::min(side, y + radius); ++row)
      for (int column = std::max(0, x - radius); column < std::min(side, x + radius); ++column)
        if ((column - x) * (column - x) + (row - y) * (row - y) < radius * radius)
          solid[static_cast<std::size_t>(row * side + column)] = 1;
  }
  return solid;
}

std::vector<std::uint8_t> doubled(const map_file::Image& image) {
  std::vector<std::uint8_t> solid;
  for (int row = side - 1; row >= 0; --row)
    for (int column = 0; column < side; ++column)
      solid.push_back(image.pixels[static_cast<std::size_t>(row / 2 * image.columns + column / 2)].shade < 128 ? 1 : 0);
  return solid;
}

}  // namespace

std::optional<std::string> test_data(const std::string& file) {
  const char* given = std::getenv("KERVAN_TEST_DATA");
  const std::filesystem::path folder = given ? given : KERVAN_SOURCES "/../shared/data";
  if (!std::filesystem::exists(folder / file)) return std::nullopt;
  return (folder / file).string();
}

sim::Bitmap cave(double extent) {
  sim::Bitmap map{{}, sim::Vector2::Constant(extent / side), side, side, {}};
  const auto file = test_data("stage/cave.png");
  map.solid = file ? doubled(map_file::load_image(*file)) : random_discs();
  for (std::size_t i = 0; i < side; ++i)
    map.solid[i] = map.solid[(side - 1) * side + i] = map.solid[i * side] = map.solid[i * side + side - 1] = 1;
  return map;
}

std::string cave_name() { return test_data("stage/cave.png") ? "Stage's cave" : "random discs (no test data)"; }

}  // namespace kervan::bench
