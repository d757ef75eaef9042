/// Where a map that is being made can be made larger: the frontiers between what is known to be free and what is not
/// known. B. Yamauchi 1997, "A Frontier-Based Approach for Autonomous Exploration", doi:10.1109/CIRA.1997.613851.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "components/grid/tile.hpp"
#include "components/planning/costmap.hpp"
#include "framework/geometry/pose2.hpp"

namespace kervan::exploration {

struct FrontierMapParams {
  double radius = 0.35;          ///< m; no obstacle may be nearer to the robot's middle
  double occupied_above = 50.0;  ///< per cent; a cell above it is an obstacle
  double least_length = 0.6;     ///< m; shorter frontiers are left out
  double most_length = 3.0;      ///< m; longer ones are cut into several
  double escape =
      1.0;  ///< m; a robot too near to obstacles, or where nothing is known, may go so far to where it can drive
  std::size_t most_bytes = std::size_t{256} << 20;  ///< that the map may take
};

struct Frontier {
  geometry::Vector2 place;  ///< m; of its free cells the one in its middle
  double length = 0.0;      ///< m
  double distance = 0.0;    ///< m; for the robot to drive to the place, over what is known to be free
};

/// The map is looked at in blocks of a few cells, no larger than the radius. A robot can be in a block if one of its
/// cells is free, known and farther than the radius from every obstacle; a block of which less than half is known is
/// unknown. A frontier is a set of blocks that touch each other, in which a robot can be, which it can reach, and which
/// lie beside an unknown one. Only what has changed is looked at anew.
class FrontierMap {
 public:
  explicit FrontierMap(const FrontierMapParams& params);

  /// Puts a tile of the map in its place. False if it does not fit: why() says in what respect.
  bool put(const grid::TileView& tile);
  std::string_view why() const { return why_; }

  /// The frontiers that a robot at `robot` can reach, in the order of their lowest, leftmost blocks. Empty without a
  /// map, and where the robot has no way out.
  const std::vector<Frontier>& find(const geometry::Vector2& robot);

  /// True if a place within `reach`, m, of this one lies at a frontier; as of the last find().
  bool open_near(const geometry::Vector2& place, double reach) const;

  bool empty() const { return map_.box().empty(); }
  /// m2 that are known to be free.
  double free_area() const { return static_cast<double>(free_cells_) * map_.resolution() * map_.resolution(); }

 private:
  enum Mark : std::uint8_t { passable = 1, unknown = 2, frontier = 4 };

  static constexpr std::uint32_t unreached = ~std::uint32_t{0};

  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(x);
  }
  bool contains(int x, int y) const { return x >= 0 && y >= 0 && x < columns_ && y < rows_; }
  geometry::Vector2 middle(int x, int y) const;
  template <class Visit>
  void blocks_near(const geometry::Vector2& place, double reach, Visit visit) const;
  void follow();
  void look(int x, int y);
  void mark_frontier(int x, int y);
  void spread(const geometry::Vector2& robot);
  void gather();
  void add(const std::vector<std::uint32_t>& cluster);
  std::optional<geometry::Vector2> free_place(int x, int y) const;

  FrontierMapParams params_;
  grid::Occupancy map_;
  planning::Costmap costs_;
  std::vector<grid::Cell> changed_;  ///< tiles
  std::uint64_t free_cells_ = 0;
  std::string_view why_;
  int side_ = 1;                ///< cells along a block
  grid::CellBox box_;           ///< of the cells that the blocks are made of
  int columns_ = 0, rows_ = 0;  ///< blocks
  std::vector<std::uint8_t> marks_;
  std::vector<std::uint32_t> distance_;  ///< from the robot, in tenths of a block
  std::vector<std::uint8_t> taken_;      ///< blocks that belong to a frontier already
  std::vector<std::vector<std::uint32_t>> buckets_;
  std::vector<std::uint32_t> cluster_;
  std::vector<Frontier> found_;
};

}  // namespace kervan::exploration
