/// Lockstep in one process and in several: what a cycle costs, and how much faster than real time a run goes. The ring
/// of stations of the distributed tests, and the laboratory as `kervan run` runs it. Asserts that the trace is the same
/// everywhere, never a time.
#include <unistd.h>

#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/bench/report.hpp"
#include "tests/bench/statistics.hpp"
#include "tests/conformance/wire/peer.hpp"
#include "tests/distributed/stations.hpp"
#include "tests/program/program.hpp"

namespace {

using namespace kervan;
using namespace std::chrono_literals;
using bench::say;
namespace fs = std::filesystem;

bool failed = false;

struct Figures {
  std::uint64_t cycles = 0;
  double wall_s = 0.0;  ///< of the slowest container, from the first cycle to the last
  std::uint64_t trace = 0;
};

/// One container of the ring; tells its figures in one line.
int be_member(unsigned containers, unsigned self, const std::string& tag, Duration limit) {
  std::int64_t began = 0;
  runtime::RunControl control;
  control.limit = limit;
  control.phase = [&](runtime::RunPhase phase) {
    if (phase == runtime::RunPhase::active) began = bench::now_ns();
  };
  const test::MemberResult result = test::run_member(test::stations(1, {.containers = containers}, self, tag), control);
  std::printf("%" PRIu64 " %" PRId64 " %016" PRIx64 " %s\n", result.report.cycles, bench::now_ns() - began,
              result.trace, result.report.reason.c_str());
  return result.report.end == runtime::RunEnd::time_limit ? 0 : 1;
}

Figures ring(unsigned containers, Duration limit) {
  const std::string tag = test::new_tag();
  std::vector<std::unique_ptr<test::Peer>> members;
  for (unsigned i = 0; i < containers; ++i)
    members.push_back(std::make_unique<test::Peer>(std::vector<std::string>{
        "--member", std::to_string(containers), std::to_string(i), tag, std::to_string(limit.count())}));
  Figures figures;
  for (const auto& member : members) {
    const int code = member->end();
    std::uint64_t cycles = 0, trace = 0;
    std::int64_t wall_ns = 0;
    const bool understood =
        !member->lines().empty() &&
        std::sscanf(member->lines().back().c_str(), "%" SCNu64 " %" SCNd64 " %" SCNx64, &cycles, &wall_ns, &trace) == 3;
    if (code != 0 || !understood || (figures.trace != 0 && figures.trace != trace)) {
      say("FAILED: a container of %u: %s\n", containers, understood ? member->lines().back().c_str() : "no answer");
      failed = true;
    }
    figures.trace = trace;
    figures.cycles = std::max(figures.cycles, cycles);
    figures.wall_s = std::max(figures.wall_s, static_cast<double>(wall_ns) / 1e9);
  }
  return figures;
}

void bench_ring(int rounds, Duration limit) {
  say("\n## A ring of ten components, %.0f s of logical time, median of %d rounds\n\n", seconds(limit), rounds);
  say("| containers | cycles a second of logical time | us a cycle | times real time |\n|---|---|---|---|\n");
  std::uint64_t trace = 0;
  for (const unsigned containers : {1u, 2u, 3u, 5u}) {
    std::vector<double> walls;
    Figures figures;
    for (int round = 0; round < rounds; ++round) {
      figures = ring(containers, limit);
      walls.push_back(figures.wall_s);
    }
    const double wall_s = bench::median(walls);
    // The cycles of one container are those in which it has something to do; all go through those of the whole run.
    static double cycles = 0.0;
    if (containers == 1) cycles = static_cast<double>(figures.cycles);
    say("| %u | %.0f | %.1f | %.0f |\n", containers, cycles / seconds(limit), wall_s * 1e6 / cycles,
        seconds(limit) / wall_s);
    if (trace != 0 && trace != figures.trace) {
      say("FAILED: trace %016" PRIx64 " in %u containers, %016" PRIx64 " in one\n", figures.trace, containers, trace);
      failed = true;
    }
    trace = trace != 0 ? trace : figures.trace;
  }
}

/// The shipped laboratory with another placement.
std::string lab(const std::string& containers) {
  std::ifstream file(fs::path(KERVAN_SOURCES) / "deploy/compositions/lab.yaml");
  std::ostringstream text;
  text << file.rdbuf() << containers;
  return text.str();
}

void bench_laboratory(int rounds) {
  struct Split {
    const char* name;
    const char* containers;
    const char* target;
  };
  const Split splits[] = {
      {"1", "", "-"},
      {"2", "containers:\n  sim: {components: [world, report, mission]}\n  brain: {components: [\"r1/*\"]}\n", "5"},
      {"5",
       "containers:\n  sim: {components: [world]}\n  plan: {components: [r1/planner, r1/follower]}\n"
       "  control: {components: [r1/control]}\n  safety: {components: [r1/guard]}\n"
       "  observe: {components: [report, mission]}\n",
       "2"}};
  say("\n## The laboratory by `kervan run`, start and end of the processes included, median of %d rounds\n\n", rounds);
  say("| containers | times real time | target | trace |\n|---|---|---|---|\n");
  std::string trace;
  for (const Split& split : splits) {
    const test::Folder folder;
    std::ofstream(folder.path() / "split.yaml") << lab(split.containers);
    std::vector<double> factors;
    std::string here;
    for (int round = 0; round < rounds; ++round) {
      const fs::path runs = folder.path() / ("runs" + std::to_string(round));
      const test::Result result =
          test::run({KERVAN_PROGRAM, {"run", "split.yaml", "--runs", runs.string()}}, folder.path());
      nlohmann::json summary;
      if (fs::exists(runs))
        for (const auto& run : fs::directory_iterator(runs)) std::ifstream(run.path() / "summary.json") >> summary;
      if (result.code != 0 || summary.empty()) {
        say("FAILED: %s containers: %s%s\n", split.name, result.out.c_str(), result.err.c_str());
        failed = true;
        return;
      }
      factors.push_back(summary["simulated_s"].get<double>() / summary["wall_s"].get<double>());
      here = summary["trace_hash"];
    }
    if (trace.empty()) trace = here;
    failed = failed || trace != here;
    say("| %s | %.1f | %s | %s |\n", split.name, bench::median(factors), split.target, here.c_str());
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 6 && std::strcmp(argv[1], "--member") == 0)
    return be_member(static_cast<unsigned>(std::atoi(argv[2])), static_cast<unsigned>(std::atoi(argv[3])), argv[4],
                     Duration(std::atoll(argv[5])));
  const bool smoke = bench::begin(argc, argv, "Lockstep");
  bench_ring(smoke ? 1 : 5, smoke ? 300ms : 5s);
  bench_laboratory(smoke ? 1 : 5);
  return bench::end(failed);
}
