/// Who may meet whom within a step. Bodies that come near each other, themselves or by way of others, form a group;
/// what the bodies of one group do makes no difference to those of another.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace kervan::sim {

/// First reset(), then join(), then sort(); after that the groups can be asked.
class Groups {
 public:
  /// Of so many bodies each is a group of its own, but for the first `common` of them: they belong to every group.
  void reset(std::size_t bodies, std::size_t common);

  /// The groups of two bodies, neither of them common, become one. Several threads may do this at once, for the
  /// outcome does not depend on the order.
  void join(std::size_t a, std::size_t b);

  /// Lists the bodies of each group in this order. It holds all but the common ones, and 0 is the first of them.
  void sort(std::span<const std::size_t> order);

  /// True if b does not belong to the group of a.
  bool apart(std::size_t a, std::size_t b) const { return b >= common_ && leader_[a] != leader_[b]; }

  /// Calls visit(body) for all bodies of a group, if `leader` is its leader: each group has one.
  template <class Visit>
  void visit_led_by(std::size_t leader, Visit&& visit) const {
    if (leader_[leader] != leader) return;
    for (std::uint32_t body = first_[leader]; body != nobody; body = next_[body]) visit(std::size_t{body});
  }

 private:
  static constexpr std::uint32_t nobody = ~std::uint32_t{0};

  std::size_t common_ = 0;
  std::vector<std::uint32_t> leader_;  // of each body's group: the least of its numbers; on the way to it before sort()
  std::vector<std::uint32_t> first_, last_;  // of the group, by its leader
  std::vector<std::uint32_t> next_;          // in its group, of each body
};

}  // namespace kervan::sim
