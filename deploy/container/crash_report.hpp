/// Says what ran when the process is killed by its own fault: SIGSEGV, SIGBUS, SIGFPE, SIGILL or SIGABRT.
#pragma once

#include <filesystem>
#include <string>

namespace kervan::container {

struct CrashReportOptions {
  std::string container;        ///< its name
  std::filesystem::path file;   ///< gets the report too, after what it holds already; empty: no file
  int control_descriptor = -1;  ///< gets a Crash message (control_channel.hpp); -1: nobody
};

/// From now on such a signal first prints one line, "container brain crashed: SIGSEGV at address 0x0 in r1/control (in
/// a timer)", and a backtrace, on stderr and into the file, and then ends the process as it would have. Once a process.
void report_crashes(const CrashReportOptions& options);

}  // namespace kervan::container
