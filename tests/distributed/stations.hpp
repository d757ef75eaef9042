/// A composition that shows every way in which the order of things could depend on where they run: timers of different
/// periods, loops without delay, topics with many writers, keys that come and go, and all times that qualities of
/// service know. Each station mixes what it hears into its state, and what it says depends on that: any difference
/// spreads.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "framework/component/registry.hpp"
#include "framework/runtime/container.hpp"

namespace kervan::test {

inline constexpr unsigned kStations = 10;

struct Placement {
  unsigned containers = 1;
  unsigned threads = 1;  ///< in each
};

/// The stations spread over containers called c0, c1, …; all the same but for `name`, as everywhere.
runtime::ContainerSpec stations(std::uint64_t seed, const Placement& placement, unsigned container,
                                const std::string& tag);

/// A tag that no other run has.
std::string new_tag();

/// Closed while it exists: the handler of a `test/gate` does not return before it opens. One at a time.
class ClosedGate {
 public:
  ClosedGate();
  ~ClosedGate() { open(); }
  ClosedGate(const ClosedGate&) = delete;
  ClosedGate& operator=(const ClosedGate&) = delete;
  void open();
};

/// Knows the stations, and `test/stopper`, which ends the run at 100 ms, `test/ball`, which answers each sample with
/// one of its own, `test/sleeper`, which takes seconds to handle one timer, and `test/gate`, whose first timer does not
/// return while there is a closed gate.
ComponentRegistry station_registry();

struct MemberResult {
  runtime::RunReport report;
  std::uint64_t trace = 0;
  std::string failures;  ///< of components
};

MemberResult run_member(const runtime::ContainerSpec& spec, const runtime::RunControl& control);

}  // namespace kervan::test
