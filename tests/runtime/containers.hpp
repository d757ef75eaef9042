/// Several containers of one composition in one process: each has a thread and a DDS domain of its own, and they meet
/// on the loopback interface as processes do.
#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "framework/runtime/container.hpp"
#include "tests/program/eventually.hpp"

namespace kervan::test {

/// A composition whose containers meet on a network of their own.
class Composition {
 public:
  explicit Composition(std::vector<std::string> containers);
  Composition(const Composition&) = delete;
  Composition& operator=(const Composition&) = delete;
  ~Composition();

  /// Adds a component; its ports must all be listed.
  void add(const std::string& container, const std::string& name, const ComponentClass& type,
           std::vector<runtime::PortBinding> ports, ValueMap parameters = {});

  /// What the container called `name` is told to run. Each call gives a domain number of its own.
  runtime::ContainerSpec spec(const std::string& name);

  ComponentRegistry& registry() { return registry_; }
  const std::filesystem::path& folder() const { return folder_; }  ///< the runs' folders are below it, by container

 private:
  runtime::ContainerSpec spec_;
  ComponentRegistry registry_{{}};
  std::filesystem::path folder_;
};

/// The binding of a port as a composition resolves it.
template <class T>
runtime::PortBinding binding(const std::string& port, PortDirection direction, const std::string& topic,
                             const QosProfile& profile) {
  const TypeSupport& type = type_support<T>();
  return {port, topic, profile, direction, type.name, type.layout_hash};
}

/// A container that runs in a thread of its own from construction on, until it ends by itself or is stopped.
class Running {
 public:
  Running(const runtime::ContainerSpec& spec, ComponentRegistry& registry);
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;
  ~Running();

  bool has_reached(runtime::RunPhase phase) const;
  bool has_ended() const { return ended_; }
  void stop() { stop_ = true; }
  /// Waits for its end, with all patience.
  runtime::RunReport report();
  /// What it has logged.
  std::string log() const;
  runtime::Container& container() { return container_; }

 private:
  runtime::Container container_;
  mutable std::mutex mutex_;
  std::vector<runtime::RunPhase> phases_;
  std::atomic<bool> stop_{false};
  std::atomic<bool> ended_{false};
  runtime::RunReport report_;
  std::thread thread_;
};

}  // namespace kervan::test
