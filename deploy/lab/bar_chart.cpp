#include "deploy/lab/bar_chart.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "components/observe/decimal.hpp"
#include "components/observe/svg_writer.hpp"

namespace kervan::lab {
namespace {

using observe::decimal;
using observe::SvgWriter;

// Pixels of the page.
constexpr double page_width = 1000.0, margin = 36.0, header = 66.0, text_width = 96.0;
constexpr double bar_height = 15.0, group_gap = 11.0, line_height = 19.0, axis_height = 30.0;
constexpr double right = page_width - margin - text_width;

constexpr std::array<const char*, 10> colours{"#1769aa", "#d1580f", "#2c8a4b", "#8445a8", "#b3881a",
                                              "#0f8b8d", "#c2417c", "#5b6b1e", "#7a4a2b", "#4f5bd5"};
constexpr const char* ink = "#1f2933";
constexpr const char* soft_ink = "#6b7785";
constexpr const char* fonts = "Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif";

std::string px(double value) { return decimal(value, 1); }

/// The values of the axis: from `low` to `high` in steps of 1, 2 or 5 times a power of ten, 0 among them. It begins at
/// `left` (px).
struct Axis {
  double left = 0.0;
  double low = 0.0, high = 0.0, step = 1.0;

  double at(double value) const { return left + (right - left) * (value - low) / (high - low); }
};

/// Room for the longest label; nobody knows the font's exact widths.
double label_width(const BarChart& chart) {
  std::size_t longest = 0;
  for (const Bars& group : chart.groups) longest = std::max(longest, group.label.size());
  return std::clamp(7.0 * static_cast<double>(longest) + 12.0, 40.0, 300.0);
}

Axis axis_of(const BarChart& chart) {
  double low = 0.0, high = 0.0;
  for (const Bars& group : chart.groups)
    for (const auto& bar : group.bars)
      if (bar) {
        low = std::min({low, bar->low, bar->value});
        high = std::max({high, bar->high, bar->value});
      }
  if (chart.percent) high = 1.0;
  if (!(high > low)) high = low + 1.0;
  const double power = std::pow(10.0, std::floor(std::log10((high - low) / 5.0)));
  double step = 10.0 * power;
  for (const double factor : {5.0, 2.0, 1.0})
    if (factor * power >= (high - low) / 8.0) step = factor * power;
  return {margin + label_width(chart), std::floor(low / step + 1e-9) * step, std::ceil(high / step - 1e-9) * step,
          step};
}

int digits_of(double step) { return std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 9); }

std::string value_text(double value, const Axis& axis, bool percent) {
  if (percent) return decimal(100.0 * value, 0) + " %";
  return decimal(value, std::min(9, digits_of(axis.step) + 1));
}

void draw_axis(SvgWriter& svg, const Axis& axis, bool percent, double top, double bottom) {
  const int steps = static_cast<int>(std::lround((axis.high - axis.low) / axis.step));
  for (int i = 0; i <= steps; ++i) {
    const double value = axis.low + i * axis.step;
    const std::string x = px(axis.at(value));
    const bool zero = std::abs(value) < axis.step / 2.0;
    svg.element("line", {{"x1", x},
                         {"x2", x},
                         {"y1", px(top)},
                         {"y2", px(bottom)},
                         {"stroke", zero ? soft_ink : "#e3e8ed"},
                         {"stroke-width", "1"}});
    svg.text(percent ? decimal(100.0 * value, 0) + " %" : decimal(value, digits_of(axis.step)),
             {{"x", x}, {"y", px(bottom + 15.0)}, {"font-size", "11"}, {"fill", soft_ink}, {"text-anchor", "middle"}});
  }
}

void draw_interval(SvgWriter& svg, const Axis& axis, const Estimate& bar, double y) {
  const double a = axis.at(bar.low), b = axis.at(bar.high);
  const std::string path = "M" + px(a) + ',' + px(y - 3.5) + " V" + px(y + 3.5) + " M" + px(a) + ',' + px(y) + " H" +
                           px(b) + " M" + px(b) + ',' + px(y - 3.5) + " V" + px(y + 3.5);
  svg.element("path", {{"d", path}, {"fill", "none"}, {"stroke", ink}, {"stroke-width", "1.3"}});
}

void draw_bar(SvgWriter& svg, const Axis& axis, const std::optional<Estimate>& bar, bool percent, const char* colour,
              double top) {
  const double middle = top + bar_height / 2.0;
  std::string text = "-";
  if (bar) {
    const double a = axis.at(std::min(0.0, bar->value)), b = axis.at(std::max(0.0, bar->value));
    svg.element("rect", {{"x", px(a)},
                         {"y", px(top + 1.0)},
                         {"width", px(b - a)},
                         {"height", px(bar_height - 2.0)},
                         {"fill", colour},
                         {"fill-opacity", "0.75"}});
    if (bar->high > bar->low) draw_interval(svg, axis, *bar, middle);
    text = value_text(bar->value, axis, percent);
  }
  svg.text(text, {{"x", px(page_width - margin)},
                  {"y", px(middle + 4.0)},
                  {"font-size", "11.5"},
                  {"fill", bar ? ink : soft_ink},
                  {"text-anchor", "end"}});
}

/// Names of the series in two columns. Returns where they end.
double draw_legend(SvgWriter& svg, const std::vector<std::string>& series, double top) {
  if (series.size() == 1 && series.front().empty()) return top;
  double y = top;
  for (std::size_t i = 0; i < series.size(); ++i) {
    const double x = margin + (i % 2 == 0 ? 0.0 : 460.0);
    if (i % 2 == 0) y += line_height;
    svg.element("rect", {{"x", px(x)},
                         {"y", px(y - 10.0)},
                         {"width", "22"},
                         {"height", "11"},
                         {"fill", colours[i % colours.size()]},
                         {"fill-opacity", "0.75"}});
    svg.text(series[i], {{"x", px(x + 32.0)}, {"y", px(y)}, {"font-size", "12"}, {"fill", ink}});
  }
  return y + group_gap;
}

}  // namespace

std::string to_svg(const BarChart& chart) {
  const Axis axis = axis_of(chart);
  SvgWriter head, body, lines;
  head.text(chart.title, {{"x", px(margin)}, {"y", "34"}, {"font-size", "19"}, {"font-weight", "bold"}, {"fill", ink}});
  head.text((chart.unit.empty() ? "" : chart.unit + "; ") + "thin lines: 95 % confidence intervals",
            {{"x", px(margin)}, {"y", "54"}, {"font-size", "12"}, {"fill", soft_ink}});
  const double top = draw_legend(head, chart.series, header) + group_gap;
  double y = top;
  for (const Bars& group : chart.groups) {
    const double height = bar_height * static_cast<double>(group.bars.size());
    body.text(group.label, {{"x", px(axis.left - 12.0)},
                            {"y", px(y + height / 2.0 + 4.0)},
                            {"font-size", "12"},
                            {"fill", ink},
                            {"text-anchor", "end"}});
    for (std::size_t i = 0; i < group.bars.size(); ++i)
      draw_bar(body, axis, group.bars[i], chart.percent, colours[i % colours.size()],
               y + bar_height * static_cast<double>(i));
    y += height + group_gap;
  }
  draw_axis(lines, axis, chart.percent, top - group_gap / 2.0, y);
  const double height = y + axis_height + margin / 2.0;
  SvgWriter svg;
  svg.open("svg", {{"xmlns", "http://www.w3.org/2000/svg"},
                   {"width", px(page_width)},
                   {"height", px(height)},
                   {"viewBox", "0 0 " + px(page_width) + ' ' + px(height)},
                   {"font-family", fonts}});
  svg.element("rect", {{"width", px(page_width)}, {"height", px(height)}, {"fill", "#fafbfc"}});
  svg.append(head);
  svg.append(lines);
  svg.append(body);
  svg.close("svg");
  return svg.document();
}

}  // namespace kervan::lab
