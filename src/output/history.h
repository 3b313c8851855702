/// \file
/// history.csv: a file of rows. Each row is written by one call, so that a killed run leaves whole
/// rows.
#pragma once

#include <cstdint>
#include <string>

namespace floe {

/// Size and header of the part of a file that is kept.
struct HistoryStart {
  std::int64_t size = 0;  ///< in bytes
  std::string header;     ///< the first line
};
/// Finds the end of the first `keep` rows. \throws InputError if the file has fewer rows, or bytes
/// in them that are not text
HistoryStart history_start(const std::string& path, std::int64_t keep);

/// Writes history.csv; lives on rank 0.
class History {
 public:
  /// \param keep  number of rows of an earlier file to keep; -1: a new file
  /// \throws InputError if the file has fewer rows
  /// \throws FileError
  History(const std::string& path, std::int64_t keep);
  ~History();
  History(const History&) = delete;
  History& operator=(const History&) = delete;

  /// The first line as it is on file; empty in a new file.
  const std::string& header() const { return header_; }
  /// Writes the first line. \throws FileError
  void write_header(const std::string& line);
  /// Appends a row. \param line  ends in a newline
  /// \throws FileError, with the file as it was before
  void write(const std::string& line);
  /// Syncs all rows to the disk, so that they survive a crash of the machine. \throws FileError
  void sync();
  /// Closes the file, as the last call. A full network disk may raise its error only here. \throws
  /// FileError
  void close();

 private:
  std::string path_, header_;
  int file_ = -1;
  std::int64_t size_ = 0;
};

}  // namespace floe
