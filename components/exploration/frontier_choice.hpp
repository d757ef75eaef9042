/// Which frontier to drive to next.
#pragma once

#include <span>
#include <vector>

#include "components/exploration/frontier_map.hpp"
#include "framework/component/time.hpp"

namespace kervan::exploration {

struct FrontierChoiceParams {
  double gain = 1.0;                          ///< m of way that a metre of frontier is worth
  double separation = 2.0;                    ///< m; nearer to what another robot has chosen nothing is
  double same_within = 0.5;                   ///< m; what was put aside is this place and what is so near to it
  Duration aside = std::chrono::seconds(30);  ///< for so long
  int most_tries = 2;                         ///< put aside so often it is given up
};

enum class Choice {
  chosen,
  waiting,   ///< all that there is was chosen by others, or is put aside
  explored,  ///< there is none any more, but for what was given up
};

/// Chooses the frontier of the least cost: the way to it, less what its length is worth (Burgard et al. 2005,
/// "Coordinated Multi-Robot Exploration", doi:10.1109/TRO.2004.839232, with a fixed gain instead of an expected one).
class FrontierChoice {
 public:
  explicit FrontierChoice(const FrontierChoiceParams& params) : params_(params) {}

  /// It could not be reached, or there was nothing to be seen from it.
  void put_aside(Time now, const geometry::Vector2& place);

  /// `taken`: what other robots have chosen. Of equals the first.
  Choice choose(Time now, std::span<const Frontier> frontiers, std::span<const geometry::Vector2> taken);

  /// Good after `chosen`.
  const Frontier& chosen() const { return chosen_; }

 private:
  struct Aside {
    geometry::Vector2 place;
    Time until;
    int tries;
  };

  const Aside* aside_at(const geometry::Vector2& place) const;

  FrontierChoiceParams params_;
  std::vector<Aside> aside_;
  Frontier chosen_;
};

}  // namespace kervan::exploration
