#include "html.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

namespace valsalva::report {

std::string escape(const std::string& text) {
  std::string out;
  for (char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

std::string base64(const std::string& bytes) {
  std::string out(4 * ((bytes.size() + 2) / 3) + 1, '\0');
  const int length =
      EVP_EncodeBlock(reinterpret_cast<unsigned char*>(out.data()),
                      reinterpret_cast<const unsigned char*>(bytes.data()), static_cast<int>(bytes.size()));
  out.resize(static_cast<std::size_t>(length));
  return out;
}

Quantity quantity(const std::string& key) {
  static const std::vector<std::pair<std::string, std::string>> endings{{"_mmHg_per_s", "mmHg/s"},
                                                                        {"_mm_per_s", "mm/s"},
                                                                        {"_cm_per_s", "cm/s"},
                                                                        {"_m_per_s", "m/s"},
                                                                        {"_mL_per_s", "mL/s"},
                                                                        {"_L_per_min", "L/min"},
                                                                        {"_per_min", "1/min"},
                                                                        {"_mmHg", "mmHg"},
                                                                        {"_mm2", "mm²"},
                                                                        {"_mm3", "mm³"},
                                                                        {"_cm2", "cm²"},
                                                                        {"_mL", "mL"},
                                                                        {"_mm", "mm"},
                                                                        {"_kPa", "kPa"},
                                                                        {"_MPa", "MPa"},
                                                                        {"_Pa", "Pa"},
                                                                        {"_pct", "%"},
                                                                        {"_deg", "°"},
                                                                        {"_rad", "rad"},
                                                                        {"_Hz", "Hz"},
                                                                        {"_Fr", "Fr"},
                                                                        {"_uN", "µN"},
                                                                        {"_mN", "mN"},
                                                                        {"_N", "N"},
                                                                        {"_nJ", "nJ"},
                                                                        {"_mJ", "mJ"},
                                                                        {"_uJ", "µJ"},
                                                                        {"_ms", "ms"},
                                                                        {"_us", "µs"},
                                                                        {"_s", "s"},
                                                                        {"_MiB", "MiB"},
                                                                        {"_HU", "HU"}};
  Quantity result;
  std::string words = key.substr(key.find('.') + 1);
  for (const auto& [ending, unit] : endings)
    if (words.size() > ending.size() && words.ends_with(ending)) {
      result.unit = unit;
      words.resize(words.size() - ending.size());
      break;
    }
  static const std::vector<std::pair<std::string, std::string>> spelt{{"eoa", "effective orifice area"},
                                                                      {"goa", "geometric orifice area"},
                                                                      {"lvot", "LVOT"},
                                                                      {"stj", "sinotubular junction"},
                                                                      {"cfl", "CFL number"},
                                                                      {"lv", "LV"},
                                                                      {"la", "LA"},
                                                                      {"ao", "aortic"},
                                                                      {"p99", "99th percentile"},
                                                                      {"dt", "time step"},
                                                                      {"p", "pressure"},
                                                                      {"q", "flow"},
                                                                      {"v", "volume"}};
  std::string sentence;
  std::size_t start = 0;
  while (start <= words.size()) {
    const std::size_t end = std::min(words.find('_', start), words.size());
    std::string word = words.substr(start, end - start);
    for (const auto& [from, to] : spelt)
      if (word == from) {
        word = to;
        break;
      }
    sentence += (sentence.empty() ? "" : " ") + word;
    start = end + 1;
  }
  if (!sentence.empty())
    sentence[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(sentence[0])));
  result.words = sentence;
  return result;
}

std::string number(double value, int digits) {
  if (!std::isfinite(value)) return "–";
  if (value == 0) return "0";
  const double size = std::abs(value);
  if (size >= 1e-3 && size < 1e6) {
    const int before = static_cast<int>(std::floor(std::log10(size))) + 1;
    std::string text = fmt::format("{:.{}f}", value, std::max(0, digits - before));
    if (text.find('.') != std::string::npos) {
      text.erase(text.find_last_not_of('0') + 1);
      if (text.back() == '.') text.pop_back();
    }
    return text;
  }
  return fmt::format("{:.{}g}", value, digits);
}

std::string duration(double seconds) {
  if (!std::isfinite(seconds)) return "–";
  if (seconds < 90) return fmt::format("{} s", number(seconds, 3));
  const long total = std::lround(seconds);
  if (total < 5400) return fmt::format("{} min {:02d} s", total / 60, total % 60);
  return fmt::format("{} h {:02d} min", total / 3600, total % 3600 / 60);
}

std::string table(const std::string& caption, const std::vector<std::string>& head,
                  const std::vector<std::vector<std::string>>& cells) {
  std::string out = "<div class=\"scroll\"><table><caption>" + escape(caption) + "</caption><thead><tr>";
  for (const std::string& name : head) out += "<th scope=\"col\">" + escape(name) + "</th>";
  out += "</tr></thead><tbody>\n";
  for (const auto& row : cells) {
    out += "<tr>";
    for (std::size_t c = 0; c < row.size(); ++c)
      out += c == 0 ? "<th scope=\"row\">" + row[c] + "</th>" : "<td>" + row[c] + "</td>";
    out += "</tr>\n";
  }
  return out + "</tbody></table></div>\n";
}

namespace {

/// 1, 2 or 5 times a power of ten, near a quarter of the picture.
double bar_length(double width_mm) {
  const double wanted = width_mm / 4;
  const double decade = std::pow(10, std::floor(std::log10(wanted)));
  for (double factor : {5.0, 2.0})
    if (factor * decade <= wanted) return factor * decade;
  return decade;
}

std::string css(const Colour& c) {
  return fmt::format("rgb({},{},{})", std::lround(255 * c[0]), std::lround(255 * c[1]),
                     std::lround(255 * c[2]));
}

}  // namespace

std::string figure(const Picture& picture) {
  std::string out = "<figure><div class=\"picture\"><img alt=\"" + escape(picture.alt) +
                    "\" src=\"data:image/png;base64," + base64(picture.png) + "\">";
  if (picture.width_mm > 0) {
    const double length = bar_length(picture.width_mm);
    out += fmt::format("<div class=\"scale\" style=\"width:{:.3f}%\"><span>{} mm</span></div>",
                       100 * length / picture.width_mm, number(length));
  }
  out += "</div>";
  if (picture.has_bar) {
    std::string stops;
    for (int i = 0; i <= 12; ++i) stops += (i ? "," : "") + css(heat(i / 12.0));
    out += fmt::format(
        "<div class=\"bar\"><span>{}</span><i style=\"background:linear-gradient(to "
        "right,{})\"></i><span>{}</span>"
        "<em>{}</em></div>",
        number(picture.bar.low, 3), stops, number(picture.bar.high, 3), escape(picture.bar.label));
  }
  return out + "<figcaption>" + escape(picture.caption) + "</figcaption></figure>\n";
}

std::string details(const std::string& title, const std::string& body) {
  return "<details><summary>" + escape(title) + "</summary>" + body + "</details>\n";
}

std::string paragraph(const std::string& text, const std::string& css_class) {
  const std::string attribute = css_class.empty() ? "" : " class=\"" + css_class + "\"";
  return "<p" + attribute + ">" + escape(text) + "</p>\n";
}

}  // namespace valsalva::report
