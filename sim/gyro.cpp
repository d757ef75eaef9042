#include "sim/gyro.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

namespace kervan::sim {

Gyro::Gyro(const GyroSettings& settings, const RandomSource& random) : settings_(settings) {
  if (!(settings.bias >= 0.0 && std::isfinite(settings.bias) && settings.noise >= 0.0 && std::isfinite(settings.noise)))
    throw std::invalid_argument("bias and noise of the gyroscope must not be negative");
  if (!(settings.scale >= 0.0 && settings.scale < 1.0))
    throw std::invalid_argument("the scale error of the gyroscope must be in [0, 1)");
  auto sequence = random.at(RandomUse::gyro_scale, 0, 0);
  bias_ = sequence.uniform(-settings.bias, settings.bias);
  scale_ = 1.0 + sequence.uniform(-settings.scale, settings.scale);
}

double Gyro::measure(const RandomSource& random, Duration now) {
  const double time = seconds(now - std::exchange(last_, now));
  const double turned = std::exchange(turned_, 0.0);
  const double rate = time > 0.0 ? turned / time : 0.0;
  auto sequence = random.at(RandomUse::gyro_noise, 0, static_cast<std::uint64_t>(now.count()));
  return scale_ * rate + bias_ + settings_.noise * sequence.gaussian();
}

}  // namespace kervan::sim
