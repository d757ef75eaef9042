/// What one input has got of each writer in another container of a lockstep run: how many samples have arrived, and how
/// many of them belong to the present cycle. A peer may be one cycle ahead, so more may have arrived.
#pragma once

#include <cstdint>
#include <vector>

namespace kervan::runtime {

class CountedWriters {
 public:
  struct Writer {
    std::uint64_t handle;       ///< Cyclone's
    unsigned index;             ///< in the composition
    std::uint64_t arrived = 0;  ///< so far
    std::uint64_t awaited = 0;  ///< somebody waits until so many have; 0: nobody does
    std::uint64_t allowed = 0;  ///< so many were published up to the present cycle
    std::uint64_t staged = 0;   ///< handed on to the cache
  };

  void add(std::uint64_t handle, unsigned index) { writers_.push_back({handle, index}); }
  bool empty() const { return writers_.empty(); }

  /// nullptr if the writer is of this container.
  Writer* find(std::uint64_t handle) {
    for (Writer& writer : writers_)
      if (writer.handle == handle) return &writer;
    return nullptr;
  }

  /// In the order they were added.
  Writer& operator[](std::size_t place) { return writers_[place]; }
  const std::vector<Writer>& all() const { return writers_; }

 private:
  std::vector<Writer> writers_;  ///< a topic has few writers, so looking through them is the fastest
};

}  // namespace kervan::runtime
