/// Belief in a cell by Dempster and Shafer: what speaks for occupied, what for empty, and what is not known.
#pragma once

#include <cmath>
#include <cstdint>

namespace kervan::grid {

struct Masses {
  double occupied = 0.0;
  double empty = 0.0;
  double unknown() const { return 1.0 - occupied - empty; }
};

struct Combination {
  Masses masses;
  double conflict = 0.0;  ///< mass of the contradictions between the two, which the rule leaves out
};

/// Dempster's rule, the orthogonal sum of two independent beliefs divided by 1 - conflict. Two that contradict each
/// other entirely (conflict 1) have no sum: the first one remains.
inline Combination combine(const Masses& a, const Masses& b) {
  const double conflict = a.occupied * b.empty + a.empty * b.occupied;
  if (!(conflict < 1.0)) return {a, conflict};
  const double n = 1.0 / (1.0 - conflict);
  return {{n * (a.occupied * (b.occupied + b.unknown()) + a.unknown() * b.occupied),
           n * (a.empty * (b.empty + b.unknown()) + a.unknown() * b.empty)},
          conflict};
}

/// A cell of a map. Its masses leave a little unknown (least_unknown), so that it can change its mind.
struct MassCell {
  float occupied = 0.0f;
  float empty = 0.0f;

  bool operator==(const MassCell&) const = default;
};

inline constexpr float least_unknown = 0.02f;

/// Per cent occupied, half of the unknown counting for it (Smets' pignistic probability); -1 if nothing is known.
inline std::int8_t percent_of(const MassCell& cell) {
  if (cell.occupied == 0.0f && cell.empty == 0.0f) return -1;
  return static_cast<std::int8_t>(std::lround(50.0f * (1.0f + cell.occupied - cell.empty)));
}

}  // namespace kervan::grid
