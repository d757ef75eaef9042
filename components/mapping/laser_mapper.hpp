/// A map out of laser scans.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "components/grid/grid.hpp"
#include "components/grid/log_odds.hpp"
#include "framework/geometry/scan.hpp"

namespace kervan::mapping {

struct LaserMapperParams {
  double resolution = 0.05;                         ///< m, side of a cell
  double hit = 0.7;                                 ///< P(occupied) of a cell that a beam ends in, given one scan
  double miss = 0.4;                                ///< P(occupied) of a cell that beams pass through
  double max_range = 10.0;                          ///< m; a beam that ends farther away is used up to here
  double no_echo_limit = 0.0;                       ///< m, how far a beam that brings nothing back clears its way
  std::size_t most_bytes = std::size_t{128} << 20;  ///< that the cells may take
};

enum class ScanResult {
  added,
  refused_scan,    ///< angles or limits that cannot be
  refused_place,   ///< the laser is nowhere that has a cell
  refused_memory,  ///< the map would grow beyond its memory: left out
};

/// Evidence is added as log-odds (Moravec and Elfes 1985). What a scan sees to be empty is one polygon round the laser,
/// through the ends of its beams, and is filled row by row: each cell is told something once a scan, however many beams
/// pass through it, and nothing lies unseen between two beams on one wall. Where the distance jumps from one beam to
/// the next, the polygon stays with the nearer.
class LaserMapper {
 public:
  explicit LaserMapper(const LaserMapperParams& params);

  /// `laser`: its pose in the map's frame when the scan was taken. A range at or beyond scan.range_max, infinity
  /// included, is a beam that brought nothing back (REP 117). NaN, and ranges below range_min, are left out with their
  /// part of the polygon; those that are NaN or negative, but not -infinity, are counted as refused.
  ScanResult add(const geometry::Pose2& laser, const geometry::Scan& scan);

  std::uint64_t refused_ranges() const { return refused_ranges_; }

  double resolution() const { return params_.resolution; }
  grid::CellBox box() const { return cells_.box(); }
  std::vector<grid::Cell> take_touched() { return cells_.take_touched(); }

  /// Per cent occupied of a rectangle of cells (occupancy.hpp).
  void read_percent(const grid::CellBox& box, std::span<std::int8_t> percent) const;

 private:
  /// Where a row's middle line crosses the polygon, in cells from the left of what the scan covers.
  struct Crossing {
    int row;
    float x;
  };
  struct End {
    std::ptrdiff_t cell;  // from the first value of the grid
    grid::LogOdds before;
  };

  void use_beams(const geometry::Scan& scan);
  void trace(const geometry::Pose2& laser, const geometry::Scan& scan);
  void edge(const geometry::Vector2& from, const geometry::Vector2& to, int left);
  void fill(const grid::CellBox& box);

  LaserMapperParams params_;
  grid::LogOdds hit_;
  grid::LogOdds miss_;
  grid::Grid<grid::LogOdds> cells_;
  std::uint64_t refused_ranges_ = 0;

  // The beams' directions in the laser's frame, kept while the scans have the same angles.
  double angle_min_ = 0.0;
  double angle_increment_ = 0.0;
  std::vector<geometry::Vector2> beams_;
  // Of the scan at hand, kept for their memory.
  std::vector<geometry::Vector2> polygon_;  // in cells
  std::vector<grid::Cell> ends_;
  std::vector<End> befores_;
  std::vector<Crossing> crossings_;
  std::vector<std::size_t> row_begins_;
  std::vector<float> sorted_;
};

}  // namespace kervan::mapping
