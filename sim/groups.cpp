#include "sim/groups.hpp"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <utility>

namespace kervan::sim {

void Groups::reset(std::size_t bodies, std::size_t common) {
  common_ = common;
  leader_.resize(bodies);
  std::iota(leader_.begin(), leader_.end(), 0u);
  first_.assign(bodies, nobody);
  last_.resize(bodies);
  next_.assign(bodies, nobody);
}

// A forest whose roots are the leaders; whoever leads no longer follows one with a lesser number.
void Groups::join(std::size_t a, std::size_t b) {
  const auto follow = [this](std::uint32_t body) { return std::atomic_ref(leader_[body]).load(); };
  const auto root = [&follow](std::uint32_t body) {
    for (std::uint32_t next; (next = follow(body)) != body;) body = next;
    return body;
  };
  auto one = static_cast<std::uint32_t>(a), other = static_cast<std::uint32_t>(b);
  while ((one = root(one)) != (other = root(other))) {
    if (one > other) std::swap(one, other);
    std::uint32_t itself = other;  // unless another thread has been quicker
    if (std::atomic_ref(leader_[other]).compare_exchange_strong(itself, one)) return;
  }
}

void Groups::sort(std::span<const std::size_t> order) {
  // Leaders have lesser numbers, so those of whom a body follows are known before its own.
  for (std::uint32_t& leader : leader_) leader = leader_[leader];
  for (const std::size_t place : order) {
    const auto body = static_cast<std::uint32_t>(common_ + place);
    const std::uint32_t leader = leader_[body];
    (first_[leader] == nobody ? first_[leader] : next_[last_[leader]]) = body;
    last_[leader] = body;
  }
}

}  // namespace kervan::sim
