/// Handles on pooled samples. A Sample is shared and read-only, the very object the publisher filled when both live in
/// one container; a Loan is the publisher's, mutable until it is published.
#pragma once

#include <utility>

#include "framework/component/time.hpp"

namespace kervan {

namespace dds {
struct SampleBlock;
void retain(SampleBlock* block) noexcept;
void release(SampleBlock* block) noexcept;
const void* value_of(const SampleBlock* block) noexcept;
void* mutable_value_of(SampleBlock* block) noexcept;
Time published_at(const SampleBlock* block) noexcept;
Time received_at(const SampleBlock* block) noexcept;
bool is_disposed(const SampleBlock* block) noexcept;
/// Whether it repeats its writer's last sample only to say that the writer is alive; under logical clocks.
bool is_assertion(const SampleBlock* block) noexcept;
}  // namespace dds

/// A shared, read-only sample of message type T. Copying it copies a pointer. A default-constructed one is empty.
template <class T>
class Sample {
 public:
  Sample() = default;
  explicit Sample(dds::SampleBlock* block) noexcept : block_(block) { dds::retain(block_); }
  Sample(const Sample& other) noexcept : block_(other.block_) {
    if (block_) dds::retain(block_);
  }
  Sample(Sample&& other) noexcept : block_(std::exchange(other.block_, nullptr)) {}
  Sample& operator=(Sample other) noexcept {
    std::swap(block_, other.block_);
    return *this;
  }
  ~Sample() {
    if (block_) dds::release(block_);
  }

  explicit operator bool() const { return block_ != nullptr; }
  const T& operator*() const { return *static_cast<const T*>(dds::value_of(block_)); }
  const T* operator->() const { return &**this; }

  /// When the publisher published it, on the composition's clock (its own clock, if it lives on another host).
  Time published() const { return dds::published_at(block_); }
  /// The instance it belongs to was disposed; only the key members of the value count.
  bool disposed() const { return dds::is_disposed(block_); }

 private:
  dds::SampleBlock* block_ = nullptr;
};

/// A mutable block out of the topic's pool, filled by the publisher and handed to Output::publish. Dropped unpublished,
/// it goes back to the pool.
template <class T>
class Loan {
 public:
  Loan(Loan&& other) noexcept : block_(std::exchange(other.block_, nullptr)) {}
  Loan(const Loan&) = delete;
  Loan& operator=(const Loan&) = delete;
  Loan& operator=(Loan&&) = delete;
  ~Loan() {
    if (block_) dds::release(block_);
  }

  T& operator*() const { return *static_cast<T*>(dds::mutable_value_of(block_)); }
  T* operator->() const { return &**this; }

 private:
  template <class>
  friend class Output;
  explicit Loan(dds::SampleBlock* block) noexcept : block_(block) {}

  dds::SampleBlock* block_;
};

}  // namespace kervan
