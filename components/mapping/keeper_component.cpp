#include <spdlog/spdlog.h>

#include <algorithm>
#include <deque>
#include <filesystem>
#include <stdexcept>

#include "components/grid/checkpoint.hpp"
#include "components/grid/messages.hpp"
#include "components/grid/occupancy.hpp"
#include "components/mapping/map_merger.hpp"
#include "components/mapping/map_ports.hpp"

namespace kervan::mapping {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;
using kervan_msgs::msg::MapTile;

constexpr Duration patience = 2s;

struct KeeperParams {
  std::vector<std::string> sources;
  double resolution = 0.05;
  double memory = 256.0;
  std::string file;
  map_file::Format image = map_file::Format::png;
  std::string frame = "map";
  Duration period = 500ms;
  Duration checkpoint_period = 5s;

  template <class Visitor>
  void describe(Visitor& v) {
    v(sources, "sources", {.help = "Names of the mappers, or of the robots they map for.", .required = true});
    v(resolution, "resolution", {.unit = "m", .min = 0.01, .max = 1.0, .help = "Side of a cell, that of the mappers."});
    v(memory, "memory",
      {.unit = "", .min = 0.1, .max = 16384.0, .help = "That each layer of the map may take, in MiB."});
    v(file, "file", {.help = "Where the map is kept beyond the run; empty: in the run's folder."});
    v(image, "image", {.choices = {"png", "pgm"}, .help = "Format of the picture that is left for map_server."});
    v(frame, "frame", {.help = "Name of the map's frame."});
    v(period, "period", {.min = 0.01, .max = 60.0, .help = "Time between two looks at what has changed."});
    v(checkpoint_period, "checkpoint_period",
      {.min = 0.1, .max = 3600.0, .help = "Time between two checkpoints, if anything has changed."});
  }
};

/// Keeps one map of what several mappers see (map_merger.hpp), on disk too.
class KeeperComponent final : public Component {
  /// The tiles of one mapper.
  class Source {
   public:
    Source(KeeperComponent* owner, std::size_t index, const std::string& name)
        : owner_(owner),
          index_(index),
          tiles_(owner, name + "/tiles", qos::latched, "Tiles of the map that " + name + " makes.") {}

    void take() {
      for (const auto& tile : tiles_.take())
        if (!tile.disposed()) owner_->on_tile(index_, *tile);
    }
    std::string missing() const { return tiles_.missing(); }

   private:
    KeeperComponent* owner_;
    std::size_t index_;
    Input<MapTile> tiles_;
  };

  const KeeperParams& params_ = parameters<KeeperParams>();
  MapMerger map_{params_.sources, params_.resolution, static_cast<std::size_t>(params_.memory * 1024.0 * 1024.0)};
  std::deque<Source> sources_ = sources();
  MapPorts ports_{this};
  Timer tick_{this, params_.period, &KeeperComponent::on_tick};
  Time activated_{};
  Time saved_{};
  bool unsaved_ = false;
  bool save_failed_ = false;
  std::uint64_t merged_ = 0, from_the_past_ = 0, refused_ = 0;
  std::string trouble_;  ///< since the last tick
  std::string refusal_;  ///< of the checkpoint that was there; stays

  std::deque<Source> sources() {
    // Files are written and made durable in handlers.
    wants_own_thread();
    std::deque<Source> sources;
    for (std::size_t i = 0; i < params_.sources.size(); ++i) {
      const std::string& name = params_.sources[i];
      if (name.empty()) throw ParameterError("sources[" + std::to_string(i) + "]", "a mapper needs a name");
      if (std::find(params_.sources.begin(), params_.sources.end(), name) - params_.sources.begin() !=
          static_cast<std::ptrdiff_t>(i))
        throw ParameterError("sources[" + std::to_string(i) + "]",
                             "'" + name + "' is there already; name each mapper once");
      sources.emplace_back(this, i, name);
    }
    return sources;
  }

  /// "r1-keeper" for r1/keeper: several keepers may share a run's folder.
  std::string stem() const {
    std::string stem = name();
    std::replace(stem.begin(), stem.end(), '/', '-');
    return stem;
  }
  /// Empty: nothing is to be written.
  std::string checkpoint_file() const {
    if (!params_.file.empty()) return params_.file;
    return run_folder().empty() ? "" : (run_folder() / (stem() + ".map")).string();
  }
  std::string run() const { return run_folder().string(); }

  void on_activate(Time now) override {
    activated_ = saved_ = now;
    ports_.begin(now);
    const std::string file = checkpoint_file();
    if (file.empty() || !fs::exists(file)) return;
    try {
      map_.restore(grid::load_checkpoint(file), run());
      log().info("goes on from {}: {} x {} cells", file, map_.box().columns, map_.box().rows);
    } catch (const std::invalid_argument& error) {
      refuse_checkpoint(file, error.what());
    }
  }

  /// What cannot be read today may be somebody's only map: it is put aside, never written over.
  void refuse_checkpoint(const std::string& file, const std::string& why) {
    std::error_code failed;
    std::string aside = file + ".refused";
    for (int i = 2; fs::exists(aside, failed); ++i) aside = file + ".refused-" + std::to_string(i);
    fs::rename(file, aside, failed);
    refusal_ = "began with an empty map: " + why + (failed ? "" : "; it is kept as " + aside);
    if (failed) save_failed_ = true;
    log().error("{}", refusal_);
  }

  void on_tile(std::size_t source, const MapTile& tile) {
    const TileResult result = map_.add(source, grid::view_of(tile));
    const std::string& name = params_.sources[source];
    switch (result) {
      case TileResult::merged:
        ++merged_;
        unsaved_ = true;
        return;
      case TileResult::from_the_past: ++from_the_past_; return;
      case TileResult::refused_resolution: trouble_ = name + "/tiles: cells of another size are left out"; break;
      case TileResult::refused_size: trouble_ = name + "/tiles: tiles of another size are left out"; break;
      case TileResult::refused_value: trouble_ = name + "/tiles: a percentage is none, its tile is left out"; break;
      case TileResult::refused_memory:
        trouble_ = "the map may not grow any more, memory is used up: tiles beyond it are left out";
        break;
    }
    ++refused_;
  }

  void on_tick(Time now) {
    for (Source& source : sources_) source.take();
    ports_.publish(map_, now, params_.frame);
    if (unsaved_ && now - saved_ >= params_.checkpoint_period) save(now);
    report(now);
    trouble_.clear();
  }

  void report(Time now) {
    if (!trouble_.empty()) return report_degraded(trouble_);
    if (!refusal_.empty()) return report_degraded(refusal_);
    if (save_failed_) return report_degraded("the map cannot be kept in " + checkpoint_file());
    std::string missing;
    for (const Source& source : sources_)
      if (missing.empty()) missing = source.missing();
    if (missing.empty())
      report_active();
    else if (now - activated_ >= patience)  // Mappers see something first, and publish it at their own periods.
      report_degraded(missing);
  }

  void save(Time now) {
    saved_ = now;
    const std::string file = checkpoint_file();
    if (file.empty()) return;
    try {
      grid::save_checkpoint(map_.checkpoint(run()), file);
      unsaved_ = save_failed_ = false;
    } catch (const std::invalid_argument& error) {
      if (!save_failed_) log().error("{}", error.what());
      save_failed_ = true;
    }
  }

  void on_deactivate(Time now) override {
    for (Source& source : sources_) source.take();
    ports_.publish(map_, now, params_.frame);
  }

  void on_shutdown(Time now) override {
    for (Source& source : sources_) source.take();
    save(now);
    log().info("{} tiles merged into {} x {} cells, {} published", merged_, map_.box().columns, map_.box().rows,
               ports_.published());
    if (refused_ + from_the_past_ > 0)
      log().warn("left out: {} tiles refused, {} of mappers that had ended", refused_, from_the_past_);
    if (run_folder().empty()) return;
    try {
      map_file::save(grid::to_map_file(map_.merged()), (run_folder() / (stem() + ".yaml")).string(),
                     map_file::Mode::trinary, params_.image);
    } catch (const std::invalid_argument& error) {
      log().error("{}", error.what());
    }
  }
};

}  // namespace
}  // namespace kervan::mapping

KERVAN_COMPONENT(kervan::mapping::KeeperComponent, "mapping/keeper",
                 "Keeps one map of what several mappers see, on disk too.")
