#include "sim/bumpers.hpp"

#include <stdexcept>

namespace kervan::sim {

Bumpers::Bumpers(const RobotModel& model, double touch_range)
    : segments_(fitted_bumpers(model)), touch_range_(touch_range) {
  if (!(touch_range > 0.0)) throw std::invalid_argument("the touch range of the bumpers must be positive");
  if (segments_.empty()) return;
  // Clearance is asked of bodies, and a body has an extent: a tenth of a millimetre, to the inside.
  constexpr double thickness = 1e-4;
  const double half = 0.5 * model.bumpers.length;
  const Outline pad({{0.0, -half}, {0.0, half}, {-thickness, half}, {-thickness, -half}});
  pads_.assign(segments_.size(), pad);
}

void Bumpers::feel(const Surroundings& around, const Pose2& pose, std::vector<bool>& pressed) const {
  pressed.resize(size());
  for (std::size_t i = 0; i < size(); ++i)
    pressed[i] = around.room(pads_[i], pose * segments_[i]).all.distance <= touch_range_;
}

}  // namespace kervan::sim
