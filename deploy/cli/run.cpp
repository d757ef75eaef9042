// kervan run: check everything, then run, then say how it went and keep it in runs/<name>-<time>/.
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <ctime>
#include <fstream>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>

#include "deploy/cli/catalogue.hpp"
#include "deploy/cli/prepare.hpp"
#include "deploy/cli/print_json.hpp"
#include "deploy/cli/progress.hpp"
#include "deploy/cli/run_composition.hpp"
#include "deploy/cli/table.hpp"
#include "deploy/cli/verbs.hpp"
#include "deploy/composition/hosts.hpp"

namespace kervan::cli {
namespace {

using composition::ResolvedComposition;
using nlohmann::ordered_json;
namespace fs = std::filesystem;

std::atomic<bool> stop_wanted = false;
std::atomic<int> signal_seen = 0;
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free,
              "a signal handler sets them");

/// The first Ctrl-C ends the run in good order; a second one ends the program.
extern "C" void on_signal(int signal) {
  signal_seen = signal;
  stop_wanted = true;
  std::signal(signal, SIG_DFL);
}

/// The time that an option gives.
Duration time_given(const std::string& option, const std::string& text) {
  const Duration time = config::scalar(text, "", option + " " + text).as_duration();
  if (time <= Duration::zero()) throw ConfigError({option + " " + text, 0, 0}, "the time must be longer than 0 s");
  return time;
}

Duration time_limit(const RunRequest& request) {
  return request.time_limit.empty() ? forever : time_given("--for", request.time_limit);
}

/// Has every component that draws the run's map show what the sensors saw.
void give_snapshots(composition::Composition& composition, const std::string& period) {
  const std::string option = "--snapshots " + period;
  time_given("--snapshots", period);
  const char* const draws = "observe/map_report";
  bool given = false;
  for (composition::ComponentEntry& entry : composition.components) {
    if (entry.type.text != draws) continue;
    std::erase_if(entry.params.children, [](const config::Node& node) { return node.name == "snapshots"; });
    entry.params.children.push_back(config::scalar(period, "snapshots", option));
    entry.params.kind = config::Kind::map;
    given = true;
  }
  if (!given)
    throw ConfigError({option, 0, 0},
                      "'" + composition.name + "' has no component that draws a map; add one of type " + draws);
}

/// 0 leaves it to the composition.
unsigned threads(const RunRequest& request) {
  if (request.threads.empty()) return 0;
  const config::Node node = config::scalar(request.threads, "", "--threads " + request.threads);
  const std::int64_t count = node.as_integer();
  if (count < 1 || count > 64) node.fail(node.shown() + " is out of range; allowed: 1 .. 64");
  return static_cast<unsigned>(count);
}

/// The mission's own time-out, which bounds the run.
Duration mission_timeout(const ResolvedComposition& composition) {
  for (const auto& component : composition.components) {
    if (component.manifest.type != "observe/mission") continue;
    const ParameterInfo* info = component.manifest.parameter("timeout");
    const auto given = component.parameters.find("timeout");
    const Value timeout = given != component.parameters.end() ? given->second : info ? info->default_value : Value();
    if (const auto* s = std::get_if<double>(&timeout)) return from_seconds(*s);
  }
  return forever;
}

/// Takes back the folders of a run that did not come about: `folder` with what is in it, and the empty ones above it
/// that were made for it.
void take_back(const fs::path& folder, const std::vector<fs::path>& made) {
  std::error_code ignored;
  if (!folder.empty()) fs::remove_all(folder, ignored);
  for (const fs::path& above : made) fs::remove(above, ignored);
}

/// The folders on the way to `folder`, itself included, that are not there yet; the deepest first.
std::vector<fs::path> missing(fs::path folder) {
  std::vector<fs::path> missing;
  std::error_code ignored;
  for (; !folder.empty() && !fs::exists(folder, ignored); folder = folder.parent_path()) missing.push_back(folder);
  return missing;
}

/// runs/lab-20250131-142501; a number follows if two runs begin in the same second.
fs::path make_run_folder(const std::string& runs, const std::string& name) {
  std::error_code error;
  fs::create_directories(runs, error);
  if (error) throw ConfigError({"--runs " + runs, 0, 0}, "cannot make the folder: " + error.message());
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char time[32];
  std::strftime(time, sizeof time, "%Y%m%d-%H%M%S", &local);
  const std::string stem = name + "-" + time;
  for (int attempt = 1; attempt < 1000; ++attempt) {
    const fs::path folder = fs::path(runs) / (attempt == 1 ? stem : stem + "-" + std::to_string(attempt));
    if (fs::create_directory(folder, error)) return folder;
    if (error) break;
  }
  throw ConfigError({"--runs " + runs, 0, 0}, "cannot make a folder in it: " + error.message());
}

/// The folder that `--out` names, made if it is not there.
fs::path take_run_folder(const std::string& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw ConfigError({"--out " + folder, 0, 0}, "cannot make the folder: " + error.message());
  if (!fs::is_empty(folder))
    throw ConfigError({"--out " + folder, 0, 0}, "the folder is not empty; name one that is, or one that is not there");
  return folder;
}

const char* to_text(RunResult result) {
  switch (result) {
    case RunResult::success: return "success";
    case RunResult::failed: return "failed";
    case RunResult::aborted: return "aborted";
  }
  return "";
}

/// Figures are for people and scripts: tenths of a millimetre and of a millisecond say all there is to say.
double rounded(double value) { return std::round(value * 1e4) / 1e4; }

ordered_json summary(const RunOutcome& outcome) {
  ordered_json robots = ordered_json::object();
  for (const auto& [name, robot] : outcome.robots) {
    ordered_json clearance = nullptr;
    if (robot.min_clearance_m) clearance = rounded(*robot.min_clearance_m);
    robots[name] = {{"reached", robot.reached},        {"error_m", rounded(robot.error_m)},
                    {"time_s", rounded(robot.time_s)}, {"path_m", rounded(robot.path_m)},
                    {"contacts", robot.contacts},      {"min_clearance_m", clearance}};
  }
  ordered_json containers = ordered_json::array();
  for (const auto& container : outcome.containers)
    containers.push_back({{"name", container.name},
                          {"pid", container.pid},
                          {"restarts", container.restarts},
                          {"exit", container.exit},
                          {"worst_latency_s", container.counters.worst_latency_s},
                          {"missed_deadlines", container.counters.missed_deadlines}});
  ordered_json object = {{"result", to_text(outcome.result)},
                         {"ended", outcome.ended},
                         {"robots", robots},
                         {"trace_hash", outcome.trace_hash},
                         {"simulated_s", rounded(outcome.simulated_s)},
                         {"wall_s", rounded(outcome.wall_s)},
                         {"containers", containers}};
  for (const link::LinkReport& link : outcome.links) object["links"].push_back(to_json(link));
  if (outcome.result != RunResult::success) object["reason"] = outcome.reason;
  if (!outcome.failures.empty()) object["failures"] = outcome.failures;
  if (outcome.signal != 0) object["interrupted"] = true;
  return object;
}

/// What components have figured out about the run and left in its folder: figures-<component>.json, one object each.
ordered_json figures(const fs::path& folder) {
  std::map<std::string, fs::path> files;  // in order of their names
  std::error_code ignored;
  const std::string begin = "figures-", end = ".json";
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with(begin) && name.ends_with(end))
      files[name.substr(begin.size(), name.size() - begin.size() - end.size())] = entry.path();
  }
  ordered_json figures = ordered_json::object();
  for (const auto& [component, path] : files) {
    std::ifstream file(path);
    auto object = ordered_json::parse(file, nullptr, false);
    if (object.is_object())
      figures[component] = std::move(object);
    else
      std::cerr << path.string() << ": left out of the summary: it is no JSON object\n";
  }
  return figures;
}

void write_summary(const fs::path& folder, const ordered_json& object) {
  std::ofstream file(folder / "summary.json");
  file << object.dump(2, ' ', false, ordered_json::error_handler_t::replace) << '\n';
  if (!file.flush()) std::cerr << (folder / "summary.json").string() << ": cannot be written\n";
}

std::string decimal(double value, int digits) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

void print_result(std::ostream& out, const RunOutcome& outcome, const fs::path& folder) {
  out << to_text(outcome.result);
  if (!outcome.reason.empty()) out << ": " << outcome.reason;
  out << '\n';
  for (const auto& [name, robot] : outcome.robots) {
    out << "  " << name << (robot.reached ? "  reached its goal in " : "  did not reach its goal in ")
        << decimal(robot.time_s, 1) << " s, error " << decimal(robot.error_m, 3) << " m, path "
        << decimal(robot.path_m, 2) << " m, " << robot.contacts << (robot.contacts == 1 ? " contact" : " contacts");
    if (robot.min_clearance_m) out << ", least clearance " << decimal(*robot.min_clearance_m, 3) << " m";
    out << '\n';
  }
  out << "  " << progress_text(from_seconds(outcome.simulated_s), forever, outcome.wall_s) << " real time";
  if (!outcome.trace_hash.empty()) out << ", trace " << outcome.trace_hash;
  out << "\n  " << folder.string() << "/\n";
}

/// How each process did. A run in this process has none of its own.
void print_containers(std::ostream& out, const RunOutcome& outcome) {
  std::vector<std::vector<std::string>> rows = {
      {"container", "pid", "restarts", "exit", "worst latency", "missed deadlines"}};
  for (const auto& container : outcome.containers)
    rows.push_back({container.name, std::to_string(container.pid), std::to_string(container.restarts), container.exit,
                    decimal(container.counters.worst_latency_s * 1e3, 1) + " ms",
                    std::to_string(container.counters.missed_deadlines)});
  print_table(out, rows, "  ");
}

int exit_code(const RunOutcome& outcome) {
  if (outcome.signal == SIGINT) return exit_interrupt;
  if (outcome.signal != 0) return exit_terminated;
  return outcome.result == RunResult::success ? exit_good : exit_found;
}

}  // namespace

int run(const RunRequest& request) {
  const Duration limit = time_limit(request);
  const unsigned thread_count = threads(request);
  ComponentRegistry registry(component_folders());
  const ResolvedComposition composition = prepare(request, registry, [&](composition::Composition& loaded) {
    if (!request.snapshots.empty()) give_snapshots(loaded, request.snapshots);
  });
  require_usable(composition);
  composition::containers_here(composition.source);  // refuses before anything is written

  const bool here = runs_here(composition);
  if (here) {  // elsewhere the supervisor takes them
    std::signal(SIGINT, on_signal);
    std::signal(SIGTERM, on_signal);
  }
  const std::vector<fs::path> made = missing(request.run_folder.empty() ? request.runs_folder : request.run_folder);
  RunOptions options;
  options.time_limit = limit;
  options.threads = thread_count;
  options.stop = &stop_wanted;

  RunOutcome outcome;
  try {
    options.run_folder = request.run_folder.empty() ? make_run_folder(request.runs_folder, composition.source.name)
                                                    : take_run_folder(request.run_folder);
    Progress progress(std::min(limit, mission_timeout(composition)), isatty(STDERR_FILENO) == 1);
    outcome = run_composition(composition, registry, options,
                              {.progress = [&](Duration simulated) { progress.show(simulated); },
                               .say = [&](const std::string& text) { progress.say(text); },
                               .waiting = [&](const std::string& text) { progress.say_for_now(text); }});
    if (here) outcome.signal = signal_seen;
    progress.finish(from_seconds(outcome.simulated_s), outcome.wall_s);
  } catch (...) {
    // A failing handler fails its component, not the run: this is a container that could not be made. Leave nothing
    // behind.
    take_back(options.run_folder, made);
    throw;
  }
  ordered_json object = summary(outcome);
  if (ordered_json found = figures(options.run_folder); !found.empty()) object["figures"] = std::move(found);
  write_summary(options.run_folder, object);
  std::ostream& out = request.json ? std::cerr : std::cout;
  print_result(out, outcome, options.run_folder);
  if (!here) print_containers(out, outcome);
  if (!outcome.links.empty()) print_table(out, link::rows_of(outcome.links), "  ");
  if (request.json) print_json(object);
  return exit_code(outcome);
}

}  // namespace kervan::cli
