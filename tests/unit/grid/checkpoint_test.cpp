#include "components/grid/checkpoint.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "components/grid/log_odds.hpp"

namespace kervan::grid {
namespace {

namespace fs = std::filesystem;

Grid<LogOdds> some_grid() {
  Grid<LogOdds> grid(0.05, 0, 1 << 20);
  grid.cover({-64, 0, 128, 64});
  *grid.place({-64, 0}) = -123;
  *grid.place({63, 63}) = 32767;
  return grid;
}

Checkpoint some_checkpoint() {
  return {"runs/room", 0.05, {layer_of(some_grid(), "base", {}), {"r1", {7, 8}, {}, 1, ""}}};
}

std::string refusal(const std::string& bytes) {
  try {
    checkpoint_of(bytes);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(Checkpoint, ComesBackExactly) {
  EXPECT_EQ(checkpoint_of(to_bytes(some_checkpoint())), some_checkpoint());
  Grid<LogOdds> grid(0.05, 0, 1 << 20);
  restore(some_checkpoint().layers[0], grid);
  EXPECT_EQ(grid.box(), some_grid().box());
  EXPECT_EQ(grid.values(), some_grid().values());
  EXPECT_EQ(grid.take_touched().size(), 2u);
}

TEST(Checkpoint, CutOffAnywhereIsRefused) {
  const std::string bytes = to_bytes(some_checkpoint());
  EXPECT_EQ(refusal(bytes.substr(0, bytes.size() / 2)), "the checkpoint is cut off: it has " +
                                                            std::to_string(bytes.size() / 2) + " of " +
                                                            std::to_string(bytes.size()) + " bytes");
  for (std::size_t size = 0; size < bytes.size(); size += 1 + size / 50)
    EXPECT_NE(refusal(bytes.substr(0, size)), "") << size;
}

TEST(Checkpoint, OfAnotherVersionOrAnotherFormatIsRefused) {
  std::string bytes = to_bytes(some_checkpoint());
  bytes[8] = 2;
  EXPECT_EQ(refusal(bytes), "the checkpoint is of version 2 of the format; allowed: 1");
  EXPECT_EQ(refusal("image: map.png\nresolution: 0.05\n"), "it is no checkpoint of a map");
  EXPECT_EQ(refusal(""), "it is no checkpoint of a map");
}

TEST(Checkpoint, WithAFlippedBitIsRefused) {
  const std::string bytes = to_bytes(some_checkpoint());
  for (std::size_t at = 20; at < bytes.size(); at += 997) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 4);
    EXPECT_EQ(refusal(damaged), "the checkpoint is damaged: its checksum is wrong") << at;
  }
  EXPECT_EQ(refusal(bytes + "x"), "the checkpoint is damaged: its length is wrong");
}

TEST(Checkpoint, OfACellKindThatDoesNotFitIsRefused) {
  Grid<std::int8_t> bytes(0.05, -1, 1 << 20);
  EXPECT_THROW(restore(some_checkpoint().layers[0], bytes), std::invalid_argument);
  Grid<LogOdds> small(0.05, 0, 64 * 64);
  EXPECT_THROW(restore(some_checkpoint().layers[0], small), std::invalid_argument);
}

TEST(Checkpoint, OnDiskReplacesAnEarlierOneAsAWhole) {
  const fs::path folder = fs::temp_directory_path() / ("kervan_checkpoint_" + std::to_string(getpid()));
  fs::create_directories(folder);
  const std::string path = (folder / "map.kervan").string();
  save_checkpoint(some_checkpoint(), path);
  Checkpoint other = some_checkpoint();
  other.origin = "runs/other";
  save_checkpoint(other, path);
  EXPECT_EQ(load_checkpoint(path), other);
  std::ofstream(path + ".new") << "half of one, as a killed process leaves it";
  EXPECT_EQ(load_checkpoint(path), other);
  fs::resize_file(path, fs::file_size(path) / 2);
  try {
    load_checkpoint(path);
    FAIL() << "it was taken";
  } catch (const std::invalid_argument& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with(path + ": the checkpoint is cut off: ")) << error.what();
  }
  fs::remove_all(folder);
}

}  // namespace
}  // namespace kervan::grid
