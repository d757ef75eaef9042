#include "components/planning/costmap.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace kervan::planning {
namespace {

grid::CellBox grown(const grid::CellBox& box, int by, const grid::CellBox& within) {
  const int left = std::max(box.x - by, within.x), bottom = std::max(box.y - by, within.y);
  return {left, bottom, std::min(box.x + box.columns + by, within.x + within.columns) - left,
          std::min(box.y + box.rows + by, within.y + within.rows) - bottom};
}

/// Half cells from the middle of a cell to the nearest side of one that is `cells` away, squared.
constexpr std::int32_t square_to(int cells) { return cells == 0 ? 0 : (2 * cells - 1) * (2 * cells - 1); }

/// What a cell of the map is, by its percent.
class Solid {
 public:
  explicit Solid(const CostmapParams& params)
      : limit_(static_cast<std::int8_t>(std::clamp(params.occupied_above, 0.0, 100.0))),
        unknown_(!params.unknown_is_free) {}
  bool operator()(std::int8_t percent) const { return percent < 0 ? unknown_ : percent > limit_; }

 private:
  std::int8_t limit_;
  bool unknown_;
};

}  // namespace

void Costmap::update(grid::Occupancy& map, const grid::CellBox& box) {
  const std::vector<grid::Cell> tiles = map.take_touched();
  if (box != box_ || map.resolution() != resolution_) {
    begin(box, map.resolution());
    weigh(map, box_);
    return;
  }
  std::vector<grid::CellBox> changes;
  std::size_t felt = 0;
  for (const grid::Cell& tile : tiles) {
    const grid::CellBox changed = turned(map, grown(grid::cells_of_tile(tile), 0, box_));
    if (changed.empty()) continue;
    changes.push_back(changed);
    const grid::CellBox around = grown(changed, reach_, box_);
    felt += static_cast<std::size_t>(around.columns) * static_cast<std::size_t>(around.rows);
  }
  // Each change reaches some cells into what is around it; many one by one would look at those twice.
  if (felt > static_cast<std::size_t>(box_.columns) * static_cast<std::size_t>(box_.rows)) return weigh(map, box_);
  for (const grid::CellBox& changed : changes) weigh(map, changed);
}

/// Around the cells that have become obstacles, or are none any more; empty if there are none.
grid::CellBox Costmap::turned(const grid::Occupancy& map, const grid::CellBox& where) const {
  if (where.empty()) return {};
  const Solid solid(params_);
  int left = where.columns, right = -1, bottom = where.rows, top = -1;
  for (int y = 0; y < where.rows; ++y) {
    const std::int8_t* const percent = map.place({where.x, where.y + y});
    const std::uint8_t* const weights = weights_.data() + index(where.x - box_.x + 1, where.y + y - box_.y + 1);
    for (int x = 0; x < where.columns; ++x) {
      if (solid(percent[x]) == (weights[x] == occupied)) continue;
      left = std::min(left, x);
      right = std::max(right, x);
      bottom = std::min(bottom, y);
      top = y;
    }
  }
  return {where.x + left, where.y + bottom, right - left + 1, top - bottom + 1};
}

void Costmap::begin(const grid::CellBox& box, double resolution) {
  if (box.columns > widest || box.rows > widest)
    throw std::invalid_argument("the map has " + std::to_string(box.columns) + " x " + std::to_string(box.rows) +
                                " cells; allowed: at most " + std::to_string(widest) + " along a side");
  box_ = box;
  resolution_ = resolution;
  stride_ = static_cast<std::uint32_t>(box_.columns) + 2;
  const std::size_t count = std::size_t{stride_} * (static_cast<std::size_t>(box_.rows) + 2);
  weights_.assign(count, occupied);
  cells_.assign(count, std::uint16_t{0});
  row_bits_.resize(box_.rows + 2, box_.columns + 2);
  column_bits_.resize(box_.columns + 2, box_.rows + 2);

  const double felt = params_.radius + (weighs_distance() ? params_.clearance : 0.0);
  reach_ = static_cast<int>(std::ceil(felt / resolution_ + 0.5));
  weight_of_.assign(static_cast<std::size_t>(2 * square_to(reach_ + 1)), lightest);
  for (std::size_t square = 0; square < weight_of_.size(); ++square) {
    const double distance = 0.5 * std::sqrt(static_cast<double>(square)) * resolution_;
    if (square == 0) {
      weight_of_[square] = occupied;
    } else if (distance < params_.radius) {
      weight_of_[square] = inflated;
    } else if (weighs_distance() && distance < params_.radius + params_.clearance) {
      const double near = 1.0 - (distance - params_.radius) / params_.clearance;
      const double more = std::min(params_.clearance_cost, most_clearance_cost) * near * near;
      weight_of_[square] = static_cast<std::uint8_t>(std::lround(lightest * (1.0 + more)));
    }
  }
}

void Costmap::weigh(const grid::Occupancy& map, const grid::CellBox& changed) {
  const grid::CellBox to = grown(changed, reach_, box_), from = grown(to, reach_, box_);
  if (to.empty()) return;
  measure_columns(map, from, to);
  for (int row = 0; row < to.rows; ++row)
    measure_row(from.columns, to.x - from.x, to.columns,
                squares_.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(from.columns),
                weights_.data() + index(to.x - box_.x + 1, to.y + row - box_.y + 1));
  note(grown(to, 1, box_));
}

/// Into squares_, for each cell in the columns of `from` and the rows of `to`: how far the nearest obstacle of its
/// column is.
void Costmap::measure_columns(const grid::Occupancy& map, const grid::CellBox& from, const grid::CellBox& to) {
  const auto width = static_cast<std::size_t>(from.columns);
  const int far = reach_ + 1;
  squares_.assign(width * static_cast<std::size_t>(to.rows), far);
  nearest_.assign(width, far);
  const Solid solid(params_);
  const auto pass = [&](int y) {
    const std::int8_t* const percent = map.place({from.x, y});
    for (std::size_t x = 0; x < width; ++x) nearest_[x] = solid(percent[x]) ? 0 : std::min(nearest_[x] + 1, far);
    if (y < to.y || y >= to.y + to.rows) return;
    std::int32_t* const row = squares_.data() + static_cast<std::size_t>(y - to.y) * width;
    for (std::size_t x = 0; x < width; ++x) row[x] = std::min(row[x], nearest_[x]);
  };
  for (int y = from.y; y < from.y + from.rows; ++y) pass(y);
  std::fill(nearest_.begin(), nearest_.end(), far);
  for (int y = from.y + from.rows - 1; y >= from.y; --y) pass(y);
  for (std::int32_t& cells : squares_) cells = square_to(cells);
}

/// The weights of `to_width` cells, the first of which is `margin_left` cells from the beginning of `squares`.
void Costmap::measure_row(int width, int margin_left, int to_width, const std::int32_t* squares,
                          std::uint8_t* weights) {
  nearest_.assign(static_cast<std::size_t>(to_width), square_to(reach_ + 1));
  for (int shift = -reach_; shift <= reach_; ++shift) {
    const int begin = std::max(0, -margin_left - shift), end = std::min(to_width, width - margin_left - shift);
    const std::int32_t across = square_to(std::abs(shift));
    const std::int32_t* const shifted = squares + margin_left + shift;
    std::int32_t* const nearest = nearest_.data();
    for (int x = begin; x < end; ++x) nearest[x] = std::min(nearest[x], shifted[x] + across);
  }
  for (int x = 0; x < to_width; ++x)
    weights[x] = weight_of_[static_cast<std::size_t>(nearest_[static_cast<std::size_t>(x)])];
}

void Costmap::note(const grid::CellBox& changed) {
  const int left = changed.x - box_.x + 1, bottom = changed.y - box_.y + 1;
  for (int y = bottom; y < bottom + changed.rows; ++y)
    for (int x = left; x < left + changed.columns; ++x) {
      const std::uint32_t cell = index(x, y);
      const std::uint8_t own = weights_[cell];
      const bool here = own >= lightest;
      row_bits_.set(y, x, !here);
      column_bits_.set(x, y, !here);
      cells_[cell] = 0;
      if (!here) continue;
      unsigned free = 0, differs = 0;
      for (int d = 0; d < directions; ++d) {
        const std::uint8_t other =
            weights_[index(x + step_x[static_cast<std::size_t>(d)], y + step_y[static_cast<std::size_t>(d)])];
        free |= (other >= lightest ? 1u : 0u) << d;
        differs |= other >= lightest && other != own ? 1u : 0u;
      }
      // A diagonal move needs the two cells beside it: d - 1 and d + 1.
      const unsigned straight = free & 0x55u;
      const unsigned beside = (straight << 1) & ((straight >> 1) | (straight << 7));
      const unsigned moves = straight | (free & 0xaau & beside);
      cells_[cell] = static_cast<std::uint16_t>(moves | (differs == 0 ? flat : 0u) | (unsigned{own} << weight_shift));
    }
}

}  // namespace kervan::planning
