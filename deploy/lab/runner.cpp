#include "deploy/lab/runner.hpp"

#include <poll.h>

#include <algorithm>
#include <csignal>
#include <list>
#include <memory>
#include <optional>
#include <system_error>

#include "deploy/supervisor/child_process.hpp"

namespace kervan::lab {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

/// One run while it lasts. When this goes away its process is gone.
class Job {
 public:
  Job(const Run& run, const RunnerOptions& options)
      : run_(run), folder_(options.folder / run.name), console_(options.folder / (run.name + ".console")) {
    fs::remove_all(folder_);
    command_ = run.arguments;
    command_.insert(command_.end(), {"--out", folder_.string()});
    began_ = Clock::now();
    process_ = std::make_unique<supervisor::ChildProcess>(options.program, command_, console_);
    command_.insert(command_.begin(), "kervan");
  }

  int ended_descriptor() const { return process_->ended_descriptor(); }

  /// Kills it if it has lasted for longer than this.
  void limit(std::chrono::duration<double> longest) {
    if (timed_out_ || Clock::now() - began_ < longest) return;
    timed_out_ = true;
    process_->signal(SIGKILL);
  }

  /// Once its process has ended: keeps what it said if it failed, and writes the record.
  std::optional<RunRecord> finished(std::chrono::duration<double> longest) {
    const auto status = process_->reap();
    if (!status) return std::nullopt;
    RunRecord record = judge_run(*status, folder_, console_);
    if (timed_out_) record.reason = "it did not end within " + limit_text(longest) + " and was killed";
    record.fingerprint = run_.fingerprint;
    record.command = command_;
    std::error_code ignored;
    if (record.state == RunState::failed) {
      fs::create_directories(folder_, ignored);
      fs::rename(console_, folder_ / "console.txt", ignored);
    } else {
      fs::remove(console_, ignored);
    }
    if (const std::string trouble = write_record(record, folder_); !trouble.empty()) {
      record.reason = (record.reason.empty() ? "" : record.reason + "; ") + trouble;
      record.state = RunState::failed;
    }
    return record;
  }

  /// Half a run is worth nothing.
  void abandon() {
    process_.reset();
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
    fs::remove(console_, ignored);
  }

 private:
  static std::string limit_text(std::chrono::duration<double> longest) {
    char text[32];
    std::snprintf(text, sizeof text, "%g s", longest.count());
    return text;
  }

  const Run& run_;
  fs::path folder_, console_;
  std::vector<std::string> command_;
  Clock::time_point began_;
  std::unique_ptr<supervisor::ChildProcess> process_;
  bool timed_out_ = false;
};

/// The jobs that run, with the places of their runs in the plan.
using Jobs = std::list<std::pair<std::size_t, Job>>;

/// Until one of them ends, a tenth of a second, or a signal.
void wait_for_any(const Jobs& jobs) {
  std::vector<pollfd> ended;
  for (const auto& [run, job] : jobs) ended.push_back({job.ended_descriptor(), POLLIN, 0});
  ::poll(ended.data(), ended.size(), 100);
}

class Abandon {
 public:
  explicit Abandon(Jobs& jobs) : jobs_(jobs) {}
  ~Abandon() {
    for (auto& [run, job] : jobs_) job.abandon();
  }
  Abandon(const Abandon&) = delete;
  Abandon& operator=(const Abandon&) = delete;

 private:
  Jobs& jobs_;
};

}  // namespace

std::optional<std::vector<RunRecord>> make_runs(const std::vector<Run>& runs, const RunnerOptions& options,
                                                const RunnerEvents& events) {
  std::vector<RunRecord> records(runs.size());
  std::vector<std::size_t> to_make;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const fs::path folder = options.folder / runs[i].name;
    if (is_done(folder, runs[i].fingerprint))
      records[i] = *read_record(folder);
    else
      to_make.push_back(i);
  }
  RunnerProgress progress{.total = runs.size(), .kept = runs.size() - to_make.size()};
  const Clock::time_point began = Clock::now();
  const auto end_of = [&](std::size_t run, RunRecord record) {
    progress.made += 1;
    if (record.state == RunState::failed) progress.failed += 1;
    records[run] = std::move(record);
    if (events.made) events.made(run, records[run]);
  };
  const auto tell = [&] {
    progress.wall_s = std::chrono::duration<double>(Clock::now() - began).count();
    if (events.progress) events.progress(progress);
  };

  Jobs jobs;
  Abandon rest(jobs);
  for (std::size_t next = 0; next < to_make.size() || !jobs.empty();) {
    if (options.stop != nullptr && *options.stop) return std::nullopt;
    while (next < to_make.size() && jobs.size() < options.jobs) {
      const std::size_t run = to_make[next++];
      try {
        jobs.emplace_back(std::piecewise_construct, std::forward_as_tuple(run),
                          std::forward_as_tuple(runs[run], options));
      } catch (const std::system_error& error) {  // no process, no folder
        end_of(run, {RunState::failed, std::string("it could not be started: ") + error.what(), 0, {}});
      }
    }
    wait_for_any(jobs);
    for (auto job = jobs.begin(); job != jobs.end();) {
      job->second.limit(options.wall_limit);
      auto record = job->second.finished(options.wall_limit);
      if (!record) {
        ++job;
        continue;
      }
      const std::size_t run = job->first;
      job = jobs.erase(job);
      end_of(run, std::move(*record));
    }
    tell();
  }
  tell();
  return records;
}

}  // namespace kervan::lab
