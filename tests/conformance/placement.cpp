#include "tests/conformance/placement.hpp"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <deque>
#include <iostream>
#include <map>
#include <mutex>
#include <numeric>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "framework/kervan.hpp"
#include "framework/test/harness.hpp"
#include "kervan_test_msgs/msg/Piece.hpp"
#include "tests/conformance/wire/peer.hpp"
#include "tests/runtime/containers.hpp"

namespace kervan::test {

namespace {

using namespace std::chrono_literals;
using kervan_test_msgs::msg::Piece;

constexpr Duration kTick = 1ms;

/// What a writer is told, as a line: "publish KEY NUMBER COUNT BYTES" or "dispose KEY".
struct Orders {
  std::mutex mutex;
  std::deque<std::string> waiting;
  std::uint64_t given = 0;
  std::uint64_t done = 0;
};

/// What a reader is asked, and what it has seen.
struct Observations {
  std::mutex mutex;
  std::uint64_t asked = 0;
  std::uint64_t answered = 0;
  std::vector<Got> got;
  std::vector<std::string> living;
  runtime::PortCounters counters;
  std::function<runtime::PortCounters()> count;
};

std::map<std::string, Orders>& orders() {
  static std::map<std::string, Orders> all;
  return all;
}
std::map<std::string, Observations>& observations() {
  static std::map<std::string, Observations> all;
  return all;
}

std::uint8_t load_byte(int number, std::size_t at) {
  return static_cast<std::uint8_t>(at * 31 + at / 251 + static_cast<std::size_t>(number));
}

Got seen(const Piece& piece, bool disposed) {
  if (disposed) return {.key = piece.name, .disposed = true};
  for (std::size_t i = 0; i < piece.load.size(); ++i)
    if (piece.load[i] != load_byte(piece.number, i)) return {.key = "damaged", .number = piece.number};
  return {.key = piece.name, .number = piece.number, .bytes = piece.load.size()};
}

template <int Strength>
class Source final : public Component {
  Output<Piece> out_{this, "out", qos::event.strength(Strength), "Pieces."};
  Timer tick_{this, kTick, &Source::on_tick};

  void on_tick(Time) {
    Orders& mine = orders()[name()];
    for (;;) {
      std::string order;
      {
        const std::lock_guard lock(mine.mutex);
        if (mine.waiting.empty()) return;
        order = mine.waiting.front();
        mine.waiting.pop_front();
      }
      obey(order);
      const std::lock_guard lock(mine.mutex);
      ++mine.done;
    }
  }

  void obey(const std::string& order) {
    std::istringstream words(order);
    std::string verb, key;
    int number = 0, count = 1;
    std::size_t bytes = 0;
    words >> verb >> key >> number >> count >> bytes;
    for (int i = 0; i < count; ++i) {
      auto piece = out_.loan();
      piece->name = key;
      piece->number = number + i;
      piece->load.resize(bytes);
      for (std::size_t at = 0; at < bytes; ++at) piece->load[at] = load_byte(number + i, at);
      if (verb == "dispose")
        out_.dispose(*piece);
      else
        out_.publish(std::move(piece));
    }
  }
};

template <bool OwnThread>
class Sink final : public Component {
  Input<Piece> in_{this, "in", qos::event, "Pieces."};
  Timer tick_{this, kTick, &Sink::on_tick};

  void on_tick(Time) {
    Observations& mine = observations()[name()];
    const std::lock_guard lock(mine.mutex);
    if (mine.answered != mine.asked) {
      for (const Sample<Piece>& sample : in_.take()) mine.got.push_back(seen(*sample, sample.disposed()));
      mine.answered = mine.asked;
    }
    mine.living.clear();
    for (const Sample<Piece>& sample : in_.instances()) mine.living.push_back(sample->name);
    mine.counters = mine.count();
  }

 public:
  Sink() {
    if constexpr (OwnThread) wants_own_thread();
  }
};

const std::vector<ComponentClass>& component_types() {
  static const std::vector<ComponentClass> types{define<Source<2>>("test/strong"), define<Source<1>>("test/weak"),
                                                 define<Sink<false>>("test/sink"),
                                                 define<Sink<true>>("test/sink_with_a_thread")};
  return types;
}

runtime::ContainerSpec spec_of(const std::string& name, const std::string& container, bool split, bool own_thread) {
  const CaseQos qos = qos_of(name);
  QosProfile sink = qos.profile;
  if (!qos.sink_partition.empty()) sink.partition = qos.sink_partition;
  const auto add = [&](runtime::ContainerSpec& spec, const char* component, const std::string& type, const char* place,
                       const char* port, PortDirection direction, const QosProfile& profile) {
    spec.components.push_back({.name = component,
                               .type = type,
                               .container = split ? place : "",
                               .ports = {binding<Piece>(port, direction, "/pieces", profile)}});
  };
  runtime::ContainerSpec spec;
  spec.name = container;
  spec.log_to_console = false;
  const std::string sink_type = own_thread ? "test/sink_with_a_thread" : "test/sink";
  add(spec, "strong", "test/strong", "writers", "out", PortDirection::output, qos.profile);
  add(spec, "weak", "test/weak", "writers", "out", PortDirection::output, qos.profile);
  add(spec, "sink", sink_type, "readers", "in", PortDirection::input, sink);
  add(spec, "other", sink_type, "readers", "in", PortDirection::input, qos.profile);
  return spec;
}

std::uint32_t next_domain() {
  static std::atomic<std::uint32_t> domains{0};
  return 1 + domains++ % 200;
}

/// How many readers each writer finds.
std::size_t readers_of(const std::string& name) { return qos_of(name).sink_partition.empty() ? 2 : 1; }

bool all_outputs_matched(runtime::Container& container, std::size_t readers) {
  return std::ranges::all_of(container.instances(), [&](const auto& instance) {
    return std::ranges::all_of(instance->outputs(),
                               [&](const auto& port) { return port->matched().size() == readers; });
  });
}

/// A reader that is made at run time, beside the components: reader, inbox and cache as a port has them.
class LateReader final : public dds::SampleSink {
 public:
  LateReader(dds::Domain& domain, const QosProfile& profile, dds::CyclonePart part)
      : cache_(profile, forever, true, true), reader_(domain, "/pieces", type_support<Piece>(), profile, part, *this) {}
  ~LateReader() {
    for (const runtime::StagedSample& sample : arrived_) dds::release(sample.block);
  }

  std::size_t arrived() const {
    const std::lock_guard lock(mutex_);
    return arrived_.size();
  }
  std::vector<Got> take() {
    const std::lock_guard lock(mutex_);
    cache_.stage(std::exchange(arrived_, {}));
    std::vector<Got> got;
    while (dds::SampleBlock* block = cache_.take(Time{})) {
      got.push_back(seen(*static_cast<const Piece*>(dds::value_of(block)), dds::is_disposed(block)));
      dds::release(block);
    }
    return got;
  }

  void on_sample(const dds::Arrival& arrival) noexcept override {
    dds::retain(arrival.block);
    const std::lock_guard lock(mutex_);
    arrived_.push_back({arrival.block, 0, arrival.instance, arrival.strength, Time{}});
  }
  void on_writer_gone(std::uint64_t) noexcept override {}
  void on_status() noexcept override {}

 private:
  mutable std::mutex mutex_;
  std::vector<runtime::StagedSample> arrived_;
  runtime::SampleCache cache_;
  dds::Reader reader_;  // last: it calls into the members above
};

}  // namespace

struct Placement::Impl {
  Where where;
  std::string name;
  ComponentRegistry registry{{}};
  std::unique_ptr<runtime::Container> lockstep;
  std::unique_ptr<Running> writers;  ///< in two domains
  std::unique_ptr<Running> readers;  ///< in one container everybody
  std::unique_ptr<Peer> peer;
  std::uint64_t orders_to_peer = 0;

  runtime::Container& reading() { return lockstep ? *lockstep : readers->container(); }

  void start() {
    static std::atomic<int> placements{0};
    for (const ComponentClass& type : component_types()) registry.add(type);
    orders().clear();
    observations().clear();
    for (const char* writer : {"strong", "weak"}) orders()[writer];
    for (const char* reader : {"sink", "other"})
      observations()[reader].count = [this, reader] { return reading().find(reader)->inputs().front()->counters(); };
    const bool split = where == Where::two_domains || where == Where::two_processes;
    runtime::ContainerSpec spec = spec_of(name, "readers", split, where == Where::two_threads);
    spec.domain.id = next_domain();
    spec.domain.network = split;
    spec.domain.tag = "placement-" + std::to_string(getpid()) + "-" + std::to_string(++placements);
    if (split) spec.domain.external_id = 20 + static_cast<std::uint32_t>(getpid()) % 200;
    if (where == Where::lockstep) {
      spec.clock = runtime::ClockMode::lockstep;
      lockstep = std::make_unique<runtime::Container>(spec, registry);
      lockstep->activate();
      return;
    }
    // The readers' counters are asked for as soon as they run, through `readers`.
    auto begin = std::make_shared<std::atomic<bool>>(false);
    for (auto& [reader, seen_by] : observations())
      seen_by.count = [begin, count = seen_by.count] { return *begin ? count() : runtime::PortCounters{}; };
    readers = std::make_unique<Running>(spec, registry);
    *begin = true;
    if (where == Where::two_domains) {
      spec.name = "writers";
      spec.domain.id = next_domain();
      writers = std::make_unique<Running>(spec, registry);
    }
    if (where == Where::two_processes)
      peer = std::make_unique<Peer>(
          std::vector<std::string>{"--peer", name, std::to_string(*spec.domain.external_id), spec.domain.tag});
  }

  bool matched() {
    if (lockstep) return true;
    const std::size_t at_sink = readers_of(name) == 2 ? 2 : 0;
    if (reading().find("sink")->inputs().front()->matched().size() != at_sink) return false;
    if (reading().find("other")->inputs().front()->matched().size() != 2) return false;
    if (peer) return peer->has_said("matched");
    return all_outputs_matched(writers ? writers->container() : reading(), readers_of(name));
  }

  void order(const std::string& writer, const std::string& line) {
    if (peer) {
      peer->tell(writer + " " + line);
      ++orders_to_peer;
      return;
    }
    Orders& of_writer = orders().at(writer);
    const std::lock_guard lock(of_writer.mutex);
    of_writer.waiting.push_back(line);
    ++of_writer.given;
  }

  bool obeyed(const std::string& writer) {
    if (peer) return peer->lines_that_begin_with("done") == orders_to_peer;
    Orders& of_writer = orders().at(writer);
    const std::lock_guard lock(of_writer.mutex);
    return of_writer.done == of_writer.given;
  }
};

Placement::Placement(Where where, const std::string& name) : impl_(std::make_unique<Impl>()) {
  impl_->where = where;
  impl_->name = name;
  impl_->start();
  if (!eventually([this] { return impl_->matched(); })) throw std::runtime_error("the components do not match");
  for (const char* reader : {"sink", "other"}) take(reader);  // from here on samples are waited for
}

Placement::~Placement() {
  if (impl_->lockstep) impl_->lockstep->end();
}

void Placement::publish(const std::string& writer, const std::string& key, int number, int count, std::size_t bytes) {
  impl_->order(writer, "publish " + key + " " + std::to_string(number) + " " + std::to_string(count) + " " +
                           std::to_string(bytes));
  if (!eventually([&] { return impl_->obeyed(writer); })) throw std::runtime_error("the writer is blocked");
}

void Placement::dispose(const std::string& writer, const std::string& key) {
  impl_->order(writer, "dispose " + key);
  if (!eventually([&] { return impl_->obeyed(writer); })) throw std::runtime_error("the writer is blocked");
}

std::vector<Got> Placement::take(const std::string& reader) {
  Observations& of_reader = observations().at(reader);
  {
    const std::lock_guard lock(of_reader.mutex);
    ++of_reader.asked;
  }
  const bool answered = eventually([&] {
    const std::lock_guard lock(of_reader.mutex);
    return of_reader.answered == of_reader.asked;
  });
  if (!answered) throw std::runtime_error("the reader does not run");
  const std::lock_guard lock(of_reader.mutex);
  return std::exchange(of_reader.got, {});
}

runtime::PortCounters Placement::counters(const std::string& reader) const {
  Observations& of_reader = observations().at(reader);
  const std::lock_guard lock(of_reader.mutex);
  return of_reader.counters;
}

std::vector<std::string> Placement::living(const std::string& reader) const {
  Observations& of_reader = observations().at(reader);
  const std::lock_guard lock(of_reader.mutex);
  return of_reader.living;
}

std::vector<Got> Placement::late_joiner_takes(std::size_t count) {
  LateReader reader(impl_->reading().domain(), qos_of(impl_->name).profile,
                    impl_->lockstep ? dds::CyclonePart::carrier : dds::CyclonePart::whole_profile);
  eventually([&] { return reader.arrived() >= count; });
  return reader.take();
}

bool Placement::eventually(const std::function<bool()>& condition) {
  if (!impl_->lockstep) return test::eventually(condition);
  for (int i = 0; i < 5000; ++i) {
    if (condition()) return true;
    impl_->lockstep->advance(impl_->lockstep->now() + kTick);
  }
  return false;
}

void Placement::pass(Duration duration) {
  if (impl_->lockstep) {
    impl_->lockstep->advance(impl_->lockstep->now() + duration);
    return;
  }
  const auto end = std::chrono::steady_clock::now() + duration;
  test::eventually([&] { return std::chrono::steady_clock::now() >= end; });
}

int run_placement_peer(const std::string& name, std::uint32_t domain, const std::string& tag) {
  ComponentRegistry registry({});
  for (const ComponentClass& type : component_types()) registry.add(type);
  for (const char* writer : {"strong", "weak"}) orders()[writer];
  runtime::ContainerSpec spec = spec_of(name, "writers", true, false);
  spec.domain.id = domain;
  spec.domain.tag = tag;
  Running writers(spec, registry);
  if (!eventually([&] { return all_outputs_matched(writers.container(), readers_of(name)); })) return 1;
  const auto say = [](const char* what) {
    std::puts(what);
    std::fflush(stdout);
  };
  say("matched");
  for (std::string line; std::getline(std::cin, line);) {
    const std::size_t space = line.find(' ');
    Orders& of_writer = orders().at(line.substr(0, space));
    {
      const std::lock_guard lock(of_writer.mutex);
      of_writer.waiting.push_back(line.substr(space + 1));
      ++of_writer.given;
    }
    const bool obeyed = eventually([&] {
      const std::lock_guard lock(of_writer.mutex);
      return of_writer.done == of_writer.given;
    });
    if (!obeyed) return 1;
    say("done");
  }
  return 0;
}

}  // namespace kervan::test
