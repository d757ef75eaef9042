/// What it costs to give a map away: a changed tile, and the whole of it to somebody who comes late.
#include <atomic>
#include <set>
#include <thread>

#include "components/grid/occupancy.hpp"
#include "components/mapping/map_ports.hpp"
#include "framework/test/harness.hpp"
#include "tests/bench/report.hpp"
#include "tests/bench/statistics.hpp"
#include "tests/runtime/containers.hpp"

namespace {

using namespace kervan;
using namespace std::chrono_literals;
using bench::now_ns;
using bench::say;
using kervan_msgs::msg::MapRequest;
using kervan_msgs::msg::MapTile;
using nav_msgs::msg::OccupancyGrid;

constexpr int side = 32;  ///< tiles: 100 x 100 m with cells of 5 cm

/// A map of log-odds in which every cell is known, and changes when it is asked to.
class Map {
 public:
  Map() {
    cells_.cover({0, 0, side * grid::tile_side, side * grid::tile_side});
    change();
  }
  void change() {
    ++changes_;
    const grid::CellBox& box = cells_.box();
    for (int y = 0; y < box.rows; ++y)
      for (int x = 0; x < box.columns; ++x)
        *cells_.place({x, y}) = static_cast<grid::LogOdds>((x * 37 + y * 101 + changes_ * 7919) % 65000 - 32500);
    cells_.touch(box);
  }
  double resolution() const { return cells_.resolution(); }
  grid::CellBox box() const { return cells_.box(); }
  std::vector<grid::Cell> take_touched() { return cells_.take_touched(); }
  void read_percent(const grid::CellBox& box, std::span<std::int8_t> percent) const {
    grid::read_percent(cells_, box, percent);
  }

 private:
  grid::Grid<grid::LogOdds> cells_{0.05, 0, std::size_t{64} << 20};
  int changes_ = 0;
};

std::vector<double> us_per_tile;

/// Publishes all of its tiles at every tick, and notes what one costs.
class Cartographer final : public Component {
  mapping::MapPorts ports_{this};
  Timer tick_{this, 100ms, &Cartographer::on_tick};
  Map map_;

  void on_tick(Time now) {
    map_.change();
    const std::int64_t start = now_ns();
    ports_.publish(map_, now, "map");
    us_per_tile.push_back(1e-3 * static_cast<double>(now_ns() - start) / (side * side));
  }
};

/// Publishes all of its tiles once.
class Archive final : public Component {
  mapping::MapPorts ports_{this};
  Timer tick_{this, 100ms, &Archive::on_tick};
  Map map_;

  void on_tick(Time now) { ports_.publish(map_, now, "map"); }
};

std::atomic<std::int64_t> complete_at{0};

/// Notes when it has every tile.
class LateJoiner final : public Component {
  Input<MapTile> tiles_{this, "tiles", qos::latched, &LateJoiner::on_tile, "The map."};
  std::set<std::pair<int, int>> have_;

  void on_tile(const MapTile& tile, Time) {
    have_.insert({tile.tile_x, tile.tile_y});
    if (have_.size() == std::size_t{side} * side && complete_at == 0) complete_at = now_ns();
  }
};

void bench_publishing(bool smoke) {
  test::Harness harness(test::define<Cartographer>("bench/cartographer"));
  harness.advance(smoke ? 200ms : 3s);
  us_per_tile.erase(us_per_tile.begin());  // blocks are allocated
  say("\n## A changed tile of 64 x 64 cells, from log-odds to a local reader\n\n| median | worst | wanted "
      "|\n|---|---|---|\n"
      "| %.1f us | %.1f us | below 20 us |\n",
      bench::median(us_per_tile), bench::percentile(us_per_tile, 1.0));
}

void bench_late_joiner(bool smoke) {
  std::vector<double> all;
  for (int round = 0; round < (smoke ? 1 : 7); ++round) {
    test::Composition composition({"archive", "joiner"});
    const QosProfile latched = *builtin_profile("latched"), event = *builtin_profile("event");
    composition.add("archive", "archive", test::define<Archive>("bench/archive"),
                    {test::binding<MapTile>("tiles", PortDirection::output, "/tiles", latched),
                     test::binding<OccupancyGrid>("map", PortDirection::output, "/map", latched),
                     test::binding<MapRequest>("map_request", PortDirection::input, "/map_request", event)});
    composition.add("joiner", "joiner", test::define<LateJoiner>("bench/joiner"),
                    {test::binding<MapTile>("tiles", PortDirection::input, "/tiles", latched)});
    complete_at = 0;
    test::Running archive(composition.spec("archive"), composition.registry());
    {
      test::Running first(composition.spec("joiner"), composition.registry());
      test::eventually([] { return complete_at != 0; });
    }
    complete_at = 0;
    const std::int64_t start = now_ns();
    test::Running late(composition.spec("joiner"), composition.registry());
    test::eventually([] { return complete_at != 0; });
    all.push_back(1e-9 * static_cast<double>(complete_at - start));
  }
  say("\n## A map of 100 x 100 m (%d tiles) for a container that joins, from its construction, over the loopback\n\n"
      "| median | worst | wanted |\n|---|---|---|\n| %.3f s | %.3f s | below 0.5 s |\n",
      side * side, bench::median(all), bench::percentile(all, 1.0));
}

}  // namespace

int main(int argc, char** argv) {
  const bool smoke = bench::begin(argc, argv, "Maps that are given away");
  bench_publishing(smoke);
  bench_late_joiner(smoke);
  return bench::end();
}
