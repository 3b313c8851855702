#include "scene_model/thickness.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <sstream>
#include <string>

#include "files/hdf5.h"
#include "floe/base/item.h"
#include "floe/base/petsc.h"
#include "floe/geometry/polyhedron.h"
#include "options/option_values.h"
#include "options/text_file.h"
#include "scene/reading.h"

namespace floe {
namespace {

constexpr auto key = "sheet: thickness_file";
constexpr double least_thickness = 1e-9, most_thickness = 1e9;  // as of sheet: thickness [m]

/// Thicknesses at the points of a grid: row-major, a row for each y.
struct Grid {
  std::string file;
  std::vector<double> x, y, thickness;

  [[noreturn]] void refuse(const std::string& why) const {
    throw InputError(std::string(key) + ": '" + file + "': " + why);
  }
  /// Puts falling values of x or y, as maps from north to south have them, into rising order.
  void turn() {
    const std::size_t n = x.size();
    if (n > 1 && x.front() > x.back()) {
      std::reverse(x.begin(), x.end());
      for (std::size_t k = 0; k < thickness.size(); k += n)
        std::reverse(&thickness[k], &thickness[k] + n);
    }
    if (y.size() > 1 && y.front() > y.back()) {
      std::reverse(y.begin(), y.end());
      for (std::size_t k = 0; k < y.size() / 2; ++k)
        std::swap_ranges(&thickness[k * n], &thickness[k * n] + n,
                         &thickness[(y.size() - 1 - k) * n]);
    }
  }
  void check() const {
    const auto rises = [](const std::vector<double>& values) {
      return std::adjacent_find(values.begin(), values.end(),
                                [](double a, double b) { return !(a < b); }) == values.end();
    };
    for (const auto& [name, values] : {std::pair("x", &x), std::pair("y", &y)}) {
      if (values->size() < 2) refuse(std::string("needs two values of ") + name + " at least");
      if (!rises(*values)) refuse(std::string("values of ") + name + " must rise or fall");
    }
    for (std::size_t k = 0; k < thickness.size(); ++k) {
      if (!(thickness[k] >= least_thickness && thickness[k] <= most_thickness))
        refuse("thickness " + text_of(thickness[k]) + " at x = " + text_of(x[k % x.size()]) +
               ", y = " + text_of(y[k / x.size()]) + " must be >= 1e-9, <= 1e9 [m]");
    }
  }
  /// Linear in x and y between the points of the grid.
  double at(const Point2& p) const {
    const auto place = [&](const std::vector<double>& values, double v, const char* name) {
      if (!(v >= values.front() && v <= values.back()))
        refuse(std::string("reaches from ") + name + " = " + text_of(values.front()) + " to " +
               text_of(values.back()) + " m, and the sheet has a cell at " + name + " = " +
               text_of(v));
      const auto above = std::upper_bound(values.begin() + 1, values.end() - 1, v);
      const auto k = static_cast<std::size_t>(above - values.begin()) - 1;
      return std::pair(k, (v - values[k]) / (values[k + 1] - values[k]));
    };
    const auto [i, u] = place(x, p[0], "x");
    const auto [j, v] = place(y, p[1], "y");
    const double* low = &thickness[j * x.size() + i];
    const double* high = low + x.size();
    return (1 - v) * ((1 - u) * low[0] + u * low[1]) + v * ((1 - u) * high[0] + u * high[1]);
  }
};

/// Reads rows of numbers: first any word and the values of x, then each y and its thicknesses.
Grid read_csv(const std::string& path) {
  Grid grid{path, {}, {}, {}};
  constexpr std::size_t largest = 1'000'000'000;  // [B]
  std::istringstream in(
      read_text_file(std::string(key) + ": '" + path + "'", path, largest, PETSC_COMM_WORLD));
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.find_first_not_of(" \t\r,") == std::string::npos || line.front() == '#') continue;
    std::istringstream words(line);
    std::vector<double> row;
    std::string word;
    const bool head = grid.x.empty();
    for (bool first = true; std::getline(words, word, ','); first = false) {
      if (head && first) continue;
      const std::optional<double> value = to_number(word);
      if (!value)
        grid.refuse("line " + std::to_string(number) + ": '" + word.substr(0, 40) +
                    "' is not a number");
      row.push_back(*value);
    }
    if (head) {
      if (row.empty())
        grid.refuse("the first line must be a word, then the values of x, separated by commas");
      grid.x = row;
      continue;
    }
    if (row.size() != grid.x.size() + 1)
      grid.refuse("line " + std::to_string(number) + " has " + std::to_string(row.size()) +
                  " numbers, y and a thickness for each x are " +
                  std::to_string(grid.x.size() + 1));
    grid.y.push_back(row.front());
    grid.thickness.insert(grid.thickness.end(), row.begin() + 1, row.end());
  }
  if (grid.x.empty()) grid.refuse("is empty");
  return grid;
}

/// Reads the datasets x, y and thickness (a row for each y) of an HDF5 file; netCDF-4 is HDF5.
Grid read_hdf5(const std::string& path) {
  const Hdf5File file = Hdf5File::open(path, key);
  Grid grid{path, file.read("x"), file.read("y"), {}};
  const auto [rows, columns] = file.shape("thickness");
  const auto nx = static_cast<std::int64_t>(grid.x.size()),
             ny = static_cast<std::int64_t>(grid.y.size());
  if (rows != ny || columns != nx)
    grid.refuse("thickness has " + std::to_string(rows) + " x " + std::to_string(columns) +
                " values, y and x have " + std::to_string(ny) + " and " + std::to_string(nx));
  grid.thickness = file.read("thickness", static_cast<int>(columns));
  return grid;
}

Grid read_grid(const std::string& path) {
  const bool table = path.size() > 4 && path.compare(path.size() - 4, 4, ".csv") == 0;
  Grid grid = table ? read_csv(path) : read_hdf5(path);
  grid.turn();
  grid.check();
  return grid;
}

/// A lognormal field h = mean exp(s g - s^2/2), s^2 = ln(1 + (deviation/mean)^2), of a normal field
/// g with the covariance exp(-(dx/L_x)^2/2 - (dy/L_y)^2/2), as a sum of cosines (randomisation
/// method: Kraichnan 1970; Shinozuka & Deodatis 1996): g = sqrt(2/n) sum cos(k.x + phi), k_x L_x
/// and k_y L_y normal, phi uniform. So the field is a function of place, whatever the mesh.
class RandomField {
 public:
  RandomField(double mean, const ThicknessField& options)
      : s_(std::sqrt(std::log1p(options.deviation / mean * options.deviation / mean))),
        scale_(mean * std::exp(-0.5 * s_ * s_)) {
    constexpr double tau = 2 * std::numbers::pi;
    std::mt19937_64 engine(options.seed);
    // 53 random bits in (0, 1], the same with every standard library
    const auto uniform = [&] { return (static_cast<double>(engine() >> 11) + 1) * 0x1p-53; };
    for (auto& [kx, ky, phase] : modes_) {
      const double r = std::sqrt(-2 * std::log(uniform())), angle = tau * uniform();  // Box-Muller
      kx = r * std::cos(angle) / options.correlation[0];
      ky = r * std::sin(angle) / options.correlation[1];
      phase = tau * uniform();
    }
  }
  double at(const Point2& p) const {
    double sum = 0;
    for (const auto& [kx, ky, phase] : modes_) sum += std::cos(kx * p[0] + ky * p[1] + phase);
    return scale_ * std::exp(s_ * std::sqrt(2.0 / modes) * sum);
  }

 private:
  static constexpr std::size_t modes = 512;
  struct Mode {
    double kx, ky, phase;
  };
  std::array<Mode, modes> modes_{};
  double s_, scale_;
};

std::span<const Point2> polygon(const Tessellation& cells, std::size_t k) {
  return {cells.vertices.data() + cells.offset[k], cells.vertices.data() + cells.offset[k + 1]};
}

}  // namespace

std::vector<double> thickness_of_cells(const Scene& scene, const Tessellation& cells,
                                       const std::vector<std::int32_t>& polygon_of) {
  std::vector<double> all;
  const ThicknessField& field = scene.thickness_field;
  if (!field.varies()) return all;
  const bool is_field = !field.file.empty() || field.deviation > 0;
  if (!field.of_polygon.empty() && !is_field) {
    for (const std::int32_t k : polygon_of) all.push_back(item(field.of_polygon, k));
    return all;
  }
  const auto fill = [&](const auto& source) {
    for (std::size_t k = 0; k < cells.generators.size(); ++k) {
      const double own = field.of_polygon.empty() ? NAN : item(field.of_polygon, polygon_of[k]);
      all.push_back(std::isnan(own) ? source.at(plan_properties(polygon(cells, k)).centroid) : own);
    }
  };
  field.file.empty() ? fill(RandomField(scene.thickness, field)) : fill(read_grid(field.file));
  return all;
}

ThicknessReport thickness_report(const Tessellation& cells, const std::vector<double>& thickness) {
  ThicknessReport report{thickness.front(), 0, thickness.front(), 0};
  double area = 0, square = 0;
  for (std::size_t k = 0; k < thickness.size(); ++k) {
    const double a = plan_properties(polygon(cells, k)).area, h = thickness[k];
    area += a, report.mean += a * h;
    report.least = std::min(report.least, h), report.most = std::max(report.most, h);
  }
  report.mean /= area;
  for (std::size_t k = 0; k < thickness.size(); ++k) {
    const double from = thickness[k] - report.mean;
    square += plan_properties(polygon(cells, k)).area * from * from;
  }
  report.deviation = std::sqrt(square / area);
  return report;
}

}  // namespace floe
