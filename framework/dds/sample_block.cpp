#include "framework/dds/sample_block.hpp"

#include <dds/ddsi/q_protocol.h>
#include <dds/ddsi/q_radmin.h>
#include <dds/ddsrt/md5.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <functional>
#include <memory>
#include <new>
#include <span>

#include "framework/component/sample.hpp"
#include "framework/dds/cdr.hpp"
#include "framework/dds/reports.hpp"
#include "framework/dds/statistics.hpp"
#include "framework/dds/wall_clock.hpp"

namespace kervan::dds {

// The functions that Cyclone calls are noexcept: no exception may cross its C frames, and without memory there is no
// way on.
namespace {

std::atomic<std::uint64_t> serialised{0};
std::atomic<std::uint64_t> deserialised{0};
std::atomic<std::uint64_t> refused{0};
std::atomic<std::uint64_t> blocks_allocated{0};

std::size_t value_offset(const TypeSupport& support) {
  const std::size_t alignment = std::max(support.alignment, alignof(std::max_align_t));
  return (sizeof(SampleBlock) + alignment - 1) / alignment * alignment;
}

std::uint32_t cdr_size(const SampleBlock* block) {
  const TypeSupport& support = block->pool->support();
  const std::size_t size = block->kind == SDK_KEY ? support.cdr_key_size(block->value) : support.cdr_size(block->value);
  return static_cast<std::uint32_t>(cdr::encapsulation_size + size);
}

/// The CDR of a block; made by whoever needs it first, kept until the block goes back to its pool.
CdrBytes* cdr_of(const SampleBlock* const_block) noexcept {
  auto* block = const_cast<SampleBlock*>(const_block);
  CdrBytes* existing = block->cdr.load(std::memory_order_acquire);
  if (existing) return existing;
  const TypeSupport& support = block->pool->support();
  const std::uint32_t size = cdr_size(block);
  const std::size_t body_size = size - cdr::encapsulation_size;
  const std::size_t padding = cdr::padding_after(body_size);
  CdrBytes* made = block->spare.exchange(nullptr, std::memory_order_acq_rel);
  if (!made || made->capacity < size + padding) {
    std::free(made);
    made = static_cast<CdrBytes*>(std::malloc(sizeof(CdrBytes) + size + padding));
    if (!made) std::terminate();
    made->capacity = size + padding;
  }
  std::byte* bytes = made->data();
  std::memcpy(bytes, cdr::encapsulation(body_size).data(), cdr::encapsulation_size);
  std::memset(bytes + size, 0, padding);
  cdr::Writer writer(bytes + cdr::encapsulation_size, body_size);
  made->long_run = {};
  writer.leave_out(made->long_run);
  if (block->kind == SDK_KEY)
    support.write_key(block->value, writer);
  else
    support.write_cdr(block->value, writer);
  made->long_run.offset += cdr::encapsulation_size;
  serialised.fetch_add(1, std::memory_order_relaxed);
  if (block->cdr.compare_exchange_strong(existing, made, std::memory_order_acq_rel)) return made;
  std::free(made);
  return existing;
}

bool eqkey(const ddsi_serdata* a, const ddsi_serdata* b) noexcept {
  return static_cast<const KeyedBlock*>(a)->key == static_cast<const KeyedBlock*>(b)->key;
}

std::uint32_t get_size(const ddsi_serdata* serdata) noexcept { return cdr_size(as_block(serdata)); }

/// When a sample that is just being received counts as received.
Time arrival_time(const SampleType& type) noexcept {
  return type.time ? Time(Duration(type.time->load(std::memory_order_relaxed))) : wall_now();
}

/// Where a received sample comes from: its RTPS message, of which Cyclone has made the fields that are read here
/// native.
struct Origin {
  Guid writer{};
  std::uint64_t sequence = 0;
};

Origin origin_of(const nn_rdata* fragment) {
  const auto* header = reinterpret_cast<const Header_t*>(NN_RMSG_PAYLOAD(fragment->rmsg));
  const auto* data = reinterpret_cast<const Data_DataFrag_common_t*>(
      NN_RMSG_PAYLOADOFF(fragment->rmsg, NN_RDATA_SUBMSG_OFF(fragment)));
  Origin origin;
  const std::uint32_t words[] = {header->guid_prefix.u[0], header->guid_prefix.u[1], header->guid_prefix.u[2],
                                 data->writerId.u};
  for (std::size_t i = 0; i < origin.writer.size(); ++i)
    origin.writer[i] = static_cast<std::uint8_t>(words[i / 4] >> (24 - 8 * (i % 4)));
  origin.sequence = static_cast<std::uint64_t>(data->writerSN.high) << 32 | data->writerSN.low;
  return origin;
}

/// Decodes received bytes, the encapsulation header included, into a fresh block; nullptr if they are not a message.
ddsi_serdata* decode(const ddsi_sertype* type, ddsi_serdata_kind kind, std::span<const std::byte> payload,
                     const Origin& origin) noexcept {
  const auto* sample_type = static_cast<const SampleType*>(type);
  const TypeSupport& support = *sample_type->support;
  SampleBlock* block = sample_type->pool->get(type, kind);
  block->received = arrival_time(*sample_type);
  block->sequence = origin.sequence;
  cdr::Reader reader = cdr::open(payload.data(), payload.size());
  const bool good = kind == SDK_KEY ? support.read_key(block->value, reader) : support.read_cdr(block->value, reader);
  if (!good) {
    refused.fetch_add(1, std::memory_order_relaxed);
    sample_type->reports->add_undecodable(origin.writer);
    ddsi_serdata_unref(block);
    return nullptr;
  }
  deserialised.fetch_add(1, std::memory_order_relaxed);
  seal(block);
  return block;
}

ddsi_serdata* from_ser(const ddsi_sertype* type, ddsi_serdata_kind kind, const nn_rdata* fragment,
                       std::size_t size) noexcept {
  // Fragments may overlap; the first one holds the whole header.
  const auto payload = [](const nn_rdata* f) {
    return reinterpret_cast<const std::byte*>(NN_RMSG_PAYLOADOFF(f->rmsg, NN_RDATA_PAYLOAD_OFF(f)));
  };
  const Origin origin = origin_of(fragment);
  if (!fragment->nextfrag && fragment->maxp1 >= size) return decode(type, kind, {payload(fragment), size}, origin);
  const std::unique_ptr<std::byte[]> bytes(new std::byte[size]);
  std::uint32_t have = 0;
  for (; fragment; fragment = fragment->nextfrag) {
    if (fragment->maxp1 <= have) continue;
    const auto end = std::min<std::uint32_t>(fragment->maxp1, static_cast<std::uint32_t>(size));
    std::memcpy(bytes.get() + have, payload(fragment) + have - fragment->min, end - have);
    have = end;
  }
  return decode(type, kind, {bytes.get(), have}, origin);
}

ddsi_serdata* from_ser_iov(const ddsi_sertype* type, ddsi_serdata_kind kind, ddsrt_msg_iovlen_t count,
                           const ddsrt_iovec_t* parts, std::size_t size) noexcept {
  const std::unique_ptr<std::byte[]> bytes(new std::byte[size]);
  std::size_t have = 0;
  for (ddsrt_msg_iovlen_t i = 0; i < count; ++i) {
    const std::size_t length = std::min<std::size_t>(parts[i].iov_len, size - have);
    std::memcpy(bytes.get() + have, parts[i].iov_base, length);
    have += length;
  }
  return decode(type, kind, {bytes.get(), have}, {});
}

ddsi_serdata* from_keyhash(const ddsi_sertype* type, const ddsi_keyhash*) noexcept {
  // A key hash may be an MD5 sum, from which no key can be recovered; for keyless types there is nothing to recover.
  if (!type->typekind_no_key) return nullptr;
  const auto* sample_type = static_cast<const SampleType*>(type);
  SampleBlock* block = sample_type->pool->get(type, SDK_KEY);
  block->received = arrival_time(*sample_type);
  block->sequence = 0;
  seal(block);
  return block;
}

void to_ser(const ddsi_serdata* serdata, std::size_t offset, std::size_t size, void* buffer) {
  cdr_of(as_block(serdata))->copy(offset, size, static_cast<std::byte*>(buffer));
}

ddsi_serdata* to_ser_ref(const ddsi_serdata* serdata, std::size_t offset, std::size_t size, ddsrt_iovec_t* part) {
  CdrBytes* cdr = cdr_of(as_block(serdata));
  const std::byte* bytes = cdr->find(offset, size);
  if (!bytes) {  // more than a datagram: the whole for a reader of another implementation in this process
    auto* copied = static_cast<std::byte*>(std::malloc(size));
    if (!copied) std::terminate();
    cdr->copy(offset, size, copied);
    bytes = copied;
  }
  part->iov_base = const_cast<std::byte*>(bytes);
  part->iov_len = size;
  return ddsi_serdata_ref(serdata);
}

void to_ser_unref(ddsi_serdata* serdata, const ddsrt_iovec_t* part) {
  CdrBytes* cdr = cdr_of(as_block(serdata));
  const auto* bytes = static_cast<const std::byte*>(part->iov_base);
  const auto is_in = [bytes](const std::byte* begin, std::size_t size) {
    return begin && std::greater_equal<>()(bytes, begin) && std::less<>()(bytes, begin + size);
  };
  if (!is_in(cdr->data(), cdr->capacity) && !is_in(cdr->long_run.bytes, cdr->long_run.size)) std::free(part->iov_base);
  ddsi_serdata_unref(serdata);
}

ddsi_serdata* to_untyped(const ddsi_serdata* serdata) noexcept {
  auto* entry = new KeyedBlock;
  ddsi_serdata_init(entry, serdata->type, SDK_KEY);
  entry->type = nullptr;
  entry->key = static_cast<const KeyedBlock*>(serdata)->key;
  entry->hash = serdata->hash;
  return entry;
}

void free_serdata(ddsi_serdata* serdata) {
#ifdef __SANITIZE_THREAD__
  // It does not look into Cyclone, which may have let go of the block last, and has to be shown that whatever others did
  // with it came before.
  static_cast<void>(__atomic_load_n(&serdata->refc.v, __ATOMIC_ACQUIRE));
#endif
  auto* block = static_cast<KeyedBlock*>(serdata);
  if (block->pool)
    block->pool->put(as_block(serdata));
  else
    delete block;
}

void get_keyhash(const ddsi_serdata* serdata, ddsi_keyhash* hash, bool force_md5) {
  const std::string& key = static_cast<const KeyedBlock*>(serdata)->key;
  std::memset(hash->value, 0, sizeof hash->value);
  const auto* type = static_cast<const SampleType*>(serdata->type);
  const bool short_key = type && type->support->fixed_key;
  if (force_md5 || (!key.empty() && !short_key)) {
    ddsrt_md5_state_t state;
    ddsrt_md5_init(&state);
    ddsrt_md5_append(&state, reinterpret_cast<const ddsrt_md5_byte_t*>(key.data()), static_cast<unsigned>(key.size()));
    ddsrt_md5_finish(&state, hash->value);
  } else {
    std::memcpy(hash->value, key.data(), std::min(key.size(), sizeof hash->value));
  }
}

// Kervan publishes with dds_forwardcdr and receives through its own reader cache, so the sample operations of the typed
// API are never called; they refuse instead of pretending.
const ddsi_serdata_ops& serdata_operations() {
  static const ddsi_serdata_ops operations = [] {
    ddsi_serdata_ops ops{};
    ops.eqkey = eqkey;
    ops.get_size = get_size;
    ops.from_ser = from_ser;
    ops.from_ser_iov = from_ser_iov;
    ops.from_keyhash = from_keyhash;
    ops.from_sample = [](const ddsi_sertype*, ddsi_serdata_kind, const void*) -> ddsi_serdata* { return nullptr; };
    ops.to_ser = to_ser;
    ops.to_ser_ref = to_ser_ref;
    ops.to_ser_unref = to_ser_unref;
    ops.to_sample = [](const ddsi_serdata*, void*, void**, void*) { return false; };
    ops.to_untyped = to_untyped;
    ops.untyped_to_sample = [](const ddsi_sertype*, const ddsi_serdata*, void*, void**, void*) { return false; };
    ops.free = free_serdata;
    ops.print = [](const ddsi_sertype* type, const ddsi_serdata*, char* text, std::size_t size) {
      return static_cast<std::size_t>(std::snprintf(text, size, "%s", type ? type->type_name : "key"));
    };
    ops.get_keyhash = get_keyhash;
    return ops;
  }();
  return operations;
}

const SampleType* as_type(const ddsi_sertype* type) { return static_cast<const SampleType*>(type); }

const ddsi_sertype_ops& sertype_operations() {
  static const ddsi_sertype_ops operations = [] {
    ddsi_sertype_ops ops{};
    ops.version = ddsi_sertype_v0;
    ops.free = [](ddsi_sertype* type) {
      auto* sample_type = static_cast<SampleType*>(type);
      ddsi_sertype_fini(sample_type);
      sample_type->pool->close();
      delete sample_type;
    };
    ops.zero_samples = [](const ddsi_sertype*, void*, std::size_t) {};
    ops.realloc_samples = [](void**, const ddsi_sertype*, void*, std::size_t, std::size_t) {};
    ops.free_samples = [](const ddsi_sertype*, void**, std::size_t, dds_free_op_t) {};
    ops.equal = [](const ddsi_sertype* a, const ddsi_sertype* b) {
      return as_type(a)->support->layout_hash == as_type(b)->support->layout_hash;
    };
    ops.hash = [](const ddsi_sertype* type) { return static_cast<std::uint32_t>(as_type(type)->support->layout_hash); };
    ops.type_id = [](const ddsi_sertype* type, ddsi_typeid_kind_t kind) {
      return ddsi_sertype_ops_default.type_id(&as_type(type)->description.c, kind);
    };
    ops.type_map = [](const ddsi_sertype* type) {
      return ddsi_sertype_ops_default.type_map(&as_type(type)->description.c);
    };
    ops.type_info = [](const ddsi_sertype* type) {
      return ddsi_sertype_ops_default.type_info(&as_type(type)->description.c);
    };
    return ops;
  }();
  return operations;
}

}  // namespace

DataPathStatistics data_path_statistics() {
  return {serialised.load(), deserialised.load(), refused.load(), blocks_allocated.load()};
}

const std::byte* CdrBytes::find(std::size_t offset, std::size_t size) {
  if (long_run.contains(offset, size)) return long_run.bytes + (offset - long_run.offset);
  return !long_run.bytes || size <= cdr::LongRun::edge ? data() + offset : nullptr;
}

void CdrBytes::copy(std::size_t offset, std::size_t size, std::byte* to) {
  const std::size_t end = offset + size;
  const std::size_t run_begin = long_run.bytes ? std::clamp(long_run.offset, offset, end) : end;
  const std::size_t run_end = long_run.bytes ? std::clamp(long_run.offset + long_run.size, offset, end) : end;
  std::memcpy(to, data() + offset, run_begin - offset);
  if (run_end > run_begin)
    std::memcpy(to + (run_begin - offset), long_run.bytes + (run_begin - long_run.offset), run_end - run_begin);
  std::memcpy(to + (run_end - offset), data() + run_end, end - run_end);
}

SampleBlock* BlockPool::allocate() {
  blocks_allocated.fetch_add(1, std::memory_order_relaxed);
  const std::size_t offset = value_offset(support_);
  const auto alignment = static_cast<std::align_val_t>(std::max(support_.alignment, alignof(std::max_align_t)));
  auto* memory = static_cast<unsigned char*>(::operator new(offset + support_.size, alignment));
  auto* block = new (memory) SampleBlock;
  block->value = memory + offset;
  support_.construct(block->value);
  block->pool = this;
  return block;
}

void BlockPool::destroy(SampleBlock* block) noexcept {
  std::free(block->spare.load(std::memory_order_relaxed));
  support_.destroy(block->value);
  block->~SampleBlock();
  ::operator delete(block, static_cast<std::align_val_t>(std::max(support_.alignment, alignof(std::max_align_t))));
}

SampleBlock* BlockPool::get(const ddsi_sertype* type, ddsi_serdata_kind kind) {
  lock();
  SampleBlock* block = free_;
  if (block) {
    free_ = block->next_free;
    --free_count_;
    free_bytes_ -= block->pooled_bytes;
  }
  ++outstanding_;
  unlock();
  if (!block) block = allocate();
  ddsi_serdata_init(block, type, kind);
  block->hash = type->serdata_basehash;
  block->statusinfo = 0;
  return block;
}

void BlockPool::put(SampleBlock* block) noexcept {
  // Fresh memory costs more than the bytes written to it (page faults), so that of the CDR is kept with the block.
  if (CdrBytes* cdr = block->cdr.exchange(nullptr, std::memory_order_acq_rel))
    std::free(block->spare.exchange(cdr, std::memory_order_acq_rel));
  const CdrBytes* spare = block->spare.load(std::memory_order_relaxed);
  block->pooled_bytes =
      sizeof(SampleBlock) + support_.size + support_.heap_bytes(block->value) + (spare ? spare->capacity : 0);
  lock();
  --outstanding_;
  const bool keep = !closed_ && (free_count_ < kAlwaysPooled || free_bytes_ + block->pooled_bytes <= kMaxPooledBytes);
  if (keep) {
    block->next_free = free_;
    free_ = block;
    ++free_count_;
    free_bytes_ += block->pooled_bytes;
  }
  const bool last = closed_ && outstanding_ == 0;
  unlock();
  if (!keep) destroy(block);
  if (last) delete this;
}

void BlockPool::close() noexcept {
  lock();
  closed_ = true;
  SampleBlock* block = std::exchange(free_, nullptr);
  const bool last = outstanding_ == 0;
  unlock();
  while (block) destroy(std::exchange(block, block->next_free));
  if (last) delete this;
}

SampleType* make_sample_type(const TypeSupport& support, Reports& reports) {
  const auto* descriptor = static_cast<const dds_topic_descriptor_t*>(support.descriptor);
  auto type = std::make_unique<SampleType>();
  ddsi_sertype_init(type.get(), support.wire_name, &sertype_operations(), &serdata_operations(), !support.keyed);
  type->allowed_data_representation = DDS_DATA_REPRESENTATION_FLAG_XCDR1;
  type->support = &support;
  type->reports = &reports;
  type->pool = new BlockPool(support);
  auto& description = type->description.type;
  description.flagset = descriptor->m_flagset;
  description.typeinfo_ser = {descriptor->type_information.sz,
                              const_cast<std::uint8_t*>(descriptor->type_information.data)};
  description.typemap_ser = {descriptor->type_mapping.sz, const_cast<std::uint8_t*>(descriptor->type_mapping.data)};
  return type.release();
}

void seal(SampleBlock* block) {
  const TypeSupport& support = block->pool->support();
  if (!support.keyed) return;
  support.key_bytes(block->value, block->key);
  Hash64 hash;
  hash.bytes(block->key.data(), block->key.size());
  block->instance = hash.value();
  block->hash = static_cast<std::uint32_t>(block->instance) ^ block->type->serdata_basehash;
}

void retain(SampleBlock* block) noexcept { ddsi_serdata_ref(block); }
void release(SampleBlock* block) noexcept { ddsi_serdata_unref(block); }
const void* value_of(const SampleBlock* block) noexcept { return block->value; }
void* mutable_value_of(SampleBlock* block) noexcept { return block->value; }
Time received_at(const SampleBlock* block) noexcept { return block->received; }
bool is_assertion(const SampleBlock* block) noexcept {
  return block->timestamp.v >= kAssertionsFrom && block->timestamp.v < kAssertionsUntil;
}
Time published_at(const SampleBlock* block) noexcept {
  return Time(Duration(block->timestamp.v - (is_assertion(block) ? kAssertionsFrom : 0)));
}

}  // namespace kervan::dds
