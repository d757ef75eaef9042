/// The component around planners on occupancy grids: where the map comes from. What differs is the planner.
#pragma once

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "components/grid/messages.hpp"
#include "components/planning/map_planner.hpp"
#include "components/planning/planner_shell.hpp"
#include "nav_msgs/msg/OccupancyGrid.hpp"

namespace kervan::planning {

enum class Unknown { free, obstacle };

struct GridShellParams {
  CostmapParams costs;
  std::optional<FilePath> map;
  Unknown unknown = Unknown::free;
  double escape = 0.5;
  double tolerance = 0.25;
  double memory = 256.0;
  PlannerShellParams shell;

  template <class Visitor>
  void describe(Visitor& v) {
    v(map, "map", {.help = "Map of map_server to begin with; without it the map comes from the ports."});
    v(costs.radius, "radius",
      {.unit = "m", .min = 0.0, .max = 5.0, .help = "No obstacle may be nearer to the robot's middle."});
    v(costs.occupied_above, "occupied_above",
      {.min = 0.0, .max = 99.0, .help = "Per cent; a cell that is occupied with more is an obstacle."});
    v(unknown, "unknown", {.choices = {"free", "obstacle"}, .help = "What cells are of which nothing is known."});
    v(escape, "escape",
      {.unit = "m",
       .min = 0.0,
       .max = 10.0,
       .help = "How far a robot too near to an obstacle may go to a free place; 0: not at all.",
       .live = true});
    v(tolerance, "tolerance",
      {.unit = "m",
       .min = 0.0,
       .max = 100.0,
       .help = "How far from a goal that cannot be reached the route may end.",
       .live = true});
    v(memory, "memory", {.unit = "", .min = 0.1, .max = 16384.0, .help = "That map and search may take, in MiB."});
    shell.describe(v);
  }

  CostmapParams of_costmap() const {
    CostmapParams params = costs;
    params.unknown_is_free = unknown == Unknown::free;
    return params;
  }
};

/// Plans on an occupancy grid: a file's, a whole map's, or one that arrives tile by tile. Params: a GridShellParams.
template <class Params>
class GridPlannerShell : public PlannerShell {
 protected:
  const Params& params_ = parameters<Params>();

  // A plan may take longer than others want to wait for their turn.
  GridPlannerShell() { wants_own_thread(); }

  virtual MapPlanner& planner() = 0;
  /// What this planner asks for besides start, goal, escape and tolerance.
  virtual void complete(Query& query) const = 0;
  /// "looked at 120 cells"
  virtual std::string effort(const Plan& plan) const = 0;
  /// The share by which what is left of a route may become dearer before there is a new one.
  virtual double tolerated_rise() const = 0;

 private:
  /// Of a cell: in the map, in the costmap, its label, its parent and its place in the queue.
  static constexpr int cell_bytes = 32;
  static constexpr int mebibyte = 1024 * 1024;

  Input<kervan_msgs::msg::MapTile> tiles_{this, "tiles", qos::latched.optional(), &GridPlannerShell::on_tile,
                                          "Tiles of the map that have changed."};
  Input<nav_msgs::msg::OccupancyGrid> map_{this, "map", qos::latched.optional(), &GridPlannerShell::on_map,
                                           "A whole map; it replaces what was there."};
  grid::CellBox known_;  ///< where the map is; cells_ has some more around it
  grid::Occupancy cells_ = from_file();
  bool tiled_ = false;  ///< tiles came: what is beyond them is unknown, not outside
  std::uint64_t refused_ = 0;
  std::string trouble_;
  Plan plan_;
  RouteWatch watch_;
  bool changed_ = false;  ///< the map, since the last look at the route

  std::size_t most_cells() const {
    return static_cast<std::size_t>(params_.memory * double{mebibyte} / double{cell_bytes});
  }

  grid::Occupancy from_file() {
    if (!params_.map || describing()) return {0.05, -1, most_cells()};
    const map_file::GridMap file = map_file::load(params_.map->path);
    try {
      return taken(file);
    } catch (const std::invalid_argument& error) {
      throw ParameterError("map", error.what());
    }
  }

  grid::Occupancy taken(const map_file::GridMap& map) {
    // In whole tiles, and one more for where they begin.
    const auto whole = [](int cells) { return std::uint64_t{static_cast<unsigned>(cells / grid::tile_side + 2)}; };
    constexpr std::uint64_t tile = std::uint64_t{grid::tile_side} * grid::tile_side;
    if (const std::uint64_t cells = whole(map.columns) * whole(map.rows) * tile; cells > most_cells())
      throw std::invalid_argument("the map of " + std::to_string(map.columns) + " x " + std::to_string(map.rows) +
                                  " cells needs a memory of " + std::to_string(cells * cell_bytes / mebibyte + 1) +
                                  " MiB");
    grid::Occupancy cells = grid::from_map_file(map, most_cells());
    known_ = grid::cells_of(map);
    return cells;
  }

  void on_map(const nav_msgs::msg::OccupancyGrid& message, Time now) {
    const auto& info = message.info;
    const std::size_t count = std::size_t{info.width} * info.height;
    if (!(info.resolution > 0.0f) || count == 0 || info.width > Costmap::widest || info.height > Costmap::widest ||
        message.data.size() != count)
      return refuse("map: its size or the number of its cells is none");
    if (std::any_of(message.data.begin(), message.data.end(), [](std::int8_t p) { return p < -1 || p > 100; }))
      return refuse("map: a percentage is none");
    try {
      cells_ = taken({geometry::pose_of(info.origin), static_cast<double>(info.resolution),
                      static_cast<int>(info.width), static_cast<int>(info.height), message.data});
    } catch (const std::invalid_argument& error) {
      return refuse(std::string("map: ") + error.what());
    }
    tiled_ = false;
    changed_ = true;
    try_to_plan(now);
  }

  void on_tile(const kervan_msgs::msg::MapTile& message, Time now) {
    const grid::TileView tile = grid::view_of(message);
    if (known_.empty() && tile.resolution > 0.0 && std::isfinite(tile.resolution))
      cells_ = grid::Occupancy(tile.resolution, -1, most_cells());
    switch (grid::fault_of(tile, cells_.resolution())) {
      case grid::TileFault::none: break;
      case grid::TileFault::resolution: return refuse("tiles: cells of another size are left out");
      case grid::TileFault::size: return refuse("tiles: tiles of another size are left out");
      case grid::TileFault::value: return refuse("tiles: a percentage is none, its tile is left out");
      case grid::TileFault::place: return refuse("tiles: a tile too far from the map's origin is left out");
    }
    const grid::CellBox box = grid::cells_of_tile(tile.tile);
    if (!fits(box) || grid::put(tile, cells_) == grid::Growth::refused)
      return refuse("tiles: memory is used up, tiles beyond the map are left out");
    cells_.touch(box);
    known_ = grid::united(known_, box);
    tiled_ = true;
    // More tiles may come at the same time: the route is looked at when all are there.
    changed_ = true;
    if (waiting()) try_to_plan(now);
  }

  void refuse(std::string why) {
    ++refused_;
    trouble_ = std::move(why);
  }

  /// As far as the searches can count cells.
  bool fits(const grid::CellBox& box) const {
    const grid::CellBox all = grid::united(known_, box);
    return all.columns <= Costmap::widest && all.rows <= Costmap::widest;
  }

  /// What no tile has shown yet is unknown, but as good a way as any, if the unknown is free.
  void look_beyond(const geometry::Vector2& place) {
    constexpr double around = 2.0;  // m
    if (!tiled_ || params_.unknown != Unknown::free || !grid::has_cell(place)) return;
    const grid::Cell cell = grid::cell_of(place, cells_.resolution());
    const int margin = static_cast<int>(around / cells_.resolution());
    const grid::CellBox box{cell.x - margin, cell.y - margin, 2 * margin + 1, 2 * margin + 1};
    if (fits(box) && cells_.cover(box) != grid::Growth::refused) known_ = grid::united(known_, box);
  }

  std::string needs() const override {
    if (!known_.empty()) return {};
    return refused_ > 0 ? trouble_ : tiles_.missing();
  }
  std::string trouble() const override { return trouble_; }
  const PlannerShellParams& shell_params() const override { return params_.shell; }

  const Plan& plan(const geometry::Pose2& start, const geometry::Pose2& goal) override {
    look_beyond(start.position());
    look_beyond(goal.position());
    planner().update(cells_, known_);
    Query query{.start = start.position(),
                .goal = goal.position(),
                .escape = params_.escape,
                .tolerance = params_.tolerance,
                .start_heading = start.yaw,
                .goal_heading = goal.yaw};
    complete(query);
    planner().plan(query, plan_);
    if (plan_.outcome == Outcome::found) watch_.watch(planner().costmap(), plan_.points);
    changed_ = false;
    return plan_;
  }

  RouteChange route_change(double along) override {
    if (!std::exchange(changed_, false)) return RouteChange::none;
    planner().update(cells_, known_);
    return watch_.look(planner().costmap(), along, tolerated_rise());
  }

  void announce(const Plan& plan, const geometry::Vector2& goal, const std::string& again) override {
    if (!again.empty()) log().info("plans again: {}", again);
    log().info("route to ({:.2f}, {:.2f}) over {} points: {:.2f} m; {}", goal.x(), goal.y(), plan.points.size(),
               plan.length, effort(plan));
    if (plan.start_moved > 0.0) log().info("it begins with {:.2f} m to a free place", plan.start_moved);
    if (plan.goal_moved > 0.0) log().warn("it ends {:.2f} m from the goal", plan.goal_moved);
  }

  void on_shutdown(Time) override {
    if (refused_ > 0) log().warn("left out {} maps and tiles", refused_);
  }
};

}  // namespace kervan::planning
