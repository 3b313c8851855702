/// \file
/// HDF5 files as floe uses them: plain datasets, read and written by one process (no parallel
/// driver).
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/files.h"

namespace floe {

/// One open HDF5 file. Files are written under a temporary name that close() puts in its place; a
/// destructor without close() leaves nothing behind. Errors of the system raise FileError; a file
/// the user gave that cannot be used raises InputError, and nothing is read or allocated beyond
/// what the file really holds.
class Hdf5File {
 public:
  /// A new file that will be called `path` once close() has been called.
  /// \param user_block  bytes at its beginning that HDF5 leaves alone: 0, or 512 times a power of 2
  static Hdf5File create(const std::string& path, std::size_t user_block = 0);
  /// A copy of an existing file, to be changed, that takes its place in close().
  static Hdf5File change(const std::string& path);
  /// An existing file, for reading. \param key  the option that named it, for messages
  /// \throws InputError if it cannot be read or is not HDF5.
  static Hdf5File open(const std::string& path, const std::string& key = "lattice_file");

  Hdf5File(Hdf5File&& other) noexcept;
  Hdf5File& operator=(Hdf5File&& other) noexcept;
  Hdf5File(const Hdf5File&) = delete;
  Hdf5File& operator=(const Hdf5File&) = delete;
  ~Hdf5File();

  /// Finishes a file made by create() or change() and puts it in its place.
  void close(Place place = Place::renamed);
  /// The same, and `put(temporary, path)` puts it in its place; if that raises something the
  /// temporary file goes.
  void close(const std::function<void(const std::string& temporary, const std::string& path)>& put);

  /// Writes rows x columns values (columns = 1: a vector); groups in `name` are made as needed.
  void write(const std::string& name, std::span<const double> values, int columns = 1);
  void write(const std::string& name, std::span<const float> values, int columns = 1);
  void write(const std::string& name, std::span<const std::int32_t> values, int columns = 1);
  /// Writes rows that are made block by block, so that they are never all in memory.
  /// \param make  called with the rows' values in order, until all are made: the index of the first
  /// row of the block, and what to fill
  template <class T>
  void write_blocks(const std::string& name, std::int64_t rows, int columns,
                    const std::function<void(std::int64_t, std::span<T>)>& make);
  void attribute(const std::string& object, const std::string& name, double value);
  void write_text(const std::string& name, const std::string& text);

  /// `name` stands for an object of another file, whose path is relative to this one's folder.
  void link(const std::string& name, const std::string& file, const std::string& object);
  void remove(const std::string& name);

  bool has(const std::string& name) const;
  /// Names of the members of a group, sorted.
  std::vector<std::string> members(const std::string& group) const;
  /// Rows and columns (1 for a vector). \throws InputError naming the dataset if it is missing, has
  /// other than one or two dimensions, or has more values than the file holds
  std::pair<std::int64_t, std::int64_t> shape(const std::string& name) const;
  /// All values of a dataset, row-major. \throws InputError if it is missing or has another number
  /// of columns.
  std::vector<double> read(const std::string& name, int columns = 1) const;
  std::vector<std::int32_t> read_indices(const std::string& name, int columns = 1) const;
  std::string read_text(const std::string& name) const;
  double read_attribute(const std::string& object, const std::string& name) const;

 private:
  Hdf5File(std::int64_t id, std::string path, std::string final_path, std::string key = {})
      : id_(id), path_(std::move(path)), final_path_(std::move(final_path)), key_(std::move(key)) {}
  /// The dataset, open, once it is known to lie in this file with all its values.
  std::int64_t open_dataset(const std::string& name) const;
  std::int64_t create_dataset(const std::string& name, std::int64_t rows, int columns,
                              std::int64_t type);
  void write_any(const std::string& name, const void* values, std::int64_t count, int columns,
                 std::int64_t type);
  /// The file and `name` in it, for messages.
  std::string where(const std::string& name) const;
  std::int64_t rows_of(const std::string& name, int columns) const;
  void read_any(const std::string& name, std::int64_t type, void* values) const;

  std::int64_t id_ = -1;
  std::string path_, final_path_, key_;
};

}  // namespace floe
