#include "components/mapping/cone_stencil.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace kervan::mapping {
namespace {

/// Puts `items` in the order of `order`.
template <class Item>
std::vector<Item> arranged(const std::vector<Item>& items, const std::vector<std::size_t>& order) {
  std::vector<Item> result;
  result.reserve(items.size());
  for (const std::size_t i : order) result.push_back(items[i]);
  return result;
}

}  // namespace

Distances::Distances(std::vector<std::int16_t> rising) : values_(std::move(rising)) {
  if (values_.empty()) return;
  for (std::size_t i = 0, begin = 0; begin <= static_cast<std::size_t>(values_.back()); begin += part_length) {
    while (static_cast<std::size_t>(values_[i]) < begin) ++i;
    begins_.push_back(static_cast<std::uint16_t>(i));
  }
}

template <class Weight>
ConeStencil<Weight>::ConeStencil(const SonarModel& model, double resolution, Weigh empty, Weigh occupied)
    : model_(model), resolution_(resolution), empty_(empty), occupied_(occupied), cones_(Headings::count / 2 + 1) {
  if (!(model.params().max_range <= farthest_cone)) throw std::invalid_argument("a cone reaches 32 m at most");
  if (!(model.params().max_range <= 32767.0 * resolution))
    throw std::invalid_argument("a cone reaches over 32767 cells at most");
}

template <class Weight>
PlacedCone<Weight> ConeStencil<Weight>::cone(int heading) {
  const bool mirrored = heading > Headings::count / 2;
  const int own = mirrored ? Headings::count - heading : heading;
  auto& cone = cones_[static_cast<std::size_t>(own)];
  if (!cone) cone = std::make_unique<Cone<Weight>>(made(own));
  return {*cone, mirrored, headings_.axis(heading)};
}

template <class Weight>
Cone<Weight> ConeStencil<Weight>::made(int heading) const {
  const double c = headings_.axis(heading).x(), s = headings_.axis(heading).y();
  const SonarModelParams& params = model_.params();
  const int reach = static_cast<int>(params.max_range / resolution_);

  Cone<Weight> cone;
  std::vector<std::int16_t> nearest, within;
  for (int y = -reach; y <= reach; ++y) {
    bool begun = false;  // an eight of this row, with its first cell at `begin`
    int begin = 0;
    for (int x = -reach; x <= reach; ++x) {
      const double along = x * c + y * s, across = y * c - x * s;
      const double r = resolution_ * std::hypot(x, y);
      const double alpha = x == 0 && y == 0 ? 0.0 : std::abs(std::atan2(across, along));  // the tip is on the axis
      if (r > params.max_range || alpha > params.half_aperture) continue;
      const Weight empty = empty_(model_, r, alpha), occupied = occupied_(model_, r, alpha);
      if (empty == Weight{} && occupied == Weight{}) continue;
      if (!begun || x - begin >= 8) {
        begun = true;
        begin = x;
        cone.empty.push_back({});
        cone.occupied.push_back({});
        cone.distance.emplace_back().of.fill(never_reached);
        cone.places.push_back({static_cast<std::int16_t>(x), static_cast<std::int16_t>(y)});
        nearest.push_back(never_reached);
        within.push_back(0);
      }
      const auto i = static_cast<std::size_t>(x - begin);
      const auto millimetres = static_cast<std::int16_t>(std::lround(1000.0 * r));
      cone.empty.back().of[i] = empty;
      cone.occupied.back().of[i] = occupied;
      cone.distance.back().of[i] = millimetres;
      nearest.back() = std::min(nearest.back(), millimetres);
      within.back() = std::max(within.back(), millimetres);
    }
  }

  std::vector<std::size_t> order(cone.places.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return nearest[a] < nearest[b]; });
  cone.empty = arranged(cone.empty, order);
  cone.occupied = arranged(cone.occupied, order);
  cone.distance = arranged(cone.distance, order);
  cone.places = arranged(cone.places, order);
  cone.nearest = Distances(arranged(nearest, order));
  within = arranged(within, order);
  std::partial_sum(within.begin(), within.end(), within.begin(),
                   [](std::int16_t a, std::int16_t b) { return std::max(a, b); });
  cone.within = Distances(std::move(within));
  grid::CellBox box;
  for (const auto& place : cone.places) {
    box = grid::united(box, {place.x, place.y, 8, 1});
    cone.boxes.push_back(box);
  }
  return cone;
}

template class ConeStencil<std::int16_t>;
template class ConeStencil<float>;

}  // namespace kervan::mapping
