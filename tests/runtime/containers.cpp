#include "tests/runtime/containers.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <sstream>

namespace kervan::test {

Composition::Composition(std::vector<std::string> containers) {
  static std::atomic<int> compositions{0};
  const std::string name = "kervan_test-" + std::to_string(getpid()) + "-" + std::to_string(++compositions);
  folder_ = std::filesystem::temp_directory_path() / name;
  spec_.members = std::move(containers);
  spec_.domain.tag = name;
  spec_.domain.external_id = 20 + static_cast<std::uint32_t>(getpid()) % 200;
  spec_.log_to_console = false;
}

Composition::~Composition() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

void Composition::add(const std::string& container, const std::string& name, const ComponentClass& type,
                      std::vector<runtime::PortBinding> ports, ValueMap parameters) {
  if (!registry_.find(type.type)) registry_.add(type);
  spec_.components.push_back({.name = name,
                              .type = type.type,
                              .container = container,
                              .parameters = std::move(parameters),
                              .ports = std::move(ports)});
}

runtime::ContainerSpec Composition::spec(const std::string& name) {
  static std::atomic<std::uint32_t> domains{0};
  runtime::ContainerSpec spec = spec_;
  spec.name = name;
  spec.domain.id = 1 + domains++ % 200;
  spec.run_folder = folder_ / name;
  std::filesystem::create_directories(spec.run_folder);
  return spec;
}

Running::Running(const runtime::ContainerSpec& spec, ComponentRegistry& registry) : container_(spec, registry) {
  thread_ = std::thread([this] {
    runtime::RunControl control;
    control.limit = std::chrono::seconds(90);
    control.stop = &stop_;
    control.phase = [this](runtime::RunPhase phase) {
      const std::lock_guard lock(mutex_);
      phases_.push_back(phase);
    };
    report_ = container_.run(control);
    ended_ = true;
  });
}

Running::~Running() {
  stop();
  thread_.join();
}

bool Running::has_reached(runtime::RunPhase phase) const {
  const std::lock_guard lock(mutex_);
  return std::ranges::count(phases_, phase) > 0;
}

runtime::RunReport Running::report() {
  return eventually([this] { return ended_.load(); })
             ? report_
             : runtime::RunReport{.end = runtime::RunEnd::time_limit, .reason = "the test's patience is at an end"};
}

std::string Running::log() const {
  const runtime::ContainerSpec& spec = container_.spec();
  std::ifstream stream(spec.run_folder / (spec.members.size() > 1 ? "log-" + spec.name + ".txt" : "log.txt"));
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

}  // namespace kervan::test
