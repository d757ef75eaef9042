/// Emulated links against what is asked of them, over real sockets between two network namespaces; and what the way
/// through user space costs, beside a cable of the kernel (veth). Needs root.
#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "deploy/lab/link/emulated_network.hpp"
#include "tests/bench/report.hpp"
#include "tests/bench/statistics.hpp"
#include "tests/network/endpoint.hpp"
#include "tests/network/host.hpp"

namespace {

using namespace kervan;
using namespace std::chrono_literals;
using bench::now_ns, bench::percentile, bench::say;
using composition::LinkSettings;
using test::Endpoint, test::Packet;

constexpr const char* kHere = "10.77.0.1";
constexpr const char* kThere = "10.77.0.2";
constexpr std::size_t kSize = 200;

struct Ends {
  Endpoint here, there;
};

/// The ends of a link, once packets can pass: the first ones wait until the hosts know each other's hardware address.
Ends ends_of(const link::NetworkNamespace& a, const link::NetworkNamespace& b) {
  Ends ends{Endpoint(a, kHere), Endpoint(b, kThere)};
  do ends.here.send({}, kSize, kThere);
  while (!ends.there.receive(200ms));
  while (ends.there.receive(300ms)) {
  }
  return ends;
}

/// One emulated link; both directions are alike.
class Emulated {
 public:
  explicit Emulated(const LinkSettings& settings)
      : network_({{"a", "emulated", kHere}, {"b", "emulated", kThere}}, {1, settings, {}}),
        ends(ends_of(at("a"), at("b"))) {}

 private:
  link::NetworkNamespace at(const std::string& host) const {
    return link::NetworkNamespace::open("/proc/self/fd/" + std::to_string(network_.namespace_of(host)));
  }
  link::EmulatedNetwork network_;

 public:
  Ends ends;
};

struct Flow {
  int sent = 0;
  std::vector<double> delays_ms;  ///< of what came
  double rate = 0.0;              ///< bit/s on the wire, from the first that came to the last

  double delivered() const { return static_cast<double>(delays_ms.size()) / sent; }
};

/// A packet every `period`; then waits until nothing more comes.
Flow flow(const Ends& ends, int packets, std::chrono::nanoseconds period, std::size_t size) {
  Flow flow;
  const std::int64_t start = now_ns();
  std::int64_t first = 0, last = 0;
  for (;;) {
    const std::int64_t next = start + flow.sent * period.count(), now = now_ns();
    const bool more = flow.sent < packets;
    if (more && now >= next) {
      ends.here.send({static_cast<std::uint32_t>(flow.sent++), now_ns()}, size, kThere);
      continue;
    }
    const auto packet = ends.there.receive(more ? std::chrono::nanoseconds(next - now) : 1s);
    if (!packet) {
      if (more) continue;
      break;
    }
    last = now_ns();
    if (flow.delays_ms.empty()) first = last;
    flow.delays_ms.push_back(static_cast<double>(last - packet->sent_ns) * 1e-6);
  }
  const double arrived =
      static_cast<double>(flow.delays_ms.size() - 1) * static_cast<double>(size + Endpoint::kHeaders);
  flow.rate = arrived * 8.0 / (static_cast<double>(last - first) * 1e-9);
  return flow;
}

/// One way, us: half of there and back. Somebody else answers, as on another host, and so both wait for a packet.
std::vector<double> ways(const Ends& ends, int rounds) {
  const std::jthread echo([&ends](const std::stop_token& stop) {
    while (!stop.stop_requested())
      if (const auto packet = ends.there.receive(50ms)) ends.there.send(*packet, kSize, kHere);
  });
  std::vector<double> ways;
  for (int i = 0; i < rounds; ++i) {
    const std::int64_t start = now_ns();
    ends.here.send({}, kSize, kThere);
    if (ends.here.receive(1s)) ways.push_back(static_cast<double>(now_ns() - start) * 0.5e-3);
  }
  return ways;
}

void row(const char* what, double asked, double measured, const char* unit) {
  say("| %s | %.4g %s | %.4g %s | %+.2f %% |\n", what, asked, unit, measured, unit, 100.0 * (measured / asked - 1.0));
}

}  // namespace

int main(int argc, char** argv) try {
  const bool smoke = bench::begin(argc, argv, "Emulated links");
  const int packets = smoke ? 100 : 10000;
  test::Host a, b;
  a.connect(b, "cable", kHere, kThere);

  say("\n## What was asked of a link, and what it did, over %d packets\n\n", packets);
  say("| | asked | measured | off by |\n|---|---|---|---|\n");
  for (const double loss : {5.0, 20.0, 40.0})
    row(("delivered, of which " + std::to_string(static_cast<int>(loss)) + " % are to be lost").c_str(), 100.0 - loss,
        100.0 * flow(Emulated({.loss = loss}).ends, packets, 100us, kSize).delivered(), "%");
  row("delivered, of which 10 % are to be lost in bursts of 5", 90.0,
      100.0 * flow(Emulated({.burst_loss = 10.0}).ends, packets, 100us, kSize).delivered(), "%");
  {
    const Flow late = flow(Emulated({.delay = 50ms, .jitter = 20ms}).ends, packets, 500us, kSize);
    for (const double share : {0.05, 0.5, 0.95, 0.99})
      row(("delay 50 ms ± 20 ms, percentile " + std::to_string(static_cast<int>(share * 100.0))).c_str(),
          30.0 + share * 40.0, percentile(late.delays_ms, share), "ms");
  }
  for (const double megabits : {1.0, 10.0}) {
    // A quarter more than the link takes.
    const double bits = static_cast<double>(1000 + Endpoint::kHeaders) * 8.0;
    const auto period = std::chrono::nanoseconds(static_cast<std::int64_t>(bits / (1.25e-3 * megabits)));
    const int many = smoke ? 100 : static_cast<int>(1000 * megabits);
    row(("rate, " + std::to_string(many) + " packets").c_str(), megabits,
        flow(Emulated({.rate = megabits * 1e6}).ends, many, period, 1000).rate * 1e-6, "Mbit/s");
  }

  say("\n## One way, us: a packet there and back, half of it; five runs in turn\n\n");
  say("| | median | 99th percentile |\n|---|---|---|\n");
  std::vector<double> by_cable, by_link, far_by_cable, far_by_link;
  const auto cable = ends_of(link::NetworkNamespace::open(a.network()), link::NetworkNamespace::open(b.network()));
  const Emulated emulated({});
  for (int run = 0; run < 5; ++run) {
    const auto of_cable = ways(cable, packets / 5), of_link = ways(emulated.ends, packets / 5);
    by_cable.push_back(bench::median(of_cable));
    by_link.push_back(bench::median(of_link));
    far_by_cable.push_back(percentile(of_cable, 0.99));
    far_by_link.push_back(percentile(of_link, 0.99));
  }
  say("| a cable of the kernel | %.1f | %.1f |\n", bench::median(by_cable), bench::median(far_by_cable));
  say("| an emulated link | %.1f | %.1f |\n", bench::median(by_link), bench::median(far_by_link));
  say("| more | %.1f | %.1f |\n", bench::median(by_link) - bench::median(by_cable),
      bench::median(far_by_link) - bench::median(far_by_cable));
  return bench::end();
} catch (const test::NoHosts& error) {
  std::printf("needs root and iproute2: %s\n", error.what());
  return 0;
} catch (const link::NoPermission& error) {
  std::printf("needs root: %s\n", error.what());
  return 0;
}
