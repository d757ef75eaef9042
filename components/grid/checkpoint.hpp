/// Maps on disk exactly as they are in memory, for whoever has to go on with them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "components/grid/grid.hpp"

namespace kervan::grid {

/// One grid of a checkpoint, with what its owner has to remember about it.
struct CheckpointLayer {
  std::string name;
  std::vector<std::uint64_t> numbers;  ///< of the owner; their meaning is its own
  CellBox box;
  std::uint32_t bytes_per_cell = 1;
  std::string cells;  ///< row by row from the lowest one, in the processor's order, which is little-endian

  bool operator==(const CheckpointLayer&) const = default;
};

struct Checkpoint {
  std::string origin;       ///< of the owner: which run wrote it
  double resolution = 0.0;  ///< m
  std::vector<CheckpointLayer> layers;

  bool operator==(const Checkpoint&) const = default;
};

/// The version of the format that to_bytes() writes, and the only one that is read.
inline constexpr std::uint32_t checkpoint_version = 1;

std::string to_bytes(const Checkpoint& checkpoint);

/// Throws std::invalid_argument with one sentence: it is no checkpoint, one of another version, cut off or damaged.
Checkpoint checkpoint_of(const std::string& bytes);

/// Replaces the file as a whole: written beside it, made durable, renamed. Throws std::invalid_argument with the path.
void save_checkpoint(const Checkpoint& checkpoint, const std::string& path);

/// Throws std::invalid_argument with the path and one sentence.
Checkpoint load_checkpoint(const std::string& path);

template <class Value>
CheckpointLayer layer_of(const Grid<Value>& grid, std::string name, std::vector<std::uint64_t> numbers) {
  static_assert(std::is_trivially_copyable_v<Value>);
  CheckpointLayer layer{std::move(name), std::move(numbers), grid.box(), sizeof(Value), {}};
  layer.cells.resize(grid.values().size() * sizeof(Value));
  if (!layer.cells.empty()) std::memcpy(layer.cells.data(), grid.values().data(), layer.cells.size());
  return layer;
}

/// The layer's cells put into `grid`, which has none yet; all of its tiles are touched. Throws std::invalid_argument if
/// they are of another kind or need more memory than the grid may take.
template <class Value>
void restore(const CheckpointLayer& layer, Grid<Value>& grid) {
  static_assert(std::is_trivially_copyable_v<Value>);
  if (layer.bytes_per_cell != sizeof(Value))
    throw std::invalid_argument("its layer '" + layer.name + "' has cells of " + std::to_string(layer.bytes_per_cell) +
                                " bytes, not " + std::to_string(sizeof(Value)));
  if (layer.box.empty()) return;
  if (grid.cover(layer.box) == Growth::refused)
    throw std::invalid_argument("its layer '" + layer.name + "' needs more than the allowed " +
                                std::to_string(grid.most_bytes()) + " bytes");
  const std::size_t row_bytes = static_cast<std::size_t>(layer.box.columns) * sizeof(Value);
  for (int row = 0; row < layer.box.rows; ++row)
    std::memcpy(static_cast<void*>(grid.place({layer.box.x, layer.box.y + row})),
                layer.cells.data() + static_cast<std::size_t>(row) * row_bytes, row_bytes);
  grid.touch(layer.box);
}

}  // namespace kervan::grid
