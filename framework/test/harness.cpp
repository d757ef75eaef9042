#include "framework/test/harness.hpp"

#include <atomic>
#include <map>
#include <stdexcept>

#include "framework/dds/type_support.hpp"
#include "framework/runtime/container.hpp"
#include "framework/runtime/operations.hpp"

namespace kervan::test {

namespace {

/// Keeps what an output publishes.
class Recorder final : public dds::SampleSink {
 public:
  Recorder(dds::Domain& domain, const runtime::OutputPort& output)
      : type_(output.type()),
        reader_(domain, output.binding().topic, type_, output.binding().profile, dds::CyclonePart::carrier, *this) {}

  ~Recorder() {
    for (dds::SampleBlock* block : blocks_) dds::release(block);
    if (latest_) dds::release(latest_);
  }

  const TypeSupport& type() const { return type_; }
  dds::SampleBlock* latest() const { return latest_; }
  std::vector<dds::SampleBlock*> take() { return std::exchange(blocks_, {}); }

  void on_sample(const dds::Arrival& arrival) noexcept override {
    dds::retain(arrival.block);
    blocks_.push_back(arrival.block);
    dds::retain(arrival.block);
    if (latest_) dds::release(latest_);
    latest_ = arrival.block;
  }
  void on_writer_gone(std::uint64_t) noexcept override {}
  void on_status() noexcept override {}

 private:
  const TypeSupport& type_;
  std::vector<dds::SampleBlock*> blocks_;
  dds::SampleBlock* latest_ = nullptr;
  dds::Reader reader_;  // last: it calls into the members above
};

void expect_type(const std::string& port, const TypeSupport& is, const TypeSupport& wanted) {
  if (is.layout_hash != wanted.layout_hash)
    throw std::invalid_argument("port '" + port + "' carries " + is.name + ", the test uses " + wanted.name);
}

runtime::ContainerSpec spec_of(const std::string& type, const ValueMap& parameters,
                               const std::filesystem::path& run_folder) {
  // Domains without a network are private to the process; the numbers only keep its own apart.
  static std::atomic<std::uint32_t> next_domain{1};
  runtime::ContainerSpec spec;
  spec.name = "harness";
  spec.clock = runtime::ClockMode::lockstep;
  spec.domain.id = next_domain++ % 200 + 1;
  spec.domain.network = false;
  spec.run_folder = run_folder;
  spec.log_to_console = false;
  spec.components.push_back({.name = "subject", .type = type, .parameters = parameters});
  return spec;
}

}  // namespace

struct Harness::Impl {
  ComponentRegistry registry{ComponentRegistry::default_folders()};
  std::unique_ptr<runtime::Container> container;
  runtime::ComponentInstance* subject = nullptr;
  std::map<std::string, std::unique_ptr<dds::Writer>> writers;
  std::map<std::string, std::unique_ptr<Recorder>> recorders;
  bool ended = false;

  void start(const std::string& type, const ValueMap& parameters, const std::filesystem::path& run_folder = {}) {
    if (!registry.find(type)) {
      std::string folders;
      for (const auto& folder : registry.folders()) folders += " " + folder.string();
      throw std::invalid_argument("there is no component type '" + type + "'; looked in" + folders);
    }
    container = std::make_unique<runtime::Container>(spec_of(type, parameters, run_folder), registry);
    subject = container->instances().front().get();
    auto& domain = container->domain();
    unsigned index = static_cast<unsigned>(subject->outputs().size());
    for (const auto& output : subject->outputs())
      recorders[output->name()] = std::make_unique<Recorder>(domain, *output);
    for (const auto& input : subject->inputs())
      writers[input->name()] =
          std::make_unique<dds::Writer>(domain, input->binding().topic, input->type(), input->binding().profile,
                                        dds::CyclonePart::carrier, 0, index++);
    container->activate();
  }

  Recorder& recorder(const std::string& output) const {
    const auto found = recorders.find(output);
    if (found == recorders.end()) throw std::invalid_argument("the component has no output '" + output + "'");
    return *found->second;
  }
};

Harness::Harness(const std::string& type, const ValueMap& parameters, const std::filesystem::path& run_folder)
    : impl_(std::make_unique<Impl>()) {
  impl_->start(type, parameters, run_folder);
}

Harness::Harness(const ComponentClass& type, const ValueMap& parameters) : impl_(std::make_unique<Impl>()) {
  impl_->registry.add(type);
  impl_->start(type.type, parameters);
}

Harness::~Harness() { end(); }

void Harness::feed(const std::string& input, const TypeSupport& type, const void* message) {
  const auto writer = impl_->writers.find(input);
  if (writer == impl_->writers.end()) throw std::invalid_argument("the component has no input '" + input + "'");
  for (const auto& port : impl_->subject->inputs())
    if (port->name() == input) expect_type(input, port->type(), type);
  dds::SampleBlock* block = writer->second->loan(false);
  type.copy(dds::mutable_value_of(block), message);
  writer->second->publish(block, now(), false);
}

void Harness::change_parameters(const ValueMap& changes) {
  const auto outcome = impl_->container->operations().change_parameters(impl_->subject->name(), changes);
  if (!outcome.accepted) throw std::invalid_argument(outcome.reason);
}

std::string Harness::call(const std::string& request, const ValueMap& arguments) {
  const auto outcome = impl_->container->operations().call(impl_->subject->name(), request, arguments);
  if (!outcome.accepted) throw std::invalid_argument(outcome.reason);
  return outcome.reason;
}

void Harness::advance(Duration duration) { impl_->container->advance(now() + duration); }

const void* Harness::latest(const std::string& output, const TypeSupport& type) const {
  const Recorder& recorder = impl_->recorder(output);
  expect_type(output, recorder.type(), type);
  return recorder.latest() ? dds::value_of(recorder.latest()) : nullptr;
}

std::vector<dds::SampleBlock*> Harness::take(const std::string& output, const TypeSupport& type) {
  Recorder& recorder = impl_->recorder(output);
  expect_type(output, recorder.type(), type);
  return recorder.take();
}

Time Harness::now() const { return impl_->container->now(); }
ComponentState Harness::state() const { return impl_->subject->state(); }
const std::string& Harness::reason() const { return impl_->subject->reason(); }
bool Harness::finished() const { return impl_->container->finish_requested(); }
std::uint64_t Harness::trace_hash() const { return impl_->container->trace_hash(); }

void Harness::end() {
  if (!std::exchange(impl_->ended, true)) impl_->container->end();
}

}  // namespace kervan::test
