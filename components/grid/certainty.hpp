/// The certainty values of HIMM (Borenstein and Koren 1991, "Histogramic in-motion mapping"): a counter for each cell.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace kervan::grid {

inline constexpr int most_certain = 15;
inline constexpr int certainty_up = 3;    ///< for an echo from the cell
inline constexpr int certainty_down = 1;  ///< for an echo from behind it

/// 0 .. 15, and whether anything was ever heard of the cell.
class Certainty {
 public:
  int value() const { return state_ == 0 ? 0 : state_ - 1; }
  bool known() const { return state_ != 0; }

  void raise() { state_ = static_cast<std::uint8_t>(std::min(value() + certainty_up, most_certain) + 1); }
  void lower() { state_ = lowered[state_]; }  // half of the instructions: of a ray nearly all cells are lowered

  bool operator==(const Certainty&) const = default;

 private:
  static constexpr auto lowered = [] {
    std::array<std::uint8_t, most_certain + 2> states{};
    for (int state = 0; state < most_certain + 2; ++state)
      states[static_cast<std::size_t>(state)] =
          static_cast<std::uint8_t>(std::max(state, 1 + certainty_down) - certainty_down);
    return states;
  }();

  std::uint8_t state_ = 0;  // 0: unknown; else 1 + the value
};

/// The certainty value in fifteenths, as per cent; -1 if nothing is known.
inline std::int8_t percent_of(const Certainty& cell) {
  return cell.known() ? static_cast<std::int8_t>((100 * cell.value() + most_certain / 2) / most_certain)
                      : std::int8_t{-1};
}

}  // namespace kervan::grid
