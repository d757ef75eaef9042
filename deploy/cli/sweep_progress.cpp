#include "deploy/cli/sweep_progress.hpp"

#include <cmath>
#include <cstdio>

namespace kervan::cli {
namespace {

/// "1:02:03", "1:20", "8 s"
std::string time_text(double seconds) {
  const long all = std::lround(seconds);
  char text[40];
  if (all < 60)
    std::snprintf(text, sizeof text, "%ld s", all);
  else if (all < 3600)
    std::snprintf(text, sizeof text, "%ld:%02ld", all / 60, all % 60);
  else
    std::snprintf(text, sizeof text, "%ld:%02ld:%02ld", all / 3600, all / 60 % 60, all % 60);
  return text;
}

}  // namespace

std::string progress_text(const lab::RunnerProgress& progress) {
  const std::size_t over = progress.kept + progress.made;
  std::string text = std::to_string(over) + " of " + std::to_string(progress.total) + " runs";
  if (progress.failed > 0) text += ", " + std::to_string(progress.failed) + " failed";
  if (progress.made > 0 && over < progress.total)
    text +=
        ", " +
        time_text(progress.wall_s * static_cast<double>(progress.total - over) / static_cast<double>(progress.made)) +
        " left";
  return text;
}

SweepProgress::~SweepProgress() {
  if (terminal_ && shown_) std::fputs("\r\033[K", stderr);
}

void SweepProgress::show(const lab::RunnerProgress& progress) {
  using namespace std::chrono_literals;
  const auto now = Clock::now();
  if (now - last_ < (terminal_ ? 100ms : 5s)) return;
  last_ = now;
  std::string line = progress_text(progress);
  if (terminal_) {
    constexpr std::size_t width = 30;
    const std::size_t full = progress.total == 0 ? width : width * (progress.kept + progress.made) / progress.total;
    line = "\r[" + std::string(full, '#') + std::string(width - full, '.') + "] " + line + "\033[K";
    shown_ = true;
  } else {
    line += '\n';
  }
  std::fputs(line.c_str(), stderr);
  std::fflush(stderr);
}

void SweepProgress::say(const std::string& text) {
  std::fputs(((terminal_ && shown_ ? "\r\033[K" : "") + text + "\n").c_str(), stderr);
  shown_ = false;
}

}  // namespace kervan::cli
