#include "components/mapping/sonar_mapper.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "components/grid/occupancy.hpp"
#include "components/mapping/cell_walk.hpp"
#include "components/mapping/cone_kernel.hpp"

namespace kervan::mapping {
namespace {

std::int16_t empty_log_odds(const SonarModel& model, double r, double alpha) {
  return static_cast<std::int16_t>(-grid::log_odds_of(model.counted_empty(r, alpha)));
}

std::int16_t occupied_log_odds(const SonarModel& model, double r, double alpha) {
  return grid::log_odds_of(model.counted_occupied(r, alpha));
}

/// What is certain leaves a doubt. The formula's P is the pignistic probability of its mass, half of what stays unknown
/// counting for either, so that one half has no weight here either: taken for the mass itself, P would mark arcs far
/// off the axis more strongly than it clears them.
float mass(const SonarModel& model, double p) {
  const double mass = model.params().literal ? p : 2.0 * p - 1.0;
  return static_cast<float>(std::clamp(mass, 0.0, 1.0 - double{grid::least_unknown}));
}

float empty_mass(const SonarModel& model, double r, double alpha) { return mass(model, model.empty(r, alpha)); }

float occupied_mass(const SonarModel& model, double r, double alpha) {
  const double p = model.occupied(r, alpha);
  return model.params().record_above > 0.0 && !(p > model.params().record_above) ? 0.0f : mass(model, p);
}

constexpr double farthest_yaw = 1e6;  // rad, far within what an integer counts the headings of

/// Rounded, from -1 on.
std::int16_t millimetres(double metres) {
  return static_cast<std::int16_t>(static_cast<int>(std::clamp(1000.0 * metres, -1.0, 32766.0) + 1.5) - 1);
}

}  // namespace

SonarMapper::SonarMapper(const SonarMapperParams& params)
    : params_(params),
      model_(params.model),
      log_odds_cones_(model_, params.resolution, empty_log_odds, occupied_log_odds),
      mass_cones_(model_, params.resolution, empty_mass, occupied_mass),
      cells_(grid::Grid<grid::LogOdds>(params.resolution, 0, params.most_bytes)) {
  if (!(params.resolution > 0.0)) throw std::invalid_argument("a cell needs a positive side");
  if (params.update == UpdateRule::dempster_shafer)
    cells_ = grid::Grid<grid::MassCell>(params.resolution, {}, params.most_bytes);
  else if (params.update == UpdateRule::himm)
    cells_ = grid::Grid<grid::Certainty>(params.resolution, {}, params.most_bytes);
}

ReadingResult SonarMapper::add(const geometry::Pose2& transducer, double range, const SonarLimits& limits) {
  if (std::isnan(range)) return ReadingResult::not_fired;
  if (range < limits.min_range || range < 0.0) return ReadingResult::refused_range;
  if (!grid::has_cell(transducer.position()) || !(std::abs(transducer.yaw) <= farthest_yaw))
    return ReadingResult::refused_place;
  const bool echo = range < limits.max_range && range < params_.model.max_range;
  Along along{grid::cell_of(transducer.position(), params_.resolution), {}, transducer.yaw, 0.0, 0.0, -1.0};
  along.offset = transducer.position() - grid::center_of(along.tip, params_.resolution);
  if (echo) {
    const RegionBorders borders = model_.borders(range);
    along.empty_below = borders.empty_below;
    along.occupied_to = borders.occupied_to;
    if (borders.occupied_to > borders.empty_below) along.echo = range;
  } else {
    along.empty_below = std::min({params_.no_echo_limit, limits.max_range, params_.model.max_range});
  }
  const bool added = std::visit([&](auto& cells) { return add(cells, along); }, cells_);
  return !added ? ReadingResult::refused_memory : echo ? ReadingResult::echo : ReadingResult::no_echo;
}

template <class Value, class Weight>
bool SonarMapper::add_cone_to(grid::Grid<Value>& cells, const PlacedCone<Weight>& placed, const Along& along) {
  const double ahead = along.offset.dot(placed.axis);
  const ConeReading reading{millimetres(along.empty_below + ahead),
                            millimetres(along.echo < 0.0 ? -1.0 : along.occupied_to + ahead)};
  const std::size_t count = placed.cone.up_to(std::max<int>(reading.occupied_to, reading.empty_below - 1));
  if (count == 0) return true;
  const grid::CellBox box = placed.box(count).moved_by(along.tip);
  if (cells.cover(grid::united(box, {along.tip.x, along.tip.y, 1, 1})) == grid::Growth::refused) return false;
  add_cone(cells.place(along.tip), placed.stride(cells.stride()), placed.cone, count, reading);
  cells.touch(box);
  return true;
}

bool SonarMapper::add(grid::Grid<grid::LogOdds>& cells, const Along& along) {
  return add_cone_to(cells, log_odds_cones_.at(along.yaw), along);
}

bool SonarMapper::add(grid::Grid<grid::MassCell>& cells, const Along& along) {
  return add_cone_to(cells, mass_cones_.at(along.yaw), along);
}

bool SonarMapper::add(grid::Grid<grid::Certainty>& cells, const Along& along) {
  const geometry::Vector2 axis = headings_.direction(along.yaw);
  const double length =
      ((along.echo < 0.0 ? along.empty_below : along.echo) + along.offset.dot(axis)) / params_.resolution;
  if (length < 0.0) return true;
  const CellWalk walk(along.tip, axis, length);
  const grid::CellBox box = walk.box();
  if (cells.cover(box) == grid::Growth::refused) return false;
  grid::Certainty* const end =
      walk.over(cells.place(along.tip), cells.stride(), [](grid::Certainty& cell) { cell.lower(); });
  if (along.echo < 0.0)
    end->lower();
  else
    end->raise();
  cells.touch(box);
  return true;
}

grid::CellBox SonarMapper::box() const {
  return std::visit([](const auto& cells) { return cells.box(); }, cells_);
}

std::vector<grid::Cell> SonarMapper::take_touched() {
  return std::visit([](auto& cells) { return cells.take_touched(); }, cells_);
}

void SonarMapper::read_percent(const grid::CellBox& box, std::span<std::int8_t> percent) const {
  std::visit([&](const auto& cells) { grid::read_percent(cells, box, percent); }, cells_);
}

int readings_to_clear(const SonarMapperParams& params, double r, double alpha) {
  constexpr int never = std::numeric_limits<int>::max();
  const SonarModel model(params.model);
  if (r > params.model.max_range || std::abs(alpha) > params.model.half_aperture) return never;
  switch (params.update) {
    case UpdateRule::bayes: {
      const int weight = -empty_log_odds(model, r, alpha);
      return weight <= 0 ? never : (std::numeric_limits<std::int16_t>::max() + weight - 1) / weight;
    }
    case UpdateRule::dempster_shafer: {
      const double weight = double{empty_mass(model, r, alpha)};
      if (!(weight > 0.0)) return never;
      grid::Masses masses{1.0 - double{grid::least_unknown}, 0.0};
      int readings = 0;
      for (; masses.occupied >= masses.empty; ++readings) masses = grid::combine(masses, {0.0, weight}).masses;
      return readings;
    }
    case UpdateRule::himm: return alpha == 0.0 ? (grid::most_certain + 1) / 2 / grid::certainty_down : never;
  }
  return never;
}

}  // namespace kervan::mapping
