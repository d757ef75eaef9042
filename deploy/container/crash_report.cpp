// Between the signal and the end of the process only functions are called that a signal handler may call: no memory is
// allocated, nothing is locked, numbers are written by hand. The one exception is backtrace(), which allocates when it
// is called for the first time and is therefore called once before.
#include "deploy/container/crash_report.hpp"

#include <execinfo.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "framework/runtime/crash_context.hpp"

namespace kervan::container {
namespace {

constexpr std::array kSignals = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};

/// What the handler needs, made before it is needed.
struct Prepared {
  std::array<char, 256> container{};
  std::array<char, 4096> file{};
  int control = -1;
};
Prepared prepared;
/// The thread that reports; 0 while none does.
std::atomic<pid_t> reporter = 0;
static_assert(std::atomic<pid_t>::is_always_lock_free, "a signal handler sets it");

/// Text of limited length, put together without any allocation. What does not fit is cut off.
class Line {
 public:
  Line& operator<<(std::string_view text) {
    for (const char c : text)
      if (size_ < text_.size()) text_[size_++] = c;
    return *this;
  }
  Line& operator<<(std::int64_t number) {
    std::array<char, 20> digits{};
    std::size_t count = 0;
    auto rest = number < 0 ? ~static_cast<std::uint64_t>(number) + 1 : static_cast<std::uint64_t>(number);
    do digits[count++] = static_cast<char>('0' + rest % 10);
    while ((rest /= 10) != 0);
    if (number < 0) *this << "-";
    while (count > 0) *this << std::string_view(&digits[--count], 1);
    return *this;
  }
  Line& hexadecimal(std::uintptr_t number) {
    std::array<char, 16> digits{};
    std::size_t count = 0;
    do digits[count++] = "0123456789abcdef"[number & 15];
    while ((number >>= 4) != 0);
    *this << "0x";
    while (count > 0) *this << std::string_view(&digits[--count], 1);
    return *this;
  }
  /// As the inside of a JSON text. Names of components and ports hold nothing that would need more than this.
  Line& quoted(const char* text) {
    for (; *text; ++text) {
      const bool plain = static_cast<unsigned char>(*text) >= ' ' && *text != '"' && *text != '\\';
      *this << std::string_view(plain ? text : "?", 1);
    }
    return *this;
  }
  void write_to(int descriptor) const {
    // There is nobody left to tell that it did not succeed.
    [[maybe_unused]] const ssize_t written = ::write(descriptor, text_.data(), size_);
  }

 private:
  std::array<char, 2048> text_{};  ///< less than PIPE_BUF, so that a line arrives in one piece
  std::size_t size_ = 0;
};

const char* name_of(int signal) {
  switch (signal) {
    case SIGSEGV: return "SIGSEGV";
    case SIGBUS: return "SIGBUS";
    case SIGFPE: return "SIGFPE";
    case SIGILL: return "SIGILL";
    case SIGABRT: return "SIGABRT";
    default: return "a signal";
  }
}

void write_report(int descriptor, const Line& headline, void* const* frames, int count) {
  headline.write_to(descriptor);
  ::backtrace_symbols_fd(frames, count, descriptor);
}

void report(int signal, const siginfo_t& info) {
  const runtime::CrashContext running = runtime::RunningCode::current();
  const auto address = reinterpret_cast<std::uintptr_t>(info.si_addr);
  const bool sent = info.si_code <= 0;  // by kill() or abort(): there is no address

  Line headline;
  headline << "container " << prepared.container.data() << " crashed: " << name_of(signal);
  if (!sent) (headline << " at address ").hexadecimal(address);
  if (running.component)
    headline << " in " << running.component << " (in " << running.handler << ")";
  else
    headline << " outside of any component";
  headline << "\n";

  if (prepared.control >= 0) {
    Line message;
    message << "{\"crash\":{\"signal\":" << static_cast<std::int64_t>(signal) << ",\"address\":\"";
    if (!sent) message.hexadecimal(address);
    message << "\",\"component\":\"";
    if (running.component) message.quoted(running.component);
    message << "\",\"handler\":\"";
    if (running.handler) message.quoted(running.handler);
    message << "\",\"time_ns\":" << running.time_ns << "}}\n";
    message.write_to(prepared.control);
  }

  std::array<void*, 64> frames{};
  const int count = ::backtrace(frames.data(), static_cast<int>(frames.size()));
  write_report(STDERR_FILENO, headline, frames.data(), count);
  if (prepared.file[0] == '\0') return;
  const int file = ::open(prepared.file.data(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (file < 0) return;
  write_report(file, headline, frames.data(), count);
  ::close(file);
}

extern "C" void on_crash(int signal, siginfo_t* info, void*) {
  const auto self = static_cast<pid_t>(::syscall(SYS_gettid));
  pid_t nobody = 0;
  if (reporter.compare_exchange_strong(nobody, self)) {
    report(signal, *info);
  } else if (nobody != self) {
    for (;;) ::pause();  // another thread has crashed before; the process ends when it has said so
  }
  // As without this handler: the signal is blocked until the handler returns, and then ends the process.
  ::signal(signal, SIG_DFL);
  ::raise(signal);
}

template <std::size_t size>
void copy(std::array<char, size>& target, const std::string& text) {
  const std::size_t length = std::min(text.size(), size - 1);
  std::memcpy(target.data(), text.data(), length);
  target[length] = '\0';
}

}  // namespace

void report_crashes(const CrashReportOptions& options) {
  static const runtime::HandlerStack of_this_thread;
  copy(prepared.container, options.container);
  copy(prepared.file, options.file.string());
  prepared.control = options.control_descriptor;
  std::array<void*, 1> frames{};
  ::backtrace(frames.data(), 1);
  struct sigaction action {};
  action.sa_sigaction = on_crash;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK;
  ::sigemptyset(&action.sa_mask);
  for (const int signal : kSignals) ::sigaction(signal, &action, nullptr);
}

}  // namespace kervan::container
