#include "components/localization/likelihood_field.hpp"

#include <algorithm>
#include <cmath>

namespace kervan::localization {
namespace {

/// From here on a cell counts as occupied for certain.
const double sure = grid::log_odds_of(0.65);

}  // namespace

LikelihoodField::LikelihoodField(double sigma) : sigma_(sigma), reach_(static_cast<int>(std::ceil(3.0 * sigma))) {
  across_.resize(static_cast<std::size_t>(2 * reach_ + 1));
}

void LikelihoodField::build(const PointMap& map, const grid::CellBox& box) {
  box_ = box;
  values_.assign(static_cast<std::size_t>(box.columns) * static_cast<std::size_t>(box.rows), 0);
  known_.assign(values_.size(), 0);
  std::size_t i = 0;
  for (int row = 0; row < box.rows; ++row)
    for (int column = 0; column < box.columns; ++column, ++i) {
      const PointCell& cell = map.at({box.x + column, box.y + row});
      known_[i] = cell.log_odds != 0 || cell.echoes != 0;
      if (cell.log_odds > 0) stamp(column, row, cell);
    }
  find_bounds();
}

/// Keeps the larger of two occupied cells' values: what counts is the nearer one.
void LikelihoodField::stamp(int column, int row, const PointCell& cell) {
  const int left = std::max(-reach_, -column), right = std::min(reach_, box_.columns - 1 - column);
  const int low = std::max(-reach_, -row), high = std::min(reach_, box_.rows - 1 - row);
  const auto gauss = [this](double off) { return std::exp(-0.5 * off * off / (sigma_ * sigma_)); };
  const double weight = 255.0 * std::min(1.0, static_cast<double>(cell.log_odds) / sure);
  for (int x = left; x <= right; ++x)
    across_[static_cast<std::size_t>(x + reach_)] = static_cast<float>(weight * gauss(x - static_cast<double>(cell.x)));
  for (int y = low; y <= high; ++y) {
    const auto up = static_cast<float>(gauss(y - static_cast<double>(cell.y)));
    const float* const from = across_.data() + reach_;
    std::uint8_t* const to = values_.data() + std::ptrdiff_t{row + y} * box_.columns + column;
    for (int x = left; x <= right; ++x) to[x] = std::max(to[x], static_cast<std::uint8_t>(up * from[x] + 0.5f));
  }
}

void LikelihoodField::find_bounds() {
  sideways_ = values_;
  const auto columns = static_cast<std::size_t>(box_.columns), rows = static_cast<std::size_t>(box_.rows);
  const auto raise = [](std::uint8_t* to, const std::uint8_t* by, std::size_t count) {
    for (std::size_t x = 0; x < count; ++x) to[x] = std::max(to[x], by[x]);
  };
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t side = 1; side < bound_side && side < columns; ++side)
      raise(sideways_.data() + row * columns, values_.data() + row * columns + side, columns - side);
  bounds_ = sideways_;
  for (std::size_t side = 1; side < bound_side && side < rows; ++side)
    raise(bounds_.data(), sideways_.data() + side * columns, (rows - side) * columns);
}

}  // namespace kervan::localization
