/// \file
/// The summary.json of a run that crashes.
#pragma once

#include <string>

namespace floe {

/// Writes the summary with the status failed into the room that the run's folder reserves. The
/// crash may have been in the allocator, whose lock it then holds, so write() allocates nothing
/// and takes no lock.
class CrashSummary {
 public:
  /// \param dir       folder of the run
  /// \param reserved  name of the file in it that gives the room
  /// \param facts     members of the summary that are known, as JSON: a whole object
  CrashSummary(const std::string& dir, const std::string& reserved, const std::string& facts);

  /// Writes the summary. Characters of the reason outside ASCII become question marks.
  /// \param why   the reason
  /// \param time  time of the run [s]
  /// \return whether the file is in its place
  bool write(const char* why, double time, long long step) const noexcept;

 private:
  std::string reserved_, summary_, facts_;
  long utc_offset_;  ///< [s]
};

}  // namespace floe
