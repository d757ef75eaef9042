#include "components/mapping/cone_stencil.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>

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

template <class Weight>
std::size_t Cone<Weight>::up_to(int distance_mm) const {
  return static_cast<std::size_t>(std::upper_bound(nearest.begin(), nearest.end(), distance_mm) - nearest.begin());
}

template <class Weight>
std::size_t Cone<Weight>::wholly_before(int distance_mm) const {
  return static_cast<std::size_t>(std::lower_bound(within.begin(), within.end(), distance_mm) - within.begin());
}

template <class Weight>
ConeStencil<Weight>::ConeStencil(const SonarModel& model, double resolution, Weigh empty, Weigh occupied)
    : model_(model), resolution_(resolution), empty_(empty), occupied_(occupied), cones_(headings) {
  if (!(model.params().max_range <= farthest_cone)) throw std::invalid_argument("a cone reaches 32 m at most");
}

template <class Weight>
int ConeStencil<Weight>::heading_of(double yaw) {
  const double turns = yaw / (2.0 * std::numbers::pi);
  const auto heading = static_cast<int>(std::lround((turns - std::floor(turns)) * headings));
  return heading % headings;
}

template <class Weight>
const Cone<Weight>& ConeStencil<Weight>::cone(int heading) {
  auto& cone = cones_[static_cast<std::size_t>(heading)];
  if (!cone) cone = std::make_unique<Cone<Weight>>(made(heading));
  return *cone;
}

template <class Weight>
Cone<Weight> ConeStencil<Weight>::made(int heading) const {
  // Counted from -half to half a turn, so that sines and cosines of mirrored headings are equal but for the sign.
  const int turned = heading > headings / 2 ? heading - headings : heading;
  const double yaw = 2.0 * std::numbers::pi * turned / headings, c = std::cos(yaw), s = std::sin(yaw);
  const SonarModelParams& params = model_.params();
  const int reach = static_cast<int>(params.max_range / resolution_);

  Cone<Weight> cone;
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
        cone.places.push_back({x, y});
        cone.nearest.push_back(never_reached);
        cone.within.push_back(0);
      }
      const auto i = static_cast<std::size_t>(x - begin);
      const auto millimetres = static_cast<std::int16_t>(std::lround(1000.0 * r));
      cone.empty.back().of[i] = empty;
      cone.occupied.back().of[i] = occupied;
      cone.distance.back().of[i] = millimetres;
      cone.nearest.back() = std::min(cone.nearest.back(), millimetres);
      cone.within.back() = std::max(cone.within.back(), millimetres);
    }
  }

  std::vector<std::size_t> order(cone.places.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return cone.nearest[a] < cone.nearest[b]; });
  cone.empty = arranged(cone.empty, order);
  cone.occupied = arranged(cone.occupied, order);
  cone.distance = arranged(cone.distance, order);
  cone.places = arranged(cone.places, order);
  cone.nearest = arranged(cone.nearest, order);
  cone.within = arranged(cone.within, order);
  std::partial_sum(cone.within.begin(), cone.within.end(), cone.within.begin(),
                   [](std::int16_t a, std::int16_t b) { return std::max(a, b); });
  grid::CellBox box;
  for (const grid::Cell& place : cone.places) {
    box = grid::united(box, {place.x, place.y, 8, 1});
    cone.boxes.push_back(box);
  }
  return cone;
}

template class ConeStencil<std::int16_t>;
template class ConeStencil<float>;
template struct Cone<std::int16_t>;
template struct Cone<float>;

}  // namespace kervan::mapping
