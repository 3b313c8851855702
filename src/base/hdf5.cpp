#include "floe/base/hdf5.h"

#include <hdf5.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "floe/base/files.h"
#include "floe/base/petsc.h"

namespace floe {
namespace {

/// Whether HDF5 could not write something. It may crash where what is left of that is closed: from
/// then on nothing is closed any more, as the run is at its end.
bool has_failed = false;  // NOLINT: state of the library

/// Closes an HDF5 identifier of any kind at the end of a scope.
class Id {
 public:
  Id(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Id() {
    if (id_ >= 0 && !has_failed) close_(id_);
  }
  Id(const Id&) = delete;
  Id& operator=(const Id&) = delete;
  operator hid_t() const { return id_; }  // NOLINT: HDF5 calls take the bare identifier

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

void require(bool good, const std::string& what, const std::string& path) {
  if (good) return;
  const int why = errno;  // HDF5 keeps what the system said
  has_failed = true;
  give_up_on_mpi();  // HDF5 closes everything when MPI ends
  std::string named = path;
  if (path.ends_with(temporary_ending)) {
    std::remove(path.c_str());
    named = path.substr(0, path.size() - temporary_name("").size());
  }
  throw FileError("cannot " + what + " " + named + (why != 0 ? ": " : "") +
                  (why != 0 ? std::strerror(why) : ""));
}

template <class T>
hid_t native();
template <>
hid_t native<double>() {
  return H5T_NATIVE_DOUBLE;
}
template <>
hid_t native<float>() {
  return H5T_NATIVE_FLOAT;
}
template <>
hid_t native<std::int32_t>() {
  return H5T_NATIVE_INT32;
}

/// Before the first call of HDF5: it prints nothing, and leaves files that it could not write alone
/// when the process ends.
void quiet() {
  static const bool once = H5dont_atexit() >= 0;
  (void)once;
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

}  // namespace

Hdf5File Hdf5File::create(const std::string& path, std::uintmax_t room) {
  quiet();
  const std::string temporary = temporary_name(path);
  std::error_code unknown;
  const auto folder = std::filesystem::absolute(path).parent_path();
  const auto space = std::filesystem::space(folder, unknown);
  if (!unknown && space.available < room) {
    errno = ENOSPC;
    require(false, "write", temporary);
  }
  const hid_t id = H5Fcreate(temporary.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  require(id >= 0, "create", temporary);
  return {id, temporary, path};
}

Hdf5File Hdf5File::create_growing(const std::string& path) {
  quiet();
  const hid_t id = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  require(id >= 0, "create", path);
  return {id, path, path};
}

Hdf5File Hdf5File::open_growing(const std::string& path) {
  quiet();
  const hid_t id = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  require(id >= 0, "open", path);
  return {id, path, path};
}

Hdf5File Hdf5File::open(const std::string& path, const std::string& key) {
  quiet();
  if (!std::filesystem::is_regular_file(path))
    throw InputError(key + ": '" + path + "' does not exist or is not a regular file");
  const hid_t id = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (id < 0) throw InputError(key + ": '" + path + "' is not an HDF5 file");
  return {id, path, path, key};
}

Hdf5File::Hdf5File(Hdf5File&& other) noexcept
    : id_(std::exchange(other.id_, -1)),
      path_(std::move(other.path_)),
      final_path_(std::move(other.final_path_)),
      key_(std::move(other.key_)),
      staged_(std::exchange(other.staged_, -1)),
      staged_name_(std::move(other.staged_name_)) {}

Hdf5File& Hdf5File::operator=(Hdf5File&& other) noexcept {
  std::swap(id_, other.id_);
  std::swap(path_, other.path_);
  std::swap(final_path_, other.final_path_);
  std::swap(key_, other.key_);
  std::swap(staged_, other.staged_);
  std::swap(staged_name_, other.staged_name_);
  return *this;
}

Hdf5File::~Hdf5File() {
  if (id_ < 0) return;
  if (staged_ >= 0 && !has_failed) H5Gclose(staged_);
  if (!has_failed) H5Fclose(id_);
  if (path_ != final_path_) std::remove(path_.c_str());
}

void Hdf5File::close() {
  if (id_ < 0) return;
  errno = 0;
  require(H5Fclose(std::exchange(id_, -1)) >= 0, "write", path_);
  if (path_ == final_path_) return;
  errno = 0;
  require(std::rename(path_.c_str(), final_path_.c_str()) == 0, "write", path_);
}

void Hdf5File::flush() {
  errno = 0;
  require(H5Fflush(id_, H5F_SCOPE_GLOBAL) >= 0, "write", path_);
}

void Hdf5File::stage(const std::string& group) {
  errno = 0;
  staged_ = H5Gcreate_anon(id_, H5P_DEFAULT, H5P_DEFAULT);
  require(staged_ >= 0, "write " + group + " to", path_);
  staged_name_ = group;
}

void Hdf5File::publish() {
  flush();  // all of the group is on disk before the file knows of it
  require(H5Olink(staged_, id_, staged_name_.c_str(), H5P_DEFAULT, H5P_DEFAULT) >= 0,
          "write " + staged_name_ + " to", path_);
  H5Gclose(std::exchange(staged_, -1));
  staged_name_.clear();
  flush();
}

void Hdf5File::copy(const Hdf5File& from, const std::string& name) {
  errno = 0;
  require(H5Ocopy(from.id_, name.c_str(), id_, name.c_str(), H5P_DEFAULT, H5P_DEFAULT) >= 0,
          "copy " + name + " to", path_);
}

std::pair<std::int64_t, std::string> Hdf5File::place(const std::string& name) const {
  if (staged_ < 0 || name.rfind(staged_name_, 0) != 0) return {id_, name};
  return {staged_, name == staged_name_ ? "." : name.substr(staged_name_.size() + 1)};
}

std::int64_t Hdf5File::create_dataset(const std::string& name, std::int64_t rows, int columns,
                                      std::int64_t type) {
  const std::array<hsize_t, 2> extent{static_cast<hsize_t>(rows), static_cast<hsize_t>(columns)};
  const Id space(H5Screate_simple(columns == 1 ? 1 : 2, extent.data(), nullptr), H5Sclose);
  const Id links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(links, 1);
  const auto [where, relative] = place(name);
  errno = 0;
  const hid_t data =
      H5Dcreate2(where, relative.c_str(), type, space, links, H5P_DEFAULT, H5P_DEFAULT);
  require(data >= 0, "write " + name + " to", path_);
  return data;
}

void Hdf5File::write_any(const std::string& name, const void* values, std::int64_t count,
                         int columns, std::int64_t type) {
  const Id data(create_dataset(name, count / columns, columns, type), H5Dclose);
  if (count > 0)
    require(H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0,
            "write " + name + " to", path_);
}

template <class T>
void Hdf5File::write_blocks(const std::string& name, std::int64_t rows, int columns,
                            const std::function<void(std::int64_t, std::span<T>)>& make) {
  constexpr std::int64_t block = 1 << 14;  // rows: stays in the cache
  const std::int64_t type = native<T>();
  const Id data(create_dataset(name, rows, columns, type), H5Dclose);
  const Id file(H5Dget_space(data), H5Sclose);
  std::vector<T> values;
  for (std::int64_t first = 0; first < rows; first += block) {
    const std::int64_t count = std::min(block, rows - first);
    values.resize(static_cast<std::size_t>(count * columns));
    make(first, values);
    const std::array<hsize_t, 2> start{static_cast<hsize_t>(first), 0},
        extent{static_cast<hsize_t>(count), static_cast<hsize_t>(columns)};
    const Id memory(H5Screate_simple(columns == 1 ? 1 : 2, extent.data(), nullptr), H5Sclose);
    require(H5Sselect_hyperslab(file, H5S_SELECT_SET, start.data(), nullptr, extent.data(),
                                nullptr) >= 0 &&
                H5Dwrite(data, type, memory, file, H5P_DEFAULT, values.data()) >= 0,
            "write " + name + " to", path_);
  }
}
template void Hdf5File::write_blocks(const std::string&, std::int64_t, int,
                                     const std::function<void(std::int64_t, std::span<double>)>&);
template void Hdf5File::write_blocks(const std::string&, std::int64_t, int,
                                     const std::function<void(std::int64_t, std::span<float>)>&);
template void Hdf5File::write_blocks(
    const std::string&, std::int64_t, int,
    const std::function<void(std::int64_t, std::span<std::int32_t>)>&);

void Hdf5File::write(const std::string& name, std::span<const double> values, int columns) {
  write_any(name, values.data(), static_cast<std::int64_t>(values.size()), columns,
            native<double>());
}
void Hdf5File::write(const std::string& name, std::span<const float> values, int columns) {
  write_any(name, values.data(), static_cast<std::int64_t>(values.size()), columns,
            native<float>());
}
void Hdf5File::write(const std::string& name, std::span<const std::int32_t> values, int columns) {
  write_any(name, values.data(), static_cast<std::int64_t>(values.size()), columns,
            native<std::int32_t>());
}

void Hdf5File::attribute(const std::string& object, const std::string& name, double value) {
  const auto [where, relative] = place(object);
  errno = 0;
  const Id target(H5Oopen(where, relative.c_str(), H5P_DEFAULT), H5Oclose);
  const Id space(H5Screate(H5S_SCALAR), H5Sclose);
  const Id attribute(
      H5Acreate2(target, name.c_str(), H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT),
      H5Aclose);
  require(attribute >= 0 && H5Awrite(attribute, H5T_NATIVE_DOUBLE, &value) >= 0,
          "write attribute " + name + " to", path_);
}

void Hdf5File::write_text(const std::string& name, const std::string& text) {
  errno = 0;
  const Id type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, text.size() + 1);
  const Id space(H5Screate(H5S_SCALAR), H5Sclose);
  const Id links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(links, 1);
  const Id data(H5Dcreate2(id_, name.c_str(), type, space, links, H5P_DEFAULT, H5P_DEFAULT),
                H5Dclose);
  require(data >= 0 && H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str()) >= 0,
          "write " + name + " to", path_);
}

std::string Hdf5File::read_text(const std::string& name) const {
  const std::string where = key_ + ": '" + path_ + "': " + name;
  if (!has(name)) throw InputError(where + " is missing");
  const Id data(H5Dopen2(id_, name.c_str(), H5P_DEFAULT), H5Dclose);
  const Id stored(H5Dget_type(data), H5Tclose);
  if (H5Tget_class(stored) != H5T_STRING || H5Tis_variable_str(stored) > 0)
    throw InputError(where + " is not a text");
  std::string text(H5Tget_size(stored), '\0');
  if (H5Dread(data, stored, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()) < 0)
    throw InputError(where + " cannot be read");
  return text.substr(0, text.find('\0'));
}

double Hdf5File::read_attribute(const std::string& object, const std::string& name) const {
  const Id target(H5Aopen_by_name(id_, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT),
                  H5Aclose);
  double value = 0;
  if (target < 0 || H5Aread(target, H5T_NATIVE_DOUBLE, &value) < 0)
    throw InputError(key_ + ": '" + path_ + "': " + object + " has no attribute " + name);
  return value;
}

bool Hdf5File::has(const std::string& name) const {
  std::string path;
  std::size_t start = 0;
  while (start < name.size()) {  // H5Lexists wants every parent to exist
    const std::size_t slash = name.find('/', start);
    path += "/" + name.substr(start, slash - start);
    if (path != "/" && H5Lexists(id_, path.c_str(), H5P_DEFAULT) <= 0) return false;
    if (slash == std::string::npos) break;
    start = slash + 1;
  }
  return true;
}

std::vector<std::string> Hdf5File::members(const std::string& group) const {
  std::vector<std::string> names;
  const Id id(H5Gopen2(id_, group.c_str(), H5P_DEFAULT), H5Gclose);
  if (id < 0) throw InputError(key_ + ": '" + path_ + "': " + group + " is not a group");
  const auto collect = [](hid_t, const char* name, const H5L_info_t*, void* list) -> herr_t {
    static_cast<std::vector<std::string>*>(list)->emplace_back(name);
    return 0;
  };
  H5Literate(id, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect, &names);
  std::sort(names.begin(), names.end());
  return names;
}

std::pair<std::int64_t, std::int64_t> Hdf5File::shape(const std::string& name) const {
  const std::string where = key_ + ": '" + path_ + "': " + name;
  if (!has(name)) throw InputError(where + " is missing");
  const Id data(H5Dopen2(id_, name.c_str(), H5P_DEFAULT), H5Dclose);
  if (data < 0) throw InputError(where + " is not a dataset");
  const Id space(H5Dget_space(data), H5Sclose);
  const int dimensions = H5Sget_simple_extent_ndims(space);
  if (dimensions < 1 || dimensions > 2)
    throw InputError(where + " has " + std::to_string(dimensions) +
                     " dimensions, must have 1 or 2");
  std::array<hsize_t, 2> extent{0, 1};
  H5Sget_simple_extent_dims(space, extent.data(), nullptr);
  return {static_cast<std::int64_t>(extent[0]), static_cast<std::int64_t>(extent[1])};
}

void Hdf5File::read_any(const std::string& name, int columns, std::int64_t type,
                        void* values) const {
  const std::string where = key_ + ": '" + path_ + "': " + name;
  const auto [rows, actual] = shape(name);
  if (actual != columns)
    throw InputError(where + " has shape " + std::to_string(rows) + " x " + std::to_string(actual) +
                     ", must be n x " + std::to_string(columns));
  const Id data(H5Dopen2(id_, name.c_str(), H5P_DEFAULT), H5Dclose);
  const Id stored(H5Dget_type(data), H5Tclose);
  const H5T_class_t kind = H5Tget_class(stored);
  const bool wants_integers = type == H5T_NATIVE_INT32;
  if (wants_integers ? kind != H5T_INTEGER : (kind != H5T_INTEGER && kind != H5T_FLOAT))
    throw InputError(where + (wants_integers ? " must hold integers" : " must hold numbers"));
  if (rows > 0 && H5Dread(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0)
    throw InputError(where + " cannot be read");
}

std::vector<double> Hdf5File::read(const std::string& name, int columns) const {
  const auto [rows, actual] = shape(name);
  std::vector<double> values(static_cast<std::size_t>(rows * actual));
  read_any(name, columns, H5T_NATIVE_DOUBLE, values.data());
  return values;
}

std::vector<std::int32_t> Hdf5File::read_indices(const std::string& name, int columns) const {
  const auto [rows, actual] = shape(name);
  std::vector<std::int32_t> values(static_cast<std::size_t>(rows * actual));
  read_any(name, columns, H5T_NATIVE_INT32, values.data());
  return values;
}

}  // namespace floe
