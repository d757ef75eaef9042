#include <cmath>
#include <numbers>

#include "components/mapping/cell_walk.hpp"
#include "tests/bench/mapping_reference.hpp"

namespace kervan::bench {
namespace {

class TextbookMap final : public ReferenceMap {
 public:
  TextbookMap(double resolution, const mapping::SonarModelParams& params)
      : resolution_(resolution),
        side_(static_cast<int>(40.0 / resolution)),
        model_(params),
        cells_(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_), 0.5f) {}

  std::string name() const override { return "textbook"; }

  void sonar(const geometry::Pose2& at, double range, double) override {
    const double reach = range + model_.params().tolerance;
    const grid::Cell low = grid::cell_of(at.position() - geometry::Vector2::Constant(reach), resolution_);
    const grid::Cell high = grid::cell_of(at.position() + geometry::Vector2::Constant(reach), resolution_);
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x) {
        const geometry::Vector2 to = grid::center_of({x, y}, resolution_) - at.position();
        const double alpha = geometry::angle_between(at.yaw, std::atan2(to.y(), to.x()));
        tell({x, y}, model_.likelihood(to.norm(), alpha, range));
      }
  }

  void laser(const geometry::Pose2& at, const std::vector<float>& ranges) override {
    const grid::Cell from = grid::cell_of(at.position(), resolution_);
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      const double beam = std::numbers::pi * (static_cast<double>(i) / static_cast<double>(ranges.size() - 1) - 0.5);
      mapping::CellWalk walk(from, geometry::heading(at.yaw + beam), static_cast<double>(ranges[i]) / resolution_);
      for (; !walk.at_end(); walk.step()) tell(walk.cell(), {0.4, 0.6});
      tell(walk.cell(), {0.7, 0.3});
    }
  }

 private:
  void tell(const grid::Cell& cell, const mapping::Likelihood& reading) {
    const int x = cell.x + side_ / 2, y = cell.y + side_ / 2;
    if (x < 0 || y < 0 || x >= side_ || y >= side_) return;
    float& p = cells_[static_cast<std::size_t>(y) * static_cast<std::size_t>(side_) + static_cast<std::size_t>(x)];
    p = static_cast<float>(std::clamp(mapping::updated(static_cast<double>(p), reading), 0.01, 0.99));
  }

  double resolution_;
  int side_;
  mapping::SonarModel model_;
  std::vector<float> cells_;
};

}  // namespace

std::unique_ptr<ReferenceMap> textbook_map(double resolution, const mapping::SonarModelParams& model) {
  return std::make_unique<TextbookMap>(resolution, model);
}

}  // namespace kervan::bench
