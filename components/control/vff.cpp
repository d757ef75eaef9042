#include "components/control/vff.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace kervan::control {
namespace {

using geometry::Vector2;

constexpr int middle = window_side / 2;

// Sixteen cells are a word of four times four bytes: byte k of all four at once, for each k.
using Cells [[gnu::vector_size(16)]] = std::int32_t;
using Lanes [[gnu::vector_size(16)]] = float;
constexpr std::size_t cells_at_once = 16;
constexpr std::size_t blocks = window_cells / cells_at_once;
static_assert(window_cells == blocks * cells_at_once + 1, "the last cell is added by itself");
static_assert(std::endian::native == std::endian::little, "byte k of a word is the cell k places on");

/// What a cell of certainty 1 pushes with at Fcr = 1 and cells of 1 m.
Vector2 unit_force(std::size_t cell) {
  const auto row = static_cast<int>(cell) / window_side, column = static_cast<int>(cell) % window_side;
  const Vector2 away(middle - column, middle - row);
  const double d = away.norm();
  return d == 0.0 ? Vector2(Vector2::Zero()) : Vector2(away / (d * d * d));
}

/// Of the byte k of block b: those of its four cells.
struct UnitForces {
  Lanes x, y;
};
using UnitForceTable = std::array<std::array<UnitForces, 4>, blocks>;

UnitForceTable made_unit_forces() {
  UnitForceTable table;
  for (std::size_t block = 0; block < blocks; ++block)
    for (std::size_t byte = 0; byte < 4; ++byte)
      for (std::size_t lane = 0; lane < 4; ++lane) {
        const Vector2 force = unit_force(block * cells_at_once + 4 * lane + byte);
        table[block][byte].x[lane] = static_cast<float>(force.x());
        table[block][byte].y[lane] = static_cast<float>(force.y());
      }
  return table;
}

const UnitForceTable unit_forces = made_unit_forces();
const Vector2 last_unit_force = unit_force(window_cells - 1);

double sum_of(const std::array<Lanes, 4>& lanes) {
  const Lanes sum = (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
  return static_cast<double>((sum[0] + sum[1]) + (sum[2] + sum[3]));
}

/// A bit that no certainty has shows in the union of all.
std::uint8_t union_of(const std::array<std::uint8_t, window_cells>& cells) {
  std::uint8_t bits = 0;
  for (const std::uint8_t cell : cells) bits = static_cast<std::uint8_t>(bits | cell);
  return bits;
}
static_assert((grid::most_certain & (grid::most_certain + 1)) == 0, "all bits below the highest one are used");

/// What is wrong with these inputs; empty: nothing.
std::string_view fault_of(const RobotState& robot, const Vector2& target, const CertaintyWindow& window) {
  if (const std::string_view fault = fault_of(robot, target); !fault.empty()) return fault;
  if (!(window.resolution > 0.0) || !std::isfinite(window.resolution)) return "the cells of the window have no size";
  const Vector2 off = (robot.pose.position() - window.origin) / window.resolution - Vector2::Constant(middle + 0.5);
  if (!(off.cwiseAbs().maxCoeff() <= 0.5 + 1e-6)) return "the robot is not in the middle of the window";  // also NaN
  if (union_of(window.cells) > grid::most_certain) return "a cell of the window is more certain than 15";
  return {};
}

}  // namespace

void cut_window(const grid::Grid<grid::Certainty>& cells, const Vector2& robot, CertaintyWindow& window) {
  const grid::Cell center = grid::cell_of(robot, cells.resolution());
  const grid::CellBox box{center.x - middle, center.y - middle, window_side, window_side};
  window.resolution = cells.resolution();
  window.origin = {box.x * window.resolution, box.y * window.resolution};
  const int left = std::max(box.x, cells.box().x);
  const int right = std::min(box.x + box.columns, cells.box().x + cells.box().columns);
  std::uint8_t* row = window.cells.data();
  for (int y = box.y; y < box.y + box.rows; ++y, row += window_side) {
    std::fill_n(row, window_side, std::uint8_t{0});
    if (left >= right || !cells.box().contains(grid::Cell{left, y})) continue;
    const grid::Certainty* from = cells.place({left, y});
    std::transform(from, from + (right - left), row + (left - box.x),
                   [](const grid::Certainty& cell) { return static_cast<std::uint8_t>(cell.value()); });
  }
}

Vector2 repulsion_of(const CertaintyWindow& window, double f_cr) {
  // Four sums side by side: a single one would wait for itself at every cell.
  std::array<Lanes, 4> x{}, y{};
  for (std::size_t block = 0; block < blocks; ++block) {
    Cells cells;
    std::memcpy(&cells, &window.cells[block * cells_at_once], sizeof cells);
    for (std::size_t byte = 0; byte < 4; ++byte) {
      const Lanes certainty = __builtin_convertvector((cells >> static_cast<int>(8 * byte)) & 0xff, Lanes);
      x[byte] += certainty * unit_forces[block][byte].x;
      y[byte] += certainty * unit_forces[block][byte].y;
    }
  }
  const Vector2 sum = Vector2(sum_of(x), sum_of(y)) + static_cast<double>(window.cells.back()) * last_unit_force;
  return f_cr / (window.resolution * window.resolution) * sum;
}

Vector2 attraction_of(const Vector2& robot, const Vector2& target, double f_ct) {
  const double d = (target - robot).norm();
  return d > 0.0 ? Vector2(f_ct / d * (target - robot)) : Vector2(Vector2::Zero());
}

double motion_against(double yaw, double speed, const Vector2& repulsion) {
  const double size = repulsion.norm();
  if (speed == 0.0 || size == 0.0) return -1.0;
  return std::clamp(std::copysign(1.0, speed) * geometry::heading(yaw).dot(repulsion) / size, -1.0, 1.0);
}

double damping(double w, double cos_theta) { return w - (1.0 - w) * cos_theta; }

double speed_of(const VffParams& params, double repulsion, double cos_theta) {
  if (repulsion <= params.dead_band) return params.v_max;
  return std::max(std::min(params.v_min, params.v_max), params.v_max * (1.0 - std::abs(cos_theta)));
}

double low_passed(const VffParams& params, double omega, double before) {
  if (params.tau <= params.period) return omega;
  return (params.period * omega + (params.tau - params.period) * before) / params.tau;
}

VffStep VirtualForceField::step(const RobotState& robot, const Vector2& target, const CertaintyWindow& window) {
  VffStep step;
  step.why = fault_of(robot, target, window);
  if (!step.why.empty()) {
    step.outcome = Outcome::fault;
    reset();
    return step;
  }
  step.attraction = attraction_of(robot.pose.position(), target, params_.f_ct);  // 3
  step.repulsion = repulsion_of(window, params_.f_cr);                           // 1, 2
  const double cos_theta = motion_against(robot.pose.yaw, robot.twist.linear, step.repulsion);
  step.damped = damping(params_.w, cos_theta) * step.repulsion;  // 8
  step.resultant = step.attraction + step.damped;

  double omega = 0.0;
  if (!step.resultant.isZero(0.0)) {
    const double theta = std::atan2(step.resultant.y(), step.resultant.x());  // 4
    omega = std::clamp(params_.k_s * geometry::angle_between(robot.pose.yaw, theta), -params_.turn_rate,
                       params_.turn_rate);  // 5
  }
  turning_ = low_passed(params_, omega, turning_);  // 7
  step.twist = {speed_of(params_, step.repulsion.norm(), cos_theta), turning_};
  return step;
}

}  // namespace kervan::control
