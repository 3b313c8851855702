#include "files/hdf5.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include "files/files.h"
#include "files/hdf5_id.h"
#include "floe/base/petsc.h"

namespace floe {
namespace {

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

/// Notes that HDF5 could not write a file. HDF5 would try again, and crash, when MPI ends.
void give_up_on_hdf5() {
  hdf5_has_failed = true;
  give_up_on_mpi();
}

/// Throws FileError if HDF5 failed; errno holds the error of the system.
void require(bool good, const std::string& path) {
  if (good) return;
  const int why = errno;
  give_up_on_hdf5();
  throw_file_error("write", path, why);
}

/// Copies a file. Returns errno after a failure, else 0.
int copy_file(const std::string& from, const std::string& to) {
  const int in = ::open(from.c_str(), O_RDONLY | O_CLOEXEC);
  const int out = ::open(to.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  std::vector<char> block(1 << 18);
  int error = in < 0 || out < 0 ? errno : 0;
  for (::ssize_t size = 1; error == 0 && size != 0;) {
    size = ::read(in, block.data(), block.size());
    if (size < 0 && errno == EINTR) continue;
    const auto good = static_cast<std::size_t>(std::max<::ssize_t>(size, 0));
    if (size < 0 || !write_all(out, {block.data(), good})) error = errno;
  }
  if (in >= 0) ::close(in);
  if (out >= 0 && ::close(out) != 0 && error == 0) error = errno;
  return error;
}

/// Returns access without a lock: no other process writes under a temporary name, and some file
/// systems have no locks.
Hdf5Id unlocked() {
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  constexpr bool lock = false, unless_disabled = true;
  H5Pset_file_locking(access, lock, unless_disabled);
  return {access, H5Pclose};
}

}  // namespace

Hdf5File Hdf5File::create(const std::string& path, std::size_t user_block) {
  quiet_hdf5();
  const std::string temporary = temporary_name(path);
  const Hdf5Id plan(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  H5Pset_userblock(plan, user_block);
  errno = 0;
  const hid_t id = H5Fcreate(temporary.c_str(), H5F_ACC_TRUNC, plan, unlocked());
  require(id >= 0, path);
  return {id, temporary, path};
}

Hdf5File Hdf5File::in_memory() {
  quiet_hdf5();
  const Hdf5Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  constexpr std::size_t growth = 1 << 20;  // bytes
  constexpr bool on_disk = false;
  H5Pset_fapl_core(access, growth, on_disk);
  // No file has such a name. HDF5 tells open files apart by their names.
  static std::int64_t number = 0;
  const std::string name = "(state in memory " + std::to_string(number++) + ")";
  const hid_t id = H5Fcreate(name.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access);
  require(id >= 0, name);
  return {id, {}, name};
}

Hdf5File Hdf5File::change(const std::string& path) {
  quiet_hdf5();
  const std::string temporary = temporary_name(path);
  errno = copy_file(path, temporary);
  hid_t id = -1;
  if (errno == 0) id = H5Fopen(temporary.c_str(), H5F_ACC_RDWR, unlocked());
  if (id < 0) {
    const int why = errno;
    ::unlink(temporary.c_str());
    throw_file_error("write", path, why);
  }
  return {id, temporary, path};
}

Hdf5File::Hdf5File(Hdf5File&& other) noexcept
    : id_(std::exchange(other.id_, -1)),
      path_(std::move(other.path_)),
      final_path_(std::move(other.final_path_)),
      key_(std::move(other.key_)) {}

Hdf5File& Hdf5File::operator=(Hdf5File&& other) noexcept {
  std::swap(id_, other.id_);
  std::swap(path_, other.path_);
  std::swap(final_path_, other.final_path_);
  std::swap(key_, other.key_);
  return *this;
}

Hdf5File::~Hdf5File() {
  int ended = 0;
  MPI_Finalized(&ended);
  if (ended != 0) return;  // it has closed whatever HDF5 had open
  if (id_ >= 0 && !hdf5_has_failed && H5Fclose(id_) < 0) give_up_on_hdf5();
  if (!path_.empty() && path_ != final_path_) ::unlink(path_.c_str());
}

void Hdf5File::close(Place place) {
  errno = 0;
  require(H5Fclose(std::exchange(id_, -1)) >= 0, final_path_);
  put_in_place(std::exchange(path_, {}), final_path_, place);
}

void Hdf5File::close(
    const std::function<void(const std::string& temporary, const std::string& path)>& put) {
  errno = 0;
  require(H5Fclose(std::exchange(id_, -1)) >= 0, final_path_);
  put(path_, final_path_);
  path_.clear();
}

void Hdf5File::link(const std::string& name, const std::string& file, const std::string& object) {
  errno = 0;
  require(H5Lcreate_external(file.c_str(), object.c_str(), id_, name.c_str(), H5P_DEFAULT,
                             H5P_DEFAULT) >= 0,
          final_path_);
}

void Hdf5File::remove(const std::string& name) {
  errno = 0;
  require(H5Ldelete(id_, name.c_str(), H5P_DEFAULT) >= 0, final_path_);
}

std::int64_t Hdf5File::create_dataset(const std::string& name, std::int64_t rows, int columns,
                                      std::int64_t type) {
  const std::array<hsize_t, 2> extent{static_cast<hsize_t>(rows), static_cast<hsize_t>(columns)};
  const Hdf5Id space(H5Screate_simple(columns == 1 ? 1 : 2, extent.data(), nullptr), H5Sclose);
  const Hdf5Id links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(links, 1);
  errno = 0;
  const hid_t data = H5Dcreate2(id_, name.c_str(), type, space, links, H5P_DEFAULT, H5P_DEFAULT);
  require(data >= 0, final_path_);
  return data;
}

void Hdf5File::write_any(const std::string& name, const void* values, std::int64_t count,
                         int columns, std::int64_t type) {
  const Hdf5Id data(create_dataset(name, count / columns, columns, type), H5Dclose);
  if (count > 0)
    require(H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0, final_path_);
}

template <class T>
void Hdf5File::write_blocks(const std::string& name, std::int64_t rows, int columns,
                            const std::function<void(std::int64_t, std::span<T>)>& make) {
  constexpr std::int64_t block = 1 << 14;  // rows; one block stays in the cache
  const std::int64_t type = native<T>();
  const Hdf5Id data(create_dataset(name, rows, columns, type), H5Dclose);
  const Hdf5Id file(H5Dget_space(data), H5Sclose);
  std::vector<T> values;
  for (std::int64_t first = 0; first < rows; first += block) {
    const std::int64_t count = std::min(block, rows - first);
    values.resize(static_cast<std::size_t>(count * columns));
    make(first, values);
    const std::array<hsize_t, 2> start{static_cast<hsize_t>(first), 0},
        extent{static_cast<hsize_t>(count), static_cast<hsize_t>(columns)};
    const Hdf5Id memory(H5Screate_simple(columns == 1 ? 1 : 2, extent.data(), nullptr), H5Sclose);
    require(H5Sselect_hyperslab(file, H5S_SELECT_SET, start.data(), nullptr, extent.data(),
                                nullptr) >= 0 &&
                H5Dwrite(data, type, memory, file, H5P_DEFAULT, values.data()) >= 0,
            final_path_);
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
void Hdf5File::write(const std::string& name, std::span<const Vec3<double>> vectors) {
  const auto values = reinterpret_cast<const double*>(vectors.data());
  write(name, std::span(values, 3 * vectors.size()), 3);
}

void Hdf5File::attribute(const std::string& object, const std::string& name, double value) {
  errno = 0;
  const Hdf5Id target(H5Oopen(id_, object.c_str(), H5P_DEFAULT), H5Oclose);
  const Hdf5Id space(H5Screate(H5S_SCALAR), H5Sclose);
  const Hdf5Id attribute(
      H5Acreate2(target, name.c_str(), H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT),
      H5Aclose);
  require(attribute >= 0 && H5Awrite(attribute, H5T_NATIVE_DOUBLE, &value) >= 0, final_path_);
}

void Hdf5File::write_text(const std::string& name, const std::string& text) {
  errno = 0;
  const Hdf5Id type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, text.size() + 1);
  const Hdf5Id space(H5Screate(H5S_SCALAR), H5Sclose);
  const Hdf5Id links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(links, 1);
  const Hdf5Id data(H5Dcreate2(id_, name.c_str(), type, space, links, H5P_DEFAULT, H5P_DEFAULT),
                    H5Dclose);
  require(data >= 0 && H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str()) >= 0,
          final_path_);
}

}  // namespace floe
