#include "components/mapping/laser_mapper.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "components/grid/occupancy.hpp"
#include "components/mapping/run_kernel.hpp"

namespace kervan::mapping {
namespace {

using geometry::Scan;
using geometry::Vector2;

constexpr double whole_turn = 2.0 * std::numbers::pi;

/// A polygon ends this much before what the beam met, in cells: more than half the diagonal of one, so that the cell of
/// a wall is not cleared by the beam beside the one that met it.
constexpr double before_the_end = 0.75;

/// tan 75 degrees: neighbouring beams that differ more than on a wall met as obliquely as that see two things.
constexpr double steepest = 3.73;

/// Nearly always there are two.
void sort_few(float* begin, float* end) {
  for (float* at = begin + 1; at < end; ++at) {
    const float value = *at;
    float* to = at;
    for (; to > begin && to[-1] > value; --to) *to = to[-1];
    *to = value;
  }
}

}  // namespace

LaserMapper::LaserMapper(const LaserMapperParams& params)
    : params_(params),
      hit_(grid::log_odds_of(params.hit)),
      miss_(grid::log_odds_of(params.miss)),
      cells_(params.resolution, 0, params.most_bytes) {}

ScanResult LaserMapper::add(const geometry::Pose2& laser, const Scan& scan) {
  if (!possible(scan)) return ScanResult::refused_scan;
  if (!grid::has_cell(laser.position()) || !std::isfinite(laser.yaw)) return ScanResult::refused_place;
  use_beams(scan);
  trace(laser, scan);

  const double resolution = params_.resolution;
  grid::CellBox box;
  for (const Vector2& corner : polygon_) {
    const grid::Cell cell = grid::cell_of(corner, 1.0);
    box = grid::united(box, {cell.x, cell.y, 1, 1});
  }
  for (const grid::Cell& end : ends_) box = grid::united(box, {end.x, end.y, 1, 1});
  if (box.empty()) return ScanResult::added;
  if (!grid::has_cell(resolution * Vector2(box.x, box.y)) || cells_.cover(box) == grid::Growth::refused)
    return ScanResult::refused_memory;

  // The cells that beams end in keep what they had, whatever the polygon covers, and are then told of the end alone:
  // once, since each of several beams adds to what was there before the scan.
  grid::LogOdds* const first = cells_.place({cells_.box().x, cells_.box().y});
  befores_.clear();
  for (const grid::Cell& end : ends_) {
    const grid::LogOdds* const cell = cells_.place(end);
    befores_.push_back({cell - first, *cell});
  }
  fill(box);
  for (const End& end : befores_) first[end.cell] = grid::added(end.before, hit_);
  cells_.touch(box);
  return ScanResult::added;
}

void LaserMapper::use_beams(const Scan& scan) {
  if (beams_.size() == scan.ranges.size() && angle_min_ == scan.angle_min && angle_increment_ == scan.angle_increment)
    return;
  angle_min_ = scan.angle_min;
  angle_increment_ = scan.angle_increment;
  beams_.clear();
  for (std::size_t i = 0; i < scan.ranges.size(); ++i)
    beams_.push_back(geometry::heading(scan.angle_min + static_cast<double>(i) * scan.angle_increment));
}

/// Makes the polygon and the cells that beams end in.
void LaserMapper::trace(const geometry::Pose2& laser, const Scan& scan) {
  const double resolution = params_.resolution, per_metre = 1.0 / resolution;
  const double c = std::cos(laser.yaw), s = std::sin(laser.yaw);
  const Vector2 at = laser.position() * per_metre;
  const double jump = steepest * std::abs(scan.angle_increment);
  polygon_.clear();
  ends_.clear();
  double last = 0.0;
  Vector2 last_beam = Vector2::Zero();
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const double range = static_cast<double>(scan.ranges[i]);
    const Vector2 beam(c * beams_[i].x() - s * beams_[i].y(), s * beams_[i].x() + c * beams_[i].y());
    double clear = 0.0;  // cells
    if (range >= scan.range_max) {
      clear = std::min(params_.no_echo_limit, params_.max_range) * per_metre;
    } else if (range >= scan.range_min) {
      clear = std::max(0.0, range * per_metre - before_the_end);
      if (range <= params_.max_range)
        ends_.push_back(grid::cell_of(at + range * per_metre * beam, 1.0));
      else
        clear = params_.max_range * per_metre;
    } else if (std::isnan(range) || (range < 0.0 && std::isfinite(range))) {
      ++refused_ranges_;
    }
    // A scan of more than a turn sees some of it twice; its polygon must not.
    if (static_cast<double>(i) * std::abs(scan.angle_increment) > whole_turn + 1e-9) continue;
    if (i == 0)
      polygon_.push_back(at);
    else if (clear - last > jump * last + 2.0)
      polygon_.push_back(at + last * beam);
    else if (last - clear > jump * clear + 2.0)
      polygon_.push_back(at + clear * last_beam);
    polygon_.push_back(at + clear * beam);
    last = clear;
    last_beam = beam;
  }
  // A whole turn closes on itself; anything less through the laser, with which it began.
  const double turn = std::abs(scan.angle_increment) * static_cast<double>(scan.ranges.size());
  if (!polygon_.empty() && turn > whole_turn - 1e-3) polygon_.front() = polygon_.back();
}

/// Notes where an edge crosses the middle lines of rows. A line through a corner counts for one of its two edges only.
void LaserMapper::edge(const Vector2& from, const Vector2& to, int left) {
  const Vector2 &low = from.y() < to.y() ? from : to, &high = from.y() < to.y() ? to : from;
  const int begin = static_cast<int>(std::ceil(low.y() - 0.5)), end = static_cast<int>(std::ceil(high.y() - 0.5));
  if (begin >= end) return;
  const double slope = (high.x() - low.x()) / (high.y() - low.y());
  for (int row = begin; row < end; ++row)
    crossings_.push_back({row, static_cast<float>(low.x() - left + (row + 0.5 - low.y()) * slope)});
}

/// Tells every cell whose middle lies in the polygon that it was passed.
void LaserMapper::fill(const grid::CellBox& box) {
  crossings_.clear();
  for (std::size_t i = 0; i < polygon_.size(); ++i)
    edge(polygon_[i], polygon_[i + 1 == polygon_.size() ? 0 : i + 1], box.x);

  // Sorted by row by counting, then each row by place.
  row_begins_.assign(static_cast<std::size_t>(box.rows) + 1, 0);
  for (const Crossing& crossing : crossings_) ++row_begins_[static_cast<std::size_t>(crossing.row - box.y) + 1];
  for (std::size_t row = 1; row < row_begins_.size(); ++row) row_begins_[row] += row_begins_[row - 1];
  sorted_.resize(crossings_.size());
  for (const Crossing& crossing : crossings_)
    sorted_[row_begins_[static_cast<std::size_t>(crossing.row - box.y)]++] = crossing.x;
  for (std::size_t row = 0, begin = 0; row + 1 < row_begins_.size(); ++row) {
    const std::size_t end = row_begins_[row];  // by now the next one's begin
    if (end - begin > 1) sort_few(sorted_.data() + begin, sorted_.data() + end);
    for (; begin + 1 < end; begin += 2) {
      const int from = static_cast<int>(std::ceil(sorted_[begin] - 0.5f));
      const int to = static_cast<int>(std::ceil(sorted_[begin + 1] - 0.5f));
      if (from < to) add_run(cells_.place({box.x + from, box.y + static_cast<int>(row)}), to - from, miss_);
    }
    begin = end;
  }
}

void LaserMapper::read_percent(const grid::CellBox& box, std::span<std::int8_t> percent) const {
  grid::read_percent(cells_, box, percent);
}

}  // namespace kervan::mapping
