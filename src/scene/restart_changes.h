/// \file
/// Changes of options that a restart allows (docs/restarts.md).
#pragma once

#include <string_view>

#include "floe/options/options.h"

namespace floe {

/// Checks the options against those of the checkpoint; does nothing without a checkpoint.
/// \throws InputError, with both values, for an option of the scene or the command line that may
///   not change and differs from the checkpoint's
void refuse_changes(const UserOptions& user);

/// Checks for options that the checkpoint does not have.
/// \param options  all have been read
/// \throws InputError for an option that may not change, has an effect and is not among the
///   checkpoint's
void refuse_additions(const Options& options, const UserOptions& user);

/// Whether a restart keeps an option of the checkpoint that is not given again: all but those that
/// limit or monitor a single part of a run.
bool is_taken_along(std::string_view option);

}  // namespace floe
