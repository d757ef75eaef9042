/// One map out of those of several mappers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "components/grid/checkpoint.hpp"
#include "components/grid/grid.hpp"
#include "components/grid/log_odds.hpp"
#include "components/grid/occupancy.hpp"
#include "components/grid/tile.hpp"

namespace kervan::mapping {

enum class TileResult {
  merged,
  from_the_past,       ///< of a life of the mapper that has ended: what it said is in the map already
  refused_resolution,  ///< its cells are not of the map's size
  refused_size,        ///< it has not as many cells as a tile has
  refused_value,       ///< a percentage that is none
  refused_memory,      ///< the map would grow beyond its memory: left out
};

/// Mappers that know where they start see one world in one frame, each with its own errors: their evidence is
/// independent, so its log-odds are added. Of each mapper only its newest word on a tile counts, so that a tile may
/// come twice. What a mapper said in an earlier life stays: it goes into a base, and the mapper begins anew on top of
/// it.
class MapMerger {
 public:
  /// `sources`: the mappers' names. `most_bytes`: that the cells of each of its layers may take.
  MapMerger(std::vector<std::string> sources, double resolution, std::size_t most_bytes);

  TileResult add(std::size_t source, const grid::TileView& tile);

  double resolution() const { return merged_.resolution(); }
  grid::CellBox box() const { return merged_.box(); }
  std::vector<grid::Cell> take_touched() { return merged_.take_touched(); }
  void read_percent(const grid::CellBox& box, std::span<std::int8_t> percent) const;
  const grid::Grid<grid::LogOdds>& merged() const { return merged_; }

  /// Everything it knows. `run` names the run whose mappers' lives are meant.
  grid::Checkpoint checkpoint(const std::string& run) const;

  /// Goes on from a checkpoint; nothing may have been added yet. Of another run, and of sources that are not there any
  /// more, the layers become part of the base. Throws std::invalid_argument, and is empty as before, if the checkpoint
  /// has another resolution or needs more memory.
  void restore(const grid::Checkpoint& checkpoint, const std::string& run);

 private:
  struct Source {
    std::string name;
    std::uint64_t session;
    std::uint64_t before;  // the session before this one
    bool heard;
    grid::Occupancy layer;
  };

  bool cover(const grid::CellBox& box);
  void add_to_base(const grid::Occupancy& layer);
  void merge(const grid::CellBox& box);

  std::vector<Source> sources_;
  grid::Grid<grid::LogOdds> base_;
  grid::Grid<grid::LogOdds> merged_;
};

}  // namespace kervan::mapping
