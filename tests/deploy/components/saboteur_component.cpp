// Breaks its process in every way that a component can.
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <stdexcept>

#include "builtin_interfaces/msg/Time.hpp"
#include "framework/kervan.hpp"

namespace kervan::test {
namespace {

using namespace std::chrono_literals;

struct SaboteurParams {
  std::string where = "nowhere";
  std::string how = "segv";
  Duration after = 0ms;

  template <class Visitor>
  void describe(Visitor& v) {
    v(where, "where",
      {.choices = {"nowhere", "constructor", "activate", "timer", "input", "deactivate"}, .help = "In which code."});
    v(how, "how",
      {.choices = {"segv", "null", "abort", "overflow", "refuse", "hang", "exit"}, .help = "What it does there."});
    v(after, "after", {.min = 0.0, .max = 100.0, .help = "Not before this time after the activation."});
  }
};

[[gnu::noinline]] int overflow(int depth) {
  volatile char page[4096];
  page[0] = static_cast<char>(depth);
  return depth < 0 ? 0 : overflow(depth + 1) + page[0];
}

class Saboteur final : public Component {
  SaboteurParams params_ = parameters<SaboteurParams>();
  Input<builtin_interfaces::msg::Time> poke_{this, "poke", qos::state.optional(), &Saboteur::on_input, "Anything."};
  Timer tick_{this, 10ms, &Saboteur::on_tick};
  Time activated_{};

  void strike(const std::string& where) {
    if (params_.where != where) return;
    if (params_.how == "segv") ::raise(SIGSEGV);
    if (params_.how == "null") {
      int* volatile nowhere = reinterpret_cast<int*>(0x10);
      *nowhere = 1;
    }
    if (params_.how == "abort") std::abort();
    if (params_.how == "overflow") overflow(0);
    if (params_.how == "refuse") throw ParameterError("how", "it is refused here and nowhere else");
    if (params_.how == "exit") ::_exit(7);
    while (params_.how == "hang") ::pause();
  }

  void on_activate(Time now) override {
    activated_ = now;
    strike("activate");
  }
  void on_tick(Time now) {
    if (now - activated_ >= params_.after) strike("timer");
  }
  void on_input(const builtin_interfaces::msg::Time&, Time) { strike("input"); }
  void on_deactivate(Time) override { strike("deactivate"); }

 public:
  Saboteur() {
    if (!describing()) strike("constructor");
  }
};

}  // namespace
}  // namespace kervan::test

KERVAN_COMPONENT(kervan::test::Saboteur, "test/saboteur", "Breaks its process in every way that a component can.")
