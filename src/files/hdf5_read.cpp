#include <fcntl.h>
#include <hdf5.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

#include "files/hdf5.h"
#include "files/hdf5_id.h"
#include "floe/base/item.h"
#include "floe/base/petsc.h"

namespace floe {
namespace {

/// While an object of this class lives, the process gets 512 MiB more and then no memory. On some
/// damaged files HDF5 1.10 takes memory without end (one byte of a group was flipped), until the
/// system kills the process; where memory is refused it says that it cannot read. Reading values
/// takes as much as they need, and is not bounded.
class BoundedMemory {
 public:
  BoundedMemory() {
    if (getrlimit(RLIMIT_AS, &before_) != 0) return;
    rlimit bound = before_;
    bound.rlim_cur = std::min<rlim_t>(before_.rlim_cur, address_space() + more);
    is_set_ = setrlimit(RLIMIT_AS, &bound) == 0;
  }
  ~BoundedMemory() {
    if (is_set_) (void)setrlimit(RLIMIT_AS, &before_);
  }
  BoundedMemory(const BoundedMemory&) = delete;
  BoundedMemory& operator=(const BoundedMemory&) = delete;

 private:
  static constexpr rlim_t more = rlim_t{1} << 29;
  /// Returns the address space of the process [bytes]; without /proc a value that bounds nothing.
  static rlim_t address_space() {
    std::ifstream file("/proc/self/statm");
    rlim_t pages = 0;
    if (!(file >> pages)) return RLIM_INFINITY - more;
    return pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
  }

  rlimit before_{};
  bool is_set_ = false;
};

/// Returns why the system cannot read a file; empty if it can. Does not wait for a FIFO.
std::string system_problem(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (file < 0)
    return errno == ENOENT ? "does not exist"
                           : std::string("cannot be read: ") + std::strerror(errno);
  struct stat status {};
  const bool known = ::fstat(file, &status) == 0;
  ::close(file);
  if (!known) return std::string("cannot be read: ") + std::strerror(errno);
  if (S_ISDIR(status.st_mode)) return "is a folder, must be a file";
  if (!S_ISREG(status.st_mode)) return "is not a regular file";
  return status.st_size == 0 ? "is empty, must be an HDF5 file" : "";
}

/// Returns the bytes that a file occupies on disk; the holes of a sparse file occupy none.
double bytes_on_disk(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return 0;
  constexpr double block = 512;  // unit of st_blocks; some file systems report 0 blocks
  const auto size = static_cast<double>(status.st_size);
  return status.st_blocks > 0 ? std::min(size, block * static_cast<double>(status.st_blocks))
                              : size;
}

/// Returns the number of values as a double, because it may exceed an integer.
double values_in(hid_t space) {
  if (H5Sget_simple_extent_type(space) == H5S_NULL) return 0;
  std::array<hsize_t, H5S_MAX_RANK> extent{};
  const int dimensions = H5Sget_simple_extent_dims(space, extent.data(), nullptr);
  double values = 1;
  for (int k = 0; k < dimensions; ++k) values *= static_cast<double>(item(extent, k));
  return values;
}

/// Whether a dataset that fills `bytes` of memory may lie in its file: every chunk has been
/// written, and the file is no smaller than compression could make it.
bool is_stored(hid_t data, hid_t plan, hid_t space, double bytes, double on_disk) {
  constexpr double least_compressed = 1100;  // deflate: at most 1032
  if (bytes > least_compressed * on_disk) return false;
  if (H5Pget_layout(plan) != H5D_CHUNKED)
    return static_cast<double>(H5Dget_storage_size(data)) >= bytes;
  std::array<hsize_t, H5S_MAX_RANK> extent{}, chunk{};
  const int dimensions = H5Sget_simple_extent_dims(space, extent.data(), nullptr);
  if (H5Pget_chunk(plan, dimensions, chunk.data()) != dimensions) return false;
  double needed = 1;
  for (std::size_t k = 0; k < static_cast<std::size_t>(dimensions); ++k)
    needed *= std::ceil(static_cast<double>(extent[k]) / static_cast<double>(chunk[k]));
  hsize_t there = 0;
  return H5Dget_num_chunks(data, space, &there) >= 0 && static_cast<double>(there) >= needed;
}

/// Whether another program has locked the file for writing. HDF5 1.14 does not report this in
/// errno.
bool is_locked(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) return false;
  const bool locked = ::flock(file, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(file);
  return locked;
}

}  // namespace

Hdf5File Hdf5File::open(const std::string& path, const std::string& key) {
  quiet_hdf5();
  const std::string where = key + ": '" + path + "' ";
  if (const std::string problem = system_problem(path); !problem.empty())
    throw InputError(where + problem);
  const Hdf5Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  constexpr bool lock = true, unless_disabled = true;
  H5Pset_file_locking(access, lock, unless_disabled);
  const BoundedMemory bounded;
  const hid_t id = H5Fopen(path.c_str(), H5F_ACC_RDONLY, access);
  if (id >= 0) return {id, path, path, key};
  if (is_locked(path)) throw InputError(where + "is being written by another program");
  throw InputError(where + (H5Fis_hdf5(path.c_str()) > 0 ? "is a damaged or unfinished HDF5 file"
                                                         : "is not an HDF5 file"));
}

std::string Hdf5File::where(const std::string& name) const {
  return key_ + ": '" + path_ + "': " + name;
}

bool Hdf5File::has(const std::string& name) const {
  const BoundedMemory bounded;
  std::string path;
  std::size_t start = 0;
  while (start < name.size()) {  // H5Lexists requires every parent to exist
    const std::size_t slash = name.find('/', start);
    path += "/" + name.substr(start, slash - start);
    if (path != "/") {
      if (H5Lexists(id_, path.c_str(), H5P_DEFAULT) <= 0) return false;
      H5L_info_t link{};
      if (H5Lget_info(id_, path.c_str(), &link, H5P_DEFAULT) < 0 ||
          (link.type != H5L_TYPE_HARD && link.type != H5L_TYPE_SOFT))
        throw InputError(where(path) + " is a link to another file; it must be in this one");
      if (link.type == H5L_TYPE_SOFT && H5Oexists_by_name(id_, path.c_str(), H5P_DEFAULT) <= 0)
        throw InputError(where(path) + " is a link that leads nowhere");
    }
    if (slash == std::string::npos) break;
    start = slash + 1;
  }
  return true;
}

std::vector<std::string> Hdf5File::members(const std::string& group) const {
  const BoundedMemory bounded;
  std::vector<std::string> names;
  const Hdf5Id id(H5Gopen2(id_, group.c_str(), H5P_DEFAULT), H5Gclose);
  if (id < 0) throw InputError(where(group) + " is not a group");
  const auto collect = [](hid_t, const char* name, const H5L_info_t*, void* list) -> herr_t {
    static_cast<std::vector<std::string>*>(list)->emplace_back(name);
    return 0;
  };
  H5Literate(id, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect, &names);
  std::sort(names.begin(), names.end());
  return names;
}

std::int64_t Hdf5File::open_dataset(const std::string& name) const {
  if (!has(name)) throw InputError(where(name) + " is missing");
  const BoundedMemory bounded;
  const hid_t data = H5Dopen2(id_, name.c_str(), H5P_DEFAULT);
  if (data < 0) throw InputError(where(name) + " is not a dataset");
  const auto refuse = [&](const char* why) {
    H5Dclose(data);
    throw InputError(where(name) + why);
  };
  const Hdf5Id plan(H5Dget_create_plist(data), H5Pclose);
  if (H5Pget_layout(plan) == H5D_VIRTUAL)
    refuse(" is a virtual dataset; its values must be in this file");
  if (H5Pget_external_count(plan) > 0) refuse(" has its values in another file");
  const Hdf5Id type(H5Dget_type(data), H5Tclose), space(H5Dget_space(data), H5Sclose);
  const double bytes = values_in(space) * static_cast<double>(H5Tget_size(type));
  const bool in_memory = path_.empty();
  if (bytes > 0 && !in_memory && !is_stored(data, plan, space, bytes, bytes_on_disk(path_)))
    refuse(" has values that its file does not hold: they were never written");
  return data;
}

std::pair<std::int64_t, std::int64_t> Hdf5File::shape(const std::string& name) const {
  const Hdf5Id data(open_dataset(name), H5Dclose);
  const Hdf5Id space(H5Dget_space(data), H5Sclose);
  const int dimensions = H5Sget_simple_extent_ndims(space);
  if (dimensions < 1 || dimensions > 2)
    throw InputError(where(name) + " has " + std::to_string(dimensions) +
                     " dimensions, must have 1 or 2");
  std::array<hsize_t, 2> extent{0, 1};
  H5Sget_simple_extent_dims(space, extent.data(), nullptr);
  constexpr hsize_t most = std::numeric_limits<std::int32_t>::max();  // indices are 32-bit
  if (extent[0] > most || extent[1] > most)
    throw InputError(where(name) + " has shape " + std::to_string(extent[0]) + " x " +
                     std::to_string(extent[1]) + ", at most " + std::to_string(most) +
                     " rows are possible");
  return {static_cast<std::int64_t>(extent[0]), static_cast<std::int64_t>(extent[1])};
}

std::int64_t Hdf5File::rows_of(const std::string& name, int columns) const {
  const auto [rows, actual] = shape(name);
  if (actual != columns)
    throw InputError(where(name) + " has shape " + std::to_string(rows) + " x " +
                     std::to_string(actual) + ", must be n x " + std::to_string(columns));
  return rows;
}

void Hdf5File::read_any(const std::string& name, std::int64_t type, void* values) const {
  const Hdf5Id data(open_dataset(name), H5Dclose);
  const Hdf5Id stored(H5Dget_type(data), H5Tclose);
  const H5T_class_t kind = H5Tget_class(stored);
  const bool wants_integers = type == H5T_NATIVE_INT32;
  if (wants_integers ? kind != H5T_INTEGER : (kind != H5T_INTEGER && kind != H5T_FLOAT))
    throw InputError(where(name) + (wants_integers ? " must hold integers" : " must hold numbers"));
  const Hdf5Id space(H5Dget_space(data), H5Sclose);
  if (H5Sget_simple_extent_npoints(space) > 0 &&
      H5Dread(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0)
    throw InputError(where(name) +
                     " cannot be read: damaged, or packed by a filter that is not here");
}

std::vector<double> Hdf5File::read(const std::string& name, int columns) const {
  std::vector<double> values(static_cast<std::size_t>(rows_of(name, columns) * columns));
  read_any(name, H5T_NATIVE_DOUBLE, values.data());
  return values;
}

std::vector<std::int32_t> Hdf5File::read_indices(const std::string& name, int columns) const {
  std::vector<std::int32_t> values(static_cast<std::size_t>(rows_of(name, columns) * columns));
  read_any(name, H5T_NATIVE_INT32, values.data());
  return values;
}

std::string Hdf5File::read_text(const std::string& name) const {
  const Hdf5Id data(open_dataset(name), H5Dclose);
  const Hdf5Id stored(H5Dget_type(data), H5Tclose), space(H5Dget_space(data), H5Sclose);
  if (H5Tget_class(stored) != H5T_STRING || H5Tis_variable_str(stored) > 0 ||
      H5Sget_simple_extent_npoints(space) != 1)
    throw InputError(where(name) + " is not a text");
  std::string text(H5Tget_size(stored), '\0');
  if (H5Dread(data, stored, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()) < 0)
    throw InputError(where(name) + " cannot be read");
  return text.substr(0, text.find('\0'));
}

double Hdf5File::read_attribute(const std::string& object, const std::string& name) const {
  const BoundedMemory bounded;
  const Hdf5Id target(H5Aopen_by_name(id_, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT),
                      H5Aclose);
  if (target < 0) throw InputError(where(object) + " has no attribute " + name);
  const Hdf5Id stored(H5Aget_type(target), H5Tclose), space(H5Aget_space(target), H5Sclose);
  const H5T_class_t kind = H5Tget_class(stored);
  double value = 0;
  if ((kind != H5T_FLOAT && kind != H5T_INTEGER) || H5Sget_simple_extent_npoints(space) != 1 ||
      H5Aread(target, H5T_NATIVE_DOUBLE, &value) < 0)
    throw InputError(where(object) + ": the attribute " + name + " must be a number");
  return value;
}

}  // namespace floe
