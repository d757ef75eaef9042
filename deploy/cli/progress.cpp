#include "deploy/cli/progress.hpp"

#include <algorithm>
#include <cstdio>

namespace kervan::cli {
namespace {

std::string decimal(double value, int digits) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

}  // namespace

std::string progress_text(Duration simulated, Duration expected, double wall_s) {
  std::string text = decimal(seconds(simulated), 1) + " s";
  if (expected != forever) text += " of " + decimal(seconds(expected), 1) + " s";
  if (wall_s > 0.0) {
    const double factor = seconds(simulated) / wall_s;
    text += ", " + decimal(factor, factor < 10.0 ? 1 : 0) + "x";
  }
  return text;
}

Progress::Progress(Duration expected, bool terminal)
    : expected_(expected), terminal_(terminal), start_(std::chrono::steady_clock::now()), last_(start_) {}

Progress::~Progress() {
  if (terminal_ && shown_) std::fputs("\r\033[K", stderr);
}

void Progress::show(Duration simulated) {
  using namespace std::chrono_literals;
  const auto now = std::chrono::steady_clock::now();
  if (now - last_ < (terminal_ ? 100ms : 5s)) return;
  last_ = now;
  shown_ = true;
  const double wall = std::chrono::duration<double>(now - start_).count();
  std::fputs(line(simulated, wall).c_str(), stderr);
  std::fflush(stderr);
}

void Progress::say(const std::string& text) {
  std::fputs(((terminal_ && shown_ ? "\r\033[K" : "") + text + "\n").c_str(), stderr);
  shown_ = false;
}

void Progress::say_for_now(const std::string& text) {
  if (!terminal_) {
    if (text != said_) say(text);
    said_ = text;
    return;
  }
  std::fputs(("\r" + text + "\033[K").c_str(), stderr);
  std::fflush(stderr);
  shown_ = true;
}

void Progress::finish(Duration simulated, double wall_s) {
  if (!terminal_) return;
  std::fputs((line(simulated, wall_s) + "\n").c_str(), stderr);
  shown_ = false;
}

std::string Progress::line(Duration simulated, double wall) const {
  const std::string text = progress_text(simulated, expected_, wall);
  if (!terminal_) return text + "\n";
  constexpr std::size_t width = 30;
  std::string bar;
  if (expected_ != forever && expected_ > Duration::zero()) {
    const double share = std::clamp(seconds(simulated) / seconds(expected_), 0.0, 1.0);
    const auto full = static_cast<std::size_t>(share * width);
    bar = "[" + std::string(full, '#') + std::string(width - full, '.') + "] ";
  }
  return "\r" + bar + text + "\033[K";
}

}  // namespace kervan::cli
