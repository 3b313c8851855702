/// \file
/// Files that are replaced as a whole: they are written under a temporary name and then renamed in
/// one step, so that no reader ever sees a part of a file.
#pragma once

#include <string>
#include <string_view>

namespace floe {

/// The ending of temporary names.
inline constexpr std::string_view temporary_ending = ".part";

/// Returns the temporary name under which this process writes `path`. The name holds host and
/// process, because several runs on several machines may write the same file.
std::string temporary_name(const std::string& path);

/// Removes the temporary files beside `path` that ended processes of this machine left. Never
/// fails.
void remove_left_over(const std::string& path);

/// How a finished file replaces the old one.
enum class Place {
  renamed,  ///< some file systems first write a renamed file to disk: safe, and slow
  swapped,  ///< for files that change often; sync_to_disk() writes them to disk
};

/// Replaces `path` by a finished temporary file. A process that has the old file open keeps it.
/// After a failure `path` is unchanged and the temporary file is removed.
/// \throws FileError
void put_in_place(const std::string& temporary, const std::string& path,
                  Place place = Place::renamed);

/// Gives the file `path` a second name and replaces the file of that name. At any instant each of
/// the two names refers to a whole file. On a file system without hard links the file loses its
/// first name. Does nothing if `path` does not exist.
/// \throws FileError
void give_second_name(const std::string& path, const std::string& second);

/// Writes a text and replaces `path` as a whole. \throws FileError
void write_whole(const std::string& path, std::string_view text, Place place = Place::renamed);

/// Writes a text to an open file, also where a signal interrupts a write. False: errno says why
/// the rest could not be written.
bool write_all(int file, std::string_view text);

/// Flushes a file, or the entries of a folder, to disk, so that they survive a crash of the
/// machine. \throws FileError
void sync_to_disk(const std::string& path);

/// Returns the name of this machine.
std::string host_name();

/// Returns the local date and time, as in 2025-01-31T12:30:05+01:00.
std::string date_and_time();

/// Throws FileError "cannot WHAT PATH: reason", with the reason of `error` (errno; 0: none).
[[noreturn]] void throw_file_error(std::string_view what, const std::string& path, int error);

}  // namespace floe
