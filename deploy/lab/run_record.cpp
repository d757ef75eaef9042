#include "deploy/lab/run_record.hpp"

#include <sys/wait.h>

#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "deploy/supervisor/child_process.hpp"

namespace kervan::lab {
namespace {

using nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr const char* record_name = "cell.json";

std::string hex(std::uint64_t value) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(value));
  return text;
}

ordered_json read_object(const fs::path& file) {
  std::ifstream stream(file);
  return ordered_json::parse(stream, nullptr, false);
}

/// What a program that ended badly had to say: the line that names the crash, else its last one.
std::string last_words(const fs::path& console) {
  std::ifstream stream(console);
  std::string words;
  for (std::string line; std::getline(stream, line);) {
    if (line.find(" crashed: ") != std::string::npos) return line;
    if (!line.empty()) words = line;
  }
  return words;
}

RunRecord failed(std::string reason) { return {RunState::failed, std::move(reason), 0, {}}; }

}  // namespace

std::optional<RunRecord> read_record(const fs::path& run_folder) {
  const ordered_json object = read_object(run_folder / record_name);
  if (!object.is_object()) return std::nullopt;
  const std::string state = object.value("state", ""), fingerprint = object.value("fingerprint", "");
  RunRecord record;
  if (state != "done" && state != "failed") return std::nullopt;
  record.state = state == "done" ? RunState::done : RunState::failed;
  record.reason = object.value("reason", "");
  const auto end = fingerprint.data() + fingerprint.size();
  if (std::from_chars(fingerprint.data(), end, record.fingerprint, 16).ptr != end) return std::nullopt;
  if (const auto command = object.find("command"); command != object.end() && command->is_array())
    for (const auto& word : *command)
      if (word.is_string()) record.command.push_back(word.get<std::string>());
  return record;
}

std::string write_record(const RunRecord& record, const fs::path& run_folder) {
  ordered_json object = {{"state", record.state == RunState::done ? "done" : "failed"}};
  if (!record.reason.empty()) object["reason"] = record.reason;
  object["fingerprint"] = hex(record.fingerprint);
  object["command"] = record.command;
  std::error_code error;
  fs::create_directories(run_folder, error);
  const fs::path file = run_folder / record_name, beside = run_folder / (std::string(record_name) + ".new");
  errno = 0;
  std::ofstream stream(beside);
  stream << object.dump(2, ' ', false, ordered_json::error_handler_t::replace) << '\n';
  if (!stream.flush()) {
    const std::string reason = errno != 0 ? std::strerror(errno) : "it cannot be written";
    stream.close();
    fs::remove(beside, error);
    return file.string() + ": " + reason;
  }
  stream.close();
  fs::rename(beside, file, error);
  return error ? file.string() + ": " + error.message() : "";
}

bool is_done(const fs::path& run_folder, std::uint64_t fingerprint) {
  const auto record = read_record(run_folder);
  return record && record->state == RunState::done && record->fingerprint == fingerprint &&
         read_object(run_folder / "summary.json").is_object();
}

RunRecord judge_run(int status, const fs::path& run_folder, const fs::path& console) {
  const std::string ended = supervisor::exit_text(status);
  const ordered_json summary = read_object(run_folder / "summary.json");
  const bool good_exit = WIFEXITED(status) && WEXITSTATUS(status) <= 1;
  if (!good_exit) {
    const std::string words = last_words(console);
    return failed(ended + (words.empty() ? "" : ": " + words));
  }
  if (!summary.is_object()) return failed(ended + ", but it left no summary.json that can be read");
  // What a component broke spoils the mission's verdict; a time that is over is a way to end.
  if (const std::string failures = summary.value("failures", ""); !failures.empty()) return failed(failures);
  if (summary.value("result", "") == "aborted" && summary.value("ended", "") != "time limit")
    return failed(summary.value("reason", "aborted"));
  return {RunState::done, "", 0, {}};
}

}  // namespace kervan::lab
