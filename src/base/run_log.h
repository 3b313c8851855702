/// \file
/// What a run says: on the terminal, and in the log file of its output folder alike.
#pragma once

#include <string>
#include <string_view>

namespace floe {

/// Prints on standard output, or error, and in the log. Called on rank 0.
void print(std::string_view text);
void print_error(std::string_view text);

/// Into the log alone. Takes no memory once the log is open, so that a handler of a signal may call
/// it. Never fails: a log that cannot be written any more ends there, and one warning says so.
void put_into_log(std::string_view text) noexcept;

/// From here on what is printed is kept for the log that open_log() begins; without this nothing
/// is. For rank 0. \param heading  what the log begins with
void keep_log(std::string heading);

/// Begins the log, or goes on with an earlier one after a line that says so, with the heading and
/// with what has been printed so far. Does nothing without keep_log(). \throws FileError
void open_log(const std::string& path, bool goes_on);

/// Ends the log with a last line; nothing is kept for it any more.
void close_log(std::string_view last_line) noexcept;

/// Standard input, output and error that whoever started the process has closed lead to nowhere
/// from here on. Otherwise the next files that are opened would take their numbers, and what is
/// printed would go into these. To be called before anything else.
void open_closed_streams();

}  // namespace floe
