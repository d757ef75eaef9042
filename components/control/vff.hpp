/// The Virtual Force Field: certain cells around the robot push it away, the target pulls it.
///
/// J. Borenstein, Y. Koren, "Real-Time Obstacle Avoidance for Fast Mobile Robots", IEEE Trans. Systems, Man, and
/// Cybernetics 19(5), 1989, doi:10.1109/21.44033. Equation numbers 1 to 10 are those of the account by Yenilmez and
/// Ersak, with what its print got wrong put right: the force of a cell points away from the cell (1), the sum is of
/// the cells' forces (2), repulsion and attraction have a constant each (1, 3), θ is the direction of the resultant in
/// all four quadrants (4), δ is the heading (5), and the speed depends on the repulsion alone (10).
///
/// Symbols: C certainty of a cell, d distance, Fcr and Fct the constants of repulsion and attraction, Fr and Ft those
/// forces, R their sum, θ its direction, δ the heading, Ω the turning rate, T the period, τ the time constant of the
/// low-pass, w the share of the repulsion that is never damped, V the speed. Forces have no physical unit.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "components/control/control_law.hpp"
#include "components/grid/certainty.hpp"
#include "components/grid/grid.hpp"
#include "framework/geometry/pose2.hpp"

namespace kervan::control {

inline constexpr int window_side = 33;
inline constexpr std::size_t window_cells = std::size_t{window_side} * window_side;

/// The cells around the robot, which is in the middle one.
struct CertaintyWindow {
  std::array<std::uint8_t, window_cells> cells{};        ///< C, 0 .. 15, row by row from the lowest, x fastest
  double resolution = 0.1;                               ///< m, side of a cell
  geometry::Vector2 origin = geometry::Vector2::Zero();  ///< lower left corner, m, in the frame of robot and target
};

/// Fills `window` with the cells around `robot` (m, in the frame of the grid), which must have a cell (grid::has_cell).
/// Cells of which nothing is known, and those outside of the grid, have no certainty.
void cut_window(const grid::Grid<grid::Certainty>& cells, const geometry::Vector2& robot, CertaintyWindow& window);

struct VffParams {
  double period = 0.1;       ///< s, T: time from one step to the next
  double f_cr = 0.02;        ///< Fcr, with C in 0 .. 15 and d in metres
  double f_ct = 1.0;         ///< Fct
  double k_s = 2.0;          ///< 1/s, Ks
  double tau = 0.4;          ///< s, τ; T or less: no low-pass
  double w = 0.25;           ///< 0 .. 1; 1: no damping
  double v_max = 0.78;       ///< m/s
  double v_min = 0.2;        ///< m/s; the law alone would stop a robot that heads for a cell, and hold it there
  double dead_band = 0.05;   ///< a repulsion up to this does not slow the robot: a cell of a single echo 0.9 m away
  double turn_rate = 2.094;  ///< rad/s, the most: 120 deg/s
};

/// What a step did. With a fault all forces are zero.
struct VffStep : Steering {
  geometry::Vector2 attraction = geometry::Vector2::Zero();  ///< Ft, eq. 3
  geometry::Vector2 repulsion = geometry::Vector2::Zero();   ///< Fr, eq. 2
  geometry::Vector2 damped = geometry::Vector2::Zero();      ///< Fr', eq. 8
  geometry::Vector2 resultant = geometry::Vector2::Zero();   ///< R = Ft + Fr', eq. 4
};

/// Fr of eqs. 1 and 2: each cell pushes with Fcr C / d², straight away from itself. d counts from the middle of the
/// window's middle cell, which has no direction and pushes nowhere.
geometry::Vector2 repulsion_of(const CertaintyWindow& window, double f_cr);

/// Ft of eq. 3: of size Fct, however far the target is; zero on it.
geometry::Vector2 attraction_of(const geometry::Vector2& robot, const geometry::Vector2& target, double f_ct);

/// cos θ of eq. 9, between the velocity of a robot that looks to `yaw` (rad) and drives with `speed` (m/s, negative:
/// backwards), and the repulsion; -1, head-on, if either is zero.
double motion_against(double yaw, double speed, const geometry::Vector2& repulsion);

/// The factor of eq. 8 on the repulsion, w - (1 - w) cos θ: 1 head-on, w along an obstacle, and 2 w - 1 away from it.
double damping(double w, double cos_theta);

/// V of eq. 10: Vmax up to the dead-band, beyond it Vmax (1 - |cos θ|), and never less than Vmin.
double speed_of(const VffParams& params, double repulsion, double cos_theta);

/// Ω' of eq. 7 from Ω and the Ω' before it.
double low_passed(const VffParams& params, double omega, double before);

/// Drives a robot step by step, one each T; it remembers nothing but the turning rate of eq. 7. Allocates nothing.
class VirtualForceField {
 public:
  explicit VirtualForceField(const VffParams& params) : params_(params) {}
  void set_params(const VffParams& params) { params_ = params; }

  /// The robot stands: what eq. 7 remembers is over.
  void reset() { turning_ = 0.0; }

  /// `robot` and `target` in the frame of the window's origin. On the target without a repulsion it does not turn. A
  /// fault is as reset(): a pose, a speed or a target that is not finite, a window whose cells have no size, or are
  /// more certain than 15, or in whose middle cell the robot is not.
  VffStep step(const RobotState& robot, const geometry::Vector2& target, const CertaintyWindow& window);

 private:
  VffParams params_;
  double turning_ = 0.0;  ///< Ω' of the step before, rad/s
};

}  // namespace kervan::control
