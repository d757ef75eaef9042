/// What every benchmark prints: to the terminal, and with --report FILE into a file of tests/bench/results.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>
#include <thread>

namespace kervan::bench {

inline FILE* report = nullptr;

template <class... Arguments>
void say(const char* format, Arguments... arguments) {
  std::printf(format, arguments...);
  std::fflush(stdout);
  if (report) std::fprintf(report, format, arguments...);
}

inline std::string cpu_name() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown CPU";
}

/// Reads `[--smoke | --report FILE]`, ends the program with a word about them if they are others, and prints the title.
/// True for --smoke: as short as it can be, to see that the benchmark runs.
inline bool begin(int argc, char** argv, const char* title) {
  const bool smoke = argc == 2 && std::strcmp(argv[1], "--smoke") == 0;
  if (argc == 3 && std::strcmp(argv[1], "--report") == 0) report = std::fopen(argv[2], "w");
  if (argc > 1 && !smoke && !report) {
    std::fprintf(stderr, "usage: %s [--smoke | --report FILE]\n", argv[0]);
    std::exit(2);
  }
  say("# %s on %s, %u cores\n", title, cpu_name().c_str(), std::thread::hardware_concurrency());
  return smoke;
}

/// The program's exit code.
inline int end(bool failed = false) {
  if (report) std::fclose(report);
  return failed ? 1 : 0;
}

}  // namespace kervan::bench
