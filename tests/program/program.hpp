/// Starts the real program, in a working folder of its own, and sees what it prints, leaves behind and returns.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace kervan::test {

struct Result {
  int code = -1;    ///< -1: ended by a signal, or did not end in time
  std::string out;  ///< standard output
  std::string err;  ///< standard error
};

/// A temporary folder that goes away with this object.
class Folder {
 public:
  Folder();
  ~Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::vector<std::string> everything_in_it() const;  ///< paths below it, sorted

 private:
  std::filesystem::path path_;
};

struct Command {
  std::string program;
  std::vector<std::string> arguments = {};
  std::map<std::string, std::string> environment = {};  ///< beside the test's own, of which KERVAN_… are left out
};

/// A program that runs; it is killed if it still does when this object goes away, or when the test dies.
class Process {
 public:
  Process(const Command& command, const std::filesystem::path& working_folder);
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  pid_t pid() const { return pid_; }
  void signal(int number);
  Result wait(std::chrono::seconds longest = std::chrono::seconds(60));

 private:
  Folder output_;  ///< beside the working folder, which is only the program's
  pid_t pid_ = -1;
};

/// Starts it and waits for its end.
Result run(const Command& command, const std::filesystem::path& working_folder);

/// As one would type it in a shell: `kervan` and these arguments, quotes and redirections included.
Result run_line(const std::string& program, const std::string& arguments, const std::filesystem::path& working_folder);

std::string text_of(const std::filesystem::path& file);
std::vector<std::string> lines_of(const std::string& text);

}  // namespace kervan::test
