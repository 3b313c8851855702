/// \file
/// Files that are written whole: under a temporary name first, then put in their place at once, so
/// that nobody ever sees a part of one.
#pragma once

#include <string>
#include <string_view>

namespace floe {

/// What temporary names end in.
inline constexpr std::string_view temporary_ending = ".part";

/// The name under which this process writes `path`: several runs, on several machines, may make the
/// same file.
std::string temporary_name(const std::string& path);

/// Removes what processes of this machine that are gone have left beside `path` under temporary
/// names. Never fails.
void remove_left_over(const std::string& path);

/// How a finished file takes its place.
enum class Place {
  renamed,  ///< some file systems bring what is renamed to the disk first: safe, and slow
  swapped,  ///< for what changes often; sync_to_disk() brings it to the disk
};

/// Puts a finished temporary file in the place of `path`; who has the old one open keeps it.
/// Without success neither the temporary file nor a change of `path` is left. \throws FileError
void put_in_place(const std::string& temporary, const std::string& path,
                  Place place = Place::renamed);

/// The file `path` gets a second name, in the place of what has that name; at any instant each of
/// the two names a whole file. Where the file system has no second names it loses the first.
/// Nothing if there is no such file. \throws FileError
void give_second_name(const std::string& path, const std::string& second);

/// Writes a text whole. \throws FileError
void write_whole(const std::string& path, std::string_view text, Place place = Place::renamed);

/// What has been written to a file, or what a folder holds, outlives a crash of the machine from
/// here on. \throws FileError
void sync_to_disk(const std::string& path);

/// The name of this machine.
std::string host_name();

/// The time by the clock on the wall, as 2025-01-31T12:30:05+01:00.
std::string date_and_time();

/// "cannot DO PATH: why", as `error` (errno) says.
[[noreturn]] void throw_file_error(std::string_view what, const std::string& path, int error);

}  // namespace floe
