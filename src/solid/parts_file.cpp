#include "solid/parts_file.h"

#include <array>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "base/collectives.h"
#include "base/on_root.h"
#include "files/files.h"
#include "files/hdf5.h"
#include "files/seal.h"
#include "floe/base/petsc.h"
#include "lattice/shapes_file.h"

namespace floe {
namespace {

/// Rises when the same file would be divided otherwise.
constexpr std::uint64_t version_of_parts = 2;

constexpr std::array numbers{"triangles", "volume", "parts_volume", "distance"};

std::array<double, numbers.size()> numbers_of(const ConvexParts& parts) {
  return {static_cast<double>(parts.triangles), parts.volume, parts.parts_volume, parts.distance};
}
void set_numbers(ConvexParts& parts, const std::array<double, numbers.size()>& values) {
  parts.triangles = static_cast<std::int64_t>(values[0]);
  parts.volume = values[1], parts.parts_volume = values[2], parts.distance = values[3];
}

void write(Hdf5File& file, const ConvexParts& parts) {
  write_shapes(file, parts.shapes);
  const auto values = numbers_of(parts);
  for (std::size_t k = 0; k < numbers.size(); ++k) file.attribute("/shapes", numbers[k], values[k]);
}

/// The hash FNV-1a (Fowler, Noll & Vo) with 64 bits.
class Hash {
 public:
  void add(std::string_view bytes) {
    for (const char c : bytes) value_ = (value_ ^ static_cast<unsigned char>(c)) * 1099511628211U;
  }
  void add(std::uint64_t word) {
    for (unsigned k = 0; k < 8; ++k) value_ = (value_ ^ (word >> (8 * k) & 0xffU)) * 1099511628211U;
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 14695981039346656037U;
};

/// The name under which parts are kept; nothing if the solid's file cannot be read.
std::optional<std::string> kept_name(const SolidFile& solid) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(solid.path, error)) return {};
  std::ifstream file(solid.path, std::ios::binary);
  if (!file) return {};
  Hash hash;
  std::uint64_t size = 0;
  std::vector<char> block(1U << 20U);
  while (file.read(block.data(), static_cast<std::streamsize>(block.size())), file.gcount() > 0) {
    hash.add(std::string_view(block.data(), static_cast<std::size_t>(file.gcount())));
    size += static_cast<std::uint64_t>(file.gcount());
  }
  // how the file is read goes by the ending of its name
  hash.add(std::filesystem::path(solid.path).extension().string());
  for (const std::uint64_t word :
       {std::bit_cast<std::uint64_t>(solid.unit), std::bit_cast<std::uint64_t>(solid.tolerance),
        static_cast<std::uint64_t>(solid.most_parts), version_of_parts})
    hash.add(word);
  std::array<char, 64> name{};
  std::snprintf(name.data(), name.size(), "parts_%016llx_%llu.h5",
                static_cast<unsigned long long>(hash.value()),
                static_cast<unsigned long long>(size));
  return name.data();
}

/// Returns the parts that are kept in a file; nothing if it is not there or damaged.
std::optional<ConvexParts> kept(const std::string& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error) || !seal_problem(file).empty()) return {};
  try {
    return read_parts(file, "parts");
  } catch (const InputError&) {
    return {};
  }
}

void keep(const ConvexParts& parts, const std::string& file) {
  std::error_code error;
  std::filesystem::create_directories(std::filesystem::path(file).parent_path(), error);
  if (error) return;
  try {
    remove_left_over(file);
    Hdf5File out = Hdf5File::create(file, seal_size);
    write(out, parts);
    out.close([](const std::string& temporary, const std::string& path) {
      seal(temporary);
      put_in_place(temporary, path);
    });
  } catch (const FileError&) {  // nothing is kept
  }
}

}  // namespace

void write_parts(const ConvexParts& parts, const std::string& file) {
  Hdf5File out = Hdf5File::create(file);
  write(out, parts);
  out.close();
}

ConvexParts read_parts(const std::string& file, const std::string& key) {
  ConvexParts parts;
  parts.shapes = read_polyhedra(file, key);
  const Hdf5File in = Hdf5File::open(file, key);
  std::array<double, numbers.size()> values{};
  for (std::size_t k = 0; k < numbers.size(); ++k)
    values[k] = in.read_attribute("/shapes", numbers[k]);
  set_numbers(parts, values);
  return parts;
}

std::string parts_folder() {
  const auto variable = [](const char* name) {
    const char* value = std::getenv(name);
    return std::filesystem::path(value == nullptr ? "" : value);
  };
  // Relative paths are to be ignored (XDG Base Directory Specification).
  if (const auto cache = variable("XDG_CACHE_HOME"); cache.is_absolute()) return cache / "floe";
  if (const auto home = variable("HOME"); home.is_absolute()) return home / ".cache" / "floe";
  return {};
}

ConvexParts parts_of(const SolidFile& solid, const std::string& key, const std::string& folder) {
  std::string file;
  if (!folder.empty()) {
    if (const auto name = kept_name(solid)) file = std::filesystem::path(folder) / *name;
  }
  if (!file.empty()) {
    if (auto parts = kept(file)) return std::move(*parts);
  }
  const std::string where = key + ": '" + solid.path + "'";
  const Surface surface = read_surface(solid.path, solid.unit, key);
  check_surface(surface, where);
  ConvexParts parts = convex_parts(surface, solid.tolerance, solid.most_parts, where);
  if (!file.empty()) keep(parts, file);
  return parts;
}

ConvexParts parts_of(const SolidFile& solid, const std::string& key, MPI_Comm comm) {
  ConvexParts parts;
  on_root(comm, [&] { parts = parts_of(solid, key, parts_folder()); });
  auto values = numbers_of(parts);
  broadcast(values, comm);
  set_numbers(parts, values);

  Shapes& s = parts.shapes;
  std::vector<double> coordinates;
  for (const Point3& p : s.vertices) coordinates.insert(coordinates.end(), {p.x, p.y, p.z});
  broadcast(coordinates, comm);
  s.vertices.resize(coordinates.size() / 3);
  for (std::size_t k = 0; k < coordinates.size(); ++k) s.vertices[k / 3][k % 3] = coordinates[k];
  for (std::vector<std::int32_t>* indices : {&s.corners, &s.corner_of, &s.face_of, &s.vertex_of}) {
    std::vector<double> exact(indices->begin(), indices->end());
    broadcast(exact, comm);
    indices->resize(exact.size());
    for (std::size_t k = 0; k < exact.size(); ++k)
      (*indices)[k] = static_cast<std::int32_t>(exact[k]);
  }
  return parts;
}

}  // namespace floe
