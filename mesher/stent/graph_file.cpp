#include "graph_file.hpp"

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/errors.hpp"

namespace valsalva::stent {

namespace {

using Json = nlohmann::json;
constexpr const char* format_name = "valsalva-frame-graph";

double number(const Json& value, const std::string& where) {
  if (!value.is_number()) throw InputError("{}: found {}; expected a number", where, value.dump());
  return value.get<double>();
}

int node_number(const Json& value, const std::string& where) {
  if (!value.is_number_integer())
    throw InputError("{}: found {}; expected a node number", where, value.dump());
  const auto n = value.get<std::int64_t>();
  if (n < 0 || n > 10'000'000) throw InputError("{}: node {} does not exist", where, n);
  return static_cast<int>(n);
}

const Json& array_of(const Json& document, const char* key, const std::string& label) {
  if (!document.contains(key) || !document.at(key).is_array())
    throw InputError("{}: no list \"{}\"", label, key);
  return document.at(key);
}

}  // namespace

Frame read_graph(const std::filesystem::path& file, int beams_per_strut) {
  const std::string label = file.string();
  std::ifstream stream(file);
  if (!stream) throw InputError("device.graph_file: cannot read {}", label);
  Json document;
  try {
    document = Json::parse(stream);
  } catch (const Json::parse_error& error) {
    throw InputError("{}: not a JSON file (byte {}): {}", label, error.byte, error.what());
  }
  if (!document.is_object() || document.value("format", Json()) != format_name)
    throw InputError("{}: no frame graph; expected \"format\": \"{}\"", label, format_name);

  double width = 0, depth = 0;
  if (document.contains("section_mm")) {
    const Json& section = array_of(document, "section_mm", label);
    if (section.size() != 2)
      throw InputError("{}: section_mm has {} entries; expected 2", label, section.size());
    width = number(section[0], label + ": section_mm");
    depth = number(section[1], label + ": section_mm");
  }
  Points nodes;
  for (const Json& node : array_of(document, "nodes_mm", label)) {
    const std::string where = fmt::format("{}: nodes_mm entry {}", label, nodes.size());
    if (!node.is_array() || node.size() != 3)
      throw InputError("{}: found {}; expected three coordinates", where, node.dump());
    nodes.emplace_back(number(node[0], where), number(node[1], where), number(node[2], where));
  }
  std::vector<Strut> struts;
  for (const Json& strut : array_of(document, "struts", label)) {
    const std::string where = fmt::format("{}: struts entry {}", label, struts.size());
    if (!strut.is_array() || (strut.size() != 2 && strut.size() != 4))
      throw InputError("{}: found {}; expected two node numbers, or these and width and depth", where,
                       strut.dump());
    struts.push_back({node_number(strut[0], where), node_number(strut[1], where), width, depth});
    if (strut.size() == 4)
      struts.back().width_mm = number(strut[2], where), struts.back().depth_mm = number(strut[3], where);
  }
  return frame_from_struts(nodes, struts, beams_per_strut, label);
}

std::string graph_text(const Frame& frame) {
  Json document{{"format", format_name}, {"version", 1}};
  for (int i = 0; i < frame.crossings; ++i)
    document["nodes_mm"].push_back({frame.nodes[i].x(), frame.nodes[i].y(), frame.nodes[i].z()});
  for (const Strut& s : frame.struts) document["struts"].push_back({s.from, s.to, s.width_mm, s.depth_mm});
  return document.dump(1) + "\n";
}

}  // namespace valsalva::stent
