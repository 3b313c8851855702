/// \file
/// history.csv: a file of rows, each written by one call, so that a run that is killed leaves whole
/// rows.
#pragma once

#include <cstdint>
#include <string>

namespace floe {

/// The first rows of a file.
struct HistoryStart {
  std::int64_t size = 0;  ///< in bytes
  std::string header;     ///< the first line
};
/// \throws InputError if the file has fewer rows than `keep`, or what is no text in them
HistoryStart history_start(const std::string& path, std::int64_t keep);

/// Lives on rank 0.
class History {
 public:
  /// \param keep  number of rows of an earlier file to go on after; -1: a new file
  /// \throws InputError if there are fewer
  History(const std::string& path, std::int64_t keep);
  ~History();
  History(const History&) = delete;
  History& operator=(const History&) = delete;

  /// The first line, as it is on file; empty in a new file.
  const std::string& header() const { return header_; }
  void write_header(const std::string& line);
  /// \param line  ends in a newline \throws FileError, with the file as it was before
  void write(const std::string& line);
  /// All rows so far outlive a crash of the machine. \throws FileError
  void sync();
  /// The last thing. A full network disk may say so only here. \throws FileError
  void close();

 private:
  std::string path_, header_;
  int file_ = -1;
  std::int64_t size_ = 0;
};

}  // namespace floe
