#include "components/observe/arbitration_log.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "components/observe/decimal.hpp"
#include "components/observe/svg_writer.hpp"

namespace kervan::observe {
namespace {

constexpr std::array<const char*, 10> colours{"#2c8a4b", "#d1580f", "#1769aa", "#8445a8", "#b3881a",
                                              "#c2417c", "#0f8b8d", "#5b6b1e", "#7a4a2b", "#4f5bd5"};
constexpr const char* nobody = "#8d99a6";
constexpr const char* ink = "#1f2933";
constexpr const char* soft_ink = "#6b7785";
constexpr const char* line = "#d5dbe1";
constexpr const char* fonts = "Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif";

// Pixels.
constexpr double width = 1000.0, left = 150.0, right = 70.0, top = 60.0, row = 28.0, bar = 18.0, thin = 5.0,
                 foot = 46.0;

std::string pixels(double value) { return decimal(value, 2); }

/// 1, 2 or 5 times a power of ten: at most twelve steps.
double tick_step(double length) {
  const double least = std::max(length / 12.0, 1e-3);
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= least * (1.0 - 1e-9)) return factor * power;
  return 10.0 * power;
}

double total(const std::vector<ArbitrationLog::Stretch>& stretches) {
  double sum = 0.0;
  for (const auto& stretch : stretches) sum += stretch.to - stretch.from;
  return sum;
}

}  // namespace

void ArbitrationLog::extend(std::vector<Stretch>& stretches, double from, double to) {
  if (!stretches.empty() && stretches.back().to >= from)
    stretches.back().to = to;
  else
    stretches.push_back({from, to});
}

void ArbitrationLog::end(double time) {
  if (time > since_) {
    if (!in_charge_.empty()) extend(behaviours_[in_charge_].in_charge, since_, time);
    for (const std::string& name : waiting_) extend(behaviours_[name].waiting, since_, time);
  }
  since_ = time;
}

void ArbitrationLog::add(double time, const std::string& in_charge, int priority,
                         std::span<const std::string> waiting) {
  end(time);
  in_charge_ = in_charge;
  waiting_.assign(waiting.begin(), waiting.end());
  if (!in_charge.empty()) {
    Behaviour& behaviour = behaviours_[in_charge];
    behaviour.priority = std::max(behaviour.priority, priority);
  }
  for (const std::string& name : waiting) behaviours_.try_emplace(name);
}

std::vector<std::string> ArbitrationLog::ranked() const {
  std::vector<std::string> names;
  for (const auto& [name, behaviour] : behaviours_) names.push_back(name);
  std::stable_sort(names.begin(), names.end(), [this](const std::string& a, const std::string& b) {
    return behaviours_.at(a).priority > behaviours_.at(b).priority;
  });
  return names;
}

const char* ArbitrationLog::colour_of(const std::string& behaviour) const {
  const auto found = behaviours_.find(behaviour);
  if (found == behaviours_.end()) return nobody;
  return colours[static_cast<std::size_t>(std::distance(behaviours_.begin(), found)) % colours.size()];
}

std::string to_svg(const ArbitrationLog& log, const std::string& title, double end) {
  const std::vector<std::string> names = log.ranked();
  const double bottom = top + row * static_cast<double>(names.size());
  const double length = std::max(end, 1e-3), scale = (width - left - right) / length;
  const auto at = [&](double time) { return left + scale * time; };

  SvgWriter svg;
  svg.open("svg", {{"xmlns", "http://www.w3.org/2000/svg"},
                   {"width", pixels(width)},
                   {"height", pixels(bottom + foot)},
                   {"viewBox", "0 0 " + pixels(width) + " " + pixels(bottom + foot)},
                   {"font-family", fonts}});
  svg.element("rect", {{"width", pixels(width)}, {"height", pixels(bottom + foot)}, {"fill", "#fafbfc"}});
  svg.text(title, {{"x", "20"}, {"y", "32"}, {"font-size", "18"}, {"font-weight", "bold"}, {"fill", ink}});
  svg.text("in charge", {{"x", pixels(width - 12.0)},
                         {"y", pixels(top - 6.0)},
                         {"font-size", "11"},
                         {"text-anchor", "end"},
                         {"fill", soft_ink}});

  const double step = tick_step(length);
  for (int i = 0; i * step <= length * (1.0 + 1e-9); ++i) {
    const double x = at(i * step);
    svg.element("line", {{"x1", pixels(x)},
                         {"y1", pixels(top)},
                         {"x2", pixels(x)},
                         {"y2", pixels(bottom)},
                         {"stroke", line},
                         {"stroke-width", "1"}});
    svg.text(decimal(i * step, step < 1.0 ? 2 : 0), {{"x", pixels(x)},
                                                     {"y", pixels(bottom + 16.0)},
                                                     {"font-size", "11"},
                                                     {"text-anchor", "middle"},
                                                     {"fill", soft_ink}});
  }
  svg.text("time (s); thin: wants to drive, and something of higher priority does",
           {{"x", pixels(left)}, {"y", pixels(bottom + 36.0)}, {"font-size", "11"}, {"fill", soft_ink}});

  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto& behaviour = log.behaviours().at(names[i]);
    const double middle = top + row * (static_cast<double>(i) + 0.5);
    const char* colour = log.colour_of(names[i]);
    svg.text(names[i], {{"x", pixels(left - 12.0)},
                        {"y", pixels(middle + 4.0)},
                        {"font-size", "13"},
                        {"text-anchor", "end"},
                        {"fill", ink}});
    const auto draw = [&](const std::vector<ArbitrationLog::Stretch>& stretches, double height, const char* opacity) {
      for (const auto& stretch : stretches)
        svg.element("rect", {{"x", pixels(at(stretch.from))},
                             {"y", pixels(middle - height / 2.0)},
                             {"width", pixels(scale * (stretch.to - stretch.from))},
                             {"height", pixels(height)},
                             {"fill", colour},
                             {"fill-opacity", opacity}});
    };
    draw(behaviour.waiting, thin, "0.45");
    draw(behaviour.in_charge, bar, "");
    svg.text(decimal(100.0 * total(behaviour.in_charge) / length, 1) + " %", {{"x", pixels(width - 12.0)},
                                                                              {"y", pixels(middle + 4.0)},
                                                                              {"font-size", "12"},
                                                                              {"text-anchor", "end"},
                                                                              {"fill", ink}});
  }
  svg.close("svg");
  return svg.document();
}

}  // namespace kervan::observe
