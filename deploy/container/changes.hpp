/// What was changed while a container ran survives its process: components loaded, unloaded or stopped, and parameters.
#pragma once

#include "framework/runtime/spec.hpp"

namespace kervan::container {

/// The changes of one container, in the folder of its run. They belong to the specification it was started with: under
/// another one they are not taken up.
class Changes {
 public:
  /// Takes up what is kept for `spec`, if anything is. Throws ConfigError if that cannot be read.
  explicit Changes(runtime::ContainerSpec& spec);

  /// Keeps what the container is now. The file is on the disk, whole, when this returns. Throws ConfigError if it
  /// cannot be written. Without a run folder it does nothing.
  void keep(const runtime::ContainerSpec& now) const;

 private:
  std::filesystem::path file_;
};

}  // namespace kervan::container
