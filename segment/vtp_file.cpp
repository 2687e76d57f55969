// VTP is XML with encoded arrays; the few elements that make up a polygonal surface are read here, so that no
// part of VTK has to be installed.
#include <zlib.h>

#include <cstring>
#include <fstream>
#include <optional>
#include <sstream>

#include "core/errors.hpp"
#include "surface_file.hpp"

namespace valsalva::segment {
namespace {

using Bytes = std::vector<unsigned char>;

struct Element {
  std::string attributes, content;
};

std::optional<std::string> attribute(const std::string& attributes, const std::string& name) {
  const std::size_t at = attributes.find(" " + name + "=\"");
  if (at == std::string::npos) return std::nullopt;
  const std::size_t begin = at + name.size() + 3, end = attributes.find('"', begin);
  if (end == std::string::npos) return std::nullopt;
  return attributes.substr(begin, end - begin);
}

/// The first element of this name whose attributes contain `with`.
std::optional<Element> element(const std::string& text, const std::string& name,
                               const std::string& with = "") {
  for (std::size_t at = text.find("<" + name); at != std::string::npos; at = text.find("<" + name, at + 1)) {
    const std::size_t after = at + name.size() + 1, head = text.find('>', after);
    if (head == std::string::npos) return std::nullopt;
    if (text[after] != ' ' && text[after] != '\n' && text[after] != '>' && text[after] != '/') continue;
    const std::string attributes = text.substr(after, head - after);
    if (attributes.find(with) == std::string::npos) continue;
    if (text[head - 1] == '/') return Element{attributes, ""};
    const std::size_t end = text.find("</" + name + ">", head);
    if (end == std::string::npos) return std::nullopt;
    return Element{attributes, text.substr(head + 1, end - head - 1)};
  }
  return std::nullopt;
}

Bytes from_base64(const std::string& text, std::size_t from, std::size_t* stopped) {
  Bytes bytes;
  unsigned buffer = 0;
  int bits = 0;
  std::size_t at = from;
  for (; at < text.size() && text[at] != '='; ++at) {
    const char c = text[at];
    int value = -1;
    if (c >= 'A' && c <= 'Z') value = c - 'A';
    if (c >= 'a' && c <= 'z') value = c - 'a' + 26;
    if (c >= '0' && c <= '9') value = c - '0' + 52;
    if (c == '+') value = 62;
    if (c == '/') value = 63;
    if (value < 0) {
      if (std::isspace(static_cast<unsigned char>(c))) continue;
      break;
    }
    buffer = buffer << 6 | unsigned(value);
    bits += 6;
    if (bits >= 8) {
      bits -= 8;
      bytes.push_back(static_cast<unsigned char>(buffer >> bits & 0xff));
    }
  }
  while (at < text.size() && text[at] == '=') ++at;
  *stopped = at;
  return bytes;
}

class VtpFile {
 public:
  explicit VtpFile(const std::filesystem::path& path) : path_(path.string()) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream all;
    all << file.rdbuf();
    text_ = all.str();
    const auto root = element(text_, "VTKFile", "PolyData");
    if (!root) fail("is no VTK XML PolyData file, or it is cut short");
    if (attribute(root->attributes, "byte_order").value_or("LittleEndian") != "LittleEndian")
      fail("is big-endian; write it little-endian");
    const std::string compressor = attribute(root->attributes, "compressor").value_or("");
    if (!compressor.empty() && compressor != "vtkZLibDataCompressor")
      fail("is compressed by " + compressor + "; write it with zlib or uncompressed");
    compressed_ = !compressor.empty();
    long_headers_ = attribute(root->attributes, "header_type").value_or("UInt32") == "UInt64";
    if (const auto appended = element(text_, "AppendedData")) {
      if (attribute(appended->attributes, "encoding").value_or("") != "base64")
        fail("has raw appended data; write it with base64 or ASCII encoding");
      appended_ = appended->content;
      appended_.erase(0, appended_.find('_') + 1);
    }
  }

  geometry::TriMesh mesh() const {
    const auto points = element(text_, "Points"), polygons = element(text_, "Polys");
    if (!points || !polygons) fail("has no Points or no Polys");
    const auto positions = numbers(*points, "");
    const auto connectivity = numbers(*polygons, "connectivity"), offsets = numbers(*polygons, "offsets");
    geometry::TriMesh mesh;
    for (std::size_t n = 0; n + 2 < positions.size(); n += 3)
      mesh.points.emplace_back(positions[n], positions[n + 1], positions[n + 2]);
    std::size_t begin = 0;
    for (double offset : offsets) {
      const auto end = std::size_t(offset);
      if (end < begin || end > connectivity.size()) fail("has polygon offsets that do not fit");
      for (std::size_t n = begin; n < end; ++n)
        if (!(connectivity[n] >= 0 && connectivity[n] < double(mesh.points.size())))
          fail("has a polygon with an unknown point");
      for (std::size_t n = begin + 2; n < end; ++n)
        mesh.triangles.push_back({int(connectivity[begin]), int(connectivity[n - 1]), int(connectivity[n])});
      begin = end;
    }
    return mesh;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw InputError("{}: {}", path_, what); }

  std::vector<double> numbers(const Element& parent, const std::string& name) const {
    const auto array = element(parent.content, "DataArray", name.empty() ? "" : "Name=\"" + name + "\"");
    if (!array) fail("lacks the array " + (name.empty() ? std::string("of points") : name));
    const std::string format = attribute(array->attributes, "format").value_or("ascii");
    const std::string type = attribute(array->attributes, "type").value_or("");
    if (format == "ascii") {
      std::istringstream in(array->content);
      std::vector<double> values;
      for (double value; in >> value;) values.push_back(value);
      return values;
    }
    const Bytes bytes =
        format == "appended"
            ? decoded(appended_, std::stoul(attribute(array->attributes, "offset").value_or("0")))
            : decoded(array->content, 0);
    if (type == "Float32") return as<float>(bytes);
    if (type == "Float64") return as<double>(bytes);
    if (type == "Int32") return as<std::int32_t>(bytes);
    if (type == "Int64") return as<std::int64_t>(bytes);
    fail("has an array of type '" + type + "'; expected Float32, Float64, Int32 or Int64");
  }

  template <class T>
  static std::vector<double> as(const Bytes& bytes) {
    std::vector<double> values(bytes.size() / sizeof(T));
    for (std::size_t n = 0; n < values.size(); ++n) {
      T value;
      std::memcpy(&value, bytes.data() + n * sizeof(T), sizeof(T));
      values[n] = double(value);
    }
    return values;
  }

  std::uint64_t header(const Bytes& bytes, std::size_t n) const {
    const std::size_t width = long_headers_ ? 8 : 4;
    if ((n + 1) * width > bytes.size()) fail("has an encoded array that is cut short");
    std::uint64_t value = 0;
    std::memcpy(&value, bytes.data() + n * width, width);
    return value;
  }

  /// Uncompressed: byte count, data, in one base64 run. zlib: a run with block count, block size, size of the
  /// last block (0: full) and compressed sizes, then a run with the blocks.
  Bytes decoded(const std::string& text, std::size_t from) const {
    const std::size_t width = long_headers_ ? 8 : 4;
    std::size_t stopped = from;
    const Bytes first = from_base64(text, from, &stopped);
    if (!compressed_) {
      const std::uint64_t count = header(first, 0);
      if (first.size() < width + count) fail("has an encoded array that is cut short");
      return {first.begin() + std::ptrdiff_t(width), first.begin() + std::ptrdiff_t(width + count)};
    }
    const std::uint64_t blocks = header(first, 0), block = header(first, 1), last = header(first, 2);
    // The head run is padded to whole groups; without '=' the data run follows at once.
    const std::size_t head = (3 + blocks) * width, head_text = (head + 2) / 3 * 4;
    const Bytes sizes = from_base64(text.substr(0, text.find_first_not_of(" \n\r\t", from) + head_text),
                                    text.find_first_not_of(" \n\r\t", from), &stopped);
    const Bytes data = from_base64(text, stopped, &stopped);
    Bytes result;
    std::size_t at = 0;
    for (std::uint64_t b = 0; b < blocks; ++b) {
      const std::uint64_t packed = header(sizes, 3 + b);
      Bytes piece(b + 1 == blocks && last > 0 ? last : block);
      uLongf length = piece.size();
      if (at + packed > data.size() || uncompress(piece.data(), &length, data.data() + at, packed) != Z_OK)
        fail("has a compressed array that is damaged or cut short");
      result.insert(result.end(), piece.begin(), piece.begin() + std::ptrdiff_t(length));
      at += packed;
    }
    return result;
  }

  std::string path_, text_, appended_;
  bool compressed_ = false, long_headers_ = false;
};

}  // namespace

geometry::TriMesh read_vtp(const std::filesystem::path& path) {
  return VtpFile(path).mesh();
}

}  // namespace valsalva::segment
