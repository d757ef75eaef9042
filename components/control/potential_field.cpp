#include "components/control/potential_field.hpp"

#include <algorithm>
#include <cmath>

#include "components/control/heading_drive.hpp"

namespace kervan::control {
namespace {

using geometry::Vector2;

constexpr double touching = 1e-3;  // m; nearer than this, a direction away from the obstacle is noise

/// The unit vector of `v`, or zero if v is too short to have a direction.
Vector2 direction(const Vector2& v) {
  const double length = v.norm();
  return length > 0.0 ? Vector2(v / length) : Vector2(Vector2::Zero());
}

}  // namespace

Force force_at(const ForceParams& params, const Vector2& robot, const Vector2& goal,
               const std::optional<Vector2>& obstacle) {
  Force force;
  force.rho_g = (goal - robot).norm();
  const double rho_g = std::min(force.rho_g, params.rho_g_cap);
  const Vector2 n_rg = direction(goal - robot);
  force.attraction = params.xi * rho_g * n_rg;  // 3.2

  if (obstacle) {
    const double rho = (robot - *obstacle).norm();
    force.rho = rho;
    if (rho >= touching && rho <= params.rho0) {
      const double n = params.law == ForceLaw::classical ? 0.0 : params.n;
      const double nearness = 1.0 / rho - 1.0 / params.rho0;
      force.f1 = params.eta * nearness * std::pow(rho_g, n) / (rho * rho);  // 3.7; n = 0 gives 3.4
      if (n > 0.0 && rho_g > 0.0)
        force.f2 = 0.5 * n * params.eta * nearness * nearness * std::pow(rho_g, n - 1.0);  // 3.8
      force.repulsion = force.f1 * direction(robot - *obstacle) + force.f2 * n_rg;         // 3.6
    }
  }
  force.total = force.attraction + force.repulsion;  // 3.9
  return force;
}

geometry::Twist2 drive_along(const ForceDriveParams& params, const Force& force, double yaw) {
  const double strength = force.total.norm();
  if (strength == 0.0) return {};
  const double error = geometry::angle_between(yaw, std::atan2(force.total.y(), force.total.x()));
  double v = params.speed * std::min(1.0, strength / params.full_force) * std::max(0.0, std::cos(error));
  if (force.rho) {
    v = std::min(v, stopping_speed(*force.rho - params.stop_distance, params.braking));
  }
  return {v, std::clamp(params.turn_gain * error, -params.turn_rate, params.turn_rate)};
}

}  // namespace kervan::control
