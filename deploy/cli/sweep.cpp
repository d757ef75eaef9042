// kervan sweep: many runs of one composition, as a file says, and what came of them side by side.
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <map>
#include <thread>

#include "deploy/cli/drawn_world.hpp"
#include "deploy/cli/print_json.hpp"
#include "deploy/cli/sweep_plan.hpp"
#include "deploy/cli/sweep_progress.hpp"
#include "deploy/cli/verbs.hpp"
#include "deploy/composition/load.hpp"
#include "deploy/lab/report.hpp"
#include "deploy/lab/tables.hpp"
#include "framework/config/node.hpp"
#include "sim/files/world_file.hpp"

namespace kervan::cli {
namespace {

namespace fs = std::filesystem;

std::atomic<bool> stop_wanted = false;
std::atomic<int> signal_seen = 0;
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free,
              "a signal handler sets them");

extern "C" void on_sweep_signal(int signal) {
  signal_seen = signal;
  stop_wanted = true;
}

unsigned jobs_of(const SweepRequest& request) {
  if (request.jobs.empty()) return std::max(1u, std::thread::hardware_concurrency());
  const config::Node node = config::scalar(request.jobs, "", "--jobs " + request.jobs);
  const std::int64_t count = node.as_integer();
  if (count < 1 || count > 256) node.fail(node.shown() + " is out of range; allowed: 1 .. 256");
  return static_cast<unsigned>(count);
}

/// The folder of a sweep, for one sweep at a time.
class OwnFolder {
 public:
  explicit OwnFolder(const fs::path& folder) {
    const Location at{"--out " + folder.string(), 0, 0};
    std::error_code error;
    fs::create_directories(folder / "runs", error);
    if (error) throw ConfigError(at, "cannot make the folder: " + error.message());
    lock_ = ::open((folder / ".lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (lock_ < 0) throw ConfigError(at, "cannot write in the folder");
    if (::flock(lock_, LOCK_EX | LOCK_NB) == 0) return;
    ::close(lock_);
    throw ConfigError(at, "another sweep is at work in this folder");
  }
  ~OwnFolder() { ::close(lock_); }
  OwnFolder(const OwnFolder&) = delete;
  OwnFolder& operator=(const OwnFolder&) = delete;

 private:
  int lock_ = -1;
};

lab::Results results_of(SweepPlan& plan, std::vector<lab::RunRecord> records, const fs::path& runs) {
  lab::Results results{std::move(plan.experiment), std::move(plan.cells), std::move(records), {}};
  bool checked = false;
  for (std::size_t i = 0; i < results.cells.size(); ++i) {
    results.values.emplace_back();
    if (results.records[i].state != lab::RunState::done) continue;
    lab::RunValues run = lab::read_values(results.experiment.responses, runs / results.cells[i].name / "summary.json");
    if (!checked) lab::require_figures(results.experiment.responses, run);
    checked = true;
    results.values[i] = std::move(run.values);
  }
  return results;
}

/// Each world is read once.
lab::WorldOf world_reader(const std::vector<std::string>& worlds) {
  return [&worlds, read = std::map<std::string, observe::DrawnWorld>()](std::size_t cell) mutable {
    const auto [world, is_new] = read.try_emplace(worlds[cell]);
    if (is_new) world->second = drawn(sim::load_world(worlds[cell]));
    return world->second;
  };
}

std::string seconds_text(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f s", seconds);
  return text;
}

}  // namespace

int sweep(const SweepRequest& request) {
  const unsigned jobs = jobs_of(request);
  SweepPlan plan = plan_sweep(request.file);
  const fs::path folder = request.out.empty() ? fs::path("sweeps") / plan.experiment.name : fs::path(request.out);
  const OwnFolder own(folder);
  std::signal(SIGINT, on_sweep_signal);
  std::signal(SIGTERM, on_sweep_signal);

  lab::RunnerProgress last;
  std::optional<std::vector<lab::RunRecord>> records;
  {
    SweepProgress progress(isatty(STDERR_FILENO) == 1);
    bool figures_checked = false;
    lab::RunnerEvents events;
    events.progress = [&](const lab::RunnerProgress& now) {
      last = now;
      progress.show(now);
    };
    events.made = [&](std::size_t run, const lab::RunRecord& record) {
      const std::string& name = plan.cells[run].name;
      if (record.state == lab::RunState::failed) return progress.say("failed: " + name + ": " + record.reason);
      // A figure with a slip of the pen is found out by the first run, not after the last one.
      if (figures_checked) return;
      figures_checked = true;
      lab::require_figures(plan.experiment.responses,
                           lab::read_values(plan.experiment.responses, folder / "runs" / name / "summary.json"));
    };
    std::error_code none;
    records = lab::make_runs(plan.runs,
                             {.program = fs::read_symlink("/proc/self/exe", none),
                              .folder = folder / "runs",
                              .jobs = jobs,
                              .wall_limit = plan.experiment.wall_limit,
                              .stop = &stop_wanted},
                             events);
  }
  std::ostream& out = request.json ? std::cerr : std::cout;
  if (!records) {
    out << "interrupted: " << last.kept + last.made - last.failed << " of " << plan.runs.size()
        << " runs are done; the same command makes the rest\n";
    if (request.json) print_json({{"result", "interrupted"}, {"folder", folder.string()}});
    return signal_seen == SIGINT ? exit_interrupt : exit_terminated;
  }
  const lab::Results results = results_of(plan, std::move(*records), folder / "runs");
  lab::write_report(results, folder, world_reader(plan.worlds));
  out << lab::table_markdown(results) << '\n';
  if (results.experiment.comparison) out << lab::differences_markdown(results) << '\n';
  out << results.cells.size() << (results.cells.size() == 1 ? " run" : " runs");
  if (last.kept > 0) out << ", " << last.kept << " of them done before";
  if (results.failed() > 0) out << ", " << results.failed() << " failed";
  out << ", " << seconds_text(last.wall_s) << "\n" << (folder / "README.md").string() << '\n';
  if (request.json)
    print_json({{"result", results.failed() == 0 ? "success" : "failed"},
                {"runs", results.cells.size()},
                {"kept", last.kept},
                {"failed", results.failed()},
                {"wall_s", last.wall_s},
                {"folder", folder.string()}});
  return results.failed() == 0 ? exit_good : exit_found;
}

}  // namespace kervan::cli
