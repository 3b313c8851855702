/// \file
/// Output of a run to the terminal and, alike, to the log file of its output folder.
#pragma once

#include <string>
#include <string_view>

namespace floe {

/// Print on standard output or standard error, and in the log. Call on rank 0 only.
void print(std::string_view text);
void print_error(std::string_view text);

/// Appends to the log only. Allocates no memory once the log is open, so that a signal handler may
/// call it. Never fails: if the log cannot be written, it ends there with one warning.
void put_into_log(std::string_view text) noexcept;

/// Starts to keep printed text for the log that open_log() will begin; without this call no text is
/// kept. Call on rank 0 only.
/// \param heading  first text of the log
void keep_log(std::string heading);

/// Begins a log with the heading and the text printed so far. With `goes_on` an existing log is
/// continued, after a line that marks the restart. Does nothing without keep_log().
/// \throws FileError
void open_log(const std::string& path, bool goes_on);

/// Ends the log with a last line; no further text is kept.
void close_log(std::string_view last_line) noexcept;

/// Opens /dev/null for standard input, output and error if the parent process has closed them.
/// Otherwise files opened later would take the numbers of these streams, and printed text would go
/// into those files. Call before anything else.
void open_closed_streams();

}  // namespace floe
