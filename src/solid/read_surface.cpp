#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include "floe/base/item.h"
#include "floe/base/petsc.h"
#include "options/option_values.h"
#include "solid/corner_cutting.h"
#include "solid/surface.h"

namespace floe {
namespace {

constexpr std::uintmax_t most_bytes = std::uintmax_t{1} << 30U;
constexpr std::size_t longest_line = 1U << 20U;

/// Reads one file.
class Reader {
 public:
  Reader(const std::string& file, double unit, const std::string& key)
      : where_(key + ": '" + file + "'"), unit_(unit) {
    std::error_code error;
    if (std::filesystem::exists(file, error) && !std::filesystem::is_regular_file(file, error))
      refuse("is not a regular file");  // a pipe would be waited for
    size_ = std::filesystem::file_size(file, error);
    file_.open(file, std::ios::binary);
    if (error || !file_) refuse("cannot be read");
    if (size_ > most_bytes)
      refuse("has " + std::to_string(size_) + " bytes, must have at most " +
             std::to_string(most_bytes));
    std::string ending = std::filesystem::path(file).extension().string();
    for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (ending == ".obj") {
      read_obj();
    } else if (ending == ".stl") {
      is_binary() ? read_binary() : read_text();
    } else {
      refuse("must end in .stl or .obj");
    }
    if (surface_.triangles.empty()) refuse("has no triangle");
    merge_corners();
  }
  Surface surface() && { return std::move(surface_); }

 private:
  [[noreturn]] void refuse(const std::string& why) const { throw InputError(where_ + ": " + why); }
  [[noreturn]] void refuse_line(const std::string& why) const {
    refuse("line " + std::to_string(line_number_) + ": " + why);
  }
  void expect_room() const {
    if (static_cast<std::int64_t>(surface_.triangles.size()) >= most_triangles)
      refuse("has more than " + std::to_string(most_triangles) +
             " triangles; reduce it, e.g. by MeshLab's quadric edge collapse");
  }
  double metres(double number, const std::string& place) const {
    constexpr double largest = 1e9;
    const double value = number * unit_;
    if (!(std::abs(value) <= largest))
      refuse(place + " has a coordinate that is not finite or above 1e9 m in size");
    return value == 0 ? 0 : value;  // no -0
  }

  // -- binary STL: 80 bytes, the number of triangles, 50 bytes of each ----------------------------
  static std::uint32_t number(const char* bytes) {
    std::uint32_t value = 0;
    for (std::size_t k = 0; k < 4; ++k)
      value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[k])) << (8 * k);
    return value;
  }
  /// Some binary files begin with "solid" too, so their length decides.
  bool is_binary() {
    std::array<char, 84> head{};
    file_.read(head.data(), head.size());
    const auto got = file_.gcount();
    file_.clear();
    file_.seekg(0);
    if (got == head.size() && size_ == 84 + std::uintmax_t{50} * number(head.data() + 80))
      return true;
    const std::string_view start(head.data(), static_cast<std::size_t>(got));
    const auto first = start.find_first_not_of(" \t\r\n");
    const bool solid = first != std::string_view::npos && start.substr(first).starts_with("solid");
    const bool text = std::all_of(start.begin(), start.end(), [](char c) {
      return std::isprint(static_cast<unsigned char>(c)) ||
             std::isspace(static_cast<unsigned char>(c));
    });
    if (got < 84 && !solid)
      refuse("is no STL file, or incomplete: it has " + std::to_string(size_) + " bytes");
    return !(solid && text);
  }
  void read_binary() {
    std::array<char, 84> head{};
    file_.read(head.data(), head.size());
    const std::int64_t count = number(head.data() + 80);
    if (count > most_triangles)
      refuse("tells of " + std::to_string(count) + " triangles, at most " +
             std::to_string(most_triangles) +
             " are read; reduce it, e.g. by MeshLab's quadric edge collapse");
    const auto expected = 84 + 50 * static_cast<std::uintmax_t>(count);
    if (size_ < expected)
      refuse("is incomplete: " + std::to_string(count) + " triangles are " +
             std::to_string(expected) + " bytes, it has " + std::to_string(size_));
    if (size_ > expected)
      refuse("has " + std::to_string(size_) + " bytes, " + std::to_string(count) +
             " triangles of a binary STL file are " + std::to_string(expected));
    for (std::int64_t t = 0; t < count; ++t) {
      std::array<char, 50> bytes{};
      if (!file_.read(bytes.data(), bytes.size())) refuse("cannot be read to its end");
      std::array<Point3, 3> corners{};
      for (std::size_t k = 0; k < 9; ++k) {
        const auto value = std::bit_cast<float>(number(bytes.data() + 12 + 4 * k));
        corners[k / 3][k % 3] =
            metres(static_cast<double>(value), "triangle " + std::to_string(t + 1));
      }
      add(corners);
    }
  }
  void add(const std::array<Point3, 3>& corners) {
    const auto first = static_cast<std::int32_t>(surface_.vertices.size());
    surface_.vertices.insert(surface_.vertices.end(), corners.begin(), corners.end());
    surface_.triangles.push_back({first, first + 1, first + 2});
  }

  // -- text -------------------------------------------------------------------------------------
  /// Reads the next line into words_; false at the end.
  bool next_line() {
    std::string line;
    words_.clear();
    line_.clear();
    while (std::getline(file_, line)) {
      ++line_number_;
      if (!line.empty() && line.back() == '\r') line.pop_back();
      if (line_.size() + line.size() > longest_line) refuse_line("is longer than a million bytes");
      const bool goes_on = !line.empty() && line.back() == '\\';
      if (goes_on) line.back() = ' ';
      line_ += line;
      if (goes_on) continue;
      for (std::size_t at = 0; at < line_.size();) {
        const auto begin = line_.find_first_not_of(" \t\v\f", at);
        if (begin == std::string::npos) break;
        at = std::min(line_.find_first_of(" \t\v\f", begin), line_.size());
        words_.emplace_back(line_.data() + begin, at - begin);
      }
      return true;
    }
    return false;
  }
  double coordinate(std::string_view word) const {
    const std::string text(word);
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (text.empty() || *end != '\0') refuse_line(shown(text) + " is no number");
    return metres(value, "line " + std::to_string(line_number_));
  }
  Point3 point(std::size_t first) const {
    return {coordinate(words_[first]), coordinate(words_[first + 1]),
            coordinate(words_[first + 2])};
  }
  bool is_word(std::size_t k, std::string_view word) const {
    if (k >= words_.size() || words_[k].size() != word.size()) return false;
    return std::equal(word.begin(), word.end(), words_[k].begin(), [](char a, char b) {
      return a == std::tolower(static_cast<unsigned char>(b));
    });
  }

  void read_text() {
    std::vector<Point3> corners;
    bool in_facet = false, ended = false;
    while (next_line()) {
      if (words_.empty()) continue;
      if (is_word(0, "solid")) {
        ended = false;
      } else if (is_word(0, "facet")) {
        if (in_facet) refuse_line("a facet begins before the last one has ended");
        expect_room();
        in_facet = true;
        corners.clear();
        surface_.lines.push_back(line_number_);
      } else if (is_word(0, "vertex")) {
        if (!in_facet || words_.size() != 4) refuse_line("a vertex must be X Y Z in a facet");
        if (corners.size() == 3) refuse_line("a facet must have 3 vertices");
        corners.push_back(point(1));
      } else if (is_word(0, "endfacet")) {
        if (!in_facet || corners.size() != 3) refuse_line("a facet must have 3 vertices");
        add({corners[0], corners[1], corners[2]});
        in_facet = false;
      } else if (is_word(0, "endsolid")) {
        if (in_facet) refuse_line("the last facet has not ended");
        ended = true;
      } else if (!is_word(0, "outer") && !is_word(0, "endloop")) {
        refuse_line(shown(words_[0]) + " is no word of an STL file");
      }
    }
    if (!ended) refuse("is incomplete: endsolid is missing");
  }

  void read_obj() {
    std::vector<std::int32_t> polygon;
    while (next_line()) {
      if (words_.empty() || words_[0][0] == '#') continue;
      if (words_[0] == "v") {
        if (words_.size() < 4) refuse_line("a vertex must be X Y Z");
        if (static_cast<std::int64_t>(surface_.vertices.size()) >= 3 * most_triangles)
          refuse("has more than " + std::to_string(3 * most_triangles) + " vertices");
        surface_.vertices.push_back(point(1));
      } else if (words_[0] == "f") {
        polygon.clear();
        for (std::size_t k = 1; k < words_.size(); ++k) polygon.push_back(vertex(words_[k]));
        if (polygon.size() < 3) refuse_line("a face must have 3 corners or more");
        if (polygon.size() > 1000) refuse_line("a face must have at most 1000 corners");
        for (const Surface::Triangle& triangle : cut_corners(surface_.vertices, polygon)) {
          expect_room();
          surface_.triangles.push_back(triangle);
          surface_.lines.push_back(line_number_);
        }
      } else if (!std::isalpha(static_cast<unsigned char>(words_[0][0]))) {
        refuse_line(shown(words_[0]) + " is no word of an OBJ file");
      }
    }
  }
  /// The vertex of VERTEX/TEXTURE/NORMAL; negative numbers count back from the last vertex.
  std::int32_t vertex(std::string_view word) const {
    const std::string text(word.substr(0, word.find('/')));
    char* end = nullptr;
    const long long value = std::strtoll(text.c_str(), &end, 10);
    const auto count = static_cast<long long>(surface_.vertices.size());
    if (text.empty() || *end != '\0') refuse_line(shown(word) + " is no corner of a face");
    const long long index = value < 0 ? count + value : value - 1;
    if (index < 0 || index >= count)
      refuse_line("corner " + shown(word) + ": there are " + std::to_string(count) +
                  " vertices above");
    return static_cast<std::int32_t>(index);
  }

  /// Makes one vertex of those at the same coordinates; vertices without a triangle go.
  void merge_corners() {
    const auto& points = surface_.vertices;
    std::vector<std::int32_t> order(points.size()), first_of(points.size(), -1);
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = static_cast<std::int32_t>(k);
    std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
      const Point3 &p = item(points, a), &q = item(points, b);
      return std::array{p.x, p.y, p.z, static_cast<double>(a)} <
             std::array{q.x, q.y, q.z, static_cast<double>(b)};
    });
    std::int32_t first = -1;
    for (const std::int32_t v : order) {
      if (first < 0 || !(item(points, first) == item(points, v))) first = v;
      item(first_of, v) = first;
    }
    std::vector<Point3> kept;
    std::vector<std::int32_t> index(points.size(), -1);
    for (Surface::Triangle& triangle : surface_.triangles) {
      for (std::int32_t& v : triangle) {
        const std::int32_t f = item(first_of, v);
        if (item(index, f) < 0) {
          item(index, f) = static_cast<std::int32_t>(kept.size());
          kept.push_back(item(points, f));
        }
        v = item(index, f);
      }
    }
    surface_.vertices = std::move(kept);
  }

  std::string where_;
  double unit_;
  std::ifstream file_;
  std::uintmax_t size_ = 0;
  Surface surface_;
  std::string line_;
  std::vector<std::string_view> words_;
  std::int32_t line_number_ = 0;
};

}  // namespace

double volume_of(const Surface& surface) {
  if (surface.triangles.empty()) return 0;
  const Point3 apex = item(surface.vertices, surface.triangles.front()[0]);
  double volume6 = 0;
  for (const auto& [a, b, c] : surface.triangles) {
    const Point3 p = item(surface.vertices, a) - apex, q = item(surface.vertices, b) - apex,
                 r = item(surface.vertices, c) - apex;
    volume6 += dot(p, cross(q, r));
  }
  return volume6 / 6;
}

Surface read_surface(const std::string& file, double unit, const std::string& key) {
  return Reader(file, unit, key).surface();
}

}  // namespace floe
