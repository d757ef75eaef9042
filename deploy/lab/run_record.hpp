/// What is known of one run of a plan, and the file in its folder that says so: `cell.json`. It is written last, so a
/// folder without it holds half a run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace kervan::lab {

enum class RunState {
  done,    ///< it came to its end, whether its mission succeeded or not
  failed,  ///< from outside its mission: it crashed, hung, could not begin, could not write
};

struct RunRecord {
  RunState state = RunState::failed;
  std::string reason;                     ///< why it failed, one sentence; empty if it did not
  std::uint64_t fingerprint = 0;          ///< of everything that its result depends on
  std::vector<std::string> command = {};  ///< how it was started
};

/// Nothing if there is none, or it cannot be read.
std::optional<RunRecord> read_record(const std::filesystem::path& run_folder);

/// Written beside and renamed, so that it is there whole or not at all. Returns why it could not be; empty if it was.
std::string write_record(const RunRecord& record, const std::filesystem::path& run_folder);

/// Whether the folder holds a finished run with this fingerprint, so that there is nothing to do.
bool is_done(const std::filesystem::path& run_folder, std::uint64_t fingerprint);

/// How a run went whose process ended with `status` (of waitpid): by that, by the summary.json that it left, and by
/// what it printed to `console`, where the reason of a failure is looked for.
RunRecord judge_run(int status, const std::filesystem::path& run_folder, const std::filesystem::path& console);

}  // namespace kervan::lab
