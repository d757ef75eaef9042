#include "deploy/container/changes.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "deploy/container/json_reader.hpp"
#include "deploy/container/spec_json.hpp"
#include "framework/dds/hash.hpp"

namespace kervan::container {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& file) {
  throw ConfigError({file.string(), 0, 0}, std::string("cannot be written: ") + std::strerror(errno));
}

/// A file descriptor that is closed with this object.
class Descriptor {
 public:
  Descriptor(const fs::path& file, int flags) : file_(file), number_(::open(file.c_str(), flags | O_CLOEXEC, 0644)) {
    if (number_ < 0) fail(file_);
  }
  ~Descriptor() { ::close(number_); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  void write(std::string_view text) const {
    while (!text.empty()) {
      const ssize_t written = ::write(number_, text.data(), text.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) fail(file_);
      text.remove_prefix(static_cast<std::size_t>(written));
    }
  }
  void sync() const {
    if (::fsync(number_) != 0) fail(file_);
  }

 private:
  fs::path file_;
  int number_;
};

}  // namespace

Changes::Changes(runtime::ContainerSpec& spec) {
  if (spec.run_folder.empty()) return;
  Hash64 hash;
  const std::string text = to_json(spec);
  hash.bytes(text.data(), text.size());
  file_ = spec.run_folder / ("changes-" + spec.name + "-" + hash_text(hash.value()) + ".json");
  if (!fs::exists(file_)) return;
  const runtime::ContainerSpec changed = read_spec(file_);
  spec.components = changed.components;
  spec.loaded = changed.loaded;
  spec.absent = changed.absent;
  spec.inactive = changed.inactive;
}

void Changes::keep(const runtime::ContainerSpec& now) const {
  if (file_.empty()) return;
  const fs::path fresh = file_.string() + ".new";
  {
    const Descriptor file(fresh, O_WRONLY | O_CREAT | O_TRUNC);
    file.write(to_json(now));
    file.sync();
  }
  if (::rename(fresh.c_str(), file_.c_str()) != 0) fail(file_);
  Descriptor(file_.parent_path(), O_RDONLY | O_DIRECTORY).sync();
}

}  // namespace kervan::container
