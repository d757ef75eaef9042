#include "framework/dds/wall_clock.hpp"

namespace kervan::dds {

Time wall_now() {
  using std::chrono::steady_clock;
  using std::chrono::system_clock;
  static const Duration offset = Duration(system_clock::now().time_since_epoch()) -
                                 Duration(steady_clock::now().time_since_epoch());
  return Time(Duration(steady_clock::now().time_since_epoch()) + offset);
}

}  // namespace kervan::dds
