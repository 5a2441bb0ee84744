#include "orbifit/apps/chart.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "html_text.h"

namespace orbifit {

namespace {

constexpr double kWidth = 640, kHeight = 400;  // of the picture
constexpr double kLeft = 74, kRight = 176, kTop = 18, kBottom = 52;
constexpr std::array kColours{"#2f6fc2", "#c2452f", "#2f9c5a", "#8a52b8", "#c9951a", "#1f9aa8", "#6b6f78", "#b23a7a"};

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1f", value);
  return text.data();
}

/// One logarithmic axis, between powers of ten.
struct Axis {
  int first = 0, last = 1;  // exponents
  double from, to;          // of the picture

  double at(double value) const { return from + (std::log10(value) - first) / (last - first) * (to - from); }
  // So that at most eight powers are named.
  int step() const { return 1 + (last - first) / 9; }
};

bool shown(const std::pair<double, double>& point) {
  const auto fits = [](double value) { return std::isfinite(value) && value > 0; };
  return fits(point.first) && fits(point.second);
}

Axis axis_of(std::vector<double> values, double from, double to) {
  Axis axis{0, 1, from, to};
  if (values.empty()) return axis;
  const auto [least, most] = std::ranges::minmax(values);
  axis.first = static_cast<int>(std::floor(std::log10(least) + 1e-9));
  axis.last = std::max(axis.first + 1, static_cast<int>(std::ceil(std::log10(most) - 1e-9)));
  return axis;
}

std::string text(double x, double y, const std::string& anchor, const std::string& content,
                 const std::string& more = "") {
  return "<text x=\"" + number(x) + "\" y=\"" + number(y) + "\" text-anchor=\"" + anchor + "\"" + more + ">" + content +
         "</text>\n";
}

std::string line(double x1, double y1, double x2, double y2, const std::string& colour) {
  return "<line x1=\"" + number(x1) + "\" y1=\"" + number(y1) + "\" x2=\"" + number(x2) + "\" y2=\"" + number(y2) +
         "\" stroke=\"" + colour + "\"></line>\n";
}

std::string power(int exponent) {
  return "10<tspan dy=\"-5\" font-size=\"9\">" + std::to_string(exponent) + "</tspan>";
}

std::string grid(const Axis& x, const Axis& y) {
  std::string result;
  for (int e = x.first; e <= x.last; e += x.step()) {
    const double at = x.at(std::pow(10.0, e));
    result += line(at, y.from, at, y.to, "#e3e6ec") + text(at, y.from + 20, "middle", power(e));
  }
  for (int e = y.first; e <= y.last; e += y.step()) {
    const double at = y.at(std::pow(10.0, e));
    result += line(x.from, at, x.to, at, "#e3e6ec") + text(x.from - 8, at + 4, "end", power(e));
  }
  return result;
}

std::string curve(const Chart::Series& series, const Axis& x, const Axis& y, const std::string& colour) {
  std::string joined;
  std::string marks;
  for (const auto& point : series.points) {
    if (!shown(point)) continue;
    const std::string at_x = number(x.at(point.first));
    const std::string at_y = number(y.at(point.second));
    joined += (joined.empty() ? "" : " ") + at_x + "," + at_y;
    marks += "<circle cx=\"" + at_x + "\" cy=\"" + at_y + "\" r=\"3\" fill=\"" + colour + "\"></circle>\n";
  }
  return "<polyline points=\"" + joined + "\" fill=\"none\" stroke=\"" + colour +
         "\" stroke-width=\"2\"></polyline>\n" + marks;
}

}  // namespace

std::string to_svg(const Chart& chart) {
  std::vector<double> horizontal;
  std::vector<double> vertical;
  for (const Chart::Series& series : chart.series) {
    for (const auto& point : series.points) {
      if (!shown(point)) continue;
      horizontal.push_back(point.first);
      vertical.push_back(point.second);
    }
  }
  const Axis x = axis_of(horizontal, kLeft, kWidth - kRight);
  const Axis y = axis_of(vertical, kHeight - kBottom, kTop);
  std::string result = "<svg viewBox=\"0 0 " + number(kWidth) + " " + number(kHeight) +
                       "\" role=\"img\" aria-label=\"" + escaped(chart.title) +
                       "\" font-family=\"system-ui, sans-serif\" font-size=\"12\" fill=\"#1d2330\">\n";
  result += grid(x, y);
  result += text((x.from + x.to) / 2, kHeight - 12, "middle", escaped(chart.horizontal));
  const std::string middle = number((y.from + y.to) / 2);
  result +=
      text(16, (y.from + y.to) / 2, "middle", escaped(chart.vertical), " transform=\"rotate(-90 16 " + middle + ")\"");
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    const int chosen = chart.series[i].colour;
    const std::string colour = kColours[(chosen < 0 ? i : static_cast<std::size_t>(chosen)) % kColours.size()];
    const double beside = kTop + 14 + 20 * static_cast<double>(i);
    result += curve(chart.series[i], x, y, colour);
    result += "<circle cx=\"" + number(x.to + 20) + "\" cy=\"" + number(beside - 4) + "\" r=\"4\" fill=\"" + colour +
              "\"></circle>\n" + text(x.to + 32, beside, "start", escaped(chart.series[i].name));
  }
  return result + "</svg>";
}

}  // namespace orbifit
