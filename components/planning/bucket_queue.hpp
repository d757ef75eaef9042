/// The open list of a search whose costs are whole numbers.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace kervan::planning {

/// Buckets in the order of f, each of them a stack: what lies in one bucket differs by less than its width, so the
/// first one out need not be the cheapest, but none of a later bucket is cheaper. The buckets are used round and round,
/// so all that is in the queue at a time must lie within their number. R. B. Dial 1969, "Algorithm 360",
/// doi:10.1145/363269.363610.
class BucketQueue {
 public:
  struct Entry {
    std::uint32_t cell;
    std::uint32_t g;      ///< its lowest 32 bits: of another label than the cell's present one they differ
    std::uint32_t place;  ///< x and y, as place_of()
    std::uint32_t next;

    int x() const { return static_cast<int>(place & 0xffffu); }
    int y() const { return static_cast<int>(place >> 16); }
  };

  /// A step to a neighbour is one addition of place_of(dx, dy).
  static constexpr std::uint32_t place_of(int x, int y) {
    return (static_cast<std::uint32_t>(y) << 16) + static_cast<std::uint32_t>(x);
  }

  /// Empties the queue. `width`: of a bucket, as a power of two. `spread`: f of all entries at a time differ by less.
  void begin(std::uint64_t first_f, unsigned width, std::uint64_t spread) {
    const auto buckets = std::size_t{1} << std::bit_width((spread >> width) + 2);
    if (heads_.size() != buckets) {
      heads_.assign(buckets, nothing);
    } else {
      for (std::uint64_t bucket = now_; bucket <= last_; ++bucket) heads_[bucket & (buckets - 1)] = nothing;
    }
    width_ = width;
    now_ = last_ = first_f >> width;
    size_ = used_ = 0;
    free_ = nothing;
  }

  /// True if what is pushed with this f would be the next one out: it may as well be kept in hand.
  bool next_out(std::uint64_t f) const { return f >> width_ == now_; }

  /// Makes room for as many entries at a time; more cost an allocation.
  void reserve(std::size_t entries) {
    if (entries_.size() < entries) entries_.resize(entries);
  }

  void push(std::uint64_t f, std::uint32_t cell, std::uint64_t g, std::uint32_t place) {
    std::uint32_t entry = free_;
    if (entry != nothing) {
      free_ = entries_[entry].next;
    } else {
      entry = static_cast<std::uint32_t>(used_++);
      if (used_ > entries_.size()) entries_.resize(2 * used_);
    }
    const std::uint64_t bucket = f >> width_;
    std::uint32_t& head = heads_[bucket & (heads_.size() - 1)];
    entries_[entry] = {cell, static_cast<std::uint32_t>(g), place, head};
    head = entry;
    last_ = std::max(last_, bucket);
    ++size_;
  }

  /// An entry of the first bucket that has any; false if there is none, or only beyond the bucket that `limit` is in.
  bool pop(Entry& entry, std::uint64_t limit) {
    if (size_ == 0) return false;
    const std::size_t mask = heads_.size() - 1;
    while (heads_[now_ & mask] == nothing) ++now_;
    if (now_ > limit >> width_) return false;
    std::uint32_t& head = heads_[now_ & mask];
    const std::uint32_t first = head;
    entry = entries_[first];
    head = entry.next;
    entries_[first].next = free_;
    free_ = first;
    --size_;
    return true;
  }

 private:
  static constexpr std::uint32_t nothing = 0xffffffffu;

  std::vector<std::uint32_t> heads_;
  std::vector<Entry> entries_;
  std::size_t size_ = 0;
  std::size_t used_ = 0;  // entries that were in use since begin()
  std::uint32_t free_ = nothing;
  unsigned width_ = 0;
  std::uint64_t now_ = 0;   // no bucket before it has an entry
  std::uint64_t last_ = 0;  // nor one behind it
};

}  // namespace kervan::planning
