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

#include "files/files.h"
#include "floe/base/rotation.h"

namespace floe {

/// One open HDF5 file. A file is written under a temporary name and renamed by close(); destruction
/// without close() removes it. Errors of the system raise FileError. An unusable file of the user
/// raises InputError, and no more is read or allocated than the file really holds.
class Hdf5File {
 public:
  /// Creates a file that close() renames to `path`.
  /// \param user_block  bytes at its beginning that HDF5 leaves alone: 0, or 512 times a power of 2
  static Hdf5File create(const std::string& path, std::size_t user_block = 0);
  /// Creates a file in memory, which goes with the object; for reading too.
  static Hdf5File in_memory();
  /// Opens a copy of an existing file for changes; close() renames the copy to `path`.
  static Hdf5File change(const std::string& path);
  /// Opens an existing file for reading.
  /// \param key  the option that named the file, for messages
  /// \throws InputError if the file cannot be read or is not HDF5
  static Hdf5File open(const std::string& path, const std::string& key = "lattice_file");

  Hdf5File(Hdf5File&& other) noexcept;
  Hdf5File& operator=(Hdf5File&& other) noexcept;
  Hdf5File(const Hdf5File&) = delete;
  Hdf5File& operator=(const Hdf5File&) = delete;
  ~Hdf5File();

  /// Finishes a file of create() or change() and renames it to its path.
  void close(Place place = Place::renamed);
  /// As above, but `put(temporary, path)` does the renaming. If `put` throws, the temporary file is
  /// removed.
  void close(const std::function<void(const std::string& temporary, const std::string& path)>& put);

  /// Write a dataset of rows x `columns` values, row-major (1 column: a vector), and make the
  /// groups in `name`.
  void write(const std::string& name, std::span<const double> values, int columns = 1);
  void write(const std::string& name, std::span<const float> values, int columns = 1);
  void write(const std::string& name, std::span<const std::int32_t> values, int columns = 1);
  /// Writes a dataset of one row x y z per vector.
  void write(const std::string& name, std::span<const Vec3<double>> vectors);
  /// Writes rows that are made block by block, so that only one block is in memory.
  /// \param make  called for each block in order, with the index of its first row and the values to
  /// fill
  template <class T>
  void write_blocks(const std::string& name, std::int64_t rows, int columns,
                    const std::function<void(std::int64_t, std::span<T>)>& make);
  /// Writes a number as an attribute of a group or dataset.
  void attribute(const std::string& object, const std::string& name, double value);
  /// Writes a text as a scalar dataset.
  void write_text(const std::string& name, const std::string& text);

  /// Makes `name` a link to `object` of another file, whose path is relative to this file's folder.
  void link(const std::string& name, const std::string& file, const std::string& object);
  /// Removes the name of an object from the file.
  void remove(const std::string& name);

  /// Whether an object is in this file.
  /// \throws InputError if the name leads through a link to another file or to nowhere
  bool has(const std::string& name) const;
  /// Returns the sorted names of the members of a group.
  std::vector<std::string> members(const std::string& group) const;
  /// Returns the numbers of rows and columns (1 for a vector) of a dataset.
  /// \throws InputError naming the dataset if it is missing, has other than one or two dimensions,
  /// or declares more values than the file holds
  std::pair<std::int64_t, std::int64_t> shape(const std::string& name) const;
  /// Return all values of a dataset, row-major.
  /// \throws InputError if the dataset is missing or has another number of columns
  std::vector<double> read(const std::string& name, int columns = 1) const;
  std::vector<std::int32_t> read_indices(const std::string& name, int columns = 1) const;
  /// Returns a text dataset. \throws InputError if the dataset is missing or is not a text
  std::string read_text(const std::string& name) const;
  /// Returns an attribute. \throws InputError if the attribute is missing or is not a number
  double read_attribute(const std::string& object, const std::string& name) const;

 private:
  Hdf5File(std::int64_t id, std::string path, std::string final_path, std::string key = {})
      : id_(id), path_(std::move(path)), final_path_(std::move(final_path)), key_(std::move(key)) {}
  /// Opens a dataset after checking that all its values lie in this file.
  std::int64_t open_dataset(const std::string& name) const;
  std::int64_t create_dataset(const std::string& name, std::int64_t rows, int columns,
                              std::int64_t type);
  void write_any(const std::string& name, const void* values, std::int64_t count, int columns,
                 std::int64_t type);
  /// Returns the file and `name` in it, for messages.
  std::string where(const std::string& name) const;
  std::int64_t rows_of(const std::string& name, int columns) const;
  void read_any(const std::string& name, std::int64_t type, void* values) const;

  std::int64_t id_ = -1;
  std::string path_, final_path_, key_;
};

}  // namespace floe
