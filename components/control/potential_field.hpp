/// Artificial potential fields: the classical law and Ge & Cui's, and the motion that a force asks of a robot.
///
/// O. Khatib, "Real-Time Obstacle Avoidance for Manipulators and Mobile Robots", IJRR 5(1), 1986,
/// doi:10.1177/027836498600500106; S. S. Ge, Y. J. Cui, "New Potential Functions for Mobile Robot Path Planning", IEEE
/// Trans. Robotics and Automation 16(5), 2000, doi:10.1109/70.880813. Equation numbers 3.1 to 3.9 are those of the
/// comparison by Çınar, Parlaktuna and Yazıcı; the factor that its equation 3.4 lost in print is restored here.
///
/// Symbols: q the robot, ρ its distance to the obstacle, ρ0 the distance within which an obstacle acts, ρg the distance
/// to the goal, n_OR the unit vector from obstacle to robot, n_RG the unit vector from robot to goal.
#pragma once

#include <optional>

#include "framework/geometry/pose2.hpp"

namespace kervan::control {

enum class ForceLaw {
  classical,  ///< n = 0: an obstacle repels however near the goal is, so a goal close to a wall is not reached
  ge_cui,     ///< repulsion fades with ρg^n, so that the goal is the minimum of the field
};

struct ForceParams {
  ForceLaw law = ForceLaw::ge_cui;
  double xi = 1.0;         ///< ξ, attraction for each metre to the goal
  double eta = 0.3;        ///< η, strength of the repulsion
  double n = 3.0;          ///< exponent of ρg in the repulsion of Ge & Cui; 0 gives the classical law
  double rho0 = 1.0;       ///< ρ0, m
  double rho_g_cap = 1.0;  ///< m; see ρg' below
};

/// A force and the terms it is made of. Forces have no physical unit; vectors are in the frame of the points given.
struct Force {
  geometry::Vector2 attraction = geometry::Vector2::Zero();  ///< Fatt, eq. 3.2
  geometry::Vector2 repulsion = geometry::Vector2::Zero();   ///< Frep, eq. 3.6
  geometry::Vector2 total = geometry::Vector2::Zero();       ///< F, eq. 3.9
  double f1 = 0.0;                                           ///< F1, away from the obstacle, eq. 3.7
  double f2 = 0.0;                                           ///< F2, towards the goal, eq. 3.8
  double rho_g = 0.0;                                        ///< m, not capped
  std::optional<double> rho;                                 ///< m; none if no obstacle was given
};

/// The force at `robot`, a point of any frame in metres; `goal` and `obstacle` are points of the same frame. All must
/// be finite. `obstacle` is the one obstacle point nearest to the robot's centre: a sum over several points would move
/// the place where the classical law comes to rest.
///
/// The law is used with ρg' = min(ρg, rho_g_cap) in the attraction and in F1 and F2 alike. Within the cap it is the law
/// of the papers; beyond it the attraction no longer grows with the distance. If only the repulsion were capped, the
/// attraction would push the robot into the obstacle.
///
/// At the goal both laws give no attraction. On the obstacle point (ρ below 1 mm) the direction away from it is unknown
/// and the repulsion is zero; drive_along() stops a robot long before.
Force force_at(const ForceParams& params, const geometry::Vector2& robot, const geometry::Vector2& goal,
               const std::optional<geometry::Vector2>& obstacle);

struct ForceDriveParams {
  double speed = 0.5;          ///< m/s, at a force of full_force or more
  double full_force = 1.0;     ///< force for full speed
  double turn_gain = 2.0;      ///< 1/s, turning rate for each radian between the force and the heading
  double turn_rate = 1.0;      ///< rad/s, the most
  double stop_distance = 0.3;  ///< m between the robot's centre and the obstacle at which the robot must stand
  double braking = 0.5;        ///< m/s2, deceleration assumed when the speed is limited before an obstacle
};

/// The motion of a robot with heading `yaw` (rad) that follows `force` (same frame): it turns towards the force and
/// drives the faster, the stronger the force and the better its heading agrees; it never reverses. With e the angle
/// from the heading to the force, v = speed · min(1, |F| / full_force) · max(0, cos e) and ω = turn_gain · e, limited
/// to ±turn_rate. v is limited further so that braking brings the robot to rest stop_distance from the obstacle. No
/// force, no motion.
geometry::Twist2 drive_along(const ForceDriveParams& params, const Force& force, double yaw);

}  // namespace kervan::control
