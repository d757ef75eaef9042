/// Private to framework/dds: one pooled block per sample. It is Cyclone's serdata, the receive stamp, the CDR made at
/// most once and only for a remote reader, and the C++ value itself. Local readers get the block the publisher filled.
#pragma once

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_serdata_default.h>
#include <dds/ddsi/ddsi_sertype.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>

#include "framework/component/time.hpp"
#include "framework/dds/cdr_writer.hpp"
#include "framework/dds/type_support.hpp"

namespace kervan::dds {

class BlockPool;
class Reports;

/// The prefix that sample blocks share with the key-only entries of Cyclone's instance map, so that keys compare alike.
struct KeyedBlock : ddsi_serdata {
  BlockPool* pool = nullptr;  ///< nullptr: a key-only entry, owned by the instance map
  std::string key;            ///< big-endian key as DDS prescribes for the key hash; empty for keyless types
};

/// Serialised form with its 4-byte encapsulation header, padded to a multiple of 4. A long run of numbers, as an image
/// has it, is not copied here but sent out of the value.
struct CdrBytes {
  std::size_t capacity;   ///< bytes behind this struct
  cdr::LongRun long_run;  ///< counted from data()
  std::byte* data() { return reinterpret_cast<std::byte*>(this + 1); }
  /// These bytes in one piece, here or in the value; nullptr if they are in two.
  const std::byte* find(std::size_t offset, std::size_t size);
  void copy(std::size_t offset, std::size_t size, std::byte* to);
};

struct SampleBlock : KeyedBlock {
  std::atomic<CdrBytes*> cdr{nullptr};    ///< nullptr until a remote reader needs it
  std::atomic<CdrBytes*> spare{nullptr};  ///< memory for it, kept from an earlier use of the block
  SampleBlock* next_free = nullptr;
  std::size_t pooled_bytes = 0;  ///< what the block accounts for while it lies in the pool
  Time received{};               ///< on the composition's clock; the publishing time for a local sample
  std::uint64_t instance = 0;    ///< hash of the key, the same in every process; 0 for keyless types
  std::uint64_t sequence = 0;    ///< given by the writer, from 1 on; 0 if not known
  void* value = nullptr;         ///< behind this struct, suitably aligned
};

inline const SampleBlock* as_block(const ddsi_serdata* serdata) { return static_cast<const SampleBlock*>(serdata); }
inline SampleBlock* as_block(ddsi_serdata* serdata) { return static_cast<SampleBlock*>(serdata); }

/// Blocks of one type, kept for reuse with the memory their values own. It outlives the type as long as somebody holds
/// a sample.
class BlockPool {
 public:
  explicit BlockPool(const TypeSupport& support) : support_(support) {}
  BlockPool(const BlockPool&) = delete;
  BlockPool& operator=(const BlockPool&) = delete;

  /// A block whose value holds whatever its last user left; reference count 1.
  SampleBlock* get(const ddsi_sertype* type, ddsi_serdata_kind kind);
  /// Takes back a block nobody refers to.
  void put(SampleBlock* block) noexcept;
  /// The type is gone; the pool deletes itself with its last block.
  void close() noexcept;

  const TypeSupport& support() const { return support_; }

 private:
  ~BlockPool() = default;
  SampleBlock* allocate();
  void destroy(SampleBlock* block) noexcept;
  void lock() noexcept {
    while (spin_.test_and_set(std::memory_order_acquire)) {
    }
  }
  void unlock() noexcept { spin_.clear(std::memory_order_release); }

  static constexpr std::size_t kMaxPooledBytes = std::size_t{8} << 20;
  static constexpr std::size_t kAlwaysPooled = 4;  ///< so that even the largest messages are reused

  const TypeSupport& support_;
  std::atomic_flag spin_ = ATOMIC_FLAG_INIT;
  SampleBlock* free_ = nullptr;
  std::size_t free_count_ = 0;
  std::size_t free_bytes_ = 0;
  std::size_t outstanding_ = 0;
  bool closed_ = false;
};

/// Our Cyclone sample type.
struct SampleType : ddsi_sertype {
  const TypeSupport* support = nullptr;
  BlockPool* pool = nullptr;
  const std::atomic<Time::rep>* time = nullptr;  ///< stamps what is received; nullptr: the wall clock does
  Reports* reports = nullptr;                    ///< of the domain
  ddsi_sertype_default description{};            ///< idlc's descriptor, the source of XTypes information
};

/// Makes the (unregistered) Cyclone type of `support`. `reports` are those of the domain.
SampleType* make_sample_type(const TypeSupport& support, Reports& reports);

/// Timestamps of assertions: a logical time, which is years at most, plus 2^30 seconds. The timestamp is the only thing
/// beside the bytes that Cyclone carries unchanged to readers elsewhere, and no wall clock shows these years any more.
inline constexpr std::int64_t kAssertionsFrom = (std::int64_t{1} << 30) * 1'000'000'000;
inline constexpr std::int64_t kAssertionsUntil = kAssertionsFrom + std::int64_t{100'000'000} * 1'000'000'000;

/// Sets the block's key, hash and instance from its value; nothing for keyless types.
void seal(SampleBlock* block);

}  // namespace kervan::dds
