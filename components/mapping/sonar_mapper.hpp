/// A map out of sonar readings, by one of three rules.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "components/grid/certainty.hpp"
#include "components/grid/grid.hpp"
#include "components/grid/log_odds.hpp"
#include "components/grid/masses.hpp"
#include "components/mapping/cone_stencil.hpp"
#include "components/mapping/sonar_model.hpp"

namespace kervan::mapping {

/// `bayes`: log-odds, equation 15. `dempster_shafer`: masses of belief. `himm`: certainty values along the axis alone,
/// +3 at the echo, -1 before it (Borenstein and Koren 1991).
enum class UpdateRule { bayes, dempster_shafer, himm };

struct SonarMapperParams {
  UpdateRule update = UpdateRule::bayes;
  SonarModelParams model;
  double resolution = 0.05;                         ///< m, side of a cell
  double no_echo_limit = 0.5;                       ///< m, how far a sonar that hears no echo clears its cone
  std::size_t most_bytes = std::size_t{128} << 20;  ///< that the cells may take
};

/// The ranges a transducer can tell, m.
struct SonarLimits {
  double min_range = 0.0;
  double max_range = 5.0;
};

enum class ReadingResult {
  echo,            ///< in the map
  no_echo,         ///< in the map: empty up to no_echo_limit
  not_fired,       ///< NaN: the sonar had not its turn, and says nothing
  refused_range,   ///< negative or nearer than the transducer can measure: left out
  refused_place,   ///< the transducer is nowhere that has a cell, or looks into no direction
  refused_memory,  ///< the map would grow beyond its memory: left out
};

class SonarMapper {
 public:
  /// Throws std::invalid_argument if the model's range or the resolution cannot be.
  explicit SonarMapper(const SonarMapperParams& params);

  /// One reading: `transducer` in the map's frame, x along the axis of its cone, when it was taken. A range of
  /// limits.max_range or more, or of the model's R, is no echo: it came from farther away, or went astray on a smooth
  /// wall; so it only clears, and not far. The cone has the nearest of 256 headings, and its tip in the middle of a
  /// cell; its length makes up for that.
  ReadingResult add(const geometry::Pose2& transducer, double range, const SonarLimits& limits);

  double resolution() const { return params_.resolution; }
  grid::CellBox box() const;

  /// The certainty values themselves; null unless the rule is HIMM.
  const grid::Grid<grid::Certainty>* certainties() const { return std::get_if<grid::Grid<grid::Certainty>>(&cells_); }

  /// Tiles whose cells were told something since the last call.
  std::vector<grid::Cell> take_touched();

  /// Per cent occupied of a rectangle of cells (occupancy.hpp).
  void read_percent(const grid::CellBox& box, std::span<std::int8_t> percent) const;

 private:
  /// Empty up to `empty_below`, occupied from there to `occupied_to`, m along the axis from the transducer; the latter
  /// at most the former if there was no echo. A cone begins in the middle of its cell: what the transducer is ahead of
  /// that, along the cone's axis, the cone is longer.
  struct Along {
    grid::Cell tip;
    geometry::Vector2 offset;  ///< of the transducer from the middle of its cell, m
    double yaw;
    double empty_below;
    double occupied_to;
    double echo;  // m; where an echo came from, negative without
  };
  bool add(grid::Grid<grid::LogOdds>& cells, const Along& along);
  bool add(grid::Grid<grid::MassCell>& cells, const Along& along);
  bool add(grid::Grid<grid::Certainty>& cells, const Along& along);
  /// False if there is no memory for it.
  template <class Value, class Weight>
  bool add_cone_to(grid::Grid<Value>& cells, const PlacedCone<Weight>& placed, const Along& along);

  SonarMapperParams params_;
  SonarModel model_;
  Headings headings_;
  ConeStencil<std::int16_t> log_odds_cones_;
  ConeStencil<float> mass_cones_;
  std::variant<grid::Grid<grid::LogOdds>, grid::Grid<grid::MassCell>, grid::Grid<grid::Certainty>> cells_;
};

/// Readings that find a cell empty, at distance r and angle α off the axis (rad), until one that was as sure to be
/// occupied as a cell can be is more likely empty: how long an object that was taken away stays in the map. Nothing
/// clears what is told nothing: then it is the largest int.
int readings_to_clear(const SonarMapperParams& params, double r, double alpha);

}  // namespace kervan::mapping
