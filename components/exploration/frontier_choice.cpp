#include "components/exploration/frontier_choice.hpp"

#include <algorithm>
#include <limits>

namespace kervan::exploration {

using geometry::Vector2;

const FrontierChoice::Aside* FrontierChoice::aside_at(const Vector2& place) const {
  for (const Aside& aside : aside_)
    if ((aside.place - place).norm() <= params_.same_within) return &aside;
  return nullptr;
}

void FrontierChoice::put_aside(Time now, const Vector2& place) {
  if (const Aside* known = aside_at(place)) {
    Aside& aside = aside_[static_cast<std::size_t>(known - aside_.data())];
    aside.until = now + params_.aside;
    ++aside.tries;
  } else {
    aside_.push_back({place, now + params_.aside, 1});
  }
}

Choice FrontierChoice::choose(Time now, std::span<const Frontier> frontiers, std::span<const Vector2> taken) {
  double least = std::numeric_limits<double>::infinity();
  bool later = false;
  for (const Frontier& frontier : frontiers) {
    const Aside* aside = aside_at(frontier.place);
    if (aside && aside->tries >= params_.most_tries) continue;
    const auto near = [&](const Vector2& other) { return (other - frontier.place).norm() < params_.separation; };
    if ((aside && now < aside->until) || std::any_of(taken.begin(), taken.end(), near)) {
      later = true;
      continue;
    }
    const double cost = frontier.distance - params_.gain * frontier.length;
    if (cost >= least) continue;
    least = cost;
    chosen_ = frontier;
  }
  if (least < std::numeric_limits<double>::infinity()) return Choice::chosen;
  return later ? Choice::waiting : Choice::explored;
}

}  // namespace kervan::exploration
