#include "components/exploration/frontier_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace kervan::exploration {
namespace {

using geometry::Vector2;

constexpr std::uint32_t straight = 10, diagonal = 14;  // tenths of a block
constexpr std::array<std::array<int, 2>, 4> sides = {{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};

planning::CostmapParams of_costs(const FrontierMapParams& params) {
  return {.radius = params.radius,
          .clearance = 0.0,
          .clearance_cost = 0.0,
          .occupied_above = params.occupied_above,
          .unknown_is_free = true};
}

}  // namespace

FrontierMap::FrontierMap(const FrontierMapParams& params)
    : params_(params), map_(0.05, -1, params.most_bytes), costs_(of_costs(params)) {}

bool FrontierMap::put(const grid::TileView& tile) {
  if (map_.box().empty() && tile.resolution > 0.0 && std::isfinite(tile.resolution))
    map_ = grid::Occupancy(tile.resolution, -1, params_.most_bytes);
  switch (grid::fault_of(tile, map_.resolution())) {
    case grid::TileFault::none: break;
    case grid::TileFault::resolution: why_ = "cells of another size are left out"; return false;
    case grid::TileFault::size: why_ = "tiles of another size are left out"; return false;
    case grid::TileFault::value: why_ = "a percentage is none, its tile is left out"; return false;
    case grid::TileFault::place: why_ = "a tile too far from the map's origin is left out"; return false;
  }
  const auto is_free = [this](std::int8_t percent) { return percent >= 0 && percent <= params_.occupied_above; };
  const grid::CellBox box = grid::cells_of_tile(tile.tile);
  const auto count = [&] {
    std::uint64_t free = 0;
    if (!map_.box().contains(box)) return free;
    for (int row = 0; row < box.rows; ++row)
      free += static_cast<std::uint64_t>(
          std::count_if(map_.place({box.x, box.y + row}), map_.place({box.x, box.y + row}) + box.columns, is_free));
    return free;
  };
  const std::uint64_t before = count();
  const grid::CellBox all = grid::united(map_.box(), box);
  if (all.columns > planning::Costmap::widest || all.rows > planning::Costmap::widest ||
      grid::put(tile, map_) == grid::Growth::refused) {
    why_ = "memory is used up, tiles beyond the map are left out";
    return false;
  }
  free_cells_ += count() - before;
  map_.touch(box);
  changed_.push_back(tile.tile);
  return true;
}

Vector2 FrontierMap::middle(int x, int y) const {
  return Vector2(box_.x + (x + 0.5) * side_, box_.y + (y + 0.5) * side_) * map_.resolution();
}

/// Brings costs and blocks up to date.
void FrontierMap::follow() {
  costs_.update(map_, map_.box());
  if (box_ != map_.box()) {
    box_ = map_.box();
    side_ = std::clamp(static_cast<int>(params_.radius / map_.resolution()), 1, 4);  // a tile is whole blocks, if not 3
    if (side_ == 3) side_ = 2;
    columns_ = box_.columns / side_;
    rows_ = box_.rows / side_;
    marks_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), std::uint8_t{0});
    changed_.clear();
    for (int y = 0; y < rows_; ++y)
      for (int x = 0; x < columns_; ++x) look(x, y);
    for (int y = 0; y < rows_; ++y)
      for (int x = 0; x < columns_; ++x) mark_frontier(x, y);
    return;
  }
  // An obstacle is felt as far as the radius, a frontier by the block beside it.
  const int reach = static_cast<int>(std::ceil(params_.radius / map_.resolution())) + 1;
  std::sort(changed_.begin(), changed_.end());
  changed_.erase(std::unique(changed_.begin(), changed_.end()), changed_.end());
  const auto each = [&](int margin, auto visit) {
    for (const grid::Cell& tile : changed_) {
      const grid::CellBox cells = grid::cells_of_tile(tile);
      const int left = std::max(0, (cells.x - box_.x - margin) / side_),
                bottom = std::max(0, (cells.y - box_.y - margin) / side_);
      const int right = std::min(columns_ - 1, (cells.x - box_.x + cells.columns - 1 + margin) / side_);
      const int top = std::min(rows_ - 1, (cells.y - box_.y + cells.rows - 1 + margin) / side_);
      for (int y = bottom; y <= top; ++y)
        for (int x = left; x <= right; ++x) visit(x, y);
    }
  };
  each(reach, [this](int x, int y) { look(x, y); });
  each(reach + side_, [this](int x, int y) { mark_frontier(x, y); });
  changed_.clear();
}

void FrontierMap::look(int x, int y) {
  int known = 0;
  bool room = false;
  for (int row = 0; row < side_; ++row) {
    const std::int8_t* percent = map_.place({box_.x + x * side_, box_.y + y * side_ + row});
    std::uint32_t cost = costs_.index(1 + x * side_, 1 + y * side_ + row);
    for (int column = 0; column < side_; ++column, ++percent, ++cost) {
      if (*percent < 0) continue;
      ++known;
      room = room || !costs_.blocked(cost);
    }
  }
  marks_[index(x, y)] = static_cast<std::uint8_t>((room ? passable : 0) | (2 * known < side_ * side_ ? unknown : 0));
}

void FrontierMap::mark_frontier(int x, int y) {
  std::uint8_t& mark = marks_[index(x, y)];
  mark = static_cast<std::uint8_t>(mark & ~frontier);
  if ((mark & passable) == 0) return;
  for (const auto& [dx, dy] : sides)
    if (!contains(x + dx, y + dy) || (marks_[index(x + dx, y + dy)] & unknown) != 0) {
      mark |= frontier;
      return;
    }
}

template <class Visit>
void FrontierMap::blocks_near(const Vector2& place, double reach, Visit visit) const {
  if (!grid::has_cell(place) || columns_ == 0) return;
  const grid::Cell cell = grid::cell_of(place, map_.resolution());
  const int around = static_cast<int>(std::ceil(reach / (side_ * map_.resolution()))) + 1;
  const int x0 = (cell.x - box_.x) / side_, y0 = (cell.y - box_.y) / side_;
  for (int y = y0 - around; y <= y0 + around; ++y)
    for (int x = x0 - around; x <= x0 + around; ++x)
      if (contains(x, y)) visit(x, y, (middle(x, y) - place).norm());
}

bool FrontierMap::open_near(const Vector2& place, double reach) const {
  bool open = false;
  blocks_near(place, reach, [&](int x, int y, double distance) {
    open = open || (distance <= reach && (marks_[index(x, y)] & frontier) != 0);
  });
  return open;
}

/// Distances from the robot, cheapest first (Dial 1969, doi:10.1145/363269.363610).
void FrontierMap::spread(const Vector2& robot) {
  distance_.assign(marks_.size(), unreached);
  const double block = side_ * map_.resolution();
  // Where the robot stands, the block itself; else all blocks that are within its reach.
  double nearest = std::numeric_limits<double>::infinity();
  blocks_near(robot, params_.escape, [&](int x, int y, double distance) {
    if ((marks_[index(x, y)] & passable) != 0) nearest = std::min(nearest, distance);
  });
  if (!(nearest <= params_.escape)) return;
  const double within = nearest <= block ? nearest : params_.escape;
  const auto tenths = [&](double distance) { return static_cast<std::uint32_t>(straight * distance / block); };
  buckets_.resize(std::max<std::size_t>(diagonal, tenths(params_.escape)) + 1);
  std::size_t open = 0;
  const auto enter = [&](std::size_t i, std::uint32_t distance) {
    if (distance_[i] <= distance) return;
    distance_[i] = distance;
    buckets_[distance % buckets_.size()].push_back(static_cast<std::uint32_t>(i));
    ++open;
  };
  blocks_near(robot, params_.escape, [&](int x, int y, double distance) {
    if ((marks_[index(x, y)] & passable) != 0 && distance <= within) enter(index(x, y), tenths(distance));
  });
  for (std::uint32_t now = 0; open > 0; ++now) {
    auto& bucket = buckets_[now % buckets_.size()];
    for (std::size_t k = 0; k < bucket.size(); ++k) {
      const std::size_t i = bucket[k];
      if (distance_[i] != now) continue;
      const int x = static_cast<int>(i % static_cast<std::size_t>(columns_));
      const int y = static_cast<int>(i / static_cast<std::size_t>(columns_));
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          if ((dx == 0 && dy == 0) || !contains(x + dx, y + dy)) continue;
          const std::size_t next = index(x + dx, y + dy);
          if ((marks_[next] & passable) != 0) enter(next, now + (dx != 0 && dy != 0 ? diagonal : straight));
        }
    }
    open -= bucket.size();
    bucket.clear();
  }
}

std::optional<Vector2> FrontierMap::free_place(int x, int y) const {
  std::optional<Vector2> best;
  double least = std::numeric_limits<double>::infinity();
  for (int row = 0; row < side_; ++row)
    for (int column = 0; column < side_; ++column) {
      const grid::Cell cell{box_.x + x * side_ + column, box_.y + y * side_ + row};
      const Vector2 place = grid::center_of(cell, map_.resolution());
      const double off = (place - middle(x, y)).squaredNorm();
      if (map_.at(cell) < 0 || costs_.blocked(costs_.index(cell.x - box_.x + 1, cell.y - box_.y + 1)) || off >= least)
        continue;
      least = off;
      best = place;
    }
  return best;
}

void FrontierMap::add(const std::vector<std::uint32_t>& cluster) {
  const double block = side_ * map_.resolution();
  const double length = static_cast<double>(cluster.size()) * block;
  if (length < params_.least_length) return;
  const auto place_of = [this](std::uint32_t i) {
    return middle(static_cast<int>(i) % columns_, static_cast<int>(i) / columns_);
  };
  Vector2 center = Vector2::Zero();
  for (const std::uint32_t i : cluster) center += place_of(i) / static_cast<double>(cluster.size());
  const auto nearer = [&](std::uint32_t a, std::uint32_t b) {
    return (place_of(a) - center).squaredNorm() < (place_of(b) - center).squaredNorm();
  };
  const std::uint32_t best = *std::min_element(cluster.begin(), cluster.end(), nearer);
  const auto place = free_place(static_cast<int>(best) % columns_, static_cast<int>(best) / columns_);
  if (place) found_.push_back({*place, length, distance_[best] * block / straight});
}

/// The blocks at frontiers that were reached, gathered to frontiers from each on that belongs to none.
void FrontierMap::gather() {
  found_.clear();
  taken_.assign(marks_.size(), std::uint8_t{0});
  const double block = side_ * map_.resolution();
  const auto most = static_cast<std::size_t>(std::max(1.0, params_.most_length / block));
  for (std::size_t first = 0; first < marks_.size(); ++first) {
    if ((marks_[first] & frontier) == 0 || distance_[first] == unreached || taken_[first] != 0) continue;
    cluster_.assign(1, static_cast<std::uint32_t>(first));
    taken_[first] = 1;
    for (std::size_t k = 0; k < cluster_.size(); ++k) {
      const int x = static_cast<int>(cluster_[k]) % columns_, y = static_cast<int>(cluster_[k]) / columns_;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          if (!contains(x + dx, y + dy) || cluster_.size() >= most) continue;
          const std::size_t next = index(x + dx, y + dy);
          if ((marks_[next] & frontier) == 0 || distance_[next] == unreached || taken_[next] != 0) continue;
          taken_[next] = 1;
          cluster_.push_back(static_cast<std::uint32_t>(next));
        }
    }
    add(cluster_);
  }
}

const std::vector<Frontier>& FrontierMap::find(const Vector2& robot) {
  found_.clear();
  if (empty()) return found_;
  follow();
  spread(robot);
  gather();
  return found_;
}

}  // namespace kervan::exploration
