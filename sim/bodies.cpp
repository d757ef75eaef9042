#include "sim/bodies.hpp"

#include <numeric>
#include <utility>

namespace kervan::sim {

namespace {
constexpr std::size_t worth_sorting = 16;  // fewer are looked through one by one
constexpr std::size_t cells_a_body = 4;
constexpr double far = 0.1;  // m, of cells of 1 m
}  // namespace

void Bodies::add(std::string name, const Outline& outline, const Pose2& pose) {
  names_.push_back(std::move(name));
  outlines_.push_back(outline);
  radii_.push_back(outline.circumradius());
  largest_radius_ = std::max(largest_radius_, outline.circumradius());
  corners_.resize(corners_.size() + outline.corners().size());
  first_corner_.push_back(corners_.size());
  poses_.push_back(pose);
  move(size() - 1, pose);
  // Looked through one by one, too many new ones would make adding them slow.
  if (size() - sorted_ > 4 * worth_sorting) sort_anew();
}

void Bodies::remove(std::size_t body) {
  const auto erase_from = [body](auto& list) { list.erase(list.begin() + static_cast<std::ptrdiff_t>(body)); };
  const std::size_t first = first_corner_[body], count = corner_count(body);
  corners_.erase(corners_.begin() + static_cast<std::ptrdiff_t>(first),
                 corners_.begin() + static_cast<std::ptrdiff_t>(first + count));
  erase_from(first_corner_);
  for (std::size_t i = body; i < first_corner_.size(); ++i) first_corner_[i] -= count;
  erase_from(names_);
  erase_from(outlines_);
  erase_from(radii_);
  erase_from(poses_);
  largest_radius_ = radii_.empty() ? 0.0 : *std::max_element(radii_.begin(), radii_.end());
  sort_anew();
}

void Bodies::move(std::size_t body, const Pose2& pose) {
  move_on(body, pose);
  if (body < sorted_) moved_ = std::max(moved_, (center(body) - sorted_at_[body]).lpNorm<Eigen::Infinity>());
}

void Bodies::move_on(std::size_t body, const Pose2& pose) {
  poses_[body] = pose;
  const double c = std::cos(pose.yaw), s = std::sin(pose.yaw);
  Vector2* placed = &corners_[first_corner_[body]];
  for (const Vector2& corner : outlines_[body].corners())
    *placed++ = {pose.x + c * corner.x() - s * corner.y(), pose.y + s * corner.x() + c * corner.y()};
}

double Bodies::separation(std::size_t a, std::size_t b) const {
  const Vector2 apart = center(b) - center(a);
  const double distance = apart.norm();
  if (distance == 0.0) return -(radius(a) + radius(b));
  const Vector2 axis = apart / distance;
  double reach = -infinity, other_reach = infinity;
  for (const Vector2& corner : corners(a)) reach = std::max(reach, (corner - center(a)).dot(axis));
  for (const Vector2& corner : corners(b)) other_reach = std::min(other_reach, (corner - center(a)).dot(axis));
  return other_reach - reach;
}

std::uint32_t Bodies::cell(double coordinate) const {
  const double cell = std::floor(coordinate);
  if (!(std::abs(cell) < 1e15)) return 0;
  return static_cast<std::uint32_t>(static_cast<std::int64_t>(cell)) & (side_ - 1);
}

void Bodies::sort() {
  if (moved_ > far || sorted_ < size()) sort_anew();
}

void Bodies::sort_anew() {
  sorted_ = 0;
  moved_ = 0.0;
  ids_.resize(size());
  if (size() < worth_sorting) {
    std::iota(ids_.begin(), ids_.end(), 0u);
    return;
  }
  for (side_ = 8; std::size_t{side_} * side_ < cells_a_body * size();) side_ *= 2;
  begin_.assign(std::size_t{side_} * side_ + 1, 0);
  cell_of_.resize(size());
  sorted_at_.resize(size());
  for (std::size_t body = 0; body < size(); ++body) {
    sorted_at_[body] = center(body);
    cell_of_[body] = cell(sorted_at_[body].y()) * side_ + cell(sorted_at_[body].x());
    ++begin_[cell_of_[body]];
  }
  std::uint32_t end = 0;
  for (std::uint32_t& begin : begin_) begin = end += begin;  // the end of each cell, until it has been filled
  for (std::size_t body = size(); body-- > 0;) ids_[--begin_[cell_of_[body]]] = static_cast<std::uint32_t>(body);
  sorted_ = size();
}

}  // namespace kervan::sim
