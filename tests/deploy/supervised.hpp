/// A run of the real program over several processes, which a test can watch, disturb and end.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/program/program.hpp"

namespace kervan::test {

class Supervised {
 public:
  /// `composition` is the file's text from `components:` on; what stands above it (clock, domain) is given here, with a
  /// tag of its own for every run. `arguments` follow "kervan run FILE --json"; `hosts` is `domain:`'s list of them.
  explicit Supervised(const std::string& composition, const std::string& clock = "wall",
                      const std::string& arguments = "", const std::string& hosts = "{}");
  ~Supervised();
  Supervised(const Supervised&) = delete;
  Supervised& operator=(const Supervised&) = delete;

  /// Reads what the run says on its standard error until `text` has come since the last call that waited for it, and
  /// returns the line. Throws if it does not come within a minute.
  std::string wait_for(const std::string& text);

  /// The processes of the run's containers that live now, by name.
  std::map<std::string, pid_t> containers() const;
  pid_t container(const std::string& name) const;

  /// To the program that supervises.
  void signal(int number);
  pid_t pid() const { return process_->pid(); }

  /// Waits until nobody holds the run's standard error any more, that is, every process is gone. Throws if that takes
  /// longer than the patience.
  void wait_until_nobody_lives(std::chrono::seconds patience = std::chrono::seconds(60));

  /// Waits for the program's end, and then for everybody's.
  Result wait(std::chrono::seconds patience = std::chrono::seconds(60));
  /// The last line of that result.
  nlohmann::json summary() const { return nlohmann::json::parse(lines_of(result_.out).back()); }
  /// The summary's row of this container.
  nlohmann::json row(const std::string& name) const;

  const std::string& said() const { return said_; }
  /// A file in the run's folder.
  std::string file(const std::string& name) const;
  /// Where the program was started; its runs are below it.
  const std::filesystem::path& folder() const { return folder_.path(); }
  std::vector<std::string> files() const { return folder_.everything_in_it(); }

 private:
  bool read_more(int timeout_ms);

  Folder folder_;
  int errors_ = -1;
  std::string said_;
  std::size_t seen_ = 0;
  std::unique_ptr<Process> process_;
  Result result_;
};

/// A shipped composition, less what Supervised writes above it, over these containers: {"sim", "[world]"} and so on.
/// `more` are components beside its own, one line each.
std::string split_over(const std::string& name, const std::vector<std::pair<std::string, std::string>>& containers,
                       const std::vector<std::string>& more = {});

/// The same of the laboratory.
std::string lab_over(const std::vector<std::pair<std::string, std::string>>& containers,
                     const std::vector<std::string>& more = {});

/// The number that an environment variable holds.
int number_from(const char* variable, int otherwise);

}  // namespace kervan::test
