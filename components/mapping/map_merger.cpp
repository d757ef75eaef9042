#include "components/mapping/map_merger.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace kervan::mapping {
namespace {

const char* const base_name = "";  // no mapper has it

constexpr grid::LogOdds in_doubt = 1;  // the least there is: what was seen stays known when evidence cancels out

grid::LogOdds log_odds_of_percent(std::int8_t percent) {
  static const auto table = [] {
    std::array<grid::LogOdds, 101> values{};
    for (std::size_t i = 0; i <= 100; ++i) values[i] = grid::log_odds_of(0.01 * static_cast<double>(i));
    values[50] = in_doubt;
    return values;
  }();
  return percent < 0 ? grid::LogOdds{0} : table[static_cast<std::size_t>(percent)];
}

}  // namespace

MapMerger::MapMerger(std::vector<std::string> sources, double resolution, std::size_t most_bytes)
    : base_(resolution, 0, most_bytes), merged_(resolution, 0, most_bytes) {
  for (std::string& name : sources)
    sources_.push_back({std::move(name), 0, 0, false, grid::Occupancy(resolution, -1, most_bytes)});
}

TileResult MapMerger::add(std::size_t source, const grid::TileView& tile) {
  switch (fault_of(tile, resolution())) {
    case grid::TileFault::none: break;
    case grid::TileFault::resolution: return TileResult::refused_resolution;
    case grid::TileFault::size: return TileResult::refused_size;
    case grid::TileFault::value: return TileResult::refused_value;
    case grid::TileFault::place: return TileResult::refused_memory;
  }
  Source& from = sources_[source];
  if (from.heard && tile.session != from.session && tile.session == from.before) return TileResult::from_the_past;
  const grid::CellBox box = grid::cells_of_tile(tile.tile);
  if (!cover(box) || from.layer.cover(box) == grid::Growth::refused) return TileResult::refused_memory;
  if (from.heard && tile.session != from.session) {
    add_to_base(from.layer);
    from.layer = grid::Occupancy(resolution(), -1, base_.most_bytes());
    from.layer.cover(box);
    from.before = from.session;
  }
  from.session = tile.session;
  from.heard = true;
  put(tile, from.layer);
  merge(box);
  merged_.touch(box);
  return TileResult::merged;
}

bool MapMerger::cover(const grid::CellBox& box) {
  return base_.cover(box) != grid::Growth::refused && merged_.cover(box) != grid::Growth::refused;
}

void MapMerger::add_to_base(const grid::Occupancy& layer) {
  const grid::CellBox& box = layer.box();
  for (int y = box.y; y < box.y + box.rows; ++y)
    for (int x = box.x; x < box.x + box.columns; ++x)
      if (const grid::LogOdds more = log_odds_of_percent(layer.at({x, y})); more != 0) {
        grid::LogOdds& cell = *base_.place({x, y});
        cell = grid::added(cell, more);
        if (cell == 0) cell = in_doubt;
      }
}

/// Computes these cells of the merged map anew.
void MapMerger::merge(const grid::CellBox& box) {
  for (int y = box.y; y < box.y + box.rows; ++y)
    for (int x = box.x; x < box.x + box.columns; ++x) {
      int sum = base_.at({x, y});
      bool known = sum != 0;
      for (const Source& source : sources_)
        if (const grid::LogOdds more = log_odds_of_percent(source.layer.at({x, y})); more != 0) {
          sum += more;
          known = true;
        }
      *merged_.place({x, y}) =
          known && sum == 0 ? in_doubt : static_cast<grid::LogOdds>(std::clamp(sum, -32768, 32767));
    }
}

void MapMerger::read_percent(const grid::CellBox& box, std::span<std::int8_t> percent) const {
  grid::read_percent(merged_, box, percent);
}

grid::Checkpoint MapMerger::checkpoint(const std::string& run) const {
  grid::Checkpoint checkpoint{run, resolution(), {grid::layer_of(base_, base_name, {})}};
  for (const Source& source : sources_)
    if (source.heard)
      checkpoint.layers.push_back(grid::layer_of(source.layer, source.name, {source.session, source.before}));
  return checkpoint;
}

void MapMerger::restore(const grid::Checkpoint& checkpoint, const std::string& run) {
  if (std::abs(checkpoint.resolution - resolution()) > 1e-9)
    throw std::invalid_argument("the checkpoint has cells of " + std::to_string(checkpoint.resolution) +
                                " m, the map of " + std::to_string(resolution()) + " m");
  MapMerger restored({}, resolution(), base_.most_bytes());
  for (const Source& source : sources_)
    restored.sources_.push_back({source.name, 0, 0, false, grid::Occupancy(resolution(), -1, base_.most_bytes())});
  for (const grid::CheckpointLayer& layer : checkpoint.layers) {
    if (!restored.cover(layer.box))
      throw std::invalid_argument("the checkpoint needs more memory than the map may take");
    if (layer.name == base_name) {
      grid::Grid<grid::LogOdds> base(resolution(), 0, base_.most_bytes());
      grid::restore(layer, base);
      for (int y = layer.box.y; y < layer.box.y + layer.box.rows; ++y)
        std::copy_n(base.place({layer.box.x, y}), layer.box.columns, restored.base_.place({layer.box.x, y}));
      continue;
    }
    grid::Occupancy cells(resolution(), -1, base_.most_bytes());
    grid::restore(layer, cells);
    const auto source = std::find_if(restored.sources_.begin(), restored.sources_.end(),
                                     [&](const Source& s) { return s.name == layer.name; });
    if (checkpoint.origin != run || source == restored.sources_.end() || layer.numbers.size() != 2) {
      restored.add_to_base(cells);
    } else {
      source->session = layer.numbers[0];
      source->before = layer.numbers[1];
      source->heard = true;
      source->layer = std::move(cells);
    }
  }
  if (!restored.merged_.box().empty()) {
    restored.merge(restored.merged_.box());
    restored.merged_.touch(restored.merged_.box());
  }
  *this = std::move(restored);
}

}  // namespace kervan::mapping
